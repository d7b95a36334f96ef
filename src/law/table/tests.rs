use super::build::table;
use super::measure::{Measured, yielding};
use super::tabulated::straight;
use super::*;
use crate::analytical::cattaneo_mindlin::CattaneoMindlin;
use crate::case::{self, Case, Friction, Opponent};
use crate::contact_law::Centres;
use crate::contact_law::path::{drive, follow};
use crate::law::LawError;
use crate::law::data::ShearPoint;
use crate::law::file::LawFile;
use crate::output::StepRecord;

const MU: f64 = 0.3;

fn case(text: &str) -> Case {
    let text = format!(
        "[sphere]\nradius = 2.0\n[material]\nyoungs_modulus = 200e3\npoissons_ratio = 0.3\n[material.hardening]\n{text}\n[contact]\nfriction = {MU}\n\
         [[path]]\nindentation = 0.04\n"
    );
    Case::parse(&text, "case.toml", &[]).unwrap()
}

/// A made-up contact that yields at h/R = 2e-5 and is fully plastic at 0.02, with a ripple of the
/// mesh.
fn measured(h: f64, ripple: f64) -> Measured {
    let plasticity = (h / 2e-5).ln().max(0.0) / 1000f64.ln();
    let hertz = 4.0 / (3.0 * 0.91) * h.powf(1.5);
    let f_n0 = hertz * (1.0 - 0.8 * plasticity) * (1.0 + ripple);
    let a0 = (h * (1.0 + 1.2 * plasticity)).sqrt();
    let (fall, n) = (0.3 * plasticity, 1.5 + 3.0 * plasticity);
    let k_t = 1.6 * a0;
    // In plasticity a shear starts softer than a reversal: the press has slipped outwards.
    let slip = (1.0 + 0.6 * plasticity) * n * MU * f_n0 * (1.0 - fall) / k_t;
    let at = |x: f64| ShearPoint {
        delta_t: x * slip,
        f_t: MU * f_n0 * (1.0 - fall) * (1.0 - (1.0 - x).powf(n)),
        f_n: f_n0 * (1.0 - fall * (1.0 - (1.0 - x).powf(1.5 * n)).powf(1.3)),
    };
    let curve: Vec<ShearPoint> = (0..=25).map(|i| at((f64::from(i) / 25.0).powi(2))).collect();
    let end = curve[25];
    // Masing's rule with the exponent 1.2, and an unloading with 2.4 E* a.
    let force = MU * end.f_n;
    let back = (0..=20).map(f64::from).map(|i| {
        let d = 3.0 * force / k_t * i / 20.0;
        let fall = 2.0 * force * (1.0 - (1.0 - (k_t * d / (2.4 * force)).min(1.0)).powf(1.2));
        ShearPoint { delta_t: end.delta_t - d, f_t: end.f_t - fall, f_n: end.f_n }
    });
    let release = (0..=5).map(f64::from).map(|i| [h - 0.1 * i * end.f_n / (2.4 * a0 / 0.91), end.f_n * (1.0 - 0.1 * i)]);
    Measured { h, f_n0, a0, back: back.collect(), release: release.collect(), curve }
}

fn depths() -> Vec<f64> {
    (0..=18).map(|i| 2e-5 * 1000f64.powf(f64::from(i) / 18.0)).collect()
}

fn made() -> Tabulated {
    let ripple = |i: usize| if i.is_multiple_of(2) { 0.004 } else { -0.004 };
    let all: Vec<Measured> = depths().into_iter().enumerate().map(|(i, h)| measured(h, ripple(i))).collect();
    table(&case("law = \"ideal\"\nyield_stress = 400.0"), &all, 8).unwrap()
}

#[test]
fn a_table_tells_the_depths_between() {
    let table = made();
    let parameters = table.contact_parameters(1.0, 1.0).unwrap();
    for h in [4e-5, 3.3e-4, 2.7e-3, 0.011, 0.017] {
        let exact = measured(h, 0.0);
        let virgin = parameters.virgin(h).point;
        assert!((virgin.f_n0 / exact.f_n0 - 1.0).abs() < 6e-3, "{h}: {} {}", virgin.f_n0, exact.f_n0);
        assert!((virgin.a / exact.a0 - 1.0).abs() < 2e-3, "{h}: {} {}", virgin.a, exact.a0);
        let mut places = vec![[h, 0.0]];
        places.extend(exact.curve.iter().map(|point| [h, point.delta_t]));
        for (force, point) in drive(&parameters, &places, 3)[1..].iter().zip(&exact.curve) {
            // Next to yield the sliders of its reversal are softer than its shear.
            let most = if h < 1e-4 { 0.06 } else { 0.04 };
            assert!((force[1] - point.f_t).abs() < most * exact.peak(), "{h}: F_T {} {}", force[1], point.f_t);
            assert!((force[0] - point.f_n).abs() < 0.015 * exact.f_n0, "{h}: F_N {} {}", force[0], point.f_n);
        }
    }
}

/// What earlier versions called the end of the curves, by a name that means something else.
#[test]
fn the_earlier_name_of_a_length_is_read() {
    let table = made();
    let text = serde_json::to_string(&table).unwrap();
    let earlier = text.replace("\"delta_T_end\"", "\"delta_t_slip\"");
    assert!(earlier != text && Tabulated::from_json(&earlier) == Ok(table));
}

#[test]
fn one_table_serves_every_radius_and_every_unit() {
    let table = made();
    let one = table.contact_parameters(1.0, 1.0).unwrap();
    let (radius, modulus) = (3.7e-3, 70e9);
    let other = table.contact_parameters(radius, modulus).unwrap();
    let places = [[0.01, 0.0], [0.01, 0.001], [0.012, 0.0005], [0.0115, -0.002], [0.005, 0.0], [0.015, 0.004]];
    let scaled = places.map(|place| place.map(|x| x * radius));
    let force = modulus * radius * radius;
    for (a, b) in drive(&one, &places, 20).iter().zip(drive(&other, &scaled, 20)) {
        for i in 0..2 {
            assert!((a[i] * force - b[i]).abs() < 1e-9 * force * one.virgin(0.01).point.f_n0, "{a:?} {b:?}");
        }
    }
}

#[test]
fn what_is_fitted_to_a_reversal_and_a_release_is_found_again() {
    let table = made();
    for (level, h) in table.levels.iter().zip(depths()).skip(3) {
        let exact = measured(h, 0.0);
        assert!((level.k_t / (1.6 * exact.a0) - 1.0).abs() < 0.02, "{h}: {}", level.k_t / exact.a0);
        assert!((level.backbone - 1.0 - 0.65 * 0.2).abs() < 0.02, "{h}: {}", level.backbone);
        // A straight release, of which the update's bent curve has the ends.
        let virgin = table.contact_parameters(1.0, 1.0).unwrap().virgin(h);
        let way = virgin.depth * exact.release[0][1] / exact.f_n0 * (1.0 - 0.5f64.powf(1.0 / virgin.gamma));
        assert!((way / (exact.release[0][0] - exact.release[5][0]) - 1.0).abs() < 0.05, "{h}: {way}");
    }
}

/// An oblique press that slides at first, then flows with this c.
fn oblique(case: &Case, c: impl Fn(f64) -> f64, slope: f64) -> Vec<StepRecord> {
    let row = |i: i32| {
        let h = 0.04 * f64::from(i) / 20.0;
        // r of d(delta_T)/dh = 2 c r/(1 - c r^2).
        let c = c(h / case.sphere.radius);
        let r = ((1.0 + slope * slope / c).sqrt() - 1.0) / slope;
        let f_n = 1e3 * h * (1.0 + 0.02 * f64::from(i % 2));
        StepRecord { h, delta_t: slope * h, f_n, f_t: r.min(MU) * f_n, ..StepRecord::default() }
    };
    (1..=20).map(row).collect()
}

#[test]
fn an_oblique_press_tells_how_the_contact_yields() {
    let case = case("law = \"ideal\"\nyield_stress = 400.0");
    let grows = |h: f64| 4.0 * (h / 0.02).powf(0.2);
    let found = yielding(&case, &oblique(&case, grows, 0.6));
    assert!(found.len() > 10 && found.windows(2).all(|pair| pair[0][0] < pair[1][0]), "{found:?}");
    // The mean over the ripple is one-sided at the ends.
    for [ln_h, c] in &found[2..] {
        assert!((c / grows(ln_h.exp()) - 1.0).abs() < 0.04, "{ln_h}: {c}");
    }
    // One that slides to its end is told by its last steps.
    let slides = yielding(&case, &oblique(&case, |_| 0.1, 0.6));
    assert!(slides.len() == 3 && slides.iter().all(|point| (point[1] - 0.6 / (MU * (2.0 + 0.6 * MU))).abs() < 1e-9));
    // The level's own goes into the update; without one it is that of the virgin curve.
    let mut table = made();
    let virgin = table.unit_parameters().unwrap();
    for level in &mut table.levels {
        level.yield_coefficient = straight(&found, level.h.ln());
    }
    let given = table.unit_parameters().unwrap();
    assert!((given.virgin(0.02).point.c / found[found.len() - 1][1] - 1.0).abs() < 1e-6);
    assert!((given.virgin(1e-4).point.c / found[0][1] - 1.0).abs() < 1e-6);
    assert!((virgin.virgin(0.02).point.c / given.virgin(0.02).point.c - 1.0).abs() > 0.05);
    let text = serde_json::to_string(&table).unwrap();
    assert_eq!(serde_json::from_str::<Tabulated>(&text).unwrap(), table);
    assert!(!serde_json::to_string(&made()).unwrap().contains("yield_coefficient"));
}

#[test]
fn a_file_is_read_back_and_others_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("law.json");
    let table = made();
    table.write(&path).unwrap();
    assert_eq!(LawFile::read(&path).unwrap(), LawFile::Table(Box::new(table.clone())));
    let text = std::fs::read_to_string(&path).unwrap();
    for (from, to, told) in [
        ("\"version\": 1", "\"version\": 9", "tabulated law of version 9"),
        ("\"body\": \"plane\"", "\"body\": \"cube\"", "body is \"cube\", and has to be \"plane\", \"equal pair\""),
        ("\"body\": \"plane\"", "\"body\": \"equal pair\"", "its case is against a rigid plane"),
        ("\"asperity-law-table\"", "\"asperity-law-3\"", "its format is \"asperity-law-3\""),
        ("\"levels\"", "\"lewels\"", "lewels is no key of this file"),
        ("friction = 0.3", "friction = -0.3", "case is no case"),
    ] {
        assert!(text.contains(from), "{from}");
        std::fs::write(&path, text.replacen(from, to, 1)).unwrap();
        let refused = LawFile::read(&path).unwrap_err().to_string();
        assert!(refused.contains(told), "{told}: {refused}");
    }
    let read = Tabulated::read(&path).unwrap_err().to_string();
    assert!(read.contains("law tabulate") || read.contains("law.json"), "{read}");
}

#[test]
fn another_material_is_refused_by_name() {
    let table = LawFile::Table(Box::new(made()));
    let other = |change: &dyn Fn(&mut Case)| {
        let mut case = case("law = \"ideal\"\nyield_stress = 400.0");
        change(&mut case);
        table.contact_parameters(&case).map(drop).map_err(|error| error.to_string())
    };
    assert_eq!(other(&|_| {}), Ok(()));
    // In other units it is the same.
    let units = |case: &mut Case| {
        case.material.youngs_modulus *= 1e6;
        case.material.hardening = case::Hardening::Ideal { yield_stress: 400e6 };
        case.sphere.radius = 0.7;
    };
    assert_eq!(other(&units), Ok(()));
    for (told, change) in [
        ("nu = 0.31", &(|case: &mut Case| case.material.poissons_ratio = 0.31) as &dyn Fn(&mut Case)),
        ("mu = 0.2", &|case: &mut Case| case.contact.friction = Friction::Coefficient(0.2)),
        ("stick", &|case: &mut Case| case.contact.friction = Friction::Stick),
        ("0.0021", &|case: &mut Case| case.material.hardening = case::Hardening::Ideal { yield_stress: 420.0 }),
        ("linear", &|case: &mut Case| {
            case.material.hardening = case::Hardening::Linear { yield_stress: 400.0, modulus: 0.0 };
        }),
    ] {
        let refused = other(change).unwrap_err();
        assert!(refused.contains(told), "{told}: {refused}");
    }
}

#[test]
fn another_opponent_is_refused_by_name() {
    let pair = |opponent: &str| {
        let text = format!(
            "[sphere]\nradius = 2.0\n[material]\nyoungs_modulus = 200e3\npoissons_ratio = 0.3\n\
             [material.hardening]\nlaw = \"ideal\"\nyield_stress = 400.0\n[contact]\nfriction = {MU}\n{opponent}\n\
             [[path]]\nindentation = 0.04\n"
        );
        Case::parse(&text, "case.toml", &[]).unwrap()
    };
    let other = |radius: &str, modulus: &str, stress: f64| {
        pair(&format!(
            "[opponent]\n{radius}\n[opponent.material]\nyoungs_modulus = {modulus}\npoissons_ratio = 0.25\n\
             [opponent.material.hardening]\nlaw = \"ideal\"\nyield_stress = {stress}"
        ))
    };
    let deep: Vec<Measured> = depths().into_iter().map(|h| measured(h, 0.0)).collect();
    let made = |case: &Case| LawFile::Table(Box::new(table(case, &deep, 8).unwrap()));
    let answer = |law: &LawFile, case: &Case| law.contact_parameters(case).map(drop).map_err(|error| error.to_string());
    let law = made(&other("radius = 3.0", "400e3", 900.0));
    assert_eq!(answer(&law, &other("radius = 3.0", "400e3", 900.0)), Ok(()));
    for (told, case) in [
        ("2 R, and that of the table 1.5 R", other("radius = 4.0", "400e3", 900.0)),
        ("the other body has 2.5 times the sphere's E", other("radius = 3.0", "500e3", 900.0)),
        ("of the other body, over E, hardening", other("radius = 3.0", "400e3", 901.0)),
        ("contact with a flat that deforms", other("flat = true", "400e3", 900.0)),
        ("contact with a rigid plane", pair("")),
        ("contact with an equal sphere", pair("[opponent]\nequal = true")),
    ] {
        let refused = answer(&law, &case).unwrap_err();
        assert!(refused.contains(told), "{told}: {refused}");
    }
    let rigid = |radius: f64| pair(&format!("[opponent]\nrigid = true\nradius = {radius}"));
    let refused = answer(&made(&rigid(3.0)), &rigid(5.0)).unwrap_err();
    assert!(refused.contains("the rigid sphere has 2.5 R, and that of the table 1.5 R"), "{refused}");
    // Written and read back, with its opponent; without its frame it is one of earlier versions.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("law.json");
    law.write(&path).unwrap();
    assert_eq!(LawFile::read(&path).unwrap(), law);
    let text = std::fs::read_to_string(&path).unwrap();
    let frame = "  \"frame\": \"line of centres\",\n";
    assert!(text.contains(frame), "{text}");
    std::fs::write(&path, text.replace(frame, "")).unwrap();
    let refused = LawFile::read(&path).unwrap_err().to_string();
    assert!(refused.contains("two spheres along fixed axes") && refused.contains("`asperity law tabulate`"), "{refused}");
    made(&pair("")).write(&path).unwrap();
    let text = std::fs::read_to_string(&path).unwrap();
    assert!(!text.contains("frame"));
    std::fs::write(&path, text.replacen("  \"program\"", &format!("{frame}  \"program\""), 1)).unwrap();
    let refused = LawFile::read(&path).unwrap_err().to_string();
    assert!(refused.contains("one of its bodies is flat"), "{refused}");
}

/// A history of two spheres as a simulation along fixed axes has it: `one` is what it is in the
/// frame of their centres, at one overlap.
fn along_axes(case: &Case, one: &Measured) -> Vec<StepRecord> {
    let centres = Centres::of(case);
    let (r, force) = (case.sphere.radius, case.material.youngs_modulus * case.sphere.radius * case.sphere.radius);
    let h = one.h * r;
    let mut history = vec![StepRecord { h, f_n: one.f_n0 * force, a: one.a0 * r, ..StepRecord::default() }];
    for point in &one.curve[1..] {
        // At constant h; the place at which so much has slid.
        let (mut low, mut high) = (0.0, 2.0 * point.delta_t * r);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if centres.displacement([h, 0.0], [h, middle]) < point.delta_t * r { low = middle } else { high = middle }
        }
        let [f_n, f_t] = centres.along_axes([h, low], [point.f_n * force, point.f_t * force]);
        history.push(StepRecord { segment: 1, h, delta_t: low, f_n, f_t, ..StepRecord::default() });
    }
    history
}

#[test]
fn two_spheres_are_turned_into_the_frame_of_their_centres() {
    let mut case = case("law = \"ideal\"\nyield_stress = 400.0");
    case.opponent = Some(Opponent::Rigid { radius: 1.0 });
    case.path.push(case::Segment::Shear { shear: case::ShearTarget::FullSlip, hold: case::Hold::Indentation });
    let exact = measured(0.02, 0.0);
    let history = along_axes(&case, &exact);
    let last = history[history.len() - 1];
    assert!(last.f_t / (MU * last.f_n) < 0.996, "{}", last.f_t / last.f_n);
    let one = Measured::of(&case, &history).unwrap();
    let (end, before) = (one.curve[25], exact.curve[25]);
    // To the cube root of round-off, times what is put back.
    assert!((end.f_t / (MU * end.f_n) - 1.0).abs() < 1e-7, "{end:?}");
    // What the overlap lacks, delta_T^2/2D, is put back by what the elastic approach gives.
    let lacks = before.delta_t * before.delta_t / (2.0 * 1.5);
    let stiffness = end.f_n / exact.f_n0;
    assert!(end.f_n > before.f_n && end.f_n - before.f_n < 4.0 * lacks * exact.a0 / 0.91 / stiffness, "{end:?} {before:?}");
    // On a plane nothing changes.
    case.opponent = None;
    let plain = Measured::of(&case, &history).unwrap();
    assert_eq!(plain.curve[25].f_t, last.f_t / (case.material.youngs_modulus * 4.0));
}

/// Two elastic spheres whose overlap falls as they pass each other: Hertz's and Mindlin's contact
/// at the overlap of the start.
#[test]
fn what_the_overlap_lacks_is_put_back() {
    let mut case = case("law = \"elastic\"");
    case.opponent = Some(Opponent::Equal);
    case.path.push(case::Segment::Shear { shear: case::ShearTarget::FullSlip, hold: case::Hold::Indentation });
    let (centres, h) = (Centres::of(&case), 0.1);
    let sphere = equivalent(&case);
    let slip = |h: f64| CattaneoMindlin::at_indentation(sphere, MU, h);
    let start = slip(h);
    let mut history = vec![StepRecord { h, f_n: start.normal_force, a: start.contact_radius, ..StepRecord::default() }];
    for i in 1..=20 {
        let delta_t = 0.06 * f64::from(i) / 20.0;
        let now = slip(centres.overlap([h, delta_t]));
        let slid = centres.displacement([h, 0.0], [h, delta_t]);
        let [f_n, f_t] = centres.along_axes([h, delta_t], [now.normal_force, now.force(slid)]);
        history.push(StepRecord { segment: 1, h, delta_t, f_n, f_t, ..StepRecord::default() });
    }
    let one = Measured::of(&case, &history).unwrap();
    let (r, force) = (case.sphere.radius, case.material.youngs_modulus * case.sphere.radius * case.sphere.radius);
    for point in &one.curve {
        assert!((point.f_n * force / start.normal_force - 1.0).abs() < 1e-9, "{point:?}");
        let exact = start.force(point.delta_t * r);
        assert!((point.f_t * force - exact).abs() < 1e-3 * MU * start.normal_force, "{point:?} {exact}");
    }
    let last = history[20];
    let n = centres.turned([h, last.delta_t], [last.f_n, last.f_t])[0];
    assert!(last.f_t / (MU * last.f_n) < 0.96 && n < 0.994 * start.normal_force, "{last:?}");
}

#[test]
fn beyond_its_depths_it_answers_and_says_so() {
    let table = made();
    let parameters = table.contact_parameters(1.0, 1.0).unwrap();
    assert!(table.out_of_range(0.02).is_empty() && table.out_of_range(1e-7).is_empty());
    let outside = table.out_of_range(0.03);
    assert_eq!((outside.len(), outside[0].quantity), (1, "h/R"));
    let path = [case::Segment::Indentation { indentation: 0.03 }];
    let forces: Vec<f64> = follow(&parameters, &path).iter().map(|point| point.f_n).collect();
    assert!(forces.windows(2).all(|pair| pair[1] >= pair[0]) && forces[100].is_finite());
}

#[test]
fn depths_go_from_first_yield_to_the_case() {
    let deep = build::depths(&case("law = \"ideal\"\nyield_stress = 400.0")).unwrap();
    assert!(deep.len() % 2 == 1 && deep.windows(2).all(|pair| pair[1] > pair[0]));
    assert!((deep[0] / 2.1e-5 - 1.0).abs() < 0.1 && (deep[deep.len() - 1] - 0.02).abs() < 1e-12, "{deep:?}");
    // A sphere that never yields has a half-space's contact below a depth, one that yields at once
    // is not meshed finer than can be.
    assert!((build::depths(&case("law = \"elastic\"")).unwrap()[0] - 1e-3).abs() < 1e-12);
    assert!((build::depths(&case("law = \"ideal\"\nyield_stress = 10.0")).unwrap()[0] - 2e-5).abs() < 1e-12);
    let mut stuck = case("law = \"elastic\"");
    stuck.contact.friction = Friction::Stick;
    assert!(matches!(build::depths(&stuck), Err(LawError::NotCovered { .. })));
}
