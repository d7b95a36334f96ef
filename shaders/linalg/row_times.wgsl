// Row `component` of a node's block row times x.
fn row_times(slot: u32, component: u32, node: u32) -> real {
    let blocks = level.width * level.nodes;
    let of_slot = 3u * slot * level.nodes;
    var at = 3u * (3u * slot + component) * blocks + node;
    var sum: real = 0.0;
    for (var k = 0u; k < level.width; k++) {
        let j = of_slot + column[k * level.nodes + node];
        sum += matrix[at] * x[j] + matrix[at + blocks] * x[j + level.nodes] + matrix[at + 2u * blocks] * x[j + 2u * level.nodes];
        at += level.nodes;
    }
    return sum;
}
