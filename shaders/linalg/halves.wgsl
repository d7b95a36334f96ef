// Matrices in halves. The upper 16 bits of a number are it to 8 digits (bf16): the smoother reads
// these alone, half as much. With the lower 16 bits they are the number again, to the last bit. A
// word has the halves of two blocks of a row, those of k in its lower bits, of k + 1 in its upper
// ones: [slot][upper, lower][3 i + j][k / 2][node].

// Words that a component of all blocks takes.
fn words() -> u32 {
    return level.width / 2u * level.nodes;
}

// Upper halves of the bits of two numbers, rounded, away from 0 in the middle.
fn upper_halves(first: u32, second: u32) -> u32 {
    return ((first + 0x8000u) >> 16u) | ((second + 0x8000u) & 0xffff0000u);
}

fn lower_halves(first: u32, second: u32) -> u32 {
    return (first & 0xffffu) | (second << 16u);
}

// The number that is left of the second block; of the first, with words shifted to the left by 16.
fn rounded(upper: u32) -> real {
    return real_of_single(upper & 0xffff0000u);
}

// Alike, the whole number. Where it was rounded up its lower half counts from below.
fn whole(upper: u32, lower: u32) -> real {
    return real_of_single((upper & 0xffff0000u) + bitcast<u32>(bitcast<i32>(lower) >> 16u));
}
