// The trial at which an element is evaluated. Those who only read it have it from here.

// [slot]: increment of the displacement [3 node + i], det F - 1 [point]
@group(0) @binding(5) var<storage, read> trials: array<real>;

// det F - 1 of a point, which hex8_jacobian has left.
fn jacobian_of(slot: u32, point: u32) -> real {
    return trials[slot * dimensions.trial_numbers + 3u * dimensions.nodes + point];
}
