//! The decks: what they hold, and that CalculiX takes them.

use std::path::Path;

use super::*;

/// CalculiX' manual, "Eight-node brick element": nodes of the faces S1 to S6, counted from 1.
const MANUAL: [[usize; 4]; 6] = [[1, 2, 3, 4], [5, 8, 7, 6], [1, 5, 6, 2], [2, 6, 7, 3], [3, 7, 8, 4], [4, 8, 5, 1]];

fn case(keys: &[&str]) -> (Case, Problem) {
    case_of("case.toml", keys)
}

fn case_of(name: &str, keys: &[&str]) -> (Case, Problem) {
    let file = &Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/benches/against_ccx")).join(name);
    let keys: Vec<String> =
        ["mesh.elements_per_contact_radius=4", "mesh.fine_zone=1.3"].iter().chain(keys).map(|key| (*key).to_owned()).collect();
    let case = Case::load(file, &keys).expect("a case");
    let problem = Problem::new(&case).expect("a problem");
    (case, problem)
}

fn text(keys: &[&str]) -> Result<String, String> {
    text_of("case.toml", keys)
}

fn text_of(name: &str, keys: &[&str]) -> Result<String, String> {
    let (case, problem) = case_of(name, keys);
    deck(&case, &problem, &KNOWN_TO_FINISH).map_err(|error| error.to_string())
}

/// Lines of data under the cards that begin with `card`.
fn data<'a>(deck: &'a str, card: &str) -> Vec<Vec<&'a str>> {
    let mut found = Vec::new();
    let mut inside = false;
    for line in deck.lines() {
        if line.starts_with('*') {
            inside = line.starts_with(card);
        } else if inside {
            found.push(line.split(',').map(str::trim).filter(|word| !word.is_empty()).collect());
        }
    }
    found
}

fn number(word: &str) -> f64 {
    word.parse().expect("a number")
}

#[test]
fn the_contact_surface_is_that_of_the_mesh() {
    let (_, problem) = case(&[]);
    let (deck, mesh) = (text(&[]).expect("a deck"), &problem.model.mesh);
    assert_eq!(data(&deck, "*NODE, NSET=BODY").len(), mesh.nodes.len());
    assert_eq!(data(&deck, "*ELEMENT, TYPE=C3D8, ELSET=SPHERE").len(), mesh.elements.len());
    let faces = |face: &[u32; 4]| face.iter().copied().collect::<BTreeSet<u32>>();
    let wanted: BTreeSet<_> = mesh.contact_faces.iter().map(faces).collect();
    let found: BTreeSet<_> = data(&deck, "*SURFACE, NAME=BELOW")
        .iter()
        .map(|row| {
            let element: usize = row[0].parse().expect("an element");
            let side: usize = row[1].strip_prefix('S').and_then(|s| s.parse().ok()).expect("a side");
            faces(&MANUAL[side - 1].map(|local| mesh.elements[element - 1][local - 1]))
        })
        .collect();
    assert_eq!(found, wanted);
    // The plane's S2 is its top, z = 0, wide enough for the whole lower half.
    let plane = data(&deck, "*NODE, NSET=HELD");
    for local in MANUAL[1] {
        assert!(number(plane[local - 1][3]) == 0.0 && number(plane[local - 1][1]).abs() == 2.0, "{plane:?}");
    }
}

#[test]
fn every_name_is_defined_and_every_node_held_once() {
    ["case.toml", "pairs/unlike.toml", "pairs/larger.toml", "pairs/flat.toml"].into_iter().for_each(names_and_nodes);
}

fn names_and_nodes(name: &str) {
    let deck = text_of(name, &[]).expect("a deck");
    let defined: BTreeSet<&str> = deck
        .lines()
        .filter(|l| l.starts_with('*'))
        .flat_map(|l| l.split(", "))
        .filter_map(|w| w.split_once('='))
        .map(|(_, n)| n)
        .collect();
    for row in data(&deck, "*BOUNDARY").iter().chain(&data(&deck, "*CONTACT PAIR")) {
        assert!(row.iter().take(2).filter(|word| word.parse::<f64>().is_err()).all(|name| defined.contains(name)), "{row:?}");
    }
    let nodes = |set: &str| -> BTreeSet<String> { data(&deck, set).concat().iter().map(|n| n.to_string()).collect() };
    let (equator, symmetry) = (nodes("*NSET, NSET=EQUATOR"), nodes("*NSET, NSET=SYMMETRY"));
    assert!(!equator.is_empty() && !symmetry.is_empty() && equator.is_disjoint(&symmetry));
    let held = nodes("*NSET, NSET=HELD");
    assert_eq!(held.is_empty(), name == "case.toml");
    assert!(held.is_disjoint(&symmetry) && held.is_disjoint(&equator));
}

/// Position of each node, and the nodes of each element from 0 on.
fn mesh_of(deck: &str) -> (Vec<[f64; 3]>, Vec<Vec<usize>>) {
    let nodes = data(deck, "*NODE, NSET=BODY").iter().map(|row| [1, 2, 3].map(|i| number(row[i]))).collect();
    let element = |row: &Vec<&str>| row[1..].iter().map(|n| n.parse::<usize>().expect("a node") - 1).collect();
    (nodes, data(deck, "*ELEMENT").iter().map(element).collect())
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| a[i] - b[i])
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

#[test]
fn an_opponent_lies_below_with_its_volume_and_its_surface() {
    for name in ["pairs/unlike.toml", "pairs/larger.toml", "pairs/flat.toml"] {
        let deck = text_of(name, &[]).expect("a deck");
        let (nodes, elements) = mesh_of(&deck);
        let above = data(&deck, "*ELEMENT, TYPE=C3D8, ELSET=SPHERE").len();
        assert!(0 < above && above < elements.len());
        for (e, element) in elements.iter().enumerate() {
            let at = |i: usize| nodes[element[i]];
            let edges = [1, 3, 4].map(|i| minus(at(i), at(0)));
            assert!(dot(cross(edges[0], edges[1]), edges[2]) > 0.0, "{name}: element {e}");
            assert!((0..8).all(|i| if e < above { at(i)[2] >= 0.0 } else { at(i)[2] <= 0.0 }), "{name}: element {e}");
        }
        // The manual has the nodes of all faces around the inward normal: up on the sphere,
        // down in what lies below. Both surfaces have a node at the pole.
        for (surface, inward) in [("BELOW", 1.0), ("ABOVE", -1.0)] {
            let mut nearest = f64::INFINITY;
            for row in data(&deck, &format!("*SURFACE, NAME={surface},")) {
                let element: usize = row[0].parse().expect("an element");
                let side: usize = row[1].strip_prefix('S').and_then(|s| s.parse().ok()).expect("a side");
                let corners = MANUAL[side - 1].map(|local| nodes[elements[element - 1][local - 1]]);
                let normal = cross(minus(corners[2], corners[0]), minus(corners[3], corners[1]));
                assert!((element - 1 < above) == (inward > 0.0), "{name}: {surface} has the other body");
                nearest = corners.iter().map(|x| dot(*x, *x)).fold(nearest, f64::min);
                let centre = [0, 1, 2].map(|i| corners.iter().map(|x| x[i]).sum::<f64>() / 4.0);
                if dot(centre, centre) < 0.01 {
                    assert!(inward * normal[2] > 0.0, "{name}: {surface} {row:?}");
                }
            }
            assert!(nearest < 1e-20, "{name}: {surface} is {nearest} from the pole");
        }
    }
}

#[test]
fn each_body_has_its_material_and_the_softer_one_is_the_slave() {
    let plastic = |deck: &str| data(deck, "*PLASTIC").iter().map(|row| number(row[0])).collect::<Vec<_>>();
    let elastic = |deck: &str| data(deck, "*ELASTIC").iter().map(|row| [number(row[0]), number(row[1])]).collect::<Vec<_>>();
    let near = |a: f64, b: f64| (a / b - 1.0).abs() < 1e-9;
    let unlike = text_of("pairs/unlike.toml", &[]).expect("a deck");
    assert_eq!(elastic(&unlike), [[200e3, 0.3], [600e3, 0.3]]);
    let yields = plastic(&unlike);
    assert!(yields.len() == 2 && near(yields[0], 400.0) && near(yields[1], 800.0), "{yields:?}");
    assert_eq!(data(&unlike, "*CONTACT PAIR"), [["BELOW", "ABOVE"]]);
    let larger = text_of("pairs/larger.toml", &[]).expect("a deck");
    assert_eq!(elastic(&larger), [[200e3, 0.3], [100e3, 0.33]]);
    assert_eq!(data(&larger, "*CONTACT PAIR"), [["ABOVE", "BELOW"]]);
    // 200 + 600 sqrt(alpha), after the sphere's 81 rows, of which the last is at alpha = 3.
    let yields = plastic(&larger);
    assert!(near(yields[81], 200.0) && near(yields[161], 200.0 + 600.0 * 3f64.sqrt()), "{yields:?}");
    let bottom = |deck: &str| mesh_of(deck).0.iter().map(|x| x[2]).fold(0.0, f64::min);
    assert!(near(bottom(&unlike), -1.0) && near(bottom(&larger), -2.0));
}

#[test]
fn settings_are_what_was_asked_for() {
    let (case, problem) = case(&[]);
    let settings = Settings {
        overclosure_slope: 200.0,
        stick_slope: 20.0,
        largest_increment: 0.05,
        element: Element::C3D8R,
        solver: "ITERATIVE CHOLESKY",
    };
    let deck = deck(&case, &problem, &settings).expect("a deck");
    assert_eq!(number(data(&deck, "*SURFACE BEHAVIOR")[0][0]), 200.0 * 200e3);
    assert_eq!(number(data(&deck, "*FRICTION")[0][1]), 20.0 * 200e3);
    assert!(data(&deck, "*STATIC").iter().all(|row| number(row[0]) == 0.05 && number(row[3]) == 0.05));
    assert_eq!(data(&deck, "*ELEMENT, TYPE=C3D8R, ELSET=SPHERE").len(), problem.model.mesh.elements.len());
}

#[test]
fn numbers_are_in_the_units_of_the_case() {
    let deck = text(&["sphere.radius=2.0", "path.0.indentation=0.04", "path.1.shear=-0.06"]).expect("a deck");
    assert_eq!(number(data(&deck, "*SURFACE BEHAVIOR")[0][0]), 100.0 * 200e3 / 2.0);
    assert_eq!(data(&deck, "*FRICTION")[0].iter().map(|w| number(w)).collect::<Vec<_>>(), [0.3, 5.0 * 200e3 / 2.0]);
    assert_eq!(data(&deck, "*PLASTIC").iter().map(|row| (number(row[0]), number(row[1]))).collect::<Vec<_>>(), [(400.0, 0.0)]);
    let top = data(&deck, "*NODE, NSET=BODY").iter().map(|row| number(row[3])).fold(0.0, f64::max);
    assert_eq!(top, 2.0);
    let held: Vec<f64> = data(&deck, "*BOUNDARY").iter().filter(|row| row.len() == 4).map(|row| number(row[3])).collect();
    assert_eq!(held, [0.0, -0.04, -0.06, -0.04]);
    // Hardening comes as a table that rises.
    let law = "material.hardening={law=\"linear\",yield_stress=400.0,modulus=1000.0}";
    let rows =
        data(&text(&[law]).expect("a deck"), "*PLASTIC").iter().map(|row| [number(row[0]), number(row[1])]).collect::<Vec<_>>();
    assert!(rows.len() > 50 && rows.windows(2).all(|two| two[0][0] < two[1][0] && two[0][1] < two[1][1]));
    assert!(rows.iter().all(|[stress, strain]| (stress - 400.0 - 1000.0 * strain).abs() < 1e-9 * stress), "{rows:?}");
}

#[test]
fn what_calculix_cannot_follow_is_refused() {
    for (key, word) in [
        ("path.1.shear=\"full-slip\"", "path.1.shear=0.03"),
        ("path.1.hold=\"normal-force\"", "hold"),
        ("contact.friction=\"stick\"", "stick"),
        ("opponent.equal=true", "opponent.radius"),
    ] {
        let error = text(&[key]).expect_err(key);
        assert!(error.contains(word), "{error}");
    }
}

const QUADRATIC: Settings = Settings { overclosure_slope: 50.0, element: Element::C3D20R, ..KNOWN_TO_FINISH };

#[test]
fn a_quadratic_brick_has_the_middles_of_its_edges() {
    for name in ["case.toml", "pairs/larger.toml", "pairs/flat.toml"] {
        let (case, problem) = case_of(name, &[]);
        let deck = deck(&case, &problem, &QUADRATIC).expect("a deck");
        assert_eq!(text_of(name, &[]).expect("a deck").matches("C3D20R").count(), 0);
        let nodes: Vec<[f64; 3]> = data(&deck, "*NODE, NSET=BODY").iter().map(|row| [1, 2, 3].map(|i| number(row[i]))).collect();
        let lines = data(&deck, "*ELEMENT, TYPE=C3D20R");
        assert_eq!(lines.len(), 2 * problem.model.mesh.elements.len());
        // The manual, "Twenty-node brick element": 9 lies between 1 and 2, and so on.
        let ends = [(1, 2), (2, 3), (3, 4), (4, 1), (5, 6), (6, 7), (7, 8), (8, 5), (1, 5), (2, 6), (3, 7), (4, 8)];
        let mut bent = 0.0f64;
        for element in lines.chunks(2).map(|two| two.concat()) {
            assert_eq!(element.len(), 21);
            let at = |local: usize| nodes[number(element[local]) as usize - 1];
            for (i, (a, b)) in ends.into_iter().enumerate() {
                let (from, to, middle) = (at(a), at(b), at(9 + i));
                let edge = minus(to, from);
                let off = minus(middle, [0, 1, 2].map(|i| 0.5 * (from[i] + to[i])));
                assert!(dot(off, off) < 0.04 * dot(edge, edge), "{name}: {element:?}");
                bent = bent.max(dot(off, off).sqrt());
            }
        }
        assert!(bent > 1e-4, "{name}: no edge follows the sphere");
        // The sphere's surface is round: the middles of its edges too are at R from the centre.
        let mut middles = 0;
        for x in &nodes[problem.model.mesh.nodes.len()..] {
            let from_centre = minus(*x, [0.0, 0.0, 1.0]);
            let distance = dot(from_centre, from_centre).sqrt();
            if x[2] >= 0.0 && distance > 1.0 - 1e-4 && distance < 1.0 + 1e-4 {
                assert!((distance - 1.0).abs() < 1e-9, "{name}: {x:?}");
                middles += 1;
            }
        }
        assert!(middles > 100, "{name}: {middles}");
        // What is driven is driven between its nodes too, once.
        let set = |name: &str| -> BTreeSet<usize> { data(&deck, name).concat().iter().map(|n| number(n) as usize).collect() };
        let (equator, symmetry) = (set("*NSET, NSET=EQUATOR"), set("*NSET, NSET=SYMMETRY"));
        assert!(equator.is_disjoint(&symmetry));
        for (i, x) in nodes.iter().enumerate() {
            let prescribed = equator.contains(&(i + 1)) || set("*NSET, NSET=HELD").contains(&(i + 1));
            assert_eq!(x[2] == 1.0, equator.contains(&(i + 1)), "{name}: {x:?}");
            assert!(prescribed || (x[1].abs() < 1e-12) == symmetry.contains(&(i + 1)), "{name}: {x:?}");
        }
    }
}

#[test]
fn a_rigid_sphere_is_a_cap_that_is_held() {
    let radius = 2.5;
    let keys = [format!("opponent={{radius={radius},rigid=true}}")];
    let deck = text(&[&keys[0]]).expect("a deck");
    let held = data(&deck, "*NODE, NSET=HELD");
    let nodes: std::collections::BTreeMap<usize, [f64; 3]> =
        held.iter().map(|row| (number(row[0]) as usize, [1, 2, 3].map(|i| number(row[i])))).collect();
    let bodies = data(&deck, "*NODE, NSET=BODY").len();
    assert!(nodes.keys().all(|id| *id > bodies) && nodes.len() == held.len());
    let elements = data(&deck, "*ELEMENT, TYPE=C3D8, ELSET=OPPONENT");
    assert_eq!(data(&deck, "*SURFACE, NAME=ABOVE").len(), elements.len());
    let mut widest = 0.0f64;
    for element in &elements {
        let corners: Vec<[f64; 3]> = element[1..].iter().map(|id| nodes[&(number(id) as usize)]).collect();
        let edges = [1, 3, 4].map(|i| minus(corners[i], corners[0]));
        assert!(dot(cross(edges[0], edges[1]), edges[2]) > 0.0);
        // S2 is the face of the nodes 5 to 8.
        for x in &corners[4..] {
            let from_centre = minus(*x, [0.0, 0.0, -radius]);
            assert!((dot(from_centre, from_centre).sqrt() - radius).abs() < 1e-9, "{x:?}");
            widest = widest.max(x[0]);
        }
    }
    // a/R is 0.2 and the shear 0.03.
    assert!(widest > 0.2 && widest < 0.5, "{widest}");
    let small = text(&["opponent={radius=0.3,rigid=true}", "path.1.shear=0.14"]).expect_err("no cap is that steep");
    assert!(small.contains("too small"), "{small}");
}

#[test]
fn calculix_takes_the_deck() {
    let Ok(version) = std::process::Command::new("ccx").arg("-v").output() else {
        eprintln!("SKIPPED: ccx is not installed");
        return;
    };
    assert!(String::from_utf8_lossy(&version.stdout).contains("Version"));
    for (keys, settings) in
        [(&[][..], KNOWN_TO_FINISH), (&[], QUADRATIC), (&["opponent={radius=1.0,rigid=true}"], KNOWN_TO_FINISH)]
    {
        let dir = tempfile::tempdir().expect("a directory");
        let (case, problem) = case(keys);
        // One increment of the press.
        let text = deck(&case, &problem, &settings).expect("a deck").replacen("0.1, 1., 1e-6, 0.1", "0.1, 0.1, 1e-6, 0.1", 1);
        let first = text.split_inclusive("*END STEP\n").next().expect("a step");
        std::fs::write(dir.path().join("deck.inp"), first).expect("the deck");
        let run = std::process::Command::new("ccx").args(["-i", "deck"]).current_dir(dir.path()).output().expect("ccx runs");
        let told = String::from_utf8_lossy(&run.stdout).into_owned();
        assert!(run.status.success() && !told.contains("*ERROR") && !told.contains("*WARNING"), "{told}");
        let forces = std::fs::read_to_string(dir.path().join("deck.dat")).expect("forces");
        let last = forces.lines().rev().find(|line| !line.trim().is_empty()).expect("a line");
        let pressed: Vec<f64> = last.split_whitespace().map(number).collect();
        assert!(pressed.len() == 3 && pressed[2] < -1.0 && pressed[0].abs() < 1e-6 * pressed[2].abs(), "{last}");
    }
}
