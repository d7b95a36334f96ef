//! Tables of engines, changed, through the reader in C that engines have and the update behind it,
//! compiled with checks of addresses and of undefined behaviour.

use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::Mutex;

use asperity::law::LawFile;
use asperity::law::export::engine_files;
use rand_chacha::ChaCha8Rng;

use super::super::programs::has;
use super::runner::fuzz;
use super::{any, changed_table, corpus};

/// The reader: paths go in by line, and an answer comes out for each.
struct Reader {
    child: Child,
    paths: ChildStdin,
    answers: BufReader<ChildStdout>,
}

impl Reader {
    fn start(program: &Path) -> Self {
        let mut child = Command::new(program).stdin(Stdio::piped()).stdout(Stdio::piped()).spawn().expect("it starts");
        let paths = child.stdin.take().expect("a pipe");
        let answers = BufReader::new(child.stdout.take().expect("a pipe"));
        Self { child, paths, answers }
    }

    fn takes(&mut self, path: &Path) -> bool {
        writeln!(self.paths, "{}", path.display()).expect("it is there");
        let mut answer = String::new();
        self.answers.read_line(&mut answer).expect("it is there");
        match answer.trim() {
            "1" => true,
            "0" => false,
            _ => panic!("the reader ended with {:?}", self.child.wait()),
        }
    }
}

impl Drop for Reader {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn changed_tables_of_engines() {
    if !has("gcc", "changed_tables_of_engines") {
        return;
    }
    let dir = tempfile::tempdir().expect("a scratch directory");
    let laws: Vec<LawFile> = corpus::tables()
        .into_iter()
        .map(|table| LawFile::Table(Box::new(serde_json::from_value(table).expect("a table"))))
        .collect();
    let files = |law: &LawFile| engine_files(law, None).expect("files");
    for file in files(&laws[0]) {
        fs::write(dir.path().join(file.name), file.content).expect("written");
    }
    let tables: Vec<Vec<u8>> = laws
        .iter()
        .flat_map(files)
        .filter(|file| file.name == "law.asperity")
        // Of the columns a table is made of its numbers, each in a cell of its own.
        .map(|file| file.content.replace(' ', ",").into_bytes())
        .collect();
    fs::write(dir.path().join("engine.c"), include_str!("engine.c")).expect("written");
    let program = dir.path().join("engine");
    let checks = ["-fsanitize=address,undefined,float-cast-overflow", "-fno-sanitize-recover=all"];
    let mut compiler = Command::new("gcc");
    compiler.args(["-std=c99", "-O1"]).args(checks).arg(dir.path().join("engine.c")).arg("-lm").arg("-o").arg(&program);
    let built = compiler.output().expect("gcc runs");
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    let next = move |rng: &mut ChaCha8Rng| {
        let table: &Vec<u8> = any(rng, &tables);
        let changed = changed_table(rng, table);
        changed.into_iter().map(|byte| if byte == b',' { b' ' } else { byte }).collect()
    };
    let reader = Mutex::new(Reader::start(&program));
    fuzz("engine", 0.1, next, move |_, path| {
        let _scratch = &dir;
        reader.lock().expect("one at a time").takes(path)
    });
}
