//! A thin layer dragged over the plane with Coulomb friction, against its closed form.
//!
//! Plane strain (every node is on the symmetry plane), one layer of elements between plate and
//! plane, fifty times as long as thick. As long as every point sticks, F is homogeneous and the
//! forces are exact. Once every point slips, F_T = mu F_N exactly (to 1e-9: the sum of residuals of
//! 1e-12). Between the two a layer without ends goes over at once; the ends of this one bring in a
//! band of the width of thickness/length.

use super::*;
use crate::mesh::brick;
use crate::solver::pose::Pose;

const LENGTH: f64 = 1.0;
const THICKNESS: f64 = 0.02;
const WIDTH: f64 = 0.1;
const AREA: f64 = LENGTH * WIDTH;
const MU: f64 = 0.25;
const H: f64 = 2e-4;

fn layer() -> Rig {
    let mut mesh = brick(8, 1, 1, [LENGTH, WIDTH, THICKNESS]).unwrap();
    mesh.symmetry_nodes = (0..mesh.nodes.len() as u32).collect();
    Rig::new(mesh, elastic(0.3), Friction::Coulomb(MU), TIGHT)
}

/// Nominal pressure and shear traction of the layer at F = I + gamma e_x (x) e_z + (lambda - 1) e_z
/// (x) e_z.
fn tractions(lambda: f64, gamma: f64) -> (f64, f64) {
    let e = elastic(0.3).elasticity;
    let pressure = 0.5 * e.bulk * (1.0 / lambda - lambda)
        + e.shear * (lambda.powf(-5.0 / 3.0) * (2.0 + gamma * gamma + lambda * lambda) / 3.0 - lambda.powf(1.0 / 3.0));
    (pressure, e.shear * lambda.powf(-2.0 / 3.0) * gamma)
}

/// Plate displacement at which the whole of an endless layer begins to slide, h held.
fn slip_displacement() -> f64 {
    let lambda = 1.0 - H / THICKNESS;
    let mut gamma = 0.0;
    for _ in 0..50 {
        // tau is linear in gamma, p nearly constant: a contraction.
        gamma = MU * tractions(lambda, gamma).0 / tractions(lambda, 1.0).1;
    }
    gamma * THICKNESS
}

fn all(rig: &Rig, status: Status) -> bool {
    rig.statuses().iter().all(|s| *s == status)
}

#[test]
fn a_layer_sticks_slips_and_goes_back_as_it_should() {
    let mut rig = layer();
    let lambda = 1.0 - H / THICKNESS;
    rig.to(H, 0.0);
    assert!(all(&rig, Status::Stick));
    assert!((rig.forces().0 / (tractions(lambda, 0.0).0 * AREA) - 1.0).abs() < 1e-10);
    assert!(rig.forces().1.abs() < 1e-12 * rig.forces().0);

    let slip = slip_displacement();
    // Sticking: exact.
    for part in [0.2, 0.4, 0.6] {
        rig.to(H, part * slip);
        let (p, tau) = tractions(lambda, part * slip / THICKNESS);
        let (f_n, f_t) = rig.forces();
        assert!(all(&rig, Status::Stick), "at {part}");
        assert!((f_n / (p * AREA) - 1.0).abs() < 1e-10 && (f_t / (tau * AREA) - 1.0).abs() < 1e-10, "at {part}: {f_n} {f_t}");
    }
    // Sliding: F_T = mu F_N exactly, steady, and close to the endless layer's.
    let mut last = None;
    for part in [2.0, 3.0, 10.0] {
        rig.to(H, part * slip);
        let (f_n, f_t) = rig.forces();
        assert!(all(&rig, Status::Slip), "at {part}: {:?}", rig.statuses());
        assert!((f_t / (MU * f_n) - 1.0).abs() < 1e-9, "at {part}: {}", f_t / (MU * f_n));
        let (p, _) = tractions(lambda, slip / THICKNESS);
        assert!((f_n / (p * AREA) - 1.0).abs() < 0.01, "at {part}: {}", f_n / (p * AREA));
        if let Some((n, t)) = last.replace((f_n, f_t)) {
            assert!((f_n / n - 1.0_f64).abs() < 1e-9 && (f_t / t - 1.0_f64).abs() < 1e-9, "sliding is not steady at {part}");
        }
    }
    let forward = rig.forces();

    // Back: sticks at once, with the stiffness that it had at first (but for the ends), and slides
    // the other way after twice the way.
    let turn = 10.0 * slip;
    let (_, tau) = tractions(lambda, 0.5 * slip / THICKNESS);
    rig.to(H, turn - 0.5 * slip);
    assert!(all(&rig, Status::Stick));
    assert!(((forward.1 - rig.forces().1) / (tau * AREA) - 1.0).abs() < 0.01);
    rig.to(H, turn - 1.4 * slip);
    assert!(all(&rig, Status::Stick));
    rig.to(H, turn - 2.2 * slip);
    rig.to(H, turn - 4.0 * slip);
    assert!(all(&rig, Status::Slip));
    let backward = rig.forces();
    assert!((backward.0 / forward.0 - 1.0).abs() < 1e-9, "F_N {} {}", forward.0, backward.0);
    assert!((backward.1 / forward.1 + 1.0).abs() < 1e-9, "F_T {} {}", forward.1, backward.1);
}

#[test]
fn the_answer_does_not_depend_on_the_steps() {
    // Sticking, then sliding one way: elastic and friction-limited, so one step and twenty end in
    // the same state.
    let slip = slip_displacement();
    let mut once = layer();
    once.to(H, 0.0);
    once.to(H, 5.0 * slip);
    let mut often = layer();
    for i in 1..=4 {
        often.to(0.25 * H * f64::from(i), 0.0);
    }
    for i in 1..=20 {
        often.to(H, 0.25 * slip * f64::from(i));
    }
    let (a, b) = (once.forces(), often.forces());
    assert!((a.0 / b.0 - 1.0).abs() < 1e-10 && (a.1 / b.1 - 1.0).abs() < 1e-10, "{a:?} {b:?}");
}

#[test]
fn the_normal_force_is_held_while_the_layer_is_sheared() {
    let mut rig = layer();
    rig.to(H, 0.0);
    let held = rig.forces().0;
    let slip = slip_displacement();
    // Sticking, sliding, turned (sticking again, but not from rest), and sliding the other way.
    let stick = |part| (part, Some(Status::Stick), 0.0);
    for (part, status, direction) in [
        stick(0.3),
        stick(0.6),
        (2.0, Some(Status::Slip), 1.0),
        (5.0, Some(Status::Slip), 1.0),
        (4.0, None, 0.0),
        (1.0, Some(Status::Slip), -1.0),
    ] {
        let report = rig.step(&Control { h: rig.h, pose: Pose::along_x(part * slip), normal_force: Some(held) });
        let (f_n, f_t) = rig.forces();
        assert!((f_n / held - 1.0).abs() < 1e-10, "at {part}: {}", f_n / held);
        assert!(report.iterations.len() <= 8, "at {part}: {} iterations", report.iterations.len());
        assert!(status.is_none_or(|status| all(&rig, status)), "at {part}: {:?}", rig.statuses());
        match status {
            Some(Status::Stick) => {
                // The plate comes down as the layer is sheared: at this lambda and gamma the
                // pressure is the held one.
                let (p, tau) = tractions(1.0 - rig.h / THICKNESS, part * slip / THICKNESS);
                assert!(rig.h != H && (p * AREA / held - 1.0).abs() < 1e-10, "at {part}: {}", p * AREA / held);
                assert!((f_t / (tau * AREA) - 1.0).abs() < 1e-10, "at {part}");
            }
            Some(_) => assert!((direction * f_t / (MU * held) - 1.0).abs() < 1e-9, "at {part}: {f_t}"),
            None => {}
        }
    }
}

#[test]
fn work_is_stored_or_rubbed_off() {
    // External work by the trapezoidal rule against elastic energy and friction, forward and back.
    let error = |n: usize| {
        let mut rig = layer();
        let (mut f_n, mut f_t, mut work, mut friction) = (0.0, 0.0, 0.0, 0.0);
        let slip = slip_displacement();
        let mut at = (0.0, 0.0);
        let path: Vec<(f64, f64)> = (1..=n)
            .map(|i| (H * i as f64 / n as f64, 0.0))
            .chain((1..=n).map(|i| (H, 2.5 * slip * i as f64 / n as f64)))
            .chain((1..=n).map(|i| (H, 2.5 * slip * (1.0 - 2.0 * i as f64 / n as f64))))
            .collect();
        let mut force = vec![0.0; rig.u.len()];
        for (h, delta_t) in path {
            let before = rig.u.clone();
            rig.to(h, delta_t);
            let (n, t) = rig.forces();
            work += 0.5 * (f_n + n) * (h - at.0) + 0.5 * (f_t + t) * (delta_t - at.1);
            let next = rig.newton.accepted().force.clone();
            for &node in &rig.mesh.contact_nodes {
                for k in [3 * node as usize, 3 * node as usize + 1] {
                    friction -= 0.5 * (force[k] + next[k]) * (rig.u[k] - before[k]);
                }
            }
            (f_n, f_t, at, force) = (n, t, (h, delta_t), next);
        }
        assert!(friction > 0.1 * work, "hardly any friction: {friction:e} of {work:e}");
        (work - rig.energies.elastic - friction) / work
    };
    let errors = [10, 20, 40, 80].map(error);
    // The trapezoidal rule is of second order, and nothing else is left.
    assert!(errors.windows(2).all(|e| e[1].abs() < 0.3 * e[0].abs()) && errors[3].abs() < 1e-6, "{errors:?}");
}
