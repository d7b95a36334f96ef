// A quadrature point at a trial displacement: kinematics and the material's response.

// [slot]: smallest 32 element + 16 (refused by the material) + 2 point + 1 (not finite) of what has no
// answer; all ones if there is none.
@group(0) @binding(6) var<storage, read_write> first_invalid: array<atomic<u32>>;

const REFUSED_BY_KINEMATICS: u32 = 0u;
const REFUSED_BY_MATERIAL: u32 = 16u;

struct Kinematics {
    relative: mat3x3<real>,     // f - I, f = F F_n^-1
    natural: mat3x3<real>,      // of the natural coordinates with respect to the present position
    j_minus_1: real,            // det F - 1
    theta_minus_1: real,        // mean dilatation - 1
    total_volume: real,
}

struct PointAnswer {
    valid: bool,
    k: Kinematics,
    response: Response,
}

// Mean dilatation less 1, and the volume of the element.
fn mean_dilatation(slot: u32, geometry: u32, element: u32) -> vec2<real> {
    var change: real = 0.0;
    var total: real = 0.0;
    for (var q = 0u; q < 8u; q++) {
        let point = 8u * element + q;
        let v = point_volume(geometry, point);
        change += v * jacobian_of(slot, point);
        total += v;
    }
    return vec2<real>(change / total, total);
}

fn load_state(case_index: u32, point: u32) -> PointState {
    let points = point_count();
    let s = case_index * dimensions.start_numbers + 3u * dimensions.nodes + point;
    let be = Sym(
        vec3<real>(starts[s], starts[s + points], starts[s + 2u * points]),
        vec3<real>(starts[s + 3u * points], starts[s + 4u * points], starts[s + 5u * points]),
    );
    return PointState(be, starts[s + 6u * points]);
}

fn refuse(at: Place, by: u32, is_not_finite: bool) {
    atomicMin(&first_invalid[at.slot], 32u * at.element + by + 2u * (at.point % 8u) + u32(is_not_finite));
}

// What the point answers to the trial displacement; where it has no answer, the slot is told.
fn evaluate_point(at: Place, material: Material) -> PointAnswer {
    var answer: PointAnswer;
    let j = jacobian_of(at.slot, at.point);
    if !(j > -1.0) || !is_finite(j) {
        refuse(at, REFUSED_BY_KINEMATICS, !is_finite(j));
        return answer;
    }
    let g = displacement_gradients(at);
    let f_n_inverse = invert(identity_plus(g.committed));
    let h = mat3x3<real>(
        g.committed[0] + g.increment[0],
        g.committed[1] + g.increment[1],
        g.committed[2] + g.increment[2],
    );
    answer.k.relative = g.increment * f_n_inverse;
    answer.k.natural = g.natural * invert(identity_plus(h));
    answer.k.j_minus_1 = j;
    let theta = mean_dilatation(at.slot, at.geometry, at.element);
    answer.k.theta_minus_1 = theta.x;
    answer.k.total_volume = theta.y;
    answer.response = return_mapping(material, answer.k.relative, load_state(at.case_index, at.point));
    if answer.response.status >= STATUS_INVERTED {
        refuse(at, REFUSED_BY_MATERIAL, answer.response.status == STATUS_NOT_FINITE);
        return answer;
    }
    answer.valid = true;
    return answer;
}

// The Kirchhoff stress of an answer: the deviatoric one of the point and the pressure of the
// element, as J p.
fn kirchhoff_stress(a: PointAnswer, p: real) -> Sym {
    return sym_add_identity(a.response.stress, p * (1.0 + a.k.j_minus_1));
}
