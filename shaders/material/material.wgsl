// The volumetric half of the material and its parameters: the twin of
// crates/kernels/src/material/mod.rs.

// Why a point has no answer, or what it did. The numbers are those of src/compute/gpu/material.rs.
const STATUS_ELASTIC: u32 = 0u;
const STATUS_YIELDING: u32 = 1u;
const STATUS_INVERTED: u32 = 2u;
const STATUS_NOT_FINITE: u32 = 3u;

struct Elasticity {
    bulk: real,
    shear: real,
}

// What a point remembers between accepted steps.
struct PointState {
    be: Sym,
    alpha: real,
}

// Numbers of a PointState, with those of its last Flow (multistep.wgsl) behind them, and with its
// energies (update.wgsl) behind these.
const STATE: u32 = 7u;
const HISTORY: u32 = 14u;
const NEXT_HISTORY: u32 = 16u;

struct Material {
    elasticity: Elasticity,
    hardening: Hardening,
}

const PARAMETERS: u32 = 9u;

fn load_material(index: u32, count: u32) -> Material {
    var p: array<real, PARAMETERS>;
    for (var i = 0u; i < PARAMETERS; i++) {
        p[i] = materials[i * count + index];
    }
    let hardening = Hardening(u32(p[2]), p[3], p[4], p[5], p[6], u32(p[7]), u32(p[8]));
    return Material(Elasticity(p[0], p[1]), hardening);
}

// U'(J) and U''(J) from J - 1.
fn pressure(e: Elasticity, j_minus_1: real) -> vec2<real> {
    let half = 0.5 * e.bulk;
    let inverse = 1.0 / (1.0 + j_minus_1);
    return vec2<real>(half * j_minus_1 * (2.0 + j_minus_1) * inverse, half * (1.0 + inverse * inverse));
}

// U(J) from J - 1.
fn elastic_energy_volumetric(e: Elasticity, j_minus_1: real) -> real {
    let j = j_minus_1;
    var bracket: real;
    if abs(j) < 0.2 {
        let z = j / (2.0 + j);
        let z2 = z * z;
        var sum: real = 0.0;
        for (var k = 9u; k >= 1u; k--) {
            sum = z2 * (sum + 1.0 / real(2u * k + 1u));
        }
        bracket = 0.5 * j * j + z * (j - 2.0 * sum);
    } else {
        bracket = j + 0.5 * j * j - log_(1.0 + j);
    }
    return 0.5 * e.bulk * bracket;
}
