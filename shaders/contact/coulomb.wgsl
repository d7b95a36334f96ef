// Unilateral contact with Coulomb friction: the twin of crates/kernels/src/contact/coulomb.rs,
// where the conditions and their source are.

const OPEN: u32 = 0u;
const STICK: u32 = 1u;
const SLIP: u32 = 2u;

// The coefficient that stands for "never slips".
const FULL_STICK: real = -1.0;

// The bit that a contact point on the symmetry plane has beside the number of its node.
const ON_SYMMETRY_PLANE: u32 = 0x80000000u;

struct ContactPoint {
    force: vec3<real>,
    gap: real,
    slip: vec2<real>,
    weight: real,
    on_symmetry_plane: bool,
}

// Residual and its linearisation, row by row.
struct Rows {
    status: u32,
    fixed: vec3<bool>,
    residual: vec3<real>,
    force_rows: array<vec3<real>, 3>,
    displacement_rows: array<vec3<real>, 3>,
}

fn contact_rows(friction: real, point: ContactPoint) -> Rows {
    let c = point.weight;
    let f = point.force;
    var rows: Rows;
    rows.status = OPEN;
    rows.residual = f;
    rows.force_rows[0] = vec3<real>(1.0, 0.0, 0.0);
    rows.force_rows[1] = vec3<real>(0.0, 1.0, 0.0);
    rows.force_rows[2] = vec3<real>(0.0, 0.0, 1.0);
    if point.on_symmetry_plane {
        fix_y(&rows, c * point.slip.y);
    }
    if f.z - c * point.gap <= 0.0 {
        return rows;
    }
    rows.fixed.z = true;
    rows.residual.z = c * point.gap;
    rows.force_rows[2] = vec3<real>();
    rows.displacement_rows[2] = vec3<real>(0.0, 0.0, 1.0);
    var xi = vec2<real>(f.x - c * point.slip.x, f.y - c * point.slip.y);
    if point.on_symmetry_plane {
        xi.y = 0.0;
    }
    let norm = sqrt(xi.x * xi.x + xi.y * xi.y);
    let normal_force = max(f.z, real(0.0));
    if friction == FULL_STICK || (friction > 0.0 && norm <= friction * normal_force) {
        rows.status = STICK;
        rows.fixed.x = true;
        rows.residual.x = c * point.slip.x;
        rows.force_rows[0] = vec3<real>();
        rows.displacement_rows[0] = vec3<real>(1.0, 0.0, 0.0);
        fix_y(&rows, c * point.slip.y);
        return rows;
    }
    rows.status = SLIP;
    let bound = friction * normal_force;
    if !(norm > 0.0) || !(bound > 0.0) {
        return rows;
    }
    let n = vec2<real>(xi.x / norm, xi.y / norm);
    let ratio = bound / norm;
    let x = vec2<real>(ratio * (1.0 - n.x * n.x), ratio * (-n.x * n.y));
    rows.residual.x = f.x - bound * n.x;
    rows.force_rows[0] = vec3<real>(1.0 - x.x, -x.y, -(friction * n.x));
    rows.displacement_rows[0] = vec3<real>(c * x.x, c * x.y, 0.0);
    if !point.on_symmetry_plane {
        let y = vec2<real>(ratio * (-n.y * n.x), ratio * (1.0 - n.y * n.y));
        rows.residual.y = f.y - bound * n.y;
        rows.force_rows[1] = vec3<real>(-y.x, 1.0 - y.y, -(friction * n.y));
        rows.displacement_rows[1] = vec3<real>(c * y.x, c * y.y, 0.0);
    }
    return rows;
}

// Makes the row of y prescribe its displacement.
fn fix_y(rows: ptr<function, Rows>, residual: real) {
    (*rows).fixed.y = true;
    (*rows).residual.y = residual;
    (*rows).force_rows[1] = vec3<real>();
    (*rows).displacement_rows[1] = vec3<real>(0.0, 1.0, 0.0);
}
