//! A sphere whose equatorial plane is free to widen: what that takes of the forces, what stays as
//! it is, and where it is refused.

#[path = "common/followed.rs"]
mod followed;
#[path = "common/pressed.rs"]
mod pressed;

use asperity::case::Case;
use asperity::law::LawFile;
use asperity::output::StepRecord;
use pressed::CASE;

const FREE: &str = "sphere.equator=\"free\"";

fn rows(settings: &[&str]) -> Vec<StepRecord> {
    let rows = followed::rows(CASE, settings);
    assert!(rows.iter().all(|row| row.relaxed == 0));
    rows
}

fn last(rows: &[StepRecord]) -> &StepRecord {
    rows.last().expect("rows")
}

/// F_N at an indentation, between two steps.
fn f_n(rows: &[StepRecord], h: f64) -> f64 {
    let k = rows.partition_point(|row| row.h < h).clamp(1, rows.len() - 1);
    let (a, b) = (&rows[k - 1], &rows[k]);
    a.f_n + (b.f_n - a.f_n) * (h - a.h) / (b.h - a.h)
}

fn assert_energy(rows: &[StepRecord], share: f64) {
    let end = last(rows);
    let found = end.energy_elastic + end.work_plastic + end.work_friction;
    let most = rows.iter().fold(0.0, |most: f64, row| most.max(row.work_external));
    assert!((found - end.work_external).abs() < share * most, "{found} of {}", end.work_external);
}

/// An axisymmetric code (Q8 elements, 16 along the contact radius) has so much less F_N with the
/// nodes of the equator free along r than with them held, per cent.
const ELASTIC: [(f64, f64); 4] = [(0.01, 1.80), (0.03, 3.32), (0.05, 4.45), (0.0999, 6.93)];
/// The same where E/sigma_Y = 60: its forces ripple by half a per cent, as these do.
const PLASTIC: [(f64, f64); 5] = [(0.04, 1.19), (0.05, 2.11), (0.07, 1.64), (0.08, 2.26), (0.0899, 3.17)];

#[test]
fn a_free_equator_takes_as_much_of_the_force_as_in_an_axisymmetric_code() {
    let less = |settings: &[&str], depths: &[(f64, f64)]| -> Vec<f64> {
        let (clamped, free) = (rows(settings), rows(&[settings, &[FREE]].concat()));
        assert_energy(&free, 0.005);
        depths.iter().map(|&(h, _)| 100.0 * (1.0 - f_n(&free, h) / f_n(&clamped, h))).collect()
    };
    let press = ["path=[{indentation=0.1}]", "mesh.elements_per_contact_radius=8"];
    let elastic = ["material.hardening={law=\"elastic\"}", "contact.friction=0.0", press[0], press[1]];
    let found = less(&elastic, &ELASTIC);
    eprintln!("elastic, less F_N, %: {found:.2?}");
    assert!(found.iter().zip(ELASTIC).all(|(found, (_, expected))| (found - expected).abs() < 0.1), "{found:?}");
    let found = less(&[], &PLASTIC);
    eprintln!("plastic, less F_N, %: {found:.2?}");
    let mean = |values: &mut dyn Iterator<Item = f64>| values.sum::<f64>() / 5.0;
    let apart = mean(&mut found.iter().copied()) - mean(&mut PLASTIC.iter().map(|(_, expected)| *expected));
    assert!(apart.abs() < 0.4, "{found:?}");
}

#[test]
fn shears_releases_and_rolls_keep_their_energies() {
    let sheared = "path=[{indentation=0.04},{shear=0.01},{shear=-0.004},{release=0.3},{indentation=0.05}]";
    for settings in [
        [sheared, "contact.friction=0.5"],
        ["path=[{indentation=0.04},{shear=0.01,hold=\"normal-force\"}]", "opponent={rigid=true,radius=1.0}"],
        ["path=[{indentation=0.03},{twist=0.1,roll=[0.02,0.05],shear=[0.002,0.003]},{release=true}]", "contact.friction=0.4"],
        ["path=[{indentation=0.06},{shear=[0.006,0.004]}]", "opponent.equal=true"],
    ] {
        let rows = rows(&[FREE, "solver.press_steps=40", settings[0], settings[1]]);
        assert_energy(&rows, 0.01);
    }
}

#[test]
fn a_second_press_after_a_full_release_and_full_stick_go_on() {
    let again = "path=[{indentation=0.04},{release=true},{indentation=0.04},{shear=0.004}]";
    let (clamped, free) = (rows(&[again]), rows(&[FREE, again]));
    let (a, b) = (last(&clamped), last(&free));
    assert!((b.f_n / a.f_n - 1.0).abs() < 0.03 && (b.f_t / a.f_t - 1.0).abs() < 0.03, "{a:?} {b:?}");
    // In the air and on first touch nothing pushes sideways.
    let pressed: Vec<&StepRecord> = free.iter().filter(|row| row.segment <= 2).collect();
    assert!(
        pressed.iter().all(|row| row.f_t.abs() < 1e-6 * a.f_n),
        "{:?}",
        pressed.iter().map(|row| row.f_t).collect::<Vec<_>>()
    );
    assert_energy(&free, 0.02);
    let stick = ["contact.friction=\"stick\"", "path=[{indentation=0.03},{shear=0.006},{shear=0.0}]"];
    let rows = followed::rows(CASE, &[&stick[..], &[FREE]].concat());
    assert!(last(&rows).h == 0.03 && rows.iter().any(|row| row.f_t > 0.0));
}

#[test]
fn laws_of_many_contacts_refuse_it_and_a_table_keeps_to_its_own() {
    let case = |settings: &[&str]| {
        let settings: Vec<String> = settings.iter().map(|&setting| setting.to_owned()).collect();
        Case::parse(CASE, "case.toml", &settings).expect("a case")
    };
    let (clamped, free) = (case(&["path=[{indentation=0.02}]"]), case(&[FREE, "path=[{indentation=0.02}]"]));
    let built_in = LawFile::built_in().expect("the built-in law");
    assert!(built_in.contact_parameters(&clamped).is_ok());
    let error = built_in.contact_parameters(&free).expect_err("a refusal").to_string();
    assert!(error.contains("sphere.equator = \"free\""), "{error}");
}

#[test]
fn without_friction_an_equal_sphere_is_a_plane_and_a_turned_shear_is_that_along_x() {
    let plane = rows(&[FREE, "contact.friction=0.0", "path=[{indentation=0.06}]"]);
    let pair = rows(&[FREE, "contact.friction=0.0", "opponent.equal=true", "path=[{indentation=0.12}]"]);
    assert!((last(&plane).f_n / last(&pair).f_n - 1.0).abs() < 2e-3, "{} {}", last(&plane).f_n, last(&pair).f_n);
    let along = rows(&[FREE, "path=[{indentation=0.06},{shear=0.01}]"]);
    let turned = rows(&[FREE, "path=[{indentation=0.06},{shear=0.01,shear_direction=90.0}]"]);
    let (along, turned) = (last(&along), last(&turned));
    assert!((turned.f_n / along.f_n - 1.0).abs() < 0.01 && (turned.f_t_y / along.f_t - 1.0).abs() < 0.02);
    assert!(turned.f_t.abs() < 1e-6 * turned.f_t_y, "{}", turned.f_t);
}

#[test]
fn it_is_refused_by_name_where_another_body_is_held_by_a_plate_of_its_own() {
    let error = |settings: &[&str]| {
        let settings: Vec<String> = settings.iter().map(|&setting| setting.to_owned()).collect();
        Case::parse(CASE, "case.toml", &settings).expect_err("a refusal").to_string()
    };
    for (settings, why) in [
        (&[FREE, "opponent={radius=2.0}"][..], "is \"free\" in a contact of two bodies that are both meshed"),
        (
            &[FREE, "opponent.equal=true", "path=[{indentation=0.02},{roll=0.01}]"],
            "is \"free\" on a path for which both spheres are meshed",
        ),
        (&[FREE, "sphere.flat=true", "opponent={rigid=true,radius=1.0}"], "is \"free\", and a flat has none"),
        (&["sphere.equator=\"fre\""], "did you mean \"free\"?"),
    ] {
        let told = error(settings);
        assert!(told.contains("sphere.equator") && told.contains(why), "{told}");
    }
}
