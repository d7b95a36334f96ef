// The finest matrix of half of the body, for what is even in x and for what is odd, which differ in
// what is fixed alone (see linalg/fold.rs): a thread two blocks of a row, whose halves share
// words.

@group(0) @binding(1) var<storage, read> blocks: array<real>;       // [slot][3 i + j][block]
// [side][k][node]: 2 block, + 1 if transposed; a bit for each number that changes its sign
@group(0) @binding(2) var<storage, read> sides: array<u32>;
@group(0) @binding(3) var<storage, read_write> matrix: array<u32>;  // see halves.wgsl
@group(0) @binding(4) var<uniform> counts: vec4<u32>;               // as in assemble.wgsl

const NOWHERE: u32 = 0xffffffffu;

@compute @workgroup_size(64)
fn fold_matrix(@builtin(global_invocation_id) id: vec3<u32>) {
    let words = words();
    if id.x >= words {
        return;
    }
    let slot = id.y;
    let node = id.x % level.nodes;
    let block = 2u * id.x - node;
    let first = folded(slot, block);
    let second = folded(slot, block + level.nodes);
    for (var parity = 0u; parity < 2u; parity++) {
        keep_halves(18u * (2u * slot + parity) * words + id.x, words, first, second);
    }
}

// A block of the half: the sum of those of either side, with their signs.
fn folded(slot: u32, block: u32) -> mat3x3<real> {
    var sum = mat3x3<real>();
    for (var side = 0u; side < 2u; side++) {
        let at = 2u * (side * level.width * level.nodes + block);
        let origin = sides[at];
        if origin == NOWHERE {
            continue;
        }
        let signs = sides[at + 1u];
        let first = 9u * slot * counts.x + origin / 2u;
        for (var j = 0u; j < 3u; j++) {
            for (var i = 0u; i < 3u; i++) {
                let m = select(3u * i + j, 3u * j + i, origin % 2u == 1u);
                let number = blocks[first + m * counts.x];
                sum[j][i] += select(number, -number, (signs >> (3u * i + j)) % 2u == 1u);
            }
        }
    }
    return sum;
}
