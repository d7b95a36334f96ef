// Finite-strain J2 plasticity at one point: the twin of crates/kernels/src/material/j2.rs, where
// the formulas and their sources are.

// The answer of a point to one increment.
struct Response {
    stress: Sym,            // deviatoric Kirchhoff stress
    state: PointState,      // after the increment
    status: u32,            // STATUS_..., the rest is meaningless from STATUS_INVERTED on
    mu_bar: real,
    norm: real,
    normal: Sym,
    beta_1: real,
    beta_3: real,
    beta_4: real,
    delta_gamma: real,
    plastic_work: real,
}

struct Deviator {
    tensor: Sym,
    mean: real,
}

// det(I + d) - 1. Matrices are columns: d[k][i] is d u_i/d x_k.
fn determinant_minus_one(d: mat3x3<real>) -> real {
    let a = d[0].x; let b = d[1].x; let c = d[2].x;
    let e = d[0].y; let f = d[1].y; let g = d[2].y;
    let h = d[0].z; let i = d[1].z; let j = d[2].z;
    let minors = (a * f - b * e) + (f * j - g * i) + (a * j - c * h);
    return a + f + j + minors + a * (f * j - g * i) - b * (e * j - g * h) + c * (e * i - f * h);
}

// J^(-2/3) - 1 from J - 1 > -1, by Halley's iteration on q (3 + q (3 + q)) = J - 1.
fn isochoric_factor_minus_one(j_minus_1: real) -> real {
    let j = j_minus_1;
    let jacobian = 1.0 + j;
    var q = j / (3.0 + j);
    var tolerance: real = 3e-3;
    if REAL_EPSILON < 1e-10 {
        tolerance = 3e-6;
    }
    for (var i = 0i; i < 40i; i++) {
        let root = 1.0 + q;
        let cube = root * root * root;
        let step = root * (j - q * (3.0 + q * (3.0 + q))) / (cube + cube + jacobian);
        q += step;
        if abs(step) <= tolerance * abs(q) {
            break;
        }
    }
    let root = 1.0 + q;
    return -(q * (1.0 + root)) / (root * root);
}

// The deviator of a symmetric tensor, and its mean.
fn deviator(a: Sym) -> Deviator {
    let mean = (a.diagonal.x + a.diagonal.y + a.diagonal.z) * (1.0 / 3.0);
    return Deviator(sym_add_identity(a, -mean), mean);
}

// a : a
fn norm_squared(a: Sym) -> real {
    return sym_dot(a, a);
}

// a . a
fn square(a: Sym) -> Sym {
    let d = a.diagonal;
    let s = a.shear;
    return Sym(
        vec3<real>(d.x * d.x + s.x * s.x + s.z * s.z, s.x * s.x + d.y * d.y + s.y * s.y, s.z * s.z + s.y * s.y + d.z * d.z),
        vec3<real>(d.x * s.x + s.x * d.y + s.z * s.y, s.x * s.z + d.y * s.y + s.y * d.z, d.x * s.z + s.x * s.y + s.z * d.z),
    );
}

// W = mu/2 (tr b_e_bar - 3) from b_e_bar - I.
fn elastic_energy_deviatoric(e: Elasticity, be: Sym) -> real {
    let d = deviator(be);
    return 1.5 * e.shear * isochoric_mean(d.tensor, d.mean);
}

// u = t - 1 where t is the largest root of det(D + t I) = 1, by Newton's iteration from a guess at
// or above it.
fn isochoric_mean(d: Sym, guess: real) -> real {
    let p = 0.5 * norm_squared(d);
    let determinant_d = sym_determinant(d);
    let tolerance = SQRT_EPSILON * 0.0625;
    var u = guess;
    for (var i = 0i; i < 60i; i++) {
        let t = 1.0 + u;
        let step = (u * (3.0 + u * (3.0 + u)) - p * t + determinant_d) / (3.0 * t * t - p);
        u -= step;
        if !(abs(step) > tolerance * abs(u)) {
            break;
        }
    }
    return u;
}

// b_e_bar_trial - I from d = f - I and B = b_e_bar - I.
fn trial(d: mat3x3<real>, be: Sym, r: real) -> Sym {
    let b = sym_matrix(be);
    let g = d + (b + d * b);
    let m = g + transpose(d) + g * transpose(d);
    let scale = 1.0 + r;
    return Sym(
        vec3<real>(m[0].x, m[1].y, m[2].z) * scale + vec3<real>(r),
        vec3<real>(m[1].x, m[2].y, m[0].z) * scale,
    );
}

// The deviatoric Kirchhoff stress and the new state after the relative deformation f = I +
// relative.
fn return_mapping(material: Material, relative: mat3x3<real>, state: PointState) -> Response {
    var response: Response;
    let j = determinant_minus_one(relative);
    if !(1.0 + j > 0.0) {
        response.status = STATUS_NOT_FINITE;
        if 1.0 + j <= 0.0 {
            response.status = STATUS_INVERTED;
        }
        return response;
    }
    let mu = material.elasticity.shear;
    let be = trial(relative, state.be, isochoric_factor_minus_one(j));
    let d = deviator(be);
    let strain_norm = sqrt(norm_squared(d.tensor));
    let norm = mu * strain_norm;
    let mu_bar = mu * (1.0 + d.mean);
    if !(is_finite(norm) && mu_bar > 0.0) {
        response.status = STATUS_NOT_FINITE;
        return response;
    }
    var inverse: real = 0.0;
    if strain_norm > 0.0 {
        inverse = 1.0 / strain_norm;
    }
    response.stress = sym_scale(mu, d.tensor);
    response.state = PointState(be, state.alpha);
    response.status = STATUS_ELASTIC;
    response.mu_bar = mu_bar;
    response.norm = norm;
    response.normal = sym_scale(inverse, d.tensor);
    let h = material.hardening;
    let flow = flow_stress(h, state.alpha);
    let von_mises = 1.224744871391589 * norm;
    if von_mises <= flow * (1.0 + 8.0 * REAL_EPSILON) {
        return response;
    }

    let stiffness = 3.0 * mu_bar;
    let step = plastic_strain_increment(h, state.alpha, flow, von_mises, stiffness);
    let keep = step.flow_stress / von_mises;
    let alpha = state.alpha + step.increment;
    if !is_finite(alpha) {
        response.status = STATUS_NOT_FINITE;
        return response;
    }
    let kept = sym_scale(keep, d.tensor);
    let mean = isochoric_mean(kept, d.mean);
    response.stress = sym_scale(mu, kept);
    response.state = PointState(sym_add_identity(kept, mean), alpha);
    response.status = STATUS_YIELDING;
    response.delta_gamma = 1.224744871391589 * step.increment;
    response.plastic_work = max(plastic_work(h, alpha, step.flow_stress) - plastic_work(h, state.alpha, flow), real(0.0));
    let inverse_beta_0 = stiffness / (stiffness + step.slope);
    let ratio = norm / mu_bar;
    response.beta_1 = (von_mises - step.flow_stress) / von_mises;
    let beta_2 = (1.0 - inverse_beta_0) * (2.0 / 3.0) * ratio * response.delta_gamma;
    response.beta_3 = inverse_beta_0 - response.beta_1 + beta_2;
    response.beta_4 = (inverse_beta_0 - response.beta_1) * ratio;
    return response;
}

// The spatial moduli in the form that they are applied in: modulus (I - 1/3 1 (x) 1) + n (x) x + x
// (x) n.
struct DeviatoricTangent {
    modulus: real,
    normal: Sym,
    x: Sym,
}

// The symmetrised moduli of the deviatoric Kirchhoff stress (Box 9.2).
fn deviatoric_tangent(response: Response) -> DeviatoricTangent {
    let n = response.normal;
    let elastic = 1.0 - response.beta_1;
    let modulus = elastic * (response.mu_bar + response.mu_bar);
    let coupling = elastic * (2.0 / 3.0) * response.norm;
    var x = Sym(vec3<real>(-coupling), vec3<real>());
    if response.status == STATUS_YIELDING {
        let squared = deviator(square(n)).tensor;
        let third = response.mu_bar * response.beta_3;
        let fourth = response.mu_bar * response.beta_4;
        x.diagonal = x.diagonal - third * n.diagonal - fourth * squared.diagonal;
        x.shear = x.shear - third * n.shear - fourth * squared.shear;
    }
    return DeviatoricTangent(modulus, n, x);
}

// Component ab of c, a and b counting xx, yy, zz, xy, yz, zx: no factors in it (the identity has
// 1/2 at [3][3]).
fn deviatoric_tangent_component(c: DeviatoricTangent, a: u32, b: u32) -> real {
    var entry = sym_component(c.normal, a) * sym_component(c.x, b) + sym_component(c.x, a) * sym_component(c.normal, b);
    if a < 3u && b < 3u {
        entry -= c.modulus * (1.0 / 3.0);
    }
    if a == b {
        if a < 3u {
            entry += c.modulus;
        } else {
            entry += 0.5 * c.modulus;
        }
    }
    return entry;
}
