// Energies of the body from those of its elements: a workgroup a slot.

// [slot][elastic, plastic, largest alpha][element]
@group(0) @binding(5) var<storage, read> energies: array<real>;
@group(0) @binding(6) var<storage, read_write> totals: array<real>;     // [slot][elastic, plastic, largest alpha]

@compute @workgroup_size(256)
fn iterate_energies(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let slot = group.y;
    if slot >= dimensions.in_dispatch {
        return;
    }
    let elements = dimensions.elements;
    let first = 3u * slot * elements;
    var elastic: real = 0.0;
    var plastic: real = 0.0;
    var alpha: real = 0.0;
    for (var e = local; e < elements; e += THREADS) {
        elastic += energies[first + e];
        plastic += energies[first + elements + e];
        alpha = max(alpha, energies[first + 2u * elements + e]);
    }
    elastic = add_up(local, elastic);
    plastic = add_up(local, plastic);
    alpha = largest_of(local, alpha);
    if local == 0u {
        totals[3u * slot] = elastic;
        totals[3u * slot + 1u] = plastic;
        totals[3u * slot + 2u] = alpha;
    }
}
