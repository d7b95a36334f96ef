// Two blocks of a row into `matrix`, in halves (see halves.wgsl): from word `at` on, a number of a
// block every `stride` words.
fn keep_halves(at: u32, stride: u32, first: mat3x3<real>, second: mat3x3<real>) {
    for (var j = 0u; j < 3u; j++) {
        for (var i = 0u; i < 3u; i++) {
            let a = single_bits(first[j][i]);
            let b = single_bits(second[j][i]);
            matrix[at + (3u * i + j) * stride] = upper_halves(a, b);
            matrix[at + (9u + 3u * i + j) * stride] = lower_halves(a, b);
        }
    }
}
