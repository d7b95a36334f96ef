// Plastic flow to second order in the step (BDF2): the twin of
// crates/kernels/src/material/multistep.rs, which has the derivation.

// What flowed at a point in its last step: what dev b_e_bar lost to it, and the increment of alpha.
struct Flow {
    strain: Sym,
    alpha: real,
}

// The state from which a step starts: weight times the last flow is anticipated.
fn anticipate(committed: PointState, flow: Flow, weight: real) -> PointState {
    if !(weight * flow.alpha > 0.0) {
        return committed;
    }
    let d = deviator(committed.be);
    let start = Sym(
        d.tensor.diagonal - weight * flow.strain.diagonal,
        d.tensor.shear - weight * flow.strain.shear,
    );
    let mean = isochoric_mean(start, d.mean);
    return PointState(sym_add_identity(start, mean), committed.alpha + weight * flow.alpha);
}

struct Completed {
    response: Response,
    flow: Flow,
}

// The response to commit and what flowed, after a step whose response was found from start.
fn complete(
    material: Material,
    relative: mat3x3<real>,
    committed: PointState,
    start: PointState,
    found: Response,
) -> Completed {
    let anticipated = start.alpha > committed.alpha;
    let kept = anticipated && found.status == STATUS_YIELDING;
    var response = found;
    if anticipated && !kept {
        response = return_mapping(material, relative, committed);
    }
    let length = response.beta_1 * response.norm / material.elasticity.shear;
    var flow = Flow(sym_scale(length, response.normal), response.state.alpha - committed.alpha);
    if kept {
        let lost = Sym(committed.be.diagonal - start.be.diagonal, committed.be.shear - start.be.shear);
        let pushed = push_forward(relative, lost);
        flow.strain = Sym(flow.strain.diagonal + pushed.diagonal, flow.strain.shear + pushed.shear);
        flow.alpha = min(flow.alpha, sqrt(norm_squared(flow.strain)) * 0.4082482904638630);
        response.state.alpha = committed.alpha + flow.alpha;
        let h = material.hardening;
        let end = response.state.alpha;
        let done = plastic_work(h, end, flow_stress(h, end));
        response.plastic_work = max(done - plastic_work(h, committed.alpha, flow_stress(h, committed.alpha)), real(0.0));
    }
    if response.status == STATUS_YIELDING {
        response.plastic_work *= dissipated(response.state.be);
    }
    return Completed(response, flow);
}

// What flow dissipates over the flow stress times the increment of alpha.
fn dissipated(be: Sym) -> real {
    let d = deviator(be);
    let square = norm_squared(d.tensor);
    if !(square > 0.0) {
        return 1.0;
    }
    let m = 1.0 + d.mean;
    return (m * m - 3.0 * m * (sym_determinant(d.tensor) / square)) / (m * m - square * (1.0 / 6.0));
}

// The deviator of J^(-2/3) f a f^T with f = I + d.
fn push_forward(d: mat3x3<real>, a: Sym) -> Sym {
    let m = sym_matrix(a);
    let fa = m + d * m;
    let scale = 1.0 + isochoric_factor_minus_one(determinant_minus_one(d));
    let pushed = fa + fa * transpose(d);
    return deviator(Sym(
        scale * vec3<real>(pushed[0].x, pushed[1].y, pushed[2].z),
        scale * vec3<real>(pushed[1].x, pushed[2].y, pushed[0].z),
    )).tensor;
}
