//! What a case means: defaults, merging, scaling, yield stresses. Mistakes are tried through the
//! program, in `tests/case_errors.rs`.

use super::*;
use crate::material::HardeningLaw;

const IDEAL: &str = include_str!("../../fixtures/cases/ideal.toml");

fn parse(text: &str, settings: &[&str]) -> Result<Case, CaseError> {
    let settings: Vec<String> = settings.iter().map(|setting| (*setting).to_owned()).collect();
    Case::parse(text, "case.toml", &settings)
}

fn ideal(settings: &[&str]) -> Case {
    parse(IDEAL, settings).unwrap_or_else(|error| panic!("{settings:?}: {error}"))
}

#[test]
fn the_reference_case_reads_with_the_documented_defaults() {
    let expected = Case {
        opponent: None,
        sphere: Sphere { radius: 1.0, flat: false, equator: Equator::Clamped },
        material: Material { youngs_modulus: 200e3, poissons_ratio: 0.3, hardening: Hardening::Ideal { yield_stress: 400.0 } },
        contact: Contact { friction: Friction::Coefficient(0.3) },
        mesh: Mesh {
            elements_per_contact_radius: 10,
            surface_elements_per_contact_radius: Some(20),
            first_layer_thickness: None,
            fine_zone: 1.3,
            contact_radius: None,
        },
        solver: Solver {
            linear: Linear::Multigrid,
            tolerance: 1e-4,
            press_steps: None,
            shear_steps: None,
            max_iterations: 25,
            max_cutbacks: 8,
            error_estimate: true,
            max_memory_gib: None,
        },
        output: Output::default(),
        units: UnitLabels::default(),
        path: vec![
            Segment::Indentation { indentation: 0.02 },
            Segment::Shear { shear: ShearTarget::FullSlip, hold: Hold::Indentation },
        ],
    };
    assert_eq!(ideal(&[]), expected);
}

#[test]
fn settings_replace_append_and_make_tables() {
    let case = ideal(&[
        "path.0.indentation=0.01",
        "contact.friction = stick",
        "path.1.shear=3e-3",
        "path.1.hold=normal-force",
        "path.2.release=true",
        "mesh.elements_per_contact_radius=8",
        "mesh.contact_radius=0.15",
        "solver.linear=\"direct\"",
        "solver.shear_steps=0x10",
        "output.fields=none",
        "material.hardening={law = \"power\", yield_stress = 300, coefficient = 500, exponent = 0.5}",
    ]);
    assert_eq!(case.contact.friction, Friction::Stick);
    assert_eq!(
        case.mesh,
        Mesh {
            elements_per_contact_radius: 8,
            surface_elements_per_contact_radius: None,
            first_layer_thickness: None,
            fine_zone: 1.3,
            contact_radius: Some(0.15)
        }
    );
    assert_eq!((case.solver.linear, case.solver.shear_steps), (Linear::Direct, Some(16)));
    assert_eq!(case.output.fields, Fields::None);
    assert_eq!(case.material.hardening, Hardening::Power { yield_stress: 300.0, coefficient: 500.0, exponent: 0.5 });
    let shear = Segment::Shear { shear: ShearTarget::Displacement(3e-3), hold: Hold::NormalForce };
    assert_eq!(case.path, [Segment::Indentation { indentation: 0.01 }, shear, Segment::Release { share: 0.0 }]);
    assert_eq!(parse(&case.to_toml(), &[]).expect("it reads back"), case);
}

#[test]
fn a_later_setting_wins_and_a_whole_case_can_be_set() {
    assert_eq!(ideal(&["contact.friction=0.1", "contact.friction=0.2"]).contact.friction, Friction::Coefficient(0.2));
    let settings = [
        "sphere.radius=2",
        "material={youngs_modulus=1.0, poissons_ratio=0, hardening={law=\"elastic\"}}",
        "contact.friction=0",
        "path.0.indentation=0.1",
    ];
    assert_eq!(parse("", &settings).expect("complete").path, [Segment::Indentation { indentation: 0.1 }]);
}

#[test]
fn a_table_of_an_other_document_is_a_case_with_that_documents_lines() {
    let study =
        IDEAL.replace("[sphere]", "[base.sphere]").replace("[material", "[base.material").replace("[contact]", "[base.contact]");
    let study = study.replace("[[path]]", "[[base.path]]");
    let base = Document::parse(&study, "study.toml").expect("TOML").table("base").expect("a base");
    assert_eq!(Case::from_document(&base).expect("a case"), ideal(&[]));
    let broken = Document::parse(&study.replace("0.02", "2"), "study.toml").expect("TOML").table("base").expect("a base");
    let error = Case::from_document(&broken).expect_err("too deep").to_string();
    assert!(error.starts_with("study.toml:17: path.0.indentation: is 2.0"), "{error}");
}

#[test]
fn scaling_makes_copies_in_other_units_alike() {
    // The same sphere in metres and pascals, with everything that has a unit.
    let settings = ["path.1.shear=0.003", "mesh.contact_radius=0.2", "path.2.indentation=0.01"];
    let metres = [
        "sphere.radius=1e-3",
        "material.youngs_modulus=200e9",
        "material.hardening.yield_stress=400e6",
        "path.0.indentation=0.02e-3",
        "path.1.shear=0.003e-3",
        "mesh.contact_radius=0.2e-3",
        "path.2.indentation=0.01e-3",
    ];
    let (left, right) = (ideal(&settings).scaled().0, ideal(&metres).scaled().0);
    assert_eq!((left.sphere.radius, left.material.youngs_modulus), (1.0, 1.0));
    assert_eq!(left.scaled().0, left);
    let close = |a: f64, b: f64| assert!((a - b).abs() <= 4.0 * f64::EPSILON * b.abs(), "{a} against {b}");
    let numbers = |case: &Case| {
        let mut numbers =
            vec![case.mesh.contact_radius.unwrap_or(f64::NAN), case.material.hardening.yield_stress(1.0).unwrap_or(f64::NAN)];
        for segment in &case.path {
            numbers.push(match segment {
                Segment::Indentation { indentation } => *indentation,
                Segment::Shear { shear: ShearTarget::Displacement(delta), .. } => *delta,
                _ => f64::NAN,
            });
        }
        numbers
    };
    assert_eq!(numbers(&left).len(), 5);
    for (a, b) in numbers(&left).into_iter().zip(numbers(&right)) {
        close(a, b);
    }
    close(left.material.hardening.yield_stress(1.0).unwrap_or(f64::NAN), 2e-3);
}

#[test]
fn scaling_divides_stresses_and_leaves_numbers() {
    let scaled = |law: Hardening| law.scaled(200.0);
    assert_eq!(scaled(Hardening::Elastic), Hardening::Elastic);
    assert_eq!(
        scaled(Hardening::Linear { yield_stress: 1.0, modulus: 2.0 }),
        Hardening::Linear { yield_stress: 0.005, modulus: 0.01 }
    );
    assert_eq!(
        scaled(Hardening::Power { yield_stress: 1.0, coefficient: 2.0, exponent: 0.5 }),
        Hardening::Power { yield_stress: 0.005, coefficient: 0.01, exponent: 0.5 }
    );
    assert_eq!(
        scaled(Hardening::Voce { yield_stress: 1.0, saturation_stress: 2.0, rate: 7.0 }),
        Hardening::Voce { yield_stress: 0.005, saturation_stress: 0.01, rate: 7.0 }
    );
    assert_eq!(
        scaled(Hardening::Table { points: vec![[0.0, 1.0], [0.5, 2.0]] }),
        Hardening::Table { points: vec![[0.0, 0.005], [0.5, 0.01]] }
    );
}

#[test]
fn a_law_is_written_by_its_word_with_its_numbers_in_order() {
    let laws = [
        Hardening::Elastic,
        Hardening::Ideal { yield_stress: 1.0 },
        Hardening::Linear { yield_stress: 1.0, modulus: 2.0 },
        Hardening::Power { yield_stress: 1.0, coefficient: 2.0, exponent: 3.0 },
        Hardening::Hollomon { coefficient: 1.0, exponent: 2.0 },
        Hardening::Voce { yield_stress: 1.0, saturation_stress: 2.0, rate: 3.0 },
        Hardening::Table { points: vec![[0.0, 1.0]] },
    ];
    for (law, kind) in laws.into_iter().zip(HardeningLaw::ALL) {
        let written = serde_json::to_value(&law).unwrap();
        assert_eq!((law.kind(), &written["law"]), (kind, &kind.word().into()));
        let numbers: Vec<f64> = kind.parameters().iter().map(|parameter| written[parameter.key].as_f64().unwrap()).collect();
        assert_eq!(law.numbers(), numbers, "{kind:?}");
        assert_eq!(numbers, [1.0, 2.0, 3.0][..numbers.len()]);
    }
}

#[test]
fn hollomon_yields_where_its_curve_meets_hookes_line() {
    for (modulus, coefficient, exponent) in
        [(200e3, 1124.682650380698, 4.0), (70e3, 500.0, 10.0), (1.0, 0.2, 1.5), (1.0, 1e-3, 50.0)]
    {
        let law = Hardening::Hollomon { coefficient, exponent };
        let stress = law.yield_stress(modulus).expect("it yields");
        // On Hooke's line the strain is sigma/E; there sigma_0 eps^(1/m) must be the same stress.
        let curve = coefficient * (stress / modulus).powf(1.0 / exponent);
        assert!(
            (curve / stress - 1.0).abs() < 1e-12,
            "E {modulus}, sigma_0 {coefficient}, m {exponent}: {curve} against {stress}"
        );
        let scaled = law.scaled(modulus).yield_stress(1.0).expect("it yields");
        assert!((scaled * modulus / stress - 1.0).abs() < 1e-12);
    }
    let stress = Hardening::Hollomon { coefficient: 1124.682650380698, exponent: 4.0 }.yield_stress(200e3);
    assert!((stress.expect("it yields") - 200.0).abs() < 1e-9);
    assert_eq!(Hardening::Elastic.yield_stress(200e3), None);
}

#[test]
fn a_table_always_begins_at_first_yield() {
    let points = |hardening: &str| match ideal(&[&format!("material.hardening={hardening}")]).material.hardening {
        Hardening::Table { points } => points,
        other => panic!("{other:?}"),
    };
    assert_eq!(points("{law='table', points=[[0, 400], [0.1, 500]]}"), [[0.0, 400.0], [0.1, 500.0]]);
    assert_eq!(points("{law='table', yield_stress=400, points=[[0, 400], [0.1, 500]]}"), [[0.0, 400.0], [0.1, 500.0]]);
    assert_eq!(points("{law='table', yield_stress=400, points=[[0.1, 500]]}"), [[0.0, 400.0], [0.1, 500.0]]);
}

#[test]
fn the_path_may_return_to_where_it_was() {
    // Not a standstill: something lies between, or the simulation alone knows where it is.
    for path in [
        "path=[{indentation=0.02},{indentation=0.01},{indentation=0.02}]",
        "path=[{indentation=0.02},{shear=0.01,hold='normal-force'},{indentation=0.02}]",
        "path=[{indentation=0.02},{release=true},{indentation=0.02},{shear='full-slip'}]",
        "path=[{indentation=0.02},{shear='full-slip'},{indentation=0.03},{shear='full-slip'},{shear=0.0}]",
        "path=[{indentation=0.02},{indentation=0.0},{indentation=0.01}]",
    ] {
        ideal(&[path]);
    }
}

#[test]
fn both_at_once_and_a_share_of_the_force_read_back() {
    let case = ideal(&["path=[{indentation=0.02,shear=-0.01},{release=0.5},{shear=0.0},{indentation=0.0,shear=0.01}]"]);
    let expected = [
        Segment::Oblique { indentation: 0.02, shear: -0.01 },
        Segment::Release { share: 0.5 },
        Segment::Shear { shear: ShearTarget::Displacement(0.0), hold: Hold::Indentation },
        Segment::Oblique { indentation: 0.0, shear: 0.01 },
    ];
    assert_eq!(case.path, expected);
    assert_eq!(parse(&case.to_toml(), &[]).expect("it reads back"), case);
    // What has a unit is scaled, a ratio is not.
    let scaled = ideal(&["sphere.radius=2", "path=[{indentation=0.02,shear=-0.01},{release=0.5}]"]).scaled().0;
    assert_eq!(scaled.path, [Segment::Oblique { indentation: 0.01, shear: -0.005 }, Segment::Release { share: 0.5 }]);
}

#[test]
fn a_contact_that_is_too_small_for_any_mesh_is_refused() {
    let refused = |settings: &[&str]| parse(IDEAL, settings).expect_err("too shallow").to_string();
    let told = refused(&["path=[{indentation=1e-8},{indentation=2e-7}]"]);
    assert_eq!(
        told,
        "--set path: path.1.indentation: is 2e-7, the greatest of the path. Allowed: a greatest indentation of 2.5e-7 or more: \
         there the contact radius is 0.0005 R, the smallest that is meshed for"
    );
    // On its way down a contact may be of any size; R* counts, in any units.
    ideal(&["path=[{indentation=1e-12},{indentation=2.5e-7}]"]);
    ideal(&["sphere.radius=1e-3", "path=[{indentation=2.5e-10}]"]);
    assert!(refused(&["opponent.equal=true", "path=[{indentation=4e-7}]"]).contains("of 5e-7 or more"));
    ideal(&["opponent.equal=true", "path=[{indentation=5e-7}]"]);
    refused(&["opponent={rigid=true,radius=0.1}", "path=[{indentation=2.7e-6}]"]);
    ideal(&["opponent={rigid=true,radius=0.1}", "path=[{indentation=2.8e-6}]"]);
}
