// The sum of a number of each thread of a workgroup of 256, in a fixed order. All threads call it,
// and all have the answer.

const THREADS: u32 = 256u;
var<workgroup> sums: array<real, THREADS>;

fn add_up(local: u32, number: real) -> real {
    sums[local] = number;
    workgroupBarrier();
    for (var half = THREADS / 2u; half > 0u; half /= 2u) {
        if local < half {
            sums[local] += sums[local + half];
        }
        workgroupBarrier();
    }
    let sum = sums[0];
    // The next sum may be written only when every thread has read this one.
    workgroupBarrier();
    return sum;
}
