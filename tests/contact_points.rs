//! What the points of the contact do and carry, at every step of small runs: Coulomb's bound, the
//! sums over both halves, and full stick.

mod paths;

use asperity::case::{Case, Friction};
use asperity::output::{ContactPoint, ContactStatus, Half};
use paths::Steps;
use rayon::prelude::*;

/// Follows the path of fixtures/cases/ideal.toml, or another, on a mesh of 4 elements a contact
/// radius.
fn follow(settings: &[&str]) -> (Case, Steps) {
    let mut all: Vec<String> = settings.iter().map(|&setting| setting.to_owned()).collect();
    all.push("mesh.elements_per_contact_radius=4".to_owned());
    let case = Case::parse(include_str!("../fixtures/cases/ideal.toml"), "ideal.toml", &all).expect("a case");
    let steps = paths::follow(&case);
    (case, steps)
}

const CASES: [&[&str]; 8] = [
    &[],
    &["contact.friction=0.1"],
    &["contact.friction=0.0"],
    &["contact.friction=0.6", "mesh.fine_zone=2.0"],
    &["material.hardening={law=\"elastic\"}"],
    &["material.hardening={law=\"linear\",yield_stress=300.0,modulus=5000.0}", "material.poissons_ratio=0.45"],
    &["material.hardening={law=\"hollomon\",coefficient=1000.0,exponent=5.0}", "contact.friction=0.2"],
    // There and back, and off the plane.
    &["path=[{indentation=0.01},{shear=0.0005},{shear=-0.0005},{release=true}]"],
];

#[test]
fn no_point_carries_more_than_friction_allows_and_both_halves_add_up() {
    CASES.par_iter().for_each(|settings| {
        // At the default tolerance, and one at which the iteration says nothing more.
        for tolerance in [None, Some("solver.tolerance=1e-7")] {
            let settings: Vec<&str> = settings.iter().copied().chain(tolerance).collect();
            let (case, steps) = follow(&settings);
            let Friction::Coefficient(mu) = case.contact.friction else { unreachable!("no case is of full stick") };
            let (mut closed, mut slipping) = (0, 0);
            for (row, points) in &steps {
                let at = format!("{settings:?}, step {}", row.step);
                for p in points.iter().filter(|p| p.status != ContactStatus::Open) {
                    (closed, slipping) = (closed + 1, slipping + usize::from(p.status == ContactStatus::Slip));
                    let (traction, bound) = (p.traction_x.hypot(p.traction_y), mu * p.pressure * (1.0 + 1e-3));
                    // Where the pressure is next to nothing, and wherever the step was accepted
                    // with a residual, the bound is known to that: no force is more beyond it than
                    // the merit, which counts all of them, times F_N. A point on the symmetry plane
                    // is two halves.
                    let residual = row.merit * 0.5 * row.f_n * if p.half == Half::Both { 2.0 } else { 1.0 };
                    assert!((traction - bound) * p.area <= residual * (1.0 + 1e-9), "{at}: {traction} beyond {bound}, {p:?}");
                    assert!(tolerance.is_none() || residual < 2e-7 * row.f_n);
                    assert!(p.pressure >= -1e-6 * row.f_n / p.area, "{at}: {p:?}");
                    assert!(p.half != Half::Both || p.traction_y == 0.0, "{at}: the other half's pull in {p:?}");
                }
                let sum = |of: fn(&ContactPoint) -> f64| points.iter().map(|p| of(p) * p.area).sum::<f64>();
                let size = 1e-12 * row.f_n.max(f64::MIN_POSITIVE);
                assert!((sum(|p| p.pressure) - row.f_n).abs() <= size, "{at}: F_N");
                assert!((sum(|p| p.traction_x) + row.f_t).abs() <= size, "{at}: F_T");
                assert!(sum(|p| p.traction_y).abs() <= size, "{at}: across");
                // Each image has its point, at the same distance on the other side.
                let of = |half: Half| points.iter().filter(move |p| p.half == half);
                assert!(of(Half::Both).all(|p| p.reference_y == 0.0 && p.current_y == 0.0) && of(Half::Both).count() > 4);
                assert!(of(Half::Meshed).all(|p| p.reference_y > 0.0));
                assert!(of(Half::Mirrored).map(|p| (p.point, -p.current_y)).eq(of(Half::Meshed).map(|p| (p.point, p.current_y))));
            }
            assert!(closed > 200 && slipping > 50, "{settings:?}: {closed} closed points, {slipping} slip");
        }
    });
}

/// Under full stick a point stays where it has touched down: it carries no tangential force at the
/// end of the step in which it comes down, and does not move from then on. A point that came off
/// and down again within a step does the same; such points are counted.
#[test]
fn full_stick_holds_every_point_from_where_it_touched_down() {
    let counts: Vec<(usize, usize, usize)> = [5, 12, 16, 17, 20, 24]
        .into_par_iter()
        .map(|press_steps| {
            let steps = format!("solver.press_steps={press_steps}");
            let path = "path=[{indentation=0.02},{shear=0.002}]";
            let (_, steps) = follow(&["contact.friction=\"stick\"", path, &steps]);
            let mut landed_again = 0;
            for pair in steps.windows(2) {
                let [(_, before), (row, after)] = pair else { unreachable!("pairs") };
                let at = format!("{press_steps} steps of the press, step {}", row.step);
                assert_eq!(row.relaxed, 0, "{at}");
                let mut slid = 0;
                for (was, is) in before.iter().zip(after).filter(|(_, is)| is.status != ContactStatus::Open) {
                    let traction = is.traction_x.hypot(is.traction_y);
                    if is.status == ContactStatus::Slip {
                        assert!(traction == 0.0, "{at}: {is:?} has come down and carries {traction}");
                        slid += usize::from(was.status != ContactStatus::Open);
                        continue;
                    }
                    assert_ne!(was.status, ContactStatus::Open, "{at}: {is:?} sticks to where it was above the plane");
                    let moved = (is.current_x - was.current_x).hypot(is.current_y - was.current_y);
                    assert!(moved < 1e-12, "{at}: {was:?} moved by {moved:e}");
                }
                // Both halves are in the table.
                assert!(slid <= 2 * row.landed_again, "{at}: {slid} points slide, {} have landed again", row.landed_again);
                landed_again += row.landed_again;
            }
            let last = steps.last().expect("steps").0;
            // What slides does so without friction: nothing is dissipated but for the residual at
            // which a step is accepted.
            assert!(steps.iter().all(|(row, _)| row.work_friction.abs() < 1e-5 * last.work_external), "{press_steps}: {last:?}");
            // More than any coefficient of the other cases: only the yield stress in shear limits
            // it.
            assert!(last.f_t / last.f_n > 0.4, "{last:?}");
            (press_steps, landed_again, steps.len() - 1)
        })
        .collect();
    println!("press steps, points landed again, steps: {counts:?}");
    let sums = counts.iter().fold((0, 0), |sums, count| (sums.0 + count.1, sums.1 + count.2));
    assert!(sums.0 <= sums.1 / 4, "more than one point in four steps has landed again: {counts:?}");
}
