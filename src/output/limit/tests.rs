use super::*;
use crate::output::{ErrorEstimate, Summary, SummaryInputs};

const MU: f64 = 0.3;
/// Share of F_T/F_N that one element along the contact radius lacks, and of F_N.
const FIRST: f64 = 0.4;
const NORMAL: f64 = 0.2;

fn case(path: &str) -> Case {
    let text = include_str!("../../../fixtures/cases/ideal.toml");
    Case::parse(text, "ideal.toml", &[format!("path=[{path}]")]).expect("a case")
}

/// F_T/F_N after the share x of a slip displacement.
fn ratio(x: f64) -> f64 {
    let held = 1.0 - x.clamp(0.0, 1.0);
    0.9 * MU * (1.0 - held * held.sqrt())
}

/// A run on n elements, with errors of first order in 1/n: pressed in `press` steps to h = 0.02,
/// sheared in `shear` ones by `reach`, and back.
fn run(n: f64, press: usize, shear: usize, reach: f64) -> Vec<StepRecord> {
    let slip = 0.002;
    let force = |h: f64| 7500.0 * h * (1.0 + NORMAL / n);
    let mut rows = Vec::new();
    for i in 1..=press {
        let h = 0.02 * i as f64 / press as f64;
        rows.push(StepRecord { h, f_n: force(h), a: h.sqrt() * (1.0 - NORMAL / n), ..StepRecord::default() });
    }
    let deepest = rows[press - 1];
    let sheared = |segment, delta_t: f64, at: f64| {
        let held = 1.0 - at.clamp(0.0, 1.0);
        let f_n = deepest.f_n * (0.7 + 0.3 * held * held);
        StepRecord { segment, delta_t, f_n, f_t: f_n * ratio(at) * (1.0 + FIRST / n), ..deepest }
    };
    for i in 1..=shear {
        let delta_t = reach * (i as f64 / shear as f64).powf(1.3);
        rows.push(sheared(1, delta_t, delta_t / slip));
    }
    for i in 1..=shear {
        // What comes back goes with the way from the reversal, wherever that was.
        let way = i as f64 / shear as f64 * (reach - 0.001);
        rows.push(sheared(2, reach - way, 1.0 - way / 0.004));
    }
    rows.iter_mut().enumerate().for_each(|(i, row)| row.step = i + 1);
    rows
}

fn scout(rows: &[StepRecord], elements: usize, case: &Case) -> Scout {
    let units = Units::of(case);
    let scaled = |row: &StepRecord| {
        let force = units.force();
        let in_mesh = |x: f64, y: f64| units.orientation.to_mesh([x, y]);
        let [f_t, f_t_y] = in_mesh(row.f_t, row.f_t_y).map(|value| value / force);
        let [delta_t, delta_t_y] = in_mesh(row.delta_t, row.delta_t_y);
        // With a radius of 1 a stiffness has the unit of a force.
        let k_t = row.k_t.map(|k_t| k_t / force);
        Scaled(StepRecord { f_n: row.f_n / force, f_t, f_t_y, delta_t, delta_t_y, k_t, ..*row })
    };
    Scout { rows: rows.iter().map(scaled).collect(), spacing: 0.2 / elements as f64, elements, ..Scout::default() }
}

const PATH: &str = "{indentation=0.02}, {shear=\"full-slip\"}, {shear=0.001}";

#[test]
fn an_error_of_first_order_is_taken_out_of_the_tangential_force() {
    let case = case(PATH);
    for (n, m) in [(16, 8), (5, 2)] {
        // The ends of full slip differ; half as many steps.
        let (mut rows, coarse) = (run(n as f64, 26, 20, 0.0025), run(m as f64, 13, 10, 0.0027));
        let limits = Limits::new(&case, &scout(&coarse, m, &case), 0.2 / n as f64).expect("limits");
        limits.write_into(&mut rows);
        let exact = run(f64::INFINITY, 26, 20, 0.0025);
        for (row, exact) in rows.iter().zip(&exact) {
            let [limit, error] = [row.f_t_limit, row.f_t_error].map(|value| value.expect("a value"));
            let f_n_limit = row.f_n_limit.expect("a limit");
            let wanted = exact.f_t / exact.f_n * f_n_limit;
            assert!((limit - wanted).abs() < 0.2, "{n}: {limit} instead of {wanted} in {row:?}");
            assert!((row.f_t - exact.f_t).abs() <= error + 1e-12, "{n}: {error} in {row:?}");
            // A press is not extrapolated, nor is what a shear has of the same difference.
            let added = if row.segment == 0 { 0.0 } else { 0.2 * 150.0 * NORMAL / n as f64 };
            assert!((f_n_limit - row.f_n).abs() <= added + 1e-9, "{n}: {f_n_limit} in {row:?}");
            let [off, error] = [(row.f_n - exact.f_n).abs(), row.f_n_error.expect("an error")];
            assert!(error > 0.5 * off && error < 2.0 * 150.0 * NORMAL / n as f64, "{n}: {error} for {off} in {row:?}");
        }
        // Most of what the run lacks is gone.
        let worst = |of: &dyn Fn(&StepRecord) -> f64| {
            let apart = |(row, exact): (&StepRecord, &StepRecord)| (of(row) - exact.f_t / exact.f_n).abs();
            rows.iter().zip(&exact).map(apart).fold(0.0, f64::max)
        };
        let limit = |row: &StepRecord| row.f_t_limit.zip(row.f_n_limit).map_or(f64::NAN, |(f_t, f_n)| f_t / f_n);
        let [raw, limit] = [worst(&|row| row.f_t / row.f_n), worst(&limit)];
        assert!(limit < 0.3 * raw, "{n}: {limit} of {raw}");
    }
}

/// Where the two runs agree, half a per cent of mu F_N is told from the first shear on; of F_T
/// where nothing slips.
#[test]
fn what_the_runs_do_not_show_of_the_tangential_force_is_told() {
    for stuck in [false, true] {
        let mut case = case(PATH);
        if stuck {
            case.contact.friction = Friction::Stick;
        }
        let mut rows = run(16.0, 26, 20, 0.0025);
        Limits::new(&case, &scout(&rows, 8, &case), 0.2 / 16.0).expect("limits").write_into(&mut rows);
        for row in &rows {
            let scale = if stuck { row.f_t } else { MU * row.f_n };
            let told = if row.segment == 0 { 0.0 } else { 0.005 * scale };
            assert!((row.f_t_error.expect("an error") - told).abs() < 1e-6, "{told} for {row:?}");
        }
    }
}

#[test]
fn rows_one_by_one_have_the_bits_of_all_at_once() {
    let case = case(PATH);
    let (mut rows, coarse) = (run(16.0, 26, 20, 0.0025), run(8.0, 13, 10, 0.0027));
    let limits = Limits::new(&case, &scout(&coarse, 8, &case), 0.2 / 16.0).expect("limits");
    let before = rows.clone();
    limits.write_into(&mut rows);
    for (i, row) in before.iter().enumerate() {
        let (units, mut scaled) = (Units::of(&case), Scaled(StepRecord::default()));
        limits.of(&rows[..i], row).put_into(&mut scaled, &units);
        let StepRecord { f_t_limit, f_n_limit, f_t_error, f_n_error, .. } = scaled.in_units(&units);
        assert_eq!(StepRecord { f_t_limit, f_n_limit, f_t_error, f_n_error, ..*row }, rows[i]);
    }
    // Where a run stops early, its rows have what those of the whole one have.
    let mut part = before[..30].to_vec();
    limits.write_into(&mut part);
    assert_eq!(part, rows[..30]);
}

#[test]
fn displacements_of_slip_have_the_errors_of_their_curve() {
    let mut case = case(PATH);
    // All of it is reached.
    case.contact.friction = Friction::Coefficient(0.25);
    let inputs = SummaryInputs::of(&case);
    let found = |rows: &[StepRecord]| {
        let summary = Summary::from_history(rows, &inputs);
        [summary.delta_t_90, summary.delta_t_95, summary.delta_t_slip].map(|value| value.expect("a displacement"))
    };
    let (rows, coarse) = (run(16.0, 26, 40, 0.0025), run(8.0, 13, 20, 0.0027));
    let limits = Limits::new(&case, &scout(&coarse, 8, &case), 0.2 / 16.0).expect("limits");
    let estimate = ErrorEstimate::new(&rows, &inputs.oblique, &limits);
    let exact = found(&run(f64::INFINITY, 26, 40, 0.0025));
    for ((here, exact), error) in found(&rows).into_iter().zip(exact).zip(estimate.delta_t) {
        let (off, error) = ((here - exact).abs(), error.expect("an error"));
        assert!(off <= error && error < 5.0 * off, "{here} instead of {exact}, said to be off by {error}");
    }
    // That of the curve at the limit lacks what is of second order.
    for ((here, exact), limit) in found(&rows).into_iter().zip(exact).zip(estimate.delta_t_limit) {
        let (off, left) = ((here - exact).abs(), (limit.expect("a limit") - exact).abs());
        assert!(left < 0.2 * off, "{limit:?} instead of {exact}, and {here} without the limit");
    }
    // Where the companion did not slip there is nothing to compare with.
    let short = Limits::new(&case, &scout(&run(8.0, 13, 20, 0.0008), 8, &case), 0.2 / 16.0).expect("limits");
    let short = ErrorEstimate::new(&rows, &inputs.oblique, &short);
    assert_eq!((short.delta_t, short.delta_t_limit), ([None; 3], [None; 2]));
}

#[test]
fn a_shear_in_another_direction_has_its_limits_along_it() {
    let (cosine, sine) = (0.6, 0.8);
    let along_x = (run(16.0, 26, 20, 0.0025), run(8.0, 13, 10, 0.0027));
    let turned = |rows: &[StepRecord]| -> Vec<StepRecord> {
        let turn = |row: &StepRecord| StepRecord {
            delta_t: cosine * row.delta_t,
            delta_t_y: sine * row.delta_t,
            f_t: cosine * row.f_t,
            f_t_y: sine * row.f_t,
            ..*row
        };
        rows.iter().map(turn).collect()
    };
    let path = "{indentation=0.02}, {shear=0.0025}, {shear=-0.0025}";
    let other = "{indentation=0.02}, {shear=[0.0015, 0.002]}, {shear=[-0.0015, -0.002]}";
    let limits = |case: &Case, coarse: &[StepRecord]| Limits::new(case, &scout(coarse, 8, case), 0.2 / 16.0).expect("limits");
    let (mut first, mut second) = (case(path), case(other));
    // All of it is reached.
    for case in [&mut first, &mut second] {
        case.contact.friction = Friction::Coefficient(0.25);
    }
    let (first, second) = (limits(&first, &along_x.1), limits(&second, &turned(&along_x.1)));
    let (rows, others) = (along_x.0.clone(), turned(&along_x.0));
    let mut compared = 0;
    for i in (0..rows.len()).filter(|&i| rows[i].segment < 2) {
        let (one, other) = (first.of(&rows[..i], &rows[i]), second.of(&others[..i], &others[i]));
        // A share of the segment here, a length there: the companion is interpolated alike in both.
        let (Some(along), Some(x), Some(y)) = (one.f_t_limit, other.f_t_limit, other.f_t_y_limit) else { continue };
        compared += 1;
        let errors = [(one.f_t_error, other.f_t_error), (one.f_n_error, other.f_n_error)];
        for (one, other) in errors.map(|(one, other)| (one.expect("an error"), other.expect("an error"))) {
            assert!((one - other).abs() < 1e-9 * one + 1e-12, "row {i}: {other} for {one}");
        }
        assert!((x - cosine * along).abs() < 1e-9 * along.abs() + 1e-12, "row {i}: {x} of {along}");
        assert!((y - sine * along).abs() < 1e-9 * along.abs() + 1e-12, "row {i}: {y} of {along}");
        assert!((one.f_n_limit.unwrap() - other.f_n_limit.unwrap()).abs() < 1e-9 * one.f_n_limit.unwrap());
    }
    assert!(compared > 30, "{compared} rows compared");
    let sheared = |rows: &[StepRecord]| rows.iter().copied().filter(|row| row.segment < 2).collect::<Vec<_>>();
    let [one, other] =
        [(&first, sheared(&rows)), (&second, sheared(&others))].map(|(limits, rows)| ErrorEstimate::new(&rows, &[], limits));
    let pairs = [(one.f_t_max, other.f_t_max), (one.f_t_max_limit, other.f_t_max_limit)];
    let pairs = pairs.into_iter().chain(one.delta_t.into_iter().zip(other.delta_t));
    for (one, other) in pairs.chain(one.delta_t_limit.into_iter().zip(other.delta_t_limit)) {
        assert_eq!(one.is_some(), other.is_some());
        assert!(one.zip(other).is_none_or(|(one, other)| (one - other).abs() < 1e-9 * one), "{other:?} for {one:?}");
    }
    assert!(one.f_t_max_limit.is_some());
    assert_eq!(within([0.3, 0.0], 0.2), [0.2, 0.0]);
    let [x, y] = within([0.3, -0.4], 0.25);
    assert!((x - 0.15).abs() < 1e-15 && (y + 0.2).abs() < 1e-15);
}

#[test]
fn the_tangent_of_a_shear_has_an_error() {
    let case = case(PATH);
    let stiff = |mut rows: Vec<StepRecord>, n: f64| {
        rows.iter_mut().filter(|row| row.segment == 1).take(1).for_each(|row| row.k_t = Some(4e4 * (1.0 + 0.8 / n)));
        rows
    };
    let (rows, coarse) = (stiff(run(16.0, 26, 20, 0.0025), 16.0), stiff(run(8.0, 13, 10, 0.0027), 8.0));
    let limits = Limits::new(&case, &scout(&coarse, 8, &case), 0.2 / 16.0).expect("limits");
    let error = ErrorEstimate::new(&rows, &[], &limits).k_t0.expect("an error");
    assert!((error - TANGENTIAL_SHARE * 4e4 * 0.8 / 16.0).abs() < 1e-6, "{error}");
}

#[test]
fn nothing_is_said_where_there_is_nothing_to_compare_with() {
    let case = case(PATH);
    let (mut rows, coarse) = (run(16.0, 26, 20, 0.006), run(8.0, 13, 10, 0.0027));
    let mut companion = scout(&coarse, 8, &case);
    let limits = Limits::new(&case, &companion, 0.2 / 16.0).expect("limits");
    limits.write_into(&mut rows);
    // The companion has not been everywhere where F_T may have its largest limit.
    let estimate = ErrorEstimate::new(&rows, &[], &limits);
    assert!(estimate.f_n0.is_some() && estimate.a0.is_some());
    assert!(estimate.f_t_max.is_some() && estimate.f_t_max_limit.is_none());
    let compared = run(16.0, 26, 20, 0.0025);
    let estimate = ErrorEstimate::new(&compared, &[], &limits);
    let largest = compared.iter().map(|row| row.f_t).fold(0.0, f64::max);
    assert!(estimate.f_t_max_limit.is_some_and(|limit| limit < largest && limit > 0.9 * largest), "{estimate:?} of {largest}");
    // On a mesh that is almost as coarse as the companion's.
    let mut coarser = limits.clone();
    coarser.meshed(0.9 * 0.2 / 8.0);
    assert_eq!(coarser.of(&compared[..9], &compared[9]).f_n_limit, None);
    coarser.meshed(0.2 / 16.0);
    assert_eq!(coarser, limits);
    // The companion's last step to full slip is 0.00035 long.
    for row in rows.iter().filter(|row| row.segment == 1) {
        assert_eq!(row.f_t_limit.is_some(), row.delta_t < 0.00305, "{row:?}");
        assert_eq!(row.f_n_error.is_some(), row.f_t_error.is_some());
    }
    rows[0].forget_limits();
    assert_eq!((rows[0].f_t_limit, rows[0].f_n_error), (None, None));
    companion.failure = Some("no convergence".to_owned());
    assert!(Limits::new(&case, &companion, 0.2 / 16.0).is_none());
}

#[test]
fn a_companion_that_slips_fully_slides_on() {
    let case = case(PATH);
    // Full slip is at 0.002, where the companion ends soon.
    let sliding = |mut rows: Vec<StepRecord>| {
        for row in rows.iter_mut().filter(|row| row.segment == 1) {
            row.f_t = MU * row.f_n * (1.0 - (1.0 - (row.delta_t / 0.002).min(1.0)).powf(1.5));
        }
        rows
    };
    let (mut rows, coarse) = (sliding(run(16.0, 26, 20, 0.006)), sliding(run(8.0, 13, 10, 0.0021)));
    Limits::new(&case, &scout(&coarse, 8, &case), 0.2 / 16.0).expect("limits").write_into(&mut rows);
    for row in rows.iter().filter(|row| row.segment == 1) {
        let [f_t, f_n] = [row.f_t_limit, row.f_n_limit].map(|limit| limit.expect("a limit"));
        let slides = row.delta_t > 0.0021;
        assert!(!slides || (f_t / f_n - MU).abs() < 1e-9, "{row:?}");
    }
}

#[test]
fn no_limit_is_beyond_coulombs() {
    let case = case(PATH);
    let mut rows = run(16.0, 26, 20, 0.0025);
    let mut coarse = run(8.0, 13, 10, 0.0027);
    rows.iter_mut().for_each(|row| row.f_t = if row.segment > 0 { MU * row.f_n } else { 0.0 });
    coarse.iter_mut().for_each(|row| row.f_t *= 0.5);
    Limits::new(&case, &scout(&coarse, 8, &case), 0.2 / 16.0).expect("limits").write_into(&mut rows);
    for row in &rows {
        let [f_t, f_n] = [row.f_t_limit, row.f_n_limit].map(|limit| limit.expect("a limit"));
        assert!(f_t <= MU * f_n * (1.0 + 1e-12), "{row:?}");
        assert!(row.f_t_error.expect("an error") >= 0.0);
    }
}

#[test]
fn a_release_is_compared_by_the_way_back_and_beyond_its_end_with_nothing() {
    let case = case("{indentation=0.02}, {release=true}");
    let released = |recovery: f64, steps: usize| {
        let mut rows = run(16.0, 26, 0, 0.0);
        for i in 1..=steps {
            let share = 1.0 - i as f64 / steps as f64;
            rows.push(StepRecord {
                step: 26 + i,
                segment: 1,
                h: 0.02 - recovery * (1.0 - share),
                f_n: 150.0 * share,
                ..rows[25]
            });
        }
        rows
    };
    let (mut rows, coarse) = (released(0.0022, 23), released(0.002, 10));
    Limits::new(&case, &scout(&coarse, 8, &case), 0.2 / 16.0).expect("limits").write_into(&mut rows);
    for row in rows.iter().filter(|row| row.segment == 1) {
        assert!(row.f_n_error.is_some_and(|error| error < 15.0), "{row:?}");
        assert_eq!(row.f_t_limit.is_some(), row.f_n == 0.0 || row.h > 0.018 + 1e-9, "{row:?}");
        assert!(row.f_n_limit.is_some_and(|limit| (limit - row.f_n).abs() < 1e-9), "{row:?}");
    }
}

#[test]
fn what_a_shear_adds_to_the_difference_of_the_normal_force_is_extrapolated() {
    let case = case(PATH);
    // Ripples of opposite sign in the press; in the shear F_N lacks more and more.
    let with = |mut rows: Vec<StepRecord>, n: f64, sign: f64| {
        for row in &mut rows {
            let sheared = if row.segment == 0 { 0.0 } else { 400.0 / n * (row.delta_t / 0.0025).min(1.0) };
            let ripple = if row.segment == 0 { sign * 0.2 * (300.0 * row.h).sin() } else { 0.0 };
            (row.f_n, row.f_t) = (7500.0 * row.h + ripple - sheared, row.f_t * 0.5);
        }
        rows
    };
    let mut rows = with(run(16.0, 26, 20, 0.0025), 16.0, 1.0);
    let coarse = with(run(8.0, 13, 10, 0.0025), 8.0, -1.0);
    Limits::new(&case, &scout(&coarse, 8, &case), 0.2 / 16.0).expect("limits").write_into(&mut rows);
    for row in &rows {
        let limit = row.f_n_limit.expect("a limit");
        if row.segment == 0 {
            assert!((limit - row.f_n).abs() < 1e-9, "{limit} in {row:?}");
        } else if row.segment == 1 {
            // All but the ripple's own size.
            assert!((-1e-6..0.5).contains(&(150.0 - limit)) || row.delta_t < 2e-4, "{limit} in {row:?}");
        }
    }
}
