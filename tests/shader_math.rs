//! The elementary functions of `shaders/math.wgsl` on the device against the CPU's, over their
//! whole range.

// `!(error <= bound)` is true for a NaN, which is what it is written for.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

mod device;

use asperity::internals::compute::gpu::shader_sources::MATH;
use asperity::internals::compute::gpu::source::ShaderSource;
use asperity::internals::compute::gpu::{DeviceReal, GpuContext, Kernel};
use device::device;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const FUNCTIONS: [&str; 4] = ["exp_", "expm1_", "log_", "pow_"];

static TABULATE: Kernel = Kernel::new(
    "tabulate",
    &[
        MATH,
        ShaderSource {
            path: "tests/shader_math.rs",
            text: "
@group(0) @binding(0) var<storage, read> arguments: array<real>;
@group(0) @binding(1) var<storage, read_write> values: array<real>;
@compute @workgroup_size(64)
fn tabulate(@builtin(global_invocation_id) id: vec3<u32>) {
    let count = arrayLength(&arguments) / 2u;
    if id.x >= count {
        return;
    }
    let x = arguments[2u * id.x];
    let y = arguments[2u * id.x + 1u];
    switch id.y {
        case 0u: { values[id.y * count + id.x] = exp_(x); }
        case 1u: { values[id.y * count + id.x] = expm1_(x); }
        case 2u: { values[id.y * count + id.x] = log_(x); }
        default: { values[id.y * count + id.x] = pow_(x, y); }
    }
}
",
        },
    ],
);

/// All functions at every (x, y): values[function][argument].
fn tabulate<R: DeviceReal>(context: &GpuContext, arguments: &[[R; 2]]) -> Vec<Vec<R>> {
    let flat: Vec<R> = arguments.iter().flatten().copied().collect();
    let input = context.array("arguments", &flat).unwrap();
    let output = context.zeros::<R>("values", FUNCTIONS.len() * arguments.len()).unwrap();
    let arguments_of = [output.named("values"), input.named("arguments")];
    let bound = context.bind(&TABULATE, R::PRECISION, &arguments_of).unwrap();
    let mut list = context.record();
    list.dispatch(&bound, arguments.len(), FUNCTIONS.len()).unwrap();
    list.submit().unwrap();
    context.download(&output).unwrap().chunks(arguments.len()).map(<[R]>::to_vec).collect()
}

/// What the function should give, computed in f64 (whose own error is below one ulp) from the
/// rounded arguments.
fn reference(function: usize, x: f64, y: f64) -> f64 {
    match function {
        0 => x.exp(),
        1 => x.exp_m1(),
        2 => x.ln(),
        _ => x.powf(y),
    }
}

/// Largest relative error of one function over arguments from `draw`; results outside the normal
/// range are left out.
fn worst<R: DeviceReal>(
    context: &GpuContext,
    function: usize,
    count: usize,
    mut draw: impl FnMut(&mut ChaCha8Rng) -> [f64; 2],
) -> (f64, [f64; 2]) {
    let mut rng = ChaCha8Rng::seed_from_u64(17 + function as u64);
    let arguments: Vec<[R; 2]> = (0..count).map(|_| draw(&mut rng).map(R::of)).collect();
    let values = &tabulate(context, &arguments)[function];
    let mut worst = (0.0, [0.0; 2]);
    let mut seen = 0;
    for (argument, value) in arguments.iter().zip(values) {
        let [x, y] = argument.map(R::to_f64);
        let expected = reference(function, x, y);
        if expected.abs() < 4.0 * R::MIN_POSITIVE.to_f64() || !R::of(expected).is_finite() {
            continue;
        }
        seen += 1;
        let error = ((value.to_f64() - expected) / expected).abs();
        if !(error <= worst.0) {
            worst = (error, [x, y]);
        }
    }
    assert!(seen > count / 2, "only {seen} of {count} arguments of {} count", FUNCTIONS[function]);
    worst
}

/// One range of arguments: function, name, bound in units of epsilon, how to draw.
type Range = (usize, &'static str, f64, fn(&mut ChaCha8Rng, f64) -> [f64; 2]);

/// `scale` is the largest exponent of two of the precision.
const RANGES: [Range; 13] = [
    (0, "whole range", 2.0, |rng, scale| [rng.random_range(-0.69 * scale..0.69 * scale), 0.0]),
    (0, "near 0", 2.0, |rng, _| [signed(rng, -12.0, 0.0), 0.0]),
    (1, "whole range", 2.0, |rng, scale| [rng.random_range(-0.69 * scale..0.69 * scale), 0.0]),
    (1, "one", 2.0, |rng, _| [rng.random_range(-2.0..2.0), 0.0]),
    (1, "near 0", 2.0, |rng, _| [signed(rng, -30.0, 0.0), 0.0]),
    (2, "whole range", 2.0, |rng, scale| [rng.random_range(-0.99 * scale..0.99 * scale).exp2(), 0.0]),
    (2, "near 1", 2.0, |rng, _| [1.0 + signed(rng, -6.0, -0.3), 0.0]),
    (2, "one", 2.0, |rng, _| [rng.random_range(0.4..2.5), 0.0]),
    (3, "hardening", 2.5, |rng, _| [10f64.powf(rng.random_range(-20.0..1.0)), rng.random_range(0.0..1.0)]),
    (3, "negative", 2.5, |rng, _| [10f64.powf(rng.random_range(-20.0..1.0)), rng.random_range(-1.0..0.0)]),
    (3, "whole range", 2.5, |rng, scale| [rng.random_range(-0.9 * scale..0.9 * scale).exp2(), rng.random_range(-1.0..1.0)]),
    (3, "powers to 10", 6.0, |rng, _| [rng.random_range(0.1..3.0), rng.random_range(1.0..10.0)]),
    (3, "powers to 60", 30.0, |rng, _| [rng.random_range(0.5..2.0), rng.random_range(-60.0..60.0)]),
];

fn signed(rng: &mut ChaCha8Rng, low: f64, high: f64) -> f64 {
    let size = 10f64.powf(rng.random_range(low..high));
    if rng.random::<bool>() { size } else { -size }
}

fn errors_are_a_few_ulp<R: DeviceReal>(scale: f64) {
    let Some(context) = device("shader_math", R::PRECISION) else { return };
    let mut failed = Vec::new();
    for (function, range, bound, draw) in RANGES {
        let (error, at) = worst::<R>(&context, function, 40_000, |rng| draw(rng, scale));
        let epsilons = error / R::EPSILON.to_f64();
        println!("{:7} {range:14} {} {error:.2e} = {epsilons:.2} epsilon at {at:?}", FUNCTIONS[function], R::NAME);
        if !(epsilons <= bound) {
            failed.push(format!("{} {range}: {epsilons:.2} > {bound} epsilon at {at:?}", FUNCTIONS[function]));
        }
    }
    assert!(failed.is_empty(), "{}:\n{}", R::NAME, failed.join("\n"));
}

#[test]
fn errors_are_a_few_ulp_in_f64() {
    errors_are_a_few_ulp::<f64>(1024.0);
}

#[test]
fn errors_are_a_few_ulp_in_f32() {
    errors_are_a_few_ulp::<f32>(128.0);
}

fn ends_are_right<R: DeviceReal>() {
    let Some(context) = device("shader_math ends", R::PRECISION) else { return };
    let (inf, nan, big) = (f64::INFINITY, f64::NAN, 1e4);
    // function, x, y, value
    let cases = [
        (0, 0.0, 0.0, 1.0),
        (0, big, 0.0, inf),
        (0, -big, 0.0, 0.0),
        (0, inf, 0.0, inf),
        (0, -inf, 0.0, 0.0),
        (0, nan, 0.0, nan),
        (1, 0.0, 0.0, 0.0),
        (1, big, 0.0, inf),
        (1, -big, 0.0, -1.0),
        (1, nan, 0.0, nan),
        (2, 1.0, 0.0, 0.0),
        (2, 0.0, 0.0, -inf),
        (2, -1.0, 0.0, nan),
        (2, inf, 0.0, inf),
        (2, nan, 0.0, nan),
        (3, 0.0, 0.5, 0.0),
        (3, 0.0, 0.0, 1.0),
        (3, 0.0, -0.5, inf),
        (3, 2.0, 0.0, 1.0),
        (3, 2.0, 10.0, 1024.0),
        (3, 0.25, -0.5, 2.0),
        (3, -1.0, 0.5, nan),
        (3, 10.0, 1e4, inf),
        (3, 10.0, -1e4, 0.0),
        (3, nan, 0.5, nan),
        (3, 2.0, nan, nan),
    ];
    let arguments: Vec<[R; 2]> = cases.iter().map(|c| [R::of(c.1), R::of(c.2)]).collect();
    let values = tabulate(&context, &arguments);
    for (i, (function, x, y, expected)) in cases.into_iter().enumerate() {
        let value = values[function][i].to_f64();
        let same = value == expected || (value.is_nan() && expected.is_nan());
        assert!(same, "{}({x}, {y}) in {} is {value}, not {expected}", FUNCTIONS[function], R::NAME);
    }
}

#[test]
fn ends_are_right_in_f64() {
    ends_are_right::<f64>();
}

#[test]
fn ends_are_right_in_f32() {
    ends_are_right::<f32>();
}
