// Sums over long vectors, in two stages of a fixed order: each workgroup one chunk, and whoever
// needs the sum adds up the chunks.

const CHUNK: u32 = 1024u;

fn chunks() -> u32 {
    return (3u * level.nodes + CHUNK - 1u) / CHUNK;
}

// Where a slot's partial sums of product i begin; there are restart + 2 products.
fn partial_place(slot: u32, i: u32) -> u32 {
    return (slot * (level.restart + 2u) + i) * chunks();
}

// Where a slot's small arrays begin: column and right-hand side of the least-squares problem,
// rotations, triangle, combination.
fn small_place(slot: u32) -> u32 {
    return slot * (5u * level.restart + 2u + level.restart * (level.restart + 1u) / 2u);
}

fn target_place(slot: u32) -> u32 {
    return small_place(slot) + level.restart + 1u;
}

fn rotation_place(slot: u32) -> u32 {
    return target_place(slot) + level.restart + 1u;
}

fn triangle_place(slot: u32) -> u32 {
    return rotation_place(slot) + 2u * level.restart;
}

fn combination_place(slot: u32) -> u32 {
    return triangle_place(slot) + level.restart * (level.restart + 1u) / 2u;
}
