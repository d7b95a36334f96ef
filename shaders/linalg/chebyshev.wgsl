// One step of Chebyshev acceleration of block Jacobi: residual, D^-1 and update in one go.

@group(0) @binding(4) var<storage, read> inverse: array<real>;      // see diagonal.wgsl
@group(0) @binding(5) var<storage, read> b: array<real>;            // [slot][component][node]
@group(0) @binding(6) var<storage, read_write> last_step: array<real>;   // [slot][component][node]
@group(0) @binding(7) var<storage, read_write> next: array<real>;   // [slot][component][node]
@group(0) @binding(8) var<uniform> recurrence: vec2<real>;          // shares of the last step and of D^-1 r
@group(0) @binding(9) var<storage, read> records: array<Record>;

var<workgroup> residuals: array<real, ROWS_IN_GROUP>;

@compute @workgroup_size(192)
fn smooth_step(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let slot = records[group.y].running;
    if records[slot].done != RUNNING {
        return;
    }
    let node = NODES_IN_GROUP * group.x + local % NODES_IN_GROUP;
    let component = local / NODES_IN_GROUP;
    let at = (3u * slot + component) * level.nodes + node;
    if node < level.nodes {
        residuals[local] = b[at] - rounded_row_times(slot, component, node);
    }
    workgroupBarrier();
    if node < level.nodes {
        var change = recurrence.y * inverse_times(slot, component, node, local % NODES_IN_GROUP);
        if recurrence.x > 0.0 {
            change += recurrence.x * last_step[at];
        }
        last_step[at] = change;
        next[at] = x[at] + change;
    }
}

// A component of the inverse of a node's diagonal block times its residual.
fn inverse_times(slot: u32, component: u32, node: u32, in_group: u32) -> real {
    let first = (18u * slot + 3u * component) * level.nodes + node;
    return inverse[first] * residuals[in_group]
        + inverse[first + level.nodes] * residuals[in_group + NODES_IN_GROUP]
        + inverse[first + 2u * level.nodes] * residuals[in_group + 2u * NODES_IN_GROUP];
}
