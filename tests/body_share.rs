//! What the bodies give way outside the contact, taken out of h and delta_T: what is left is that
//! of elastic half-spaces.

#[path = "common/followed.rs"]
mod followed;
#[path = "common/pressed.rs"]
mod pressed;

use asperity::output::StepRecord;
use pressed::CASE;

const NU: f64 = 0.3;
const MU: f64 = 0.3;
/// Elastic, on a finer mesh, along this path.
fn rows(settings: &[&str]) -> Vec<StepRecord> {
    let elastic = [
        "material.hardening={law=\"elastic\"}",
        "mesh.elements_per_contact_radius=6",
        "mesh.surface_elements_per_contact_radius=12",
    ];
    followed::rows(CASE, &[&elastic[..], settings].concat())
}

/// F_T/(mu F_N) of two half-spaces with as much give as `compliance` of one body of E = 1000 along
/// the surface, at a displacement (Cattaneo 1938, Mindlin 1949).
fn mindlin(delta: f64, f_n: f64, a: f64, compliance: f64) -> f64 {
    let shear = 1000.0 / (2.0 + 2.0 * NU);
    let slip = compliance * 3.0 * MU * f_n * (2.0 - NU) / (16.0 * shear * a);
    1.0 - (1.0 - delta / slip).max(0.0).powf(1.5)
}

/// Largest differences of the shear from Mindlin's, by the contact's displacement and by all of it,
/// over mu F_N; and of F_N before it from Hertz's, by its h and by all of it.
fn differences(rows: &[StepRecord], radius: f64, compliance: f64) -> [f64; 4] {
    let pressed = rows.iter().rev().find(|row| row.segment == 0).expect("a press");
    let modulus = 1000.0 / (1.0 - NU * NU) / compliance;
    let hertz = |h: f64| 4.0 / 3.0 * modulus * radius.sqrt() * h.powf(1.5);
    // Hertz's a of this force: the mesh's own is off by up to half an element.
    let a = (0.75 * pressed.f_n * radius / modulus).cbrt();
    let largest = |of: fn(&StepRecord) -> f64| {
        let apart = |row: &StepRecord| (row.f_t / (MU * row.f_n) - mindlin(of(row), row.f_n, a, compliance)).abs();
        rows.iter().filter(|row| row.segment == 1).map(apart).fold(0.0, f64::max)
    };
    let of_press = |h: f64| (pressed.f_n / hertz(h) - 1.0).abs();
    [largest(|row| row.delta_t_contact), largest(|row| row.delta_t), of_press(pressed.h_contact), of_press(pressed.h)]
}

#[test]
fn the_contact_alone_is_one_of_half_spaces() {
    let held = "{shear=0.006,hold=\"normal-force\"}";
    // Two equal spheres; the same as two bodies that are both meshed; free equators.
    for (what, settings) in [
        ("image", vec!["opponent.equal=true".to_owned()]),
        ("free", vec!["opponent.equal=true".to_owned(), "sphere.equator=\"free\"".to_owned()]),
        ("two bodies", vec!["opponent={radius=1.0}".to_owned(), "mesh.surface_elements_per_contact_radius=6".to_owned()]),
    ] {
        let path = format!("path=[{{indentation=0.02}},{held}]");
        let settings: Vec<&str> = settings.iter().map(String::as_str).chain([path.as_str()]).collect();
        let found = differences(&rows(&settings), 0.5, 2.0);
        eprintln!("{what}: F_T {:.4} ({:.4} by delta_T), F_N {:.4} ({:.4} by h)", found[0], found[1], found[2], found[3]);
        assert!(found[0] < 0.02 && found[1] > 0.05, "{what}: {found:?}");
        assert!(found[2] < 0.01 && found[3] > 0.02, "{what}: {found:?}");
    }
}

#[test]
fn each_body_has_its_share() {
    let path = "path=[{indentation=0.01},{shear=0.002}]";
    let share = |settings: &[&str]| {
        let rows = rows(&[settings, &[path, "mesh.surface_elements_per_contact_radius=6"]].concat());
        let end = *rows.last().expect("rows");
        ((end.h - end.h_contact) / end.f_n, (end.delta_t - end.delta_t_contact) / end.f_t, end.a)
    };
    let one = share(&[]);
    // A rigid sphere gives no way; a much stiffer body hardly any.
    let rigid = share(&["opponent={rigid=true,radius=1.0}"]);
    let stiff = share(&["opponent={radius=1.0,material={youngs_modulus=1e8,poissons_ratio=0.3,hardening={law=\"elastic\"}}}"]);
    for other in [rigid, stiff] {
        assert!((other.0 / one.0 - 1.0).abs() < 1e-3, "{other:?} {one:?}");
        let by_radius = (0.204 - 0.126 * other.2.ln()) / (0.204 - 0.126 * one.2.ln());
        assert!((other.1 / one.1 / by_radius - 1.0).abs() < 1e-3, "{other:?} {one:?}");
    }
    // Along y alone, the share is along y.
    let rows = rows(&["path=[{indentation=0.01},{shear=[0.0,0.002]}]", "mesh.surface_elements_per_contact_radius=6"]);
    let end = rows.last().expect("rows");
    assert!((end.delta_t_y - end.delta_t_y_contact) / end.f_t_y > 0.9 * one.1 && end.delta_t_contact.abs() < 1e-9);
}
