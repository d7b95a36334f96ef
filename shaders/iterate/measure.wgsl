// The sums over a trial's nodes that its merit is made of, a thread a node: partial sums by
// workgroup, in a fixed order.

@group(0) @binding(9) var<storage, read> correction: array<real>;           // [case][3 node + i]
// [geometry]: of a displacement that is missing
@group(0) @binding(10) var<storage, read> plate_weight: array<real>;
@group(0) @binding(11) var<storage, read_write> partial_sums: array<real>;  // [slot][PARTS][workgroup]

@compute @workgroup_size(256)
fn iterate_measure(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let slot = group.y;
    if slot >= dimensions.in_dispatch {
        return;
    }
    let node = THREADS * group.x + local;
    var square: real = 0.0;
    var work: real = 0.0;
    var work_before: real = 0.0;
    var largest: real = 0.0;
    if node < dimensions.nodes {
        let now = node_residual(slot, marks[slot].x, node, number(slot, DEPTH));
        let then = node_residual(slot, marks[slot].y, node, trial_depth(slot));
        let case_index = active_cases[slot].x;
        let of_case = (case_index * dimensions.nodes + node) * 3u;
        let along = vec3<real>(correction[of_case], correction[of_case + 1u], correction[of_case + 2u]);
        let moved = contracted(case_index, marks[slot].x, node_info[node], along);
        for (var i = 0u; i < 3u; i++) {
            var r = then.residual[i];
            if ((then.prescribed >> i) & 1u) != 0u {
                r *= plate_weight[active_cases[slot].y];
            }
            square += r * r;
            largest = max(largest, abs(then.rhs[i]));
            if ((now.fixed >> i) & 1u) == 0u {
                work_before += now.residual[i] * moved[i];
                work += then.residual[i] * moved[i];
            }
        }
    }
    let groups = (dimensions.nodes + THREADS - 1u) / THREADS;
    let out = PARTS * slot * groups + group.x;
    let square_sum = add_up(local, square);
    let work_sum = add_up(local, work);
    let before_sum = add_up(local, work_before);
    let most = largest_of(local, largest);
    if local == 0u {
        partial_sums[out] = square_sum;
        partial_sums[out + groups] = work_sum;
        partial_sums[out + 2u * groups] = before_sum;
        partial_sums[out + 3u * groups] = most;
    }
}
