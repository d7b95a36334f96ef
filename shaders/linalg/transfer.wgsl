// To the next level and back: a scalar sparse matrix by rows, on each component alike.

// Where each row begins, and, row by row, columns with their weights, which are bits of f32.
@group(0) @binding(1) var<storage, read> transfer: array<u32>;
@group(0) @binding(4) var<storage, read> given: array<real>;        // [slot][component][node]
@group(0) @binding(5) var<storage, read_write> to: array<real>;     // [slot][component][node]
@group(0) @binding(6) var<storage, read> records: array<Record>;

// A row times a component of `given`, which begins at `first`.
fn weighted(row: u32, first: u32) -> real {
    var sum: real = 0.0;
    for (var e = transfer[row]; e < transfer[row + 1u]; e += 2u) {
        sum += real_of_single(transfer[e + 1u]) * given[first + transfer[e]];
    }
    return sum;
}
