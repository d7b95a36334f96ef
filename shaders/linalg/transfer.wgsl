// To the next level and back: a scalar sparse matrix by rows, on each component alike.

@group(0) @binding(1) var<storage, read> row_start: array<u32>;
@group(0) @binding(2) var<storage, read> row_column: array<u32>;
@group(0) @binding(3) var<storage, read> row_weight: array<real>;
@group(0) @binding(4) var<storage, read> given: array<real>;         // [slot][component][node]
@group(0) @binding(5) var<storage, read_write> to: array<real>;     // [slot][component][node]
@group(0) @binding(6) var<storage, read> records: array<Record>;

// A row times a component of `given`, which begins at `first`.
fn weighted(row: u32, first: u32) -> real {
    var sum: real = 0.0;
    for (var e = row_start[row]; e < row_start[row + 1u]; e++) {
        sum += row_weight[e] * given[first + row_column[e]];
    }
    return sum;
}
