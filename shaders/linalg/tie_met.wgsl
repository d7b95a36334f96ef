// The conditions of contact in the place of forces, at unknowns y.

@group(0) @binding(1) var<storage, read> point_of: array<u32>;      // [node]: its contact point
@group(0) @binding(2) var<storage, read> is_fixed: array<u32>;      // [slot][node]: a bit a component
@group(0) @binding(3) var<storage, read> records: array<Record>;
@group(0) @binding(4) var<storage, read> force: array<real>;        // [slot][component][node]
@group(0) @binding(5) var<storage, read> y: array<real>;            // [slot][component][node]
// As in assemble.wgsl, bits of f32; before the rows of a slave that touches is a number below 0.
@group(0) @binding(6) var<storage, read> rows: array<u32>;
@group(0) @binding(9) var<uniform> counts: vec4<u32>;               // as in assemble.wgsl

const NOWHERE: u32 = 0xffffffffu;
const POINT_ROWS: u32 = 28u;

// What is at an unknown: the force, or at a slave that touches what its condition makes of it.
fn met(slot: u32, component: u32, node: u32) -> real {
    let at = 3u * slot * level.nodes + node;
    let point = point_of[node];
    if point == NOWHERE {
        return force[at + component * level.nodes];
    }
    let first = POINT_ROWS * slot * counts.y + point;
    if !(real_of_single(rows[first]) < 0.0) {
        return force[at + component * level.nodes];
    }
    var sum: real = 0.0;
    for (var j = 0u; j < 3u; j++) {
        let of_force = real_of_single(rows[first + (1u + 3u * component + j) * counts.y]);
        let of_displacement = real_of_single(rows[first + (10u + 3u * component + j) * counts.y]);
        sum += of_force * force[at + j * level.nodes] + of_displacement * y[at + j * level.nodes];
    }
    return sum;
}
