use super::coulomb::{Friction, Point, Rows, Status, contact_rows};

const MU: f64 = 0.4;
const C: f64 = 0.1;

fn point(force: [f64; 3], gap: f64, slip: [f64; 2]) -> Point<f64> {
    Point { force, gap, slip, weight: C, on_symmetry_plane: false }
}

fn rows(p: &Point<f64>) -> Rows<f64> {
    contact_rows(Friction::Coulomb(MU), p)
}

fn distance(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    (0..3).map(|i| (a[i] - b[i]).abs()).fold(0.0, f64::max)
}

#[test]
fn a_gap_opens_and_closes_a_point() {
    // Apart and free of force: nothing is asked.
    let r = rows(&point([0.0; 3], 0.3, [0.1, 0.2]));
    assert_eq!((r.status, r.residual, r.fixed), (Status::Open, [0.0; 3], [false; 3]));
    // Penetrating without force, in the first iteration of a press: closed by the gap, which is
    // what the row removes.
    let r = rows(&point([0.0; 3], -0.02, [0.0; 2]));
    assert_ne!(r.status, Status::Open);
    assert!(r.fixed[2] && (r.residual[2] - -0.02 * C).abs() < 1e-18 && (r.residual[2] / r.weight + 0.02).abs() < 1e-16);
    // Pulled to the plane: it opens, and the pull is the residual.
    let r = rows(&point([0.01, 0.0, -0.05], 0.0, [0.0; 2]));
    assert_eq!((r.status, r.residual, r.fixed), (Status::Open, [0.01, 0.0, -0.05], [false; 3]));
    // Pulled and penetrating more than the pull is worth: closed, without friction, because f_z <=
    // 0 bounds it by 0.
    let r = rows(&point([0.01, -0.02, -0.001], -0.05, [0.01, 0.02]));
    assert_eq!((r.status, r.fixed), (Status::Slip, [false, false, true]));
    assert_eq!(r.residual, [0.01, -0.02, -0.05 * C]);
    assert_eq!(r.force_rows[0], [1.0, 0.0, 0.0], "df_x = -f_x");
    assert_eq!(r.displacement_rows[0], [0.0; 3]);
    // Touching exactly with nothing on it is open: a point at rest on the plane takes no part.
    assert_eq!(rows(&point([0.0; 3], 0.0, [0.0; 2])).status, Status::Open);
}

#[test]
fn a_point_sticks_inside_the_cone_and_slips_outside() {
    let r = rows(&point([0.3, 0.2, 1.0], 0.0, [0.0; 2]));
    assert_eq!((r.status, r.residual, r.fixed), (Status::Stick, [0.0; 3], [true; 3]));
    // Stick with a slip not yet taken back.
    let r = rows(&point([0.3, 0.2, 1.0], 0.0, [1e-3, -2e-3]));
    assert_eq!((r.status, r.residual), (Status::Stick, [1e-3 * C, -2e-3 * C, 0.0]));
    // Sliding steadily on the cone, against the slip: the residual is zero.
    let r = rows(&point([-MU * 0.6, -MU * 0.8, 1.0], 0.0, [0.03, 0.04]));
    assert_eq!((r.status, r.fixed), (Status::Slip, [false, false, true]));
    assert!(distance(&r.residual, &[0.0; 3]) < 1e-16, "{:?}", r.residual);
    // Too much friction for the normal force: the excess is the residual.
    let r = rows(&point([0.9, 0.0, 1.0], 0.0, [0.0; 2]));
    assert_eq!(r.status, Status::Slip);
    assert!(distance(&r.residual, &[0.5, 0.0, 0.0]) < 1e-15, "{:?}", r.residual);
    // Friction that pushes along the slip, with a slip too large to be stuck back: wrong by twice
    // the bound.
    let r = rows(&point([MU, 0.0, 1.0], 0.0, [10.0, 0.0]));
    assert!(distance(&r.residual, &[2.0 * MU, 0.0, 0.0]) < 1e-15, "{:?}", r.residual);
}

#[test]
fn no_friction_and_full_stick_are_the_ends() {
    let p = point([0.3, -0.2, 1.0], 0.0, [0.05, 0.02]);
    let r = contact_rows(Friction::Coulomb(0.0), &p);
    assert_eq!((r.status, r.residual, r.fixed), (Status::Slip, [0.3, -0.2, 0.0], [false, false, true]));
    assert_eq!((r.force_rows[0], r.force_rows[1]), ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]));
    assert_eq!(r.displacement_rows[..2], [[0.0; 3]; 2]);
    for force in [[0.3, -0.2, 1.0], [30.0, 0.0, 1e-9]] {
        let r = contact_rows(Friction::Stick, &Point { force, ..p });
        assert_eq!((r.status, r.fixed), (Status::Stick, [true; 3]));
        assert!(distance(&r.residual, &[0.05 * C, 0.02 * C, 0.0]) < 1e-18);
    }
    // Stick ends where contact ends.
    assert_eq!(contact_rows(Friction::Stick, &Point { force: [0.1, 0.0, -0.1], ..p }).status, Status::Open);
}

#[test]
fn a_point_on_the_symmetry_plane_moves_and_rubs_along_x_alone() {
    for (force, slip, status) in [
        ([0.3, 7.0, 1.0], [1e-3, 0.0], Status::Stick),
        ([0.9, 7.0, 1.0], [1e-3, 0.0], Status::Slip),
        ([-0.9, -7.0, 1.0], [1e-3, 0.0], Status::Slip),
        ([0.1, 7.0, -1.0], [1e-3, 0.0], Status::Open),
    ] {
        let p = Point { on_symmetry_plane: true, ..point(force, 0.0, slip) };
        let r = rows(&p);
        assert_eq!(r.status, status, "the reaction in y, {}, must not count", force[1]);
        assert!(r.fixed[1] && r.residual[1] == 0.0 && r.force_rows[1] == [0.0; 3]);
        if status == Status::Slip {
            assert!((r.residual[0] - (force[0] - MU * force[0].signum())).abs() < 1e-15);
            assert_eq!((r.force_rows[0][0], r.force_rows[0][1]), (1.0, 0.0));
            assert_eq!(r.displacement_rows[0], [0.0; 3]);
        }
    }
}

/// Residual as a function of (f, u): gap and slip move with u.
fn residual(p: &Point<f64>, step: &[f64; 6]) -> [f64; 3] {
    let moved = Point {
        force: [p.force[0] + step[0], p.force[1] + step[1], p.force[2] + step[2]],
        gap: p.gap + step[5],
        slip: [p.slip[0] + step[3], p.slip[1] + step[4]],
        ..*p
    };
    rows(&moved).residual
}

#[test]
fn the_rows_are_the_derivatives_of_the_residual() {
    let points = [
        point([0.1, -0.2, -0.05], 0.3, [0.1, 0.1]),
        point([0.1, 0.2, 1.0], 0.01, [0.02, -0.03]),
        point([0.9, 0.5, 1.0], -0.01, [0.2, -0.3]),
        point([-0.4, 0.1, 0.3], 0.2, [2.0, 3.0]),
        point([0.3, 0.2, -0.001], -0.5, [0.1, 0.1]),
        Point { on_symmetry_plane: true, ..point([0.9, 0.3, 1.0], -0.01, [0.2, 0.0]) },
    ];
    let expected = [Status::Open, Status::Stick, Status::Slip, Status::Slip, Status::Slip, Status::Slip];
    for (p, expected) in points.iter().zip(expected) {
        let r = rows(p);
        assert_eq!(r.status, expected);
        for k in 0..6 {
            let e = 1e-6;
            let mut step = [0.0; 6];
            step[k] = e;
            let up = residual(p, &step);
            step[k] = -e;
            let down = residual(p, &step);
            for i in 0..3 {
                let numeric = (up[i] - down[i]) / (2.0 * e);
                let analytic = match (r.fixed[i], k < 3) {
                    // The row reads du_i = -r/c: its derivative is c times the unit row.
                    (true, false) => C * r.displacement_rows[i][k - 3],
                    (_, true) => r.force_rows[i][k],
                    (false, false) => r.displacement_rows[i][k - 3],
                };
                assert!((numeric - analytic).abs() < 1e-9, "{expected:?} row {i}, unknown {k}: {numeric} {analytic}");
            }
        }
    }
}

#[test]
fn the_residual_is_continuous_from_stick_to_slip() {
    for angle in [0.0_f64, 1.0, 2.5, -2.0] {
        let f_z = 0.7;
        let du = [0.03, -0.05];
        // On the cone: f_t = c du_t + mu f_z (cos, sin).
        let edge = |factor: f64| {
            point([C * du[0] + factor * MU * f_z * angle.cos(), C * du[1] + factor * MU * f_z * angle.sin(), f_z], 1e-3, du)
        };
        let (inside, outside) = (rows(&edge(1.0 - 1e-9)), rows(&edge(1.0 + 1e-9)));
        assert_eq!((inside.status, outside.status), (Status::Stick, Status::Slip));
        assert!(distance(&inside.residual, &outside.residual) < 1e-8);
    }
}

#[test]
fn the_residual_is_continuous_from_open_to_closed_where_the_force_vanishes() {
    // xi_n = f_z - c g = 0 is reached with any f_z > 0 off the solution; there the normal residual
    // is continuous, and the tangential one jumps by the friction that the point is allowed as soon
    // as it is closed, mu f_z. With f_z the jump vanishes.
    for f_z in [0.0, 1e-6, 1e-2] {
        let gap = f_z / C;
        let open = rows(&point([0.5, 0.1, f_z - 1e-12], gap, [0.0; 2]));
        let closed = rows(&point([0.5, 0.1, f_z + 1e-12], gap, [0.0; 2]));
        assert_eq!((open.status, closed.status), (Status::Open, Status::Slip));
        assert!((open.residual[2] - closed.residual[2]).abs() < 1e-11, "normal");
        let jump = (open.residual[0] - closed.residual[0]).hypot(open.residual[1] - closed.residual[1]);
        assert!((jump - MU * f_z).abs() < 1e-11, "tangential: {jump:e} at f_z = {f_z}");
    }
}

#[test]
fn nothing_not_finite_comes_to_rest() {
    for i in 0..3 {
        let mut force = [0.1, 0.1, 1.0];
        force[i] = f64::NAN;
        let r = rows(&point(force, 0.01, [0.0; 2]));
        let seen = r.residual.iter().any(|x| x.is_nan()) || r.status != Status::Open;
        assert!(seen, "a NaN in component {i} is taken for {r:?}");
    }
    assert!(rows(&point([0.0, 0.0, 1.0], f64::NAN, [0.0; 2])).residual[2].is_nan());
}

#[test]
fn single_precision_says_the_same() {
    for (force, gap, slip) in
        [([0.1, -0.2, -0.05], 0.3, [0.1, 0.1]), ([0.1, 0.2, 1.0], 0.01, [0.02, -0.03]), ([0.9, 0.5, 1.0], -0.01, [0.2, -0.3])]
    {
        let wide = rows(&point(force, gap, slip));
        let narrow = contact_rows(
            Friction::Coulomb(MU as f32),
            &Point {
                force: force.map(|x| x as f32),
                gap: gap as f32,
                slip: slip.map(|x| x as f32),
                weight: C as f32,
                on_symmetry_plane: false,
            },
        );
        assert_eq!((wide.status, wide.fixed), (narrow.status, narrow.fixed));
        for i in 0..3 {
            assert!((wide.residual[i] - f64::from(narrow.residual[i])).abs() < 3e-7);
            for j in 0..3 {
                assert!((wide.force_rows[i][j] - f64::from(narrow.force_rows[i][j])).abs() < 3e-7);
                assert!((wide.displacement_rows[i][j] - f64::from(narrow.displacement_rows[i][j])).abs() < 3e-7);
            }
        }
    }
}
