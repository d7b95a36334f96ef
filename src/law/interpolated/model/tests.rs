use super::*;
use crate::analytical::hertz;
use crate::case::{Hold, Segment, ShearTarget};
use crate::contact_law::Centres;
use crate::contact_law::path::follow;
use crate::law::LawFile;
use crate::law::data::ShearPoint;
use crate::law::table::Measured;

fn fixture(name: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/law/interpolated").join(name)
}

fn plane() -> Interpolated {
    Interpolated::read(&fixture("plane.json")).unwrap()
}

fn case(hardening: &str, nu: f64, mu: f64, depth: f64, more: &str) -> Case {
    let text = format!(
        "[sphere]\nradius = 3.0\n[material]\nyoungs_modulus = 210.0\npoissons_ratio = {nu:?}\nhardening = {hardening}\n\
         [contact]\nfriction = {mu:?}\n{more}\n[[path]]\nindentation = {:?}\n[[path]]\nshear = \"full-slip\"\n",
        3.0 * depth
    );
    Case::parse(&text, "case.toml", &[]).unwrap()
}

/// Materials, frictions and depths over the whole range, none of which is a sample.
fn cases(more: &str) -> Vec<Case> {
    let mut all = Vec::new();
    for hardening in [
        "{ law = \"elastic\" }",
        "{ law = \"ideal\", yield_stress = 0.1 }",
        "{ law = \"ideal\", yield_stress = 12.0 }",
        "{ law = \"linear\", yield_stress = 0.4, modulus = 4.0 }",
        "{ law = \"power\", yield_stress = 0.3, coefficient = 0.8, exponent = 0.35 }",
        "{ law = \"hollomon\", coefficient = 3.0, exponent = 5.0 }",
        "{ law = \"voce\", yield_stress = 0.2, saturation_stress = 0.6, rate = 18.0 }",
        "{ law = \"table\", points = [[0.0, 0.5], [0.02, 0.8], [0.2, 1.4]] }",
    ] {
        for (nu, mu, depth) in [(0.0, 1.0, 0.15), (0.21, 0.03, 0.01), (0.33, 0.45, 0.05), (0.49, 0.12, 0.1), (0.3, 0.0, 0.02)] {
            all.push(case(hardening, nu, mu, depth, more));
        }
    }
    all
}

#[test]
fn a_file_comes_back_and_others_are_refused() {
    let law = plane();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("law.json");
    law.write(&path).unwrap();
    assert_eq!(LawFile::read(&path).unwrap(), LawFile::Interpolated(Box::new(law.clone())));
    let text = std::fs::read_to_string(&path).unwrap();
    let cases = law.samples.len();
    let weights = format!("processes[0].weights has {} numbers, and has to have {cases}", cases + 1);
    for (from, to, words) in [
        ("\"version\":1", "\"version\":9", "version 9"),
        ("\"weights\":[", "\"weights\":[0.0,", weights.as_str()),
        ("asperity-law-interpolated", "asperity-law-other", "is not a law of formulas"),
    ] {
        std::fs::write(&path, text.replacen(from, to, 1)).unwrap();
        let refused = LawFile::read(&path).unwrap_err().to_string();
        assert!(refused.contains(words), "{refused}");
    }
}

#[test]
fn contacts_of_any_material_have_a_law_that_rises_and_stays_within_coulomb() {
    let law = plane();
    for case in cases("") {
        let table = law.table(&case).unwrap();
        // The update has at least this.
        let mu = friction(&case).max(1e-9);
        for pair in table.levels.windows(2) {
            assert!(pair[1].f_n0 > pair[0].f_n0 && pair[1].a0 > pair[0].a0, "{case:?} at {}", pair[1].h);
        }
        let parameters = LawFile::Interpolated(Box::new(law.clone())).contact_parameters(&case).unwrap();
        let (r, e) = (case.sphere.radius, case.material.youngs_modulus);
        let points = follow(&parameters, &case.path);
        assert!(points.len() > 20);
        for point in &points {
            assert!(point.f_t <= mu * point.f_n * (1.0 + 1e-9) && point.f_n >= 0.0 && point.f_n < e * r * r, "{point:?}");
        }
        let last = points[points.len() - 1];
        assert!((last.f_t - mu * last.f_n).abs() <= 2e-3 * mu * last.f_n, "{case:?} does not slip: {last:?}");
        let outside = law.out_of_range(&case, table.range.to * r).unwrap();
        assert!(outside.is_empty(), "{outside:?} of {case:?}");
    }
}

/// Tables of nine contacts that were simulated at other depths and with more elements.
#[test]
fn it_tells_what_law_tabulate_simulates() {
    let law = plane();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/paths");
    let mut compared = 0;
    for name in ["ideal-200", "ideal-3200", "power-300"] {
        for mu in ["0.1", "0.3", "0.6"] {
            let simulated = Tabulated::read(&folder.join(format!("{name}-mu-{mu}.json"))).unwrap();
            let own = law.table(&simulated.deepest_case().unwrap()).unwrap();
            let [simulated, own] = [simulated, own].map(|table| table.contact_parameters(1.0, 1.0).unwrap());
            for h in [2e-3, 5e-3, 0.012, 0.018] {
                let [a, b] = [&simulated, &own].map(|parameters| parameters.virgin(h).point);
                for (what, ours, theirs, most) in [
                    ("F_N0", b.f_n0, a.f_n0, 0.015),
                    ("F_N_slip", b.f_n_slip, a.f_n_slip, 0.06),
                    ("a0", b.a, a.a, 0.03),
                    // Of a reversal it is read to some per cent.
                    ("k_T", b.k_t, a.k_t, 0.08),
                ] {
                    assert!((ours / theirs - 1.0).abs() < most, "{name}, mu = {mu}, h = {h}, {what}: {ours} and {theirs}");
                    compared += 1;
                }
            }
        }
    }
    assert_eq!(compared, 9 * 4 * 4);
}

#[test]
fn what_it_was_not_made_for_is_said() {
    let law = plane();
    let names = |case: &Case, h: f64| law.out_of_range(case, 3.0 * h).unwrap().iter().map(|one| one.quantity).collect::<Vec<_>>();
    let ideal = "{ law = \"ideal\", yield_stress = 0.4 }";
    assert_eq!(names(&case(ideal, 0.3, 0.3, 0.02, ""), 0.2), ["a/R"]);
    assert_eq!(names(&case(ideal, 0.3, 1.5, 0.02, ""), 0.02), ["mu"]);
    assert_eq!(names(&case("{ law = \"ideal\", yield_stress = 1e-4 }", 0.3, 0.3, 0.02, ""), 0.02), ["Lambda"]);
    assert!(
        law.table(&case(ideal, 0.3, 0.3, 0.02, "[opponent]\nequal = true")).unwrap_err().to_string().contains("equal sphere")
    );
    assert!(law.table(&case(ideal, 0.3, 0.3, 0.02, "[opponent]\nrigid = true\nradius = 2.0")).is_err());
    let refused = LawFile::Interpolated(Box::new(law)).of_case(None).unwrap_err().to_string();
    assert!(refused.contains("Give the case too"), "{refused}");
}

#[test]
fn two_bodies_are_put_in_series() {
    let law = plane();
    let other = |radius: &str, times: f64| {
        format!(
            "[opponent]\n{radius}\n[opponent.material]\nyoungs_modulus = {:?}\npoissons_ratio = 0.3\n\
             hardening = {{ law = \"ideal\", yield_stress = {:?} }}",
            210.0 * times,
            0.42 * times
        )
    };
    let ideal = "{ law = \"ideal\", yield_stress = 0.42 }";
    let of = |more: &str| law.compose(&case(ideal, 0.3, 0.3, 0.02, more)).unwrap();
    let deepest = |table: &Tabulated| table.levels[table.levels.len() - 1].clone();
    let [equal, alike, rigid, flat] =
        ["[opponent]\nequal = true", &other("radius = 3.0", 1.0), &other("flat = true", 1e5), &other("flat = true", 1.0)].map(of);
    assert_eq!([equal.body, alike.body], [Against::EqualSphere, Against::OtherSphere]);
    assert_eq!(equal.levels, alike.levels);
    // On a flat 1e5 times as stiff it is the law itself.
    let (own, there) = (deepest(&of("")), deepest(&rigid));
    // The radius of a pair is a mean of two.
    for (ours, theirs, most) in
        [(there.f_n0, own.f_n0, 0.005), (there.a0, own.a0, 0.03), (there.slip_share, own.slip_share, 0.005)]
    {
        assert!((ours / theirs - 1.0).abs() < most, "{there:?} {own:?}");
    }
    // An equal pair is pressed as each of the two is on the plane between them.
    let half = deepest(&law.table(&case(ideal, 0.3, 0.3, 0.01, "")).unwrap());
    assert!((deepest(&equal).f_n0 / half.f_n0 - 1.0).abs() < 0.03, "{} {}", deepest(&equal).f_n0, half.f_n0);
    assert!(deepest(&flat).f_n0 > deepest(&equal).f_n0 && deepest(&flat).a0 > deepest(&equal).a0);
}

#[test]
fn the_built_in_law_knows_equal_spheres() {
    let law = Interpolated::built_in().unwrap();
    let pair = law.pair.as_deref().expect("the law of two equal spheres");
    assert_eq!([law.frame, pair.frame], [None, Some(Frame::LineOfCentres)]);
    let old = BUILT_IN[1].1.replacen(",\"frame\":\"line of centres\"", "", 1);
    assert!(Interpolated::from_json(&old).unwrap_err().contains("two spheres along fixed axes"));
    assert_eq!([law.body, pair.body], [Against::Plane, Against::EqualSphere]);
    for case in cases("[opponent]\nequal = true").into_iter().step_by(6) {
        let (table, own) = (law.compose(&case).unwrap(), pair.table(&case).unwrap());
        assert_eq!(table, own);
        assert_eq!(table.body, Against::EqualSphere);
        assert_eq!(law.out_of_range(&case, 0.005).unwrap(), pair.out_of_range(&case, 0.005).unwrap());
        // Two spheres in series from the plane's law are near it, and not it: a plane rubs in the
        // press already, by which F_N is up to 10 % more at nu = 0 (bonded half-spaces, Spence
        // 1968).
        let series = plane().compose(&case).unwrap();
        let (ours, theirs) = (table.levels.last().unwrap(), series.levels.last().unwrap());
        let apart = (ours.f_n0 / theirs.f_n0 - 1.0).abs();
        assert!(apart > 0.0 && apart < 0.14, "{} {}", ours.f_n0, theirs.f_n0);
    }
    // A law of equal spheres says nothing of a plane, which the built-in one asks another about.
    let on_a_plane = &cases("")[0];
    assert!(pair.table(on_a_plane).unwrap_err().to_string().contains("rigid plane"));
    assert_eq!(law.compose(on_a_plane).unwrap(), plane().compose(on_a_plane).unwrap());
}

#[test]
fn a_sphere_of_the_same_radius_and_material_is_an_equal_one() {
    let law = LawFile::built_in().unwrap();
    let ideal = "{ law = \"ideal\", yield_stress = 0.42 }";
    let along = |opponent: &str| {
        let mut case = case(ideal, 0.3, 0.3, 0.039, &format!("[opponent]\n{opponent}"));
        case.path[1] = Segment::Shear { shear: ShearTarget::Displacement(0.015), hold: Hold::Indentation };
        law.follow(&case).unwrap().0
    };
    let [equal, same, larger] = ["equal = true", "radius = 3.0", "radius = 3.003"].map(along);
    // What is asked of the law is the same too, however deep.
    for depth in [0.02, 0.1, 0.14] {
        let [outside, too] = ["equal = true", "radius = 3.0"].map(|opponent| {
            let case = case(ideal, 0.3, 0.3, depth, &format!("[opponent]\n{opponent}"));
            law.out_of_range(&case, case.greatest_indentation()).unwrap()
        });
        assert_eq!(outside.len(), too.len(), "{depth}: {outside:?} {too:?}");
    }
    let most = equal.iter().map(|point| point.f_n).fold(0.0, f64::max);
    for other in [same, larger] {
        assert_eq!(equal.len(), other.len());
        for (a, b) in equal.iter().zip(&other) {
            assert!((a.delta_t - b.delta_t).abs() < 1e-12 && (a.f_n - b.f_n).abs() < 0.005 * most, "{a:?} {b:?}");
            assert!((a.f_t - b.f_t).abs() < 0.002 * most, "{a:?} {b:?}");
        }
    }
}

#[test]
fn two_spheres_slide_at_mu_in_the_frame_of_their_centres() {
    let case = case("{ law = \"ideal\", yield_stress = 0.42 }", 0.3, 0.05, 0.04, "[opponent]\nequal = true");
    let law = Interpolated::built_in().unwrap();
    for level in &law.compose(&case).unwrap().levels {
        let last = level.tangential[level.tangential.len() - 1];
        assert!((last - 1.0).abs() < 6e-3, "{last} at {}", level.h);
    }
    // What is predicted is along the axes of a simulation: there it is less.
    let (points, _) = LawFile::Interpolated(Box::new(law)).follow(&case).unwrap();
    let last = points[points.len() - 1];
    let [n, t] = Centres::of(&case).turned([last.h, last.delta_t], [last.f_n, last.f_t]);
    assert!((t / (0.05 * n) - 1.0).abs() < 5e-3, "{}", t / n);
    assert!(last.f_t / (0.05 * last.f_n) < 0.995, "{}", last.f_t / last.f_n);
}

#[test]
fn a_contact_whose_ratio_passes_a_peak_at_full_slip_has_slipped() {
    let sphere = ElasticSphere::unit(0.1);
    let (h, mu) = (0.01, 0.8);
    let f_n0 = 0.5 * hertz::force(&sphere, h);
    // F_T/F_N over mu rises to a peak at 0.9 of the shear and falls a little.
    let sheared = |peak: f64, fall: f64| {
        let at = |x: f64| {
            let ratio = if x < 0.9 { peak * (1.0 - (1.0 - x / 0.9).powi(3)) } else { peak - fall * (x - 0.9) / 0.1 };
            let f_n = f_n0 * (1.0 - 0.2 * x);
            ShearPoint { delta_t: 0.005 * x, f_t: mu * ratio * f_n, f_n }
        };
        let curve: Vec<ShearPoint> = (0..=20).map(|i| at(f64::from(i) / 20.0)).collect();
        let end = curve[20];
        let share = |i: i32| f64::from(i) / 20.0;
        let back = (0..=20).map(|i| ShearPoint {
            delta_t: end.delta_t * (1.0 - share(i)),
            f_t: end.f_t * (1.0 - 2.0 * share(i)),
            ..end
        });
        let release = (0..=5).map(|i| [h * (1.0 - 0.1 * share(i)), end.f_n * (1.0 - 2.0 * share(i))]);
        Measured { h, f_n0, a0: 0.1, back: back.collect(), release: release.collect(), curve }
    };
    let usable = |peak: f64, fall: f64| {
        crate::law::interpolated::outputs::outputs(&sphere, mu, &sheared(peak, fall), Against::Plane).is_some()
    };
    assert!(usable(0.992, 0.005) && !usable(0.985, 0.0));
    // One that falls far has not slid there.
    assert!(!usable(0.992, 0.05));
}
