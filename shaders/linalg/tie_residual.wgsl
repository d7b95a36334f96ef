// r = b - A y, nothing at fixed unknowns.

@group(0) @binding(7) var<storage, read> b: array<real>;            // [slot][component][node]
@group(0) @binding(8) var<storage, read_write> r: array<real>;      // [slot][component][node]

@compute @workgroup_size(192)
fn tie_residual(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let slot = records[group.y].running;
    let node = NODES_IN_GROUP * group.x + local % NODES_IN_GROUP;
    if records[slot].done != RUNNING || node >= level.nodes {
        return;
    }
    let component = local / NODES_IN_GROUP;
    let at = (3u * slot + component) * level.nodes + node;
    let is_free = (is_fixed[slot * level.nodes + node] >> component) % 2u == 0u;
    r[at] = select(real(0.0), b[at] - met(slot, component, node), is_free);
}
