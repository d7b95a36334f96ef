// fine += P coarse, but nothing at fixed unknowns.

@group(0) @binding(7) var<storage, read> is_fixed: array<u32>;      // [slot][node]: a bit a component

@compute @workgroup_size(192)
fn prolong_add(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let slot = records[group.y].running;
    let node = NODES_IN_GROUP * group.x + local % NODES_IN_GROUP;
    if records[slot].done != RUNNING || node >= level.nodes {
        return;
    }
    let component = local / NODES_IN_GROUP;
    if (is_fixed[slot * level.nodes + node] >> component) % 2u == 0u {
        let at = (3u * slot + component) * level.nodes + node;
        to[at] += weighted(node, (3u * slot + component) * level.coarse_nodes);
    }
}
