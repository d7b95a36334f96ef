// Internal forces: a thread a node gathers from the points of the elements around it, in the order
// of the mesh's list, with the derivatives of the node as each of them names it. One writer and one
// order for each sum: no atomics, the same bits in every run.

@group(0) @binding(8) var<storage, read> node_start: array<u32>;        // starts of the nodes' lists
@group(0) @binding(9) var<storage, read> node_entry: array<u32>;        // 8 element + corner; see HAS_HANGING
@group(0) @binding(10) var<storage, read> stress: array<real>;          // [slot][3 k + i][point]
@group(0) @binding(11) var<storage, read_write> force: array<real>;     // [slot][3 node + i]

// Of an entry whose element has corners that hang.
const HAS_HANGING: u32 = 0x80000000u;

@compute @workgroup_size(64)
fn gather_node_force(@builtin(global_invocation_id) id: vec3<u32>) {
    if is_outside(id, dimensions.nodes) {
        return;
    }
    let node = id.x;
    let slot = id.y;
    let points = point_count();
    var sum = vec3<real>();
    for (var e = node_start[node]; e < node_start[node + 1u]; e++) {
        let entry = node_entry[e] & ~HAS_HANGING;
        let element = entry / 8u;
        var hanging = 0u;
        if node_entry[e] != entry {
            hanging = hanging_of(element);
        }
        var of_element = vec3<real>();
        for (var q = 0u; q < 8u; q++) {
            let point = 8u * element + q;
            let n = named_derivative(hanging, entry % 8u, q);
            let at = STRESS * slot * points + point;
            of_element += n.x * vec3<real>(stress[at], stress[at + points], stress[at + 2u * points]);
            of_element += n.y * vec3<real>(stress[at + 3u * points], stress[at + 4u * points], stress[at + 5u * points]);
            of_element += n.z * vec3<real>(stress[at + 6u * points], stress[at + 7u * points], stress[at + 8u * points]);
        }
        sum += of_element;
    }
    let out = 3u * (slot * dimensions.nodes + node);
    force[out] = sum.x;
    force[out + 1u] = sum.y;
    force[out + 2u] = sum.z;
}
