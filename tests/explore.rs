//! `asperity explore`, asked over TCP as a browser and as an enemy would: who is answered, what the
//! answers hold, and how the server ends. tests/explore drives the page itself.
#![cfg(feature = "explore")]

mod common;

use std::collections::BTreeMap;
use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpStream};
use std::process::{Child, ChildStderr, Command, Stdio};
use std::sync::Barrier;
use std::time::{Duration, Instant};

use asperity::Case;
use rustix::process::{Pid, Signal, kill_process};
use serde_json::Value;

use common::{asperity, interruption, program, stderr};

/// A coarse case, so that a simulation takes seconds.
const CASE: &str = r#"
sphere = { radius = 1.0 }
contact = { friction = 0.3 }
mesh = { elements_per_contact_radius = 4 }
units = { length = "mm", force = "N", stress = "MPa" }
path = [{ indentation = 0.02 }, { shear = "full-slip" }]
[material]
youngs_modulus = 200e3
poissons_ratio = 0.3
hardening = { law = "ideal", yield_stress = 400.0 }
"#;
const PATIENCE: Duration = Duration::from_secs(60);

/// A server, ended with the test.
struct Page {
    child: Child,
    port: u16,
    token: String,
    said: BufReader<ChildStderr>,
    /// Holds the case.
    _dir: tempfile::TempDir,
}

struct Answer {
    status: u16,
    headers: BTreeMap<String, String>,
    body: Vec<u8>,
}

impl Answer {
    fn text(&self) -> String {
        String::from_utf8(self.body.clone()).expect("text")
    }

    fn json(&self) -> Value {
        serde_json::from_slice(&self.body).unwrap_or_else(|error| panic!("{error}: {}", self.text()))
    }
}

impl Page {
    fn open(options: &[&str]) -> Self {
        let dir = tempfile::tempdir().expect("a directory");
        let case = dir.path().join("case.toml");
        fs::write(&case, CASE).expect("the case");
        let mut command = program();
        command.arg("explore").arg(&case).arg("--no-browser").args(["--device", "cpu"]).args(options);
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().expect("the program runs");
        let mut address = String::new();
        BufReader::new(child.stdout.take().expect("stdout")).read_line(&mut address).expect("an address");
        let said = BufReader::new(child.stderr.take().expect("stderr"));
        let rest = address.trim().strip_prefix("http://127.0.0.1:").unwrap_or_else(|| panic!("{address}"));
        let (port, token) = rest.split_once('/').expect("a token");
        Self { child, port: port.parse().expect("a port"), token: token.trim_end_matches('/').to_owned(), said, _dir: dir }
    }

    /// Sends bytes and takes all that comes back.
    fn exchange(&self, request: &[u8]) -> Vec<u8> {
        let mut stream = TcpStream::connect((Ipv4Addr::LOCALHOST, self.port)).expect("it listens");
        stream.set_read_timeout(Some(PATIENCE)).expect("a limit");
        // Who is refused early may be cut off while it still writes.
        let _ = stream.write_all(request);
        let mut back = Vec::new();
        let _ = stream.read_to_end(&mut back);
        back
    }

    fn ask(&self, method: &str, target: &str, more: &str) -> Answer {
        let request = format!("{method} {target} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n{more}\r\n", self.port);
        answer(&self.exchange(request.as_bytes()))
    }

    fn get(&self, path: &str) -> Answer {
        self.ask("GET", &format!("/{}/{path}", self.token), "")
    }

    fn post(&self, path: &str) -> Answer {
        let origin = format!("Origin: http://127.0.0.1:{}\r\nContent-Length: 0\r\n", self.port);
        self.ask("POST", &format!("/{}/{path}", self.token), &origin)
    }

    /// Ends it with a signal; its exit code and what it said.
    fn end(mut self, signal: Signal) -> (Option<i32>, String) {
        kill_process(Pid::from_child(&self.child), signal).expect("a signal is sent");
        self.ended()
    }

    fn ended(&mut self) -> (Option<i32>, String) {
        let begun = Instant::now();
        let status = loop {
            if let Some(status) = self.child.try_wait().expect("a child") {
                break status;
            }
            assert!(begun.elapsed() < PATIENCE, "it does not end");
            std::thread::sleep(Duration::from_millis(20));
        };
        let mut said = String::new();
        self.said.read_to_string(&mut said).expect("text");
        (status.code(), said)
    }
}

impl Drop for Page {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn answer(bytes: &[u8]) -> Answer {
    let end = bytes.windows(4).position(|end| end == b"\r\n\r\n");
    let end = end.unwrap_or_else(|| panic!("no answer: {:?}", String::from_utf8_lossy(bytes)));
    let head = String::from_utf8(bytes[..end].to_vec()).expect("a head");
    let mut lines = head.lines();
    let status = lines.next().and_then(|line| line.split(' ').nth(1)).and_then(|code| code.parse().ok()).expect("a status");
    let header = |line: &str| line.split_once(": ").map(|(name, value)| (name.to_ascii_lowercase(), value.to_owned()));
    Answer { status, headers: lines.filter_map(header).collect(), body: bytes[end + 4..].to_vec() }
}

#[test]
fn who_has_not_the_address_is_refused_in_plain_words() {
    let page = Page::open(&[]);
    assert_eq!(page.get("").status, 200);
    let refused = |answer: Answer, status: u16| {
        assert_eq!(answer.status, status, "{}", answer.text());
        assert!(answer.headers["content-type"].starts_with("text/plain") && answer.text().starts_with("asperity explore: "));
        assert!(!answer.text().contains(&page.token));
    };
    refused(page.ask("GET", "/", ""), 403);
    refused(page.ask("GET", &format!("/{}/", "0".repeat(32)), ""), 403);
    refused(page.ask("GET", &format!("/{}/curves", page.token), "Origin: http://evil.example\r\n"), 403);
    refused(
        page.ask("GET", &format!("/{}/curves", page.token), "Sec-Fetch-Site: cross-site\r\nSec-Fetch-Mode: no-cors\r\n"),
        403,
    );
    refused(page.ask("POST", &format!("/{}/simulate", page.token), ""), 403);
    refused(page.ask("POST", &format!("/{}/simulate", page.token), "Origin: null\r\n"), 403);
    refused(page.ask("PUT", &format!("/{}/", page.token), ""), 405);
    refused(page.get("simulate"), 405);
    refused(page.post("curves"), 405);
    refused(page.get("export/../../etc/passwd"), 404);
    refused(page.get("nothing"), 404);
    // A name that somebody has pointed at 127.0.0.1.
    let rebound = format!("GET /{}/ HTTP/1.1\r\nHost: evil.example:{}\r\n\r\n", page.token, page.port);
    refused(answer(&page.exchange(rebound.as_bytes())), 421);
    assert_eq!(page.get("simulation").json()["stage"], "none");
}

#[test]
fn a_hostile_query_is_refused_and_does_no_harm() {
    let page = Page::open(&[]);
    for (query, status) in [
        ("evil=1", 400),
        ("radius=1&radius=2", 400),
        ("radius=%zz", 400),
        ("radius=%00", 400),
        ("radius=%ff", 400),
        (&*"a".repeat(50_000), 414),
        (&*format!("radius={}", "9".repeat(4000)), 200),
        ("radius=<script>alert(1)</script>", 200),
        ("radius=1e308&youngs_modulus=1e-300", 200),
        ("indentation=1e-300", 200),
        ("friction=1e300", 200),
        ("friction=0", 200),
        ("friction=stick", 200),
        ("width=1e300&frame=-1&axes=none", 200),
        ("law=table&points=0+1;0+1", 200),
        ("opponent=sphere&opponent.radius=1e-9", 200),
        ("elements=60000", 200),
    ] {
        let answer = page.get(&format!("curves?{query}"));
        assert_eq!(answer.status, status, "{query}: {}", answer.text());
        if status == 200 {
            let told = answer.json();
            assert!(told["mistakes"].is_array() || told["problem"].is_string(), "{query}: {told}");
        }
    }
    // Heads without an end, of the wrong kind, of any length; and a client that goes away.
    assert_eq!(answer(&page.exchange(&[b'A'; 80_000])).status, 431);
    assert_eq!(answer(&page.exchange(b"\0\xff\r\n\r\n")).status, 400);
    assert_eq!(answer(&page.exchange(b"GET / HTTP/1.1\r\nHost: a\r\nHost: b\r\n\r\n")).status, 400);
    drop(TcpStream::connect((Ipv4Addr::LOCALHOST, page.port)).expect("it listens"));
    let html = page.get("?radius=%22%3E%3Cscript%3Ealert(1)%3C/script%3E").text();
    assert!(!html.contains("<script>alert"), "{html}");
    assert_eq!(page.get("curves").json()["mistakes"], serde_json::json!([]));
}

#[test]
fn the_page_is_small_and_nothing_in_it_comes_from_elsewhere() {
    let page = Page::open(&[]);
    let files = ["", "page.css", "page.js"].map(|path| page.get(path));
    let all: usize = files.iter().map(|file| file.body.len()).sum();
    assert!(all < 100_000, "{all} bytes");
    for file in &files {
        let policy = &file.headers["content-security-policy"];
        assert!(policy.contains("default-src 'none'") && !policy.contains("unsafe") && policy.contains("frame-ancestors 'none'"));
        assert_eq!(
            (file.headers["cache-control"].as_str(), file.headers["referrer-policy"].as_str()),
            ("no-store", "no-referrer")
        );
        assert!(!file.text().contains("http"), "{}", file.text());
    }
    let head = page.ask("HEAD", &format!("/{}/", page.token), "");
    assert!(head.status == 200 && head.body.is_empty() && head.headers["content-length"] != "0");
}

#[test]
fn curves_are_those_of_law_predict() {
    let page = Page::open(&[]);
    let told = page.get("curves?poissons_ratio=0.25&friction=0.2&indentation=0.01&width=400").json();
    let names: Vec<&str> = told["drawings"].as_array().unwrap().iter().map(|one| one["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["press", "tangential", "normal", "cycle"]);
    for drawing in told["drawings"].as_array().unwrap() {
        assert!(drawing["svg"].as_str().unwrap().starts_with("<svg width=\"400px\""), "{drawing}");
        for curve in drawing["curves"].as_array().unwrap() {
            assert!(curve["source"].as_str().unwrap().len() > 10 && curve["trust"].as_str().unwrap().len() > 10);
        }
    }
    let number = |symbol: &str| -> f64 {
        let row = told["numbers"].as_array().unwrap().iter().find(|row| row["symbol"] == symbol).unwrap();
        row["law"].as_str().unwrap().parse().unwrap()
    };
    let dir = tempfile::tempdir().unwrap();
    let case = dir.path().join("case.toml");
    fs::write(&case, page.get("export/case.toml?poissons_ratio=0.25&friction=0.2&indentation=0.01").text()).unwrap();
    let predicted = asperity(&["law", "predict", "built-in", case.to_str().unwrap()]);
    assert!(predicted.status.success(), "{}", stderr(&predicted));
    let rows = common::stdout(&predicted);
    let rows: Vec<Vec<f64>> =
        rows.lines().skip(1).map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect()).collect();
    let f_n0 = rows.iter().rfind(|row| row[0] == 0.0).unwrap()[3];
    let f_t = rows.iter().map(|row| row[4]).fold(0.0, f64::max);
    for (shown, own) in [(number("F_N0"), f_n0), (number("F_T,max"), f_t)] {
        assert!((shown / own - 1.0).abs() < 1e-5, "{shown} and {own}");
    }
    // Where they are given as numbers, they are the same ones.
    let csv = page.get("export/curves.csv?poissons_ratio=0.25&friction=0.2&indentation=0.01").text();
    let own = common::stdout(&predicted);
    let last = own.lines().rfind(|line| line.starts_with("1,")).unwrap();
    assert!(csv.lines().any(|line| line == format!("shear,{last}")), "{last}");
}

/// A number of the law as the page has it, none where the cell is empty.
fn number(told: &Value, symbol: &str, column: &str) -> Option<f64> {
    let rows = told["numbers"].as_array().unwrap_or_else(|| panic!("{told}"));
    rows.iter().find(|row| row["symbol"] == symbol).and_then(|row| row[column].as_str()).and_then(|cell| cell.parse().ok())
}

#[test]
fn lambda_is_that_of_the_body_that_yields_first() {
    let page = Page::open(&[]);
    let told = |query: &str| page.get(&format!("curves?{query}")).json();
    // At first yield it is Johnson's, whatever the sphere meets.
    for opponent in ["plane", "equal", "sphere", "flat"] {
        let first = number(&told(&format!("opponent={opponent}")), "h_Y", "closed").unwrap();
        let there = told(&format!("opponent={opponent}&indentation={first:e}"));
        let [lambda, own] =
            [("Λ", "law"), ("Λ_Y", "closed")].map(|(symbol, column)| number(&there, symbol, column).unwrap_or(2.533));
        assert!((lambda / own - 1.0).abs() < 0.05, "{opponent}: {lambda} and {own}");
    }
    // Which of the two bodies is the weak one does not matter.
    let pair = |sphere: f64, flat: f64| {
        let query =
            format!("yield_stress={sphere}&opponent=flat&opponent.material=own&opponent.law=ideal&opponent.yield_stress={flat}");
        number(&told(&query), "Λ", "law").unwrap()
    };
    let [weak, strong] = [pair(100.0, 1000.0), pair(1000.0, 100.0)];
    assert!((weak / strong - 1.0).abs() < 0.02 && weak > 100.0, "{weak} and {strong}");
}

#[test]
fn two_spheres_have_a_force_at_full_slip() {
    let told = Page::open(&[]).get("curves?opponent=equal&indentation=0.04").json();
    let [before, slip] = ["F_N0", "F_N,slip"].map(|symbol| number(&told, symbol, "law").unwrap());
    assert!(slip > 0.5 * before && slip < 0.95 * before, "{slip} of {before}");
}

#[test]
fn a_long_measured_table_is_taken_and_its_mistakes_stand_at_its_field() {
    let page = Page::open(&[]);
    let points: Vec<String> = (0..300).map(|i| format!("{:.10}+{:.10}", f64::from(i) / 300.0, 100.0 + f64::from(i))).collect();
    let told = page.get(&format!("curves?law=table&points={}", points.join("%3B"))).json();
    assert_eq!(told["mistakes"], serde_json::json!([]), "{told}");
    assert_eq!(page.get("curves?law=table&points=0+100%3B0.1+50").json()["mistakes"][0]["field"], "points");
}

#[test]
fn mistakes_stand_at_their_fields_and_warnings_are_those_of_law_predict() {
    let page = Page::open(&[]);
    let told = page.get("curves?poissons_ratio=0.7").json();
    assert_eq!(told["mistakes"][0]["field"], "poissons_ratio");
    let outside = page.get("curves?indentation=0.25").json();
    assert!(outside["warnings"][0].as_str().unwrap().starts_with("a/R = 0.5"), "{outside}");
    assert!(page.get("curves?opponent=rigid").json()["problem"].as_str().unwrap().contains("rigid sphere"));
    assert!(page.get("curves?friction=stick&path=slip").json()["mistakes"][0]["what"].as_str().unwrap().contains("stick"));
}

#[test]
fn what_is_exported_can_be_used() {
    let page = Page::open(&[]);
    let dir = tempfile::tempdir().unwrap();
    let query = "law=voce&yield_stress=300&saturation_stress=600&rate=15&path=cycle&displacement=0.004&elements=4";
    let kept = |name: &str| {
        let file = page.get(&format!("export/{name}?{query}"));
        assert_eq!(file.status, 200, "{name}: {}", file.text());
        assert!(file.headers["content-disposition"].contains(&format!("filename=\"{name}\"")));
        let path = dir.path().join(name);
        fs::write(&path, &file.body).unwrap();
        path
    };
    let case = Case::load(&kept("case.toml"), &[]).unwrap();
    assert_eq!((case.path.len(), case.mesh.elements_per_contact_radius), (5, 4));
    let checked = asperity(&["check", dir.path().join("case.toml").to_str().unwrap()]);
    assert!(checked.status.success(), "{}", stderr(&checked));
    let run = |command: &str| {
        let output = Command::new("bash").args(["-euc", command]).current_dir(dir.path()).output().expect("bash");
        assert!(output.status.success(), "{command}: {}", stderr(&output));
        common::stdout(&output)
    };
    for name in ["engine-c.tar", "engine-lammps.tar", "asperity_law.h", "asperity_law.py"] {
        kept(name);
    }
    run("tar xf engine-c.tar && tar xf engine-lammps.tar");
    assert!(fs::read_to_string(dir.path().join("engine-lammps/in.asperity")).unwrap().contains("sphere.asperity"));
    // What LAMMPS gets is what `law export` writes, which the tests of the plug-in run.
    fs::rename(dir.path().join("case.toml"), dir.path().join("sphere.toml")).unwrap();
    let export = ["law", "export", "built-in", "sphere.toml", "--for", "lammps", "--out", "exported"];
    let exported = program().args(export).current_dir(dir.path()).output().unwrap();
    assert!(exported.status.success(), "{}", stderr(&exported));
    run("diff -r -x README.txt engine-lammps exported");
    if Command::new("cc").arg("--version").output().is_err() {
        assert!(std::env::var_os("ASPERITY_REQUIRE_COMPILERS").is_none(), "there is no cc");
        eprintln!("SKIPPED the C of the page: there is no cc");
        return;
    }
    let printed = run("cd engine-c && cc -std=c99 -O2 main.c -o main -lm && ./main");
    assert!(printed.contains("sphere on a wall: restitution 0."), "{printed}");
    fs::write(dir.path().join("one.c"), "#include \"asperity_law.h\"\nint main(void) { return 0; }\n").unwrap();
    run("cc -std=c99 -Wall one.c -o one -lm && ./one");
}

#[test]
fn a_simulation_is_started_watched_and_cancelled() {
    let page = Page::open(&["--threads", "1"]);
    let until = |stages: &[&str]| -> Value {
        let begun = Instant::now();
        loop {
            let told = page.get("simulation").json();
            if stages.contains(&told["stage"].as_str().unwrap()) {
                return told;
            }
            assert!(begun.elapsed() < Duration::from_secs(300), "{told}");
            std::thread::sleep(Duration::from_millis(50));
        }
    };
    let query = "elements=4&indentation=0.01";
    assert_eq!(page.post(&format!("simulate?{query}")).json()["stage"], "running");
    assert_eq!(page.post(&format!("simulate?{query}")).status, 409);
    assert_eq!(page.post("cancel").status, 200);
    assert_eq!(until(&["cancelled", "done"])["stage"], "cancelled");
    assert_eq!(page.post(&format!("simulate?{query}")).json()["stage"], "running");
    let done = until(&["done", "failed", "cancelled"]);
    assert_eq!(done["stage"], "done", "{done}");
    let told = page.get(&format!("curves?{query}")).json();
    assert!(told["simulated"].as_bool().unwrap() && !told["other"].as_bool().unwrap());
    let row = told["numbers"].as_array().unwrap().iter().find(|row| row["symbol"] == "F_N0").unwrap().clone();
    let [law, run] = ["law", "simulation"].map(|column| row[column].as_str().unwrap().parse::<f64>().unwrap());
    assert!((run / law - 1.0).abs() < 0.08, "{row}");
    assert!(told["drawings"][0]["curves"].as_array().unwrap().iter().any(|curve| curve["name"] == "simulation"));
    // The numbers of a run along another path are not those of the law's.
    assert!(number(&told, "F_T,max", "simulation").is_some());
    let query = "elements=4&indentation=0.01&path=cycle&displacement=0.0003";
    assert_eq!(page.post(&format!("simulate?{query}")).json()["stage"], "running");
    assert_eq!(until(&["done", "failed", "cancelled"])["stage"], "done");
    let other = page.get(&format!("curves?{query}")).json();
    assert!(other["simulated"].as_bool().unwrap() && number(&other, "F_T,max", "simulation").is_none(), "{other}");
    let done = page.get("simulation").json();
    // At other values it is not shown.
    assert!(page.get("curves?elements=4").json()["other"].as_bool().unwrap());
    let frames = done["frames"].as_u64().unwrap();
    assert!(frames > 5, "{done}");
    assert!(page.get(&format!("frame?frame={}", frames - 1)).json()["svg"].as_str().unwrap().starts_with("<svg"));
    assert_eq!(page.get(&format!("frame?frame={frames}")).status, 404);
}

#[test]
fn a_thousand_requests_at_once_do_no_harm() {
    let page = Page::open(&[]);
    let request = |i: usize| {
        let path = if i.is_multiple_of(10) { format!("curves?indentation=0.0{}", 1 + i % 7) } else { "page.css".to_owned() };
        format!("GET /{}/{path} HTTP/1.1\r\nHost: 127.0.0.1:{}\r\n\r\n", page.token, page.port)
    };
    let place = SocketAddr::from((Ipv4Addr::LOCALHOST, page.port));
    let begin = Barrier::new(1001);
    let answered: usize = std::thread::scope(|scope| {
        let one = |i: usize| {
            let (begin, request) = (&begin, request(i));
            let work = move || {
                begin.wait();
                let mut stream = TcpStream::connect_timeout(&place, PATIENCE).expect("a connection waits its turn");
                stream.set_read_timeout(Some(PATIENCE)).expect("a limit");
                let mut back = Vec::new();
                let _ = stream.write_all(request.as_bytes()).and_then(|()| stream.read_to_end(&mut back));
                usize::from(back.starts_with(b"HTTP/1.1 200 OK"))
            };
            std::thread::Builder::new().stack_size(128 * 1024).spawn_scoped(scope, work).expect("a thread")
        };
        let threads: Vec<_> = (0..1000).map(one).collect();
        begin.wait();
        std::thread::sleep(Duration::from_millis(300));
        let status = fs::read_to_string(format!("/proc/{}/status", page.child.id())).unwrap_or_default();
        if let Some(own) = status.lines().find_map(|line| line.strip_prefix("Threads:")) {
            assert!(own.trim().parse::<usize>().unwrap() < 32, "{own} threads");
        }
        threads.into_iter().map(|thread| thread.join().expect("no panic")).sum()
    });
    assert_eq!(answered, 1000);
    assert_eq!(page.get("curves").status, 200);
    let (code, said) = page.end(interruption());
    assert_eq!(code, Some(0), "{said}");
}

#[test]
fn it_listens_on_the_loopback_address_alone() {
    let page = Page::open(&[]);
    let tables = ["/proc/net/tcp", "/proc/net/tcp6"].map(|path| fs::read_to_string(path).unwrap_or_default());
    let wanted = format!(":{:04X}", page.port);
    let listens: Vec<&str> = tables
        .iter()
        .flat_map(|table| table.lines())
        .filter_map(|line| {
            let cells: Vec<&str> = line.split_whitespace().collect();
            (cells.get(3) == Some(&"0A")).then(|| cells[1])
        })
        .filter(|local| local.ends_with(&wanted))
        .collect();
    assert_eq!(listens, [format!("0100007F{wanted}")]);
}

#[test]
fn it_ends_with_a_signal_and_tells_of_a_simulation_that_was_running() {
    let page = Page::open(&[]);
    assert_eq!(page.post("simulate?elements=8").json()["stage"], "running");
    let (code, said) = page.end(interruption());
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("the simulation that was running is cancelled") && said.trim_end().ends_with("ended"), "{said}");
    let (code, _) = Page::open(&[]).end(Signal::TERM);
    assert_eq!(code, Some(0));
}

#[test]
fn it_ends_by_itself_when_nobody_asks_any_more() {
    let mut page = Page::open(&["--idle", "1"]);
    // What is refused is no request.
    for _ in 0..3 {
        assert_eq!(page.ask("GET", "/", "").status, 403);
        std::thread::sleep(Duration::from_millis(200));
    }
    let (code, said) = page.ended();
    assert_eq!(code, Some(0));
    assert!(said.contains("nobody asked"), "{said}");
}

#[test]
fn what_cannot_be_served_is_an_error_that_says_what_to_do() {
    let page = Page::open(&[]);
    let taken = asperity(&["explore", "--no-browser", "--port", &page.port.to_string()]);
    assert_eq!(taken.status.code(), Some(2));
    assert!(stderr(&taken).contains(&format!("--port {}", page.port)), "{}", stderr(&taken));
    let missing = asperity(&["explore", "nothing.toml", "--no-browser"]);
    assert_eq!(missing.status.code(), Some(2));
    let no_study = asperity(&["explore", "--study", "nothing", "--no-browser"]);
    assert!(no_study.status.code() == Some(2) && stderr(&no_study).contains("study.csv"), "{}", stderr(&no_study));
}

/// A study and a run lie over the law as points.
#[test]
fn results_that_are_there_lie_over_the_law() {
    let dir = tempfile::tempdir().unwrap();
    let study = format!(
        "[base]\n{}\n[grid]\n\"path.0.indentation\" = [0.01, 0.02]\n",
        CASE.replace("\n[material]", "\n[base.material]").replace("\n\n", "\n")
    );
    let file = dir.path().join("study.toml");
    fs::write(&file, study).unwrap();
    let out = dir.path().join("study");
    let made = asperity(&["study", file.to_str().unwrap(), "--out", out.to_str().unwrap(), "--device", "cpu", "-q"]);
    assert!(made.status.success(), "{}", stderr(&made));
    let page = Page::open(&["--study", out.to_str().unwrap()]);
    assert!(page.get("").text().contains("μ = 0.3, h = 0.01"));
    let told = page.get("curves?indentation=0.01").json();
    let names =
        |i: usize| told["drawings"][i]["curves"].as_array().unwrap().iter().map(|c| c["name"].clone()).collect::<Vec<_>>();
    assert!(names(0).contains(&"study".into()) && names(1).contains(&"study".into()), "{told}");
    assert!(!page.get("curves?friction=0.1").text().contains("case c0001 of the study"));
    // The directory of a run in place of a case.
    let run = out.join("cases/c0002");
    let mut child = program()
        .args(["explore", run.to_str().unwrap(), "--no-browser"])
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("the program runs");
    let mut address = String::new();
    BufReader::new(child.stdout.take().expect("stdout")).read_line(&mut address).expect("an address");
    let (port, token) = address.trim().strip_prefix("http://127.0.0.1:").unwrap().split_once('/').unwrap();
    let mut stream = TcpStream::connect((Ipv4Addr::LOCALHOST, port.parse().unwrap())).unwrap();
    write!(stream, "GET /{token}curves HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n").unwrap();
    let mut back = Vec::new();
    stream.read_to_end(&mut back).unwrap();
    assert!(answer(&back).json()["simulated"].as_bool().unwrap());
    child.kill().unwrap();
    child.wait().unwrap();
}
