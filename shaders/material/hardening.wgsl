// Isotropic hardening: the twin of crates/kernels/src/material/hardening.rs,
// where the laws, the equation and its convex forms are described.

const ELASTIC: u32 = 0u;
const IDEAL: u32 = 1u;
const LINEAR: u32 = 2u;
const POWER: u32 = 3u;
const HOLLOMON: u32 = 4u;
const VOCE: u32 = 5u;
const TABLE: u32 = 6u;

// One law with its parameters; what a law has not is 0.
struct Hardening {
    law: u32,
    yield_stress: real,      // all but elastic
    coefficient: real,       // linear: modulus, power: K, hollomon: sigma_0, voce: sigma_sat
    exponent: real,          // power: n <= 1, hollomon: m, voce: rate
    youngs_modulus: real,    // hollomon
    first: u32,              // table: place of its first point in materials
    points: u32,             // table: number of points
}

// The end of a plastic step.
struct PlasticStep {
    increment: real,
    flow_stress: real,
    slope: real,
}

// Parameter p of material m at p * (their number) + m, in the order of load_material, whole numbers
// as reals; then alpha, sigma and the plastic work up to there, point after point, of all tables.
@group(0) @binding(7) var<storage, read> materials: array<real>;

// sigma(alpha); REAL_MAX for the elastic law.
fn flow_stress(h: Hardening, alpha: real) -> real {
    switch h.law {
        case ELASTIC: {
            return REAL_MAX;
        }
        case LINEAR: {
            return h.yield_stress + h.coefficient * alpha;
        }
        case POWER: {
            return h.yield_stress + h.coefficient * pow_(alpha, h.exponent);
        }
        case HOLLOMON: {
            return hollomon_flow_stress(h, alpha);
        }
        case VOCE: {
            return h.yield_stress - (h.coefficient - h.yield_stress) * expm1_(-(h.exponent * alpha));
        }
        case TABLE: {
            let i = segment(h, alpha);
            return table_stress(h, i) + table_slope(h, i) * (alpha - table_alpha(h, i));
        }
        default: {
            return h.yield_stress;
        }
    }
}

// d sigma/d alpha, given sigma(alpha).
fn slope(h: Hardening, alpha: real, flow_stress: real) -> real {
    switch h.law {
        case LINEAR: {
            return h.coefficient;
        }
        case POWER: {
            return h.coefficient * h.exponent * pow_(alpha, h.exponent - 1.0);
        }
        case HOLLOMON: {
            return hollomon_slope(h, alpha, flow_stress);
        }
        case VOCE: {
            return h.exponent * (h.coefficient - flow_stress);
        }
        case TABLE: {
            return table_slope(h, segment(h, alpha));
        }
        default: {
            return real(0.0);
        }
    }
}

// The integral of sigma d alpha from 0 to alpha, given sigma(alpha).
fn plastic_work(h: Hardening, alpha: real, flow_stress: real) -> real {
    switch h.law {
        case ELASTIC: {
            return real(0.0);
        }
        case LINEAR: {
            return 0.5 * (h.yield_stress + flow_stress) * alpha;
        }
        case POWER: {
            return (h.yield_stress + (flow_stress - h.yield_stress) / (1.0 + h.exponent)) * alpha;
        }
        case HOLLOMON: {
            let share = h.exponent / (h.exponent + 1.0);
            let rise = (flow_stress - h.yield_stress) * (flow_stress + h.yield_stress) / h.youngs_modulus;
            return share * flow_stress * alpha + (share - 0.5) * rise;
        }
        case VOCE: {
            return h.coefficient * alpha - (flow_stress - h.yield_stress) / h.exponent;
        }
        case TABLE: {
            let i = segment(h, alpha);
            return table_work(h, i) + 0.5 * (table_stress(h, i) + flow_stress) * (alpha - table_alpha(h, i));
        }
        default: {
            return h.yield_stress * alpha;
        }
    }
}

// Solves trial - sigma(alpha + da) - stiffness da = 0 for da, trial above flow_stress =
// sigma(alpha).
fn plastic_strain_increment(h: Hardening, alpha: real, flow_stress: real, trial: real, stiffness: real) -> PlasticStep {
    let excess = trial - flow_stress;
    switch h.law {
        case ELASTIC: {
            return PlasticStep(0.0, flow_stress, 0.0);
        }
        case LINEAR: {
            let increment = excess / (stiffness + h.coefficient);
            return PlasticStep(increment, flow_stress + h.coefficient * increment, h.coefficient);
        }
        case POWER: {
            return power_step(h, alpha, flow_stress, trial, stiffness);
        }
        case HOLLOMON: {
            return hollomon_step(h, alpha, flow_stress, trial, stiffness);
        }
        case VOCE: {
            return voce_step(h, flow_stress, trial, stiffness);
        }
        case TABLE: {
            return table_step(h, alpha, flow_stress, trial, stiffness);
        }
        default: {
            return PlasticStep(excess / stiffness, h.yield_stress, 0.0);
        }
    }
}

// WGSL has no closures: the increasing functions whose roots are sought, by number.
const POWER_STEP: u32 = 0u;         // power law, in u = alpha^n
const HOLLOMON_STRAIN: u32 = 1u;    // Hollomon's flow stress, in the total strain
const HOLLOMON_STRESS: u32 = 2u;    // Hollomon's step, in the stress
const VOCE_INCREMENT: u32 = 3u;     // Voce's step, in the increment

struct Equation {
    kind: u32,
    stiffness: real,
    load: real,     // power: load, Hollomon's step: trial, Voce: excess
    other: real,    // power: 1/n, Hollomon: alpha, Voce: what is left to saturation
}

// Value and derivative of the equation at x.
fn equation(h: Hardening, e: Equation, x: real) -> vec2<real> {
    switch e.kind {
        case POWER_STEP: {
            let strain = pow_(x, e.other);
            let derivative = h.coefficient + e.stiffness * e.other * strain / x;
            return vec2<real>(h.coefficient * x + e.stiffness * strain - e.load, derivative);
        }
        case HOLLOMON_STRAIN: {
            let inverse = 1.0 / h.exponent;
            let ratio = h.coefficient * pow_(x, inverse) / h.youngs_modulus;
            return vec2<real>(x - ratio - e.other, 1.0 - inverse * ratio / x);
        }
        case HOLLOMON_STRESS: {
            let strain = pow_(x / h.coefficient, h.exponent);
            let value = x - e.load + e.stiffness * (strain - x / h.youngs_modulus - e.other);
            return vec2<real>(value, 1.0 + e.stiffness * (h.exponent * strain / x - 1.0 / h.youngs_modulus));
        }
        default: {
            let decay = expm1_(-(h.exponent * x));
            let value = e.stiffness * x - e.other * decay - e.load;
            return vec2<real>(value, e.stiffness + h.exponent * e.other * (decay + 1.0));
        }
    }
}

// The root of an increasing function in [low, high]: Newton's iteration inside a shrinking bracket.
fn increasing_root(h: Hardening, e: Equation, lower: real, upper: real, start: real) -> real {
    let tolerance = SQRT_EPSILON * 0.0625;
    var low = lower;
    var high = upper;
    var x = start;
    for (var i = 0i; i < 120i; i++) {
        let f = equation(h, e, x);
        if f.x > 0.0 {
            high = x;
        } else {
            low = x;
        }
        let next = x - f.x / f.y;
        if next >= low && next <= high {
            if abs(next - x) <= tolerance * abs(next) {
                return next;
            }
            x = next;
        } else {
            let middle = 0.5 * (low + high);
            if abs(high - low) <= REAL_EPSILON * abs(middle) || !(middle > low && middle < high) {
                return middle;
            }
            x = middle;
        }
    }
    return x;
}

fn power_step(h: Hardening, alpha: real, flow_stress: real, trial: real, stiffness: real) -> PlasticStep {
    if h.coefficient <= 0.0 {
        return PlasticStep((trial - flow_stress) / stiffness, flow_stress, 0.0);
    }
    let load = trial - h.yield_stress + stiffness * alpha;
    let inverse = 1.0 / h.exponent;
    let low = (flow_stress - h.yield_stress) / h.coefficient;
    let high = max(min(load / h.coefficient, pow_(load / stiffness, h.exponent)), low);
    let u = increasing_root(h, Equation(POWER_STEP, stiffness, load, inverse), low, high, high);
    let strain = pow_(u, inverse);
    let stress = h.yield_stress + h.coefficient * u;
    let slope = h.coefficient * h.exponent * u / strain;
    var increment = strain - alpha;
    if slope <= stiffness {
        increment = (trial - stress) / stiffness;
    }
    return PlasticStep(max(increment, real(0.0)), stress, slope);
}

fn hollomon_flow_stress(h: Hardening, alpha: real) -> real {
    if !(alpha > 0.0) {
        return h.yield_stress;
    }
    let inverse = 1.0 / h.exponent;
    let yield_strain = h.yield_stress / h.youngs_modulus;
    let low = alpha + yield_strain;
    let high = yield_strain + alpha / (1.0 - inverse);
    let strain = increasing_root(h, Equation(HOLLOMON_STRAIN, 0.0, 0.0, alpha), low, high, low);
    return h.coefficient * pow_(strain, inverse);
}

fn hollomon_slope(h: Hardening, alpha: real, flow_stress: real) -> real {
    return 1.0 / (h.exponent * alpha / flow_stress + (h.exponent - 1.0) / h.youngs_modulus);
}

fn hollomon_step(h: Hardening, alpha: real, flow_stress: real, trial: real, stiffness: real) -> PlasticStep {
    let strain_at_most = alpha + (trial - flow_stress) / stiffness + trial / h.youngs_modulus;
    let high = max(min(trial, h.coefficient * pow_(strain_at_most, 1.0 / h.exponent)), flow_stress);
    let stress = increasing_root(h, Equation(HOLLOMON_STRESS, stiffness, trial, alpha), flow_stress, high, high);
    let increment = max((trial - stress) / stiffness, real(0.0));
    return PlasticStep(increment, stress, hollomon_slope(h, alpha + increment, stress));
}

fn voce_step(h: Hardening, flow_stress: real, trial: real, stiffness: real) -> PlasticStep {
    let excess = trial - flow_stress;
    let rest = h.coefficient - flow_stress;
    let low = max((trial - h.coefficient) / stiffness, real(0.0));
    let high = excess / stiffness;
    let start = min(max(low, excess / (stiffness + h.exponent * rest)), high);
    let increment = increasing_root(h, Equation(VOCE_INCREMENT, stiffness, excess, rest), min(low, high), high, start);
    let stress = flow_stress - rest * expm1_(-(h.exponent * increment));
    return PlasticStep(increment, stress, h.exponent * (h.coefficient - stress));
}

fn table_alpha(h: Hardening, i: u32) -> real {
    return materials[h.first + 3u * i];
}

fn table_stress(h: Hardening, i: u32) -> real {
    return materials[h.first + 3u * i + 1u];
}

fn table_work(h: Hardening, i: u32) -> real {
    return materials[h.first + 3u * i + 2u];
}

// The last point at or below alpha.
fn segment(h: Hardening, alpha: real) -> u32 {
    var i = 0u;
    while i + 1u < h.points && table_alpha(h, i + 1u) <= alpha {
        i += 1u;
    }
    return i;
}

// The slope to the right of point i; 0 beyond the last.
fn table_slope(h: Hardening, i: u32) -> real {
    if i + 1u >= h.points {
        return real(0.0);
    }
    return (table_stress(h, i + 1u) - table_stress(h, i)) / (table_alpha(h, i + 1u) - table_alpha(h, i));
}

// Marches over the segments, each solved exactly.
fn table_step(h: Hardening, alpha: real, flow_stress: real, trial: real, stiffness: real) -> PlasticStep {
    var i = segment(h, alpha);
    var done: real = 0.0;
    var stress = flow_stress;
    loop {
        let slope = table_slope(h, i);
        let increment = max((trial - stress - stiffness * done) / (stiffness + slope), real(0.0));
        if i + 1u >= h.points || alpha + done + increment < table_alpha(h, i + 1u) {
            return PlasticStep(done + increment, stress + slope * increment, slope);
        }
        i += 1u;
        done = table_alpha(h, i) - alpha;
        stress = table_stress(h, i);
    }
    return PlasticStep(0.0, 0.0, 0.0);
}
