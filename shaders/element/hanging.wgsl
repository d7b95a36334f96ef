// Hanging nodes, eliminated element by element: the twin of crates/kernels/src/mesh/hanging.rs. What
// a node that an element names is to its points is told by its share in each corner: the derivative
// of a named node's shape function is the sum of those of the corners, each times that share, and
// forces and tangents that are made with it are those of the named nodes.

// What an entry of element_nodes has above the number of a node. The first three have a bit each of
// the element's octant.
const NODE: u32 = 0x1fffffffu;
const SOME_HANG: u32 = 0x20000000u;     // some corner of the element hangs
const OCTANT_AT: u32 = 30u;
const HANGS_AT: u32 = 31u;              // this corner hangs

fn node_at(element: u32, corner: u32) -> u32 {
    return element_nodes[8u * element + corner] & NODE;
}

// A bit for each corner of an element that hangs, then its octant; 0 where none does.
fn hanging_of(element: u32) -> u32 {
    let first = 8u * element;
    if (element_nodes[first] & SOME_HANG) == 0u {
        return 0u;
    }
    var hanging = 0u;
    for (var a = 0u; a < 8u; a++) {
        let entry = element_nodes[first + a];
        hanging |= (entry >> HANGS_AT) << a;
        hanging |= ((entry >> OCTANT_AT) & 1u) << (8u + a);
    }
    return hanging;
}

fn hangs(hanging: u32, corner: u32) -> bool {
    return ((hanging >> corner) & 1u) != 0u;
}

// On which side a corner is of the one that the element has in common with the cell that was split:
// 1 in the directions in which it lies in the middle of that cell, if it hangs.
fn from_octant(hanging: u32, corner: u32) -> vec3<u32> {
    return sides(hanging >> 8u) ^ sides(corner);
}

// The share of a named node in a corner that hangs, which is the mean of its members.
fn share(hanging: u32, corner: u32, named: u32) -> real {
    let middle = from_octant(hanging, corner);
    if any(from_octant(hanging, named) > middle) {
        return 0.0;
    }
    let half = vec3<real>(1.0) - 0.5 * vec3<real>(middle);
    return half.x * half.y * half.z;
}

// d/dxi of a named node's shape function at quadrature point q.
fn named_derivative(hanging: u32, named: u32, q: u32) -> vec3<real> {
    if hanging == 0u {
        return shape_derivative(named, q);
    }
    var sum = vec3<real>();
    if !hangs(hanging, named) {
        sum = shape_derivative(named, q);
    }
    for (var left = hanging & 0xffu; left != 0u; left &= left - 1u) {
        let corner = firstTrailingBit(left);
        sum += share(hanging, corner, named) * shape_derivative(corner, q);
    }
    return sum;
}
