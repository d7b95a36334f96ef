// The return mapping at every point of every active case: a thread a point. Arrays are
// [case][component][point].

struct PointDimensions {
    cases: u32,          // in the arrays
    in_dispatch: u32,    // cases in this dispatch
    points: u32,         // of a case
    reserved: u32,
}

@group(0) @binding(0) var<uniform> dimensions: PointDimensions;
@group(0) @binding(1) var<storage, read> active_cases: array<u32>;
@group(0) @binding(2) var<storage, read> relative_gradient: array<real>;    // 9: f - I, row by row
@group(0) @binding(3) var<storage, read> committed: array<real>;            // 7: b_e_bar - I, alpha
@group(0) @binding(4) var<storage, read_write> answer: array<real>;         // 30, as Answer in src/compute/gpu/material.rs
@group(0) @binding(5) var<storage, read_write> tangent: array<real>;        // 36: c_ab at 6 a + b
@group(0) @binding(6) var<storage, read_write> point_status: array<u32>;

// Numbers of a point in these.
const RELATIVE: u32 = 9u;
const ANSWER: u32 = 30u;
const TANGENT: u32 = 36u;

// Index of component 0 of a point in an array of `components`; the next component is `points`
// further.
fn first_component(case_index: u32, components: u32, point: u32) -> u32 {
    return case_index * components * dimensions.points + point;
}

fn store(at: u32, value: real) -> u32 {
    answer[at] = value;
    return at + dimensions.points;
}

fn store_sym(at: u32, a: Sym) -> u32 {
    var next = at;
    for (var k = 0u; k < 6u; k++) {
        next = store(next, sym_component(a, k));
    }
    return next;
}

@compute @workgroup_size(64)
fn return_mapping_points(@builtin(global_invocation_id) id: vec3<u32>) {
    let point = id.x;
    if point >= dimensions.points || id.y >= dimensions.in_dispatch {
        return;
    }
    let case_index = active_cases[id.y];
    let points = dimensions.points;
    let material = load_material(case_index, dimensions.cases);

    let g = first_component(case_index, RELATIVE, point);
    var relative: mat3x3<real>;
    for (var k = 0u; k < 3u; k++) {
        relative[k] = vec3<real>(
            relative_gradient[g + k * points],
            relative_gradient[g + (3u + k) * points],
            relative_gradient[g + (6u + k) * points],
        );
    }
    let s = first_component(case_index, STATE, point);
    let be = Sym(
        vec3<real>(committed[s], committed[s + points], committed[s + 2u * points]),
        vec3<real>(committed[s + 3u * points], committed[s + 4u * points], committed[s + 5u * points]),
    );
    let r = return_mapping(material, relative, PointState(be, committed[s + 6u * points]));

    point_status[case_index * points + point] = r.status;
    if r.status >= STATUS_INVERTED {
        return;
    }
    let j = determinant_minus_one(relative);
    var at = first_component(case_index, ANSWER, point);
    at = store_sym(at, r.stress);
    at = store_sym(at, r.state.be);
    at = store(at, r.state.alpha);
    at = store(at, r.mu_bar);
    at = store(at, r.norm);
    at = store_sym(at, r.normal);
    at = store(at, r.beta_1);
    at = store(at, r.beta_3);
    at = store(at, r.beta_4);
    at = store(at, r.delta_gamma);
    at = store(at, r.plastic_work);
    let p = pressure(material.elasticity, j);
    at = store(at, p.x);
    at = store(at, p.y);
    at = store(at, elastic_energy_volumetric(material.elasticity, j));
    at = store(at, elastic_energy_deviatoric(material.elasticity, r.state.be));

    let c = deviatoric_tangent(r);
    let t = first_component(case_index, TANGENT, point);
    for (var ab = 0u; ab < 36u; ab++) {
        tangent[t + ab * points] = deviatoric_tangent_component(c, ab / 6u, ab % 6u);
    }
}
