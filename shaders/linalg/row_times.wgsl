// Row `component` of a node's block row times x.
fn row_times(slot: u32, component: u32, node: u32) -> real {
    let words = words();
    let of_slot = 3u * slot * level.nodes;
    var at = (18u * slot + 3u * component) * words + node;
    var sum: real = 0.0;
    for (var k = 0u; k < level.width; k += 2u) {
        let to = column[k * level.nodes + node];
        if to == NO_COLUMN {
            break;
        }
        let first = of_slot + to;
        let second = of_slot + column[(k + 1u) * level.nodes + node];
        for (var j = 0u; j < 3u; j++) {
            let upper = matrix[at + j * words];
            let lower = matrix[at + (9u + j) * words];
            let of_component = j * level.nodes;
            sum += whole(upper << 16u, lower << 16u) * x[first + of_component] + whole(upper, lower) * x[second + of_component];
        }
        at += level.nodes;
    }
    return sum;
}
