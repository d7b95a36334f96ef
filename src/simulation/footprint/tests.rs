use super::*;

/// Points on a half of a sphere's cap, each for a cell of the same area, which carries what a
/// pressure over the undeformed chord s exerts on it. What was at s is at `moved` of s.
fn contact(spacing: f64, reach: f64, pressure: impl Fn(f64) -> f64, moved: impl Fn(f64) -> f64) -> Vec<RecordedPoint> {
    const PARTS: i32 = 10;
    let count = (reach / spacing).ceil() as i32;
    let mut points = Vec::new();
    for (i, j) in (-count..=count).flat_map(|i| (0..=count).map(move |j| (i, j))) {
        // Not in line with the axes, as no mesh is.
        let (x, y) = ((f64::from(i) + 0.3) * spacing, f64::from(j) * spacing);
        let s = x.hypot(y);
        let on_symmetry_plane = j == 0;
        let half = if on_symmetry_plane { 0.5 } else { 1.0 };
        let part = |k: i32| (f64::from(k) + 0.5) / f64::from(PARTS) - 0.5;
        let over_cell: f64 =
            (0..PARTS * PARTS).map(|k| pressure((x + part(k / PARTS) * spacing).hypot(y + part(k % PARTS) * spacing))).sum();
        let force = half * spacing * spacing * over_cell / f64::from(PARTS * PARTS);
        // The point of a sphere through the origin at the chord s.
        let outwards = (1.0 - 0.25 * s * s).sqrt();
        points.push(RecordedPoint {
            node: points.len(),
            reference: [x * outwards, y * outwards, 0.5 * s * s],
            position: [x / s * moved(s), y / s * moved(s), 0.0],
            force: [0.0, 0.0, force],
            gap: if force > 0.0 { 0.0 } else { 0.1 * spacing },
            area: half * spacing * spacing,
            on_symmetry_plane,
            is_of_whole: false,
            status: if force > 0.0 { Status::Stick } else { Status::Open },
        });
    }
    points
}

#[test]
fn a_pressure_that_runs_out_ends_where_it_does() {
    // Hertz's, and those of an elastic contact with friction.
    for power in [0.5, 0.6, 0.7] {
        for elements in [6.0, 8.0, 16.0] {
            let a = 0.01;
            let pressure = |s: f64| (1.0 - s * s / (a * a)).max(0.0).powf(power);
            let found = footprint(&contact(a / elements, 1.3 * a, pressure, |s| s), a / elements, 2).radius;
            assert!((found / a - 1.0).abs() < 0.16 / elements, "{power}, {elements} elements: {}", found / a);
        }
    }
}

#[test]
fn a_pressure_that_ends_abruptly_ends_there_however_the_surface_has_stretched() {
    // As ideally plastic contacts at h = 0.1 R: twice as much in the middle, a fifth more in
    // breadth there, a tenth at the edge.
    let (edge, moved) = (0.45_f64, |s: f64| s * (1.2 - 0.45 * s * s));
    for elements in [6.0, 8.0, 16.0] {
        let pressure = |s: f64| if s < edge { 1.0 - 0.5 * (s / edge).powi(2) } else { 0.0 };
        let spacing = edge / elements;
        let found = footprint(&contact(spacing, 1.4 * edge, pressure, moved), spacing, 2);
        assert!((found.radius / moved(edge) - 1.0).abs() < 0.01, "{elements} elements: {}", found.radius / moved(edge));
        // All of it sticks: in whole points.
        let off = found.stick_radius / moved(edge) - 1.0;
        assert!(off > 0.0 && off < 0.6 / elements, "{elements} elements: {}", found.stick_radius);
    }
}

#[test]
fn a_contact_that_has_moved_is_as_large() {
    let (edge, spacing) = (0.2_f64, 0.025);
    let of = |shift: f64| {
        let pressure = |s: f64| (1.0 - s * s / (edge * edge)).max(0.0).sqrt();
        let mut points = contact(spacing, 0.3, pressure, |s| 1.05 * s);
        points.iter_mut().for_each(|p| p.position[0] += shift);
        footprint(&points, spacing, 2)
    };
    let (here, there) = (of(0.0), of(0.03));
    assert!((here.radius - there.radius).abs() < 1e-12, "{here:?}, {there:?}");
}

#[test]
fn few_points_have_a_size_and_none_has_none() {
    let nothing = footprint(&contact(0.01, 0.05, |_| 0.0, |s| s), 0.01, 2);
    assert_eq!(nothing, Footprint::default());
    let small = footprint(&contact(0.01, 0.05, |s| if s < 0.008 { 1.0 } else { 0.0 }, |s| s), 0.01, 2);
    assert!(small.radius > 0.004 && small.radius < 0.02, "{small:?}");
}
