// Partial sums of a trial: square of the residual, its work on the correction and that of the
// current iterate's, largest right-hand side.
const PARTS: u32 = 4;

// The largest number of the threads of a workgroup.
fn largest_of(local: u32, number_of_thread: real) -> real {
    sums[local] = number_of_thread;
    workgroupBarrier();
    for (var half = THREADS / 2u; half > 0u; half /= 2u) {
        if local < half {
            sums[local] = max(sums[local], sums[local + half]);
        }
        workgroupBarrier();
    }
    let most = sums[0];
    workgroupBarrier();
    return most;
}
