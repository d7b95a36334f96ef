// The finest level's matrix: a thread two blocks of a row, whose halves share words. It is the
// tangent's upper triangle, or that transposed; over a curved opponent the rows and columns of
// contact nodes are turned into their frames; where a contact point slides, the rows of its node are
// their contact conditions. Rows and columns of fixed unknowns are in it too: masks leave them out.

@group(0) @binding(1) var<storage, read> source: array<u32>;        // [k][node]: 2 block, + 1 if transposed
@group(0) @binding(2) var<storage, read> diagonal: array<u32>;      // [node]: k of its diagonal block
@group(0) @binding(3) var<storage, read> point_of: array<u32>;      // [node]: its contact point
@group(0) @binding(4) var<storage, read> blocks: array<real>;       // [slot][3 i + j][block]
// [slot][slides, force rows, displacement rows, frame][point], bits of f32
@group(0) @binding(5) var<storage, read> rows: array<u32>;
@group(0) @binding(6) var<storage, read_write> matrix: array<u32>;  // see halves.wgsl
// upper blocks, contact points, whether an opponent of the batch is curved
@group(0) @binding(7) var<uniform> counts: vec4<u32>;
@group(0) @binding(8) var<storage, read> column: array<u32>;        // [k][node]

const NOWHERE: u32 = 0xffffffffu;
// Numbers of a contact point: whether it slides, its rows, its frame.
const POINT_ROWS: u32 = 28u;
const POINT_FRAME: u32 = 19u;

@compute @workgroup_size(64)
fn assemble(@builtin(global_invocation_id) id: vec3<u32>) {
    let words = words();
    if id.x >= words {
        return;
    }
    let slot = id.y;
    let node = id.x % level.nodes;
    let block = 2u * id.x - node;
    let first = block_of(slot, node, block);
    let second = block_of(slot, node, block + level.nodes);
    keep_halves(18u * slot * words + id.x, words, first, second);
}

// Block k of a node's row, which is number k nodes + node.
fn block_of(slot: u32, node: u32, block: u32) -> mat3x3<real> {
    let origin = source[block];
    if origin == NOWHERE {
        return mat3x3<real>();
    }
    let first = 9u * slot * counts.x + origin / 2u;
    // columns of the block
    var a = mat3x3<real>(
        blocks[first], blocks[first + 3u * counts.x], blocks[first + 6u * counts.x],
        blocks[first + counts.x], blocks[first + 4u * counts.x], blocks[first + 7u * counts.x],
        blocks[first + 2u * counts.x], blocks[first + 5u * counts.x], blocks[first + 8u * counts.x],
    );
    if origin % 2u == 1u {
        a = transpose(a);
    }
    let point = point_of[node];
    if counts.z != 0u {
        let other = point_of[column[block]];
        if other != NOWHERE {
            a = a * row_block(POINT_ROWS * slot * counts.y + other, POINT_FRAME);
        }
        if point != NOWHERE {
            a = transpose(row_block(POINT_ROWS * slot * counts.y + point, POINT_FRAME)) * a;
        }
    }
    if point != NOWHERE {
        let at = POINT_ROWS * slot * counts.y + point;
        if real_of_single(rows[at]) > 0.0 {
            a = transpose(row_block(at, 1u)) * a;
            if block / level.nodes == diagonal[node] {
                a += transpose(row_block(at, 10u));
            }
        }
    }
    return a;
}

// Three rows of a contact condition, or the axes of a frame, as columns.
fn row_block(at: u32, first: u32) -> mat3x3<real> {
    return mat3x3<real>(row(at, first), row(at, first + 3u), row(at, first + 6u));
}

fn row(at: u32, first: u32) -> vec3<real> {
    let next = at + first * counts.y;
    return vec3<real>(
        real_of_single(rows[next]),
        real_of_single(rows[next + counts.y]),
        real_of_single(rows[next + 2u * counts.y]),
    );
}
