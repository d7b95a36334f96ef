// The products A P and P^T (A P), a thread a block: it sums along a list made once, so that each
// block has one writer and one order.

@group(0) @binding(1) var<storage, read> list_start: array<u32>;    // starts of the blocks' lists
@group(0) @binding(2) var<storage, read> list_entry: array<u32>;    // a block of the other factor
@group(0) @binding(3) var<storage, read> list_weight: array<real>;  // its weight

// A block of `given` whose first component is at `at`, the others `stride` apart.
fn load_block(at: u32, stride: u32) -> mat3x3<real> {
    return mat3x3<real>(
        given[at], given[at + 3u * stride], given[at + 6u * stride],
        given[at + stride], given[at + 4u * stride], given[at + 7u * stride],
        given[at + 2u * stride], given[at + 5u * stride], given[at + 8u * stride],
    );
}

fn store_block(at: u32, stride: u32, a: mat3x3<real>) {
    for (var j = 0u; j < 3u; j++) {
        for (var i = 0u; i < 3u; i++) {
            to[at + (3u * i + j) * stride] = a[j][i];
        }
    }
}

@group(0) @binding(4) var<storage, read> given: array<real>;         // [slot][3 i + j][block]
@group(0) @binding(5) var<storage, read_write> to: array<real>;     // [slot][3 i + j][block]
