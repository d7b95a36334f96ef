// A level so small that one workgroup smooths it whole: the same steps as in chebyshev_start.wgsl
// and chebyshev.wgsl, without a dispatch for each.

@group(0) @binding(1) var<storage, read> column: array<u32>;        // [k][node]
@group(0) @binding(2) var<storage, read> matrix: array<u32>;        // see halves.wgsl
@group(0) @binding(3) var<storage, read> inverse: array<real>;      // see diagonal.wgsl
@group(0) @binding(4) var<storage, read> b: array<real>;            // [slot][component][node]
@group(0) @binding(5) var<storage, read_write> x: array<real>;      // [slot][component][node]
@group(0) @binding(6) var<storage, read> records: array<Record>;
// Shares of the last step and of D^-1 r in each step.
@group(0) @binding(7) var<uniform> recurrence: array<vec4<real>, MOST_STEPS>;

const SMALL_THREADS: u32 = 256u;
// Unknowns of the largest level that one workgroup smooths, and steps at the most.
const SMALL_UNKNOWNS: u32 = 1200u;
const MOST_STEPS: u32 = 8u;

// What is left of the equations, and the last step, as bits of single precision: [component][node].
var<workgroup> left: array<real, SMALL_UNKNOWNS>;
var<workgroup> last_step: array<u32, SMALL_UNKNOWNS>;

// What is left of the equations, of x or, at first, of nothing.
fn leave(slot: u32, local: u32, from_zero: bool) {
    let first = 3u * slot * level.nodes;
    for (var i = local; i < 3u * level.nodes; i += SMALL_THREADS) {
        var r = b[first + i];
        if !from_zero {
            r -= rounded_row_times(slot, i / level.nodes, i % level.nodes);
        }
        left[i] = r;
    }
    workgroupBarrier();
}

// A step of the polynomial.
fn smooth_once(slot: u32, local: u32, step: u32, from_zero: bool) {
    leave(slot, local, from_zero);
    let first = 3u * slot * level.nodes;
    let shares = recurrence[step];
    for (var i = local; i < 3u * level.nodes; i += SMALL_THREADS) {
        let node = i % level.nodes;
        let row = 18u * slot * level.nodes + 3u * (i - node) + node;
        var change = shares.y * (inverse[row] * left[node]
            + inverse[row + level.nodes] * left[level.nodes + node]
            + inverse[row + 2u * level.nodes] * left[2u * level.nodes + node]);
        if shares.x > 0.0 {
            change += shares.x * real_of_single(last_step[i]);
        }
        last_step[i] = single_bits(change);
        x[first + i] = select(x[first + i], real(0.0), from_zero) + change;
    }
    storageBarrier();
    workgroupBarrier();
}
