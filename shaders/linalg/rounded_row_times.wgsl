// As in row_times.wgsl, of the rounded matrix. What rounding has taken from a row is added to its
// diagonal block: a constant x has the same product, and a smooth one nearly. Where material hardly
// changes its volume, half as many Krylov iterations again were needed without.
fn rounded_row_times(slot: u32, component: u32, node: u32) -> real {
    let words = words();
    let of_slot = 3u * slot * level.nodes;
    let lost = (18u * slot + 9u + 3u * component) * level.nodes + node;
    var at = (18u * slot + 3u * component) * words + node;
    var sum: real = 0.0;
    for (var j = 0u; j < 3u; j++) {
        sum += inverse[lost + j * level.nodes] * x[of_slot + j * level.nodes + node];
    }
    for (var k = 0u; k < level.width; k += 2u) {
        let to = column[k * level.nodes + node];
        if to == NO_COLUMN {
            break;
        }
        let first = of_slot + to;
        let second = of_slot + column[(k + 1u) * level.nodes + node];
        for (var j = 0u; j < 3u; j++) {
            let upper = matrix[at + j * words];
            sum += rounded(upper << 16u) * x[first + j * level.nodes] + rounded(upper) * x[second + j * level.nodes];
        }
        at += level.nodes;
    }
    return sum;
}
