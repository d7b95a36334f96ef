// The norm of the vector whose square the partial sums hold as product 0.

@group(0) @binding(2) var<storage, read> partial_sums: array<real>;     // [slot][vector][chunk]

fn norm_of_sums(slot: u32) -> real {
    var square: real = 0.0;
    for (var c = 0u; c < chunks(); c++) {
        square += partial_sums[partial_place(slot, 0u) + c];
    }
    return sqrt(square);
}
