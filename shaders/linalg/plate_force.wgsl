// What the plate's normal force changes by along the answer: the sum of the rows of its nodes; one
// workgroup a slot.

@group(0) @binding(4) var<storage, read> plate: array<u32>;             // its nodes
@group(0) @binding(5) var<storage, read_write> records: array<Record>;

@compute @workgroup_size(256)
fn plate_force(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    var sum: real = 0.0;
    for (var i = local; i < level.plate_nodes; i += THREADS) {
        sum += row_times(group.y, 2u, plate[i]);
    }
    let force = add_up(local, sum);
    if local == 0u {
        records[group.y].along = force;
    }
}
