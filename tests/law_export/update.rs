//! The vectors, and the update that they are of.

use asperity::analytical::ElasticSphere;
use asperity::law::export::{Language, law_files};
use asperity::law::variables::Body;
use asperity::law::{LawFile, Parameters};
use asperity::material::FlowStress;

use super::{IDEAL, case, fitted_law, laws};

#[test]
fn the_vectors_go_where_a_contact_can_go() {
    let law = LawFile::Formulas(Box::new(fitted_law()));
    let files = law_files(&law, Language::C, Some(&case(IDEAL))).unwrap();
    let text = &files.iter().find(|file| file.name == "asperity_law_vectors.csv").unwrap().content;
    let rows: Vec<Vec<f64>> = text.lines().skip(1).map(|line| line.split(',').map(|v| v.parse().unwrap()).collect()).collect();
    let names: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    let at = |row: &[f64], name: &str| row[names.iter().position(|other| *other == name).unwrap()];
    let count = |test: &dyn Fn(&[f64]) -> bool| rows.iter().filter(|row| test(row)).count();
    assert!(rows.iter().all(|row| row.len() == names.len() && row.iter().all(|value| value.is_finite())));
    assert!(count(&|row| at(row, "f_n") == 0.0) > 10);
    assert!(count(&|row| at(row, "worn") > 1.0 && at(row, "f_n") > 0.0) > 100);
    assert!(count(&|row| at(row, "worn") > 0.0 && at(row, "worn") < 1.0) > 100);
    let force = |row: &[f64]| at(row, "f_t0").hypot(at(row, "f_t1"));
    let slips = |row: &[f64]| at(row, "f_n") > 0.0 && force(row) > 0.999 * at(row, "mu") * at(row, "f_n");
    assert!(count(&slips) > 100);
    assert!(count(&|row| at(row, "cosine") != 1.0) > 100);
    assert!(rows.iter().all(|row| force(row) <= at(row, "mu") * at(row, "f_n") * (1.0 + 1e-12)));
}

#[test]
fn the_update_follows_the_law_it_is_made_of() {
    let sphere = ElasticSphere { radius: 0.5, youngs_modulus: 70e3, poissons_ratio: 0.3 };
    for law in laws() {
        for hardening in [FlowStress::ideal(100.0).unwrap(), FlowStress::hollomon(400.0, 4.0, 70e3).unwrap(), FlowStress::Elastic]
        {
            let body = Body { sphere, hardening };
            let friction = 0.25;
            let pair = law.contact_parameters(&body, friction).unwrap();
            for h in [1e-5, 1e-3, 0.02].map(|h| h * sphere.radius) {
                let inputs = law.inputs(&body, friction, h);
                let expected: Parameters = law.contact(&inputs);
                let (mut state, _) = pair.update(&Default::default(), h, [0.0; 2]);
                for k in 1..=20 {
                    let delta = 1.1 * expected.delta_t_end * f64::from(k) / 20.0;
                    let increment = 1.1 * expected.delta_t_end / 20.0;
                    let (next, out) = pair.update(&state, h, [0.0, increment]);
                    state = next;
                    let (f_t, f_n) = law.forces(&expected, friction, delta);
                    // The sliders of an elastic contact are good for 1.2e-2, the flow of a plastic
                    // one for some more.
                    assert!((out.f_t[1] - f_t).abs() < 6e-2 * friction * f_n, "{h} {k}: {} {f_t}", out.f_t[1]);
                    assert!((out.f_n - f_n).abs() < 3e-2 * f_n, "{h} {k}: {} {f_n}", out.f_n);
                }
            }
        }
    }
}

/// Every step of a path, however it turns, takes at least the stored energy that it adds; so no
/// closed path returns work.
#[test]
fn no_path_extracts_work() {
    let sphere = ElasticSphere { radius: 1.0, youngs_modulus: 200e3, poissons_ratio: 0.3 };
    let mut seed = 1u64;
    let mut random = |from: f64, to: f64| {
        seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        from + (to - from) * ((seed >> 11) as f64 / (1u64 << 53) as f64)
    };
    let mut worst: f64 = 0.0;
    for law in laws() {
        for (stress, friction) in [(20.0, 0.5), (400.0, 0.3), (2500.0, 0.1)] {
            let pair = law.contact_parameters(&Body { sphere, hardening: FlowStress::ideal(stress).unwrap() }, friction).unwrap();
            for _ in 0..8 {
                let deepest = 10f64.powf(random(-4.0, -1.2));
                let virgin = pair.virgin(deepest);
                let mut state = Default::default();
                let (mut at, mut f, mut work, mut through) = ([0.0; 3], [0.0; 3], 0.0, 0.0);
                for leg in 0..13 {
                    let mut to = at;
                    let kind = random(0.0, 1.0);
                    if leg == 0 || kind < 0.3 {
                        to[0] = deepest * random(0.3, 1.0);
                    } else if kind < 0.5 {
                        to[0] = at[0] - virgin.depth * random(-0.2, 0.6);
                    }
                    if leg > 0 && kind > 0.2 {
                        to[1] = virgin.point.delta_t_end * random(-1.5, 1.5);
                        to[2] = virgin.point.delta_t_end * random(-0.5, 0.5);
                    }
                    if leg == 12 {
                        to = [-1e-2 * deepest, 0.0, 0.0]; // back to where it started
                    }
                    let step: [f64; 3] = std::array::from_fn(|i| (to[i] - at[i]) / 500.0);
                    for _ in 0..500 {
                        at = std::array::from_fn(|i| at[i] + step[i]);
                        let (next, out) = pair.update(&state, at[0], [step[1], step[2]]);
                        let now = [out.f_n, out.f_t[0], out.f_t[1]];
                        let done: f64 = (0..3).map(|i| 0.5 * (f[i] + now[i]) * step[i]).sum();
                        let gain = pair.stored_energy(&next) - pair.stored_energy(&state) - done;
                        through += done.abs();
                        work += done;
                        // Between the knots of the table next to yield a step may gain a little of
                        // what others lost.
                        assert!(gain <= 1e-3 * through, "{stress} leg {leg}: {gain:e} of {through:e}");
                        (state, f) = (next, now);
                        let lost = work - pair.stored_energy(&state);
                        worst = worst.min(lost / through);
                        assert!(lost >= -1e-4 * through, "{stress} leg {leg}: {lost:e} of {through:e}");
                    }
                }
                // All that was stored is given back where the contact is lost; work in is what is
                // left.
                assert!(f == [0.0; 3] && work > 0.0, "{stress}: {f:?} {work:e} of {through:e}");
            }
        }
    }
    println!("least dissipation {worst:e} of the work exchanged");
}
