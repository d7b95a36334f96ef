// The maps of an equal pair's interface (see contact/maps.rs), as rows of blocks of the contact
// nodes, and the vectors that go through them. A slot's words are, for each map, where the row of
// each contact point begins, and then the blocks: a node, and nine numbers row by row.

// words of a slot, contact points, which map, what else is done
@group(0) @binding(1) var<uniform> tie: vec4<u32>;
@group(0) @binding(2) var<storage, read> maps: array<u32>;

// Numbers of a block with its node.
const TIE_BLOCK: u32 = 10u;

// Row `component` of a point's row of blocks times a vector.
fn tied(slot: u32, component: u32, point: u32) -> real {
    let first = slot * tie.x;
    let row = first + tie.z * (tie.y + 1u) + point;
    var sum: real = 0.0;
    for (var block = maps[row]; block < maps[row + 1u]; block += TIE_BLOCK) {
        let at = first + block;
        let x = 3u * slot * level.nodes + maps[at];
        for (var j = 0u; j < 3u; j++) {
            sum += real_of_single(maps[at + 1u + 3u * component + j]) * given[x + j * level.nodes];
        }
    }
    return sum;
}
