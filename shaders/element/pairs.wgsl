// Pairs of an element's nodes: (b + offset, b) modulo 8 with offsets 0 to 3, and with 4 for the
// first four b, so that each pair is there once.

// Numbers of an element's tangent: nine of each of its 36 pairs.
const ELEMENT_BLOCKS: u32 = 324u;

// The number of a pair.
fn pair_place(b: u32, offset: u32) -> u32 {
    return 8u * offset + b;
}
