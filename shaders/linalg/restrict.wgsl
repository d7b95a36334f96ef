// coarse = P^T fine.

@compute @workgroup_size(192)
fn restrict_residual(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let slot = records[group.y].running;
    let node = NODES_IN_GROUP * group.x + local % NODES_IN_GROUP;
    if records[slot].done != RUNNING || node >= level.coarse_nodes {
        return;
    }
    let component = 3u * slot + local / NODES_IN_GROUP;
    to[component * level.coarse_nodes + node] = weighted(node, component * level.nodes);
}
