// w = A y, nothing at fixed unknowns; y is kept for the solution.

@group(0) @binding(7) var<storage, read_write> w: array<real>;              // [slot][component][node]
@group(0) @binding(8) var<storage, read_write> preconditioned: array<real>; // [slot][step][component][node]

@compute @workgroup_size(192)
fn tie_meet(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let slot = records[group.y].running;
    let node = NODES_IN_GROUP * group.x + local % NODES_IN_GROUP;
    if records[slot].done != RUNNING || node >= level.nodes {
        return;
    }
    let component = local / NODES_IN_GROUP;
    let of_case = component * level.nodes + node;
    let n = 3u * level.nodes;
    let is_free = (is_fixed[slot * level.nodes + node] >> component) % 2u == 0u;
    w[slot * n + of_case] = select(real(0.0), met(slot, component, node), is_free);
    preconditioned[(slot * level.restart + records[slot].steps) * n + of_case] = y[slot * n + of_case];
}
