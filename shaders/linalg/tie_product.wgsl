// f = K x, all of it.

@group(0) @binding(4) var<storage, read> records: array<Record>;
@group(0) @binding(5) var<storage, read_write> f: array<real>;      // [slot][component][node]

@compute @workgroup_size(192)
fn tie_product(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let slot = records[group.y].running;
    let node = NODES_IN_GROUP * group.x + local % NODES_IN_GROUP;
    if records[slot].done != RUNNING || node >= level.nodes {
        return;
    }
    let component = local / NODES_IN_GROUP;
    f[(3u * slot + component) * level.nodes + node] = row_times(slot, component, node);
}
