// The shape of a batch: what every kernel of it knows. A dispatch runs along x over the items of a
// case and along y over its slots, the cases that were asked for; what stays on the device is
// indexed by case, what a dispatch makes by slot.
struct Dimensions {
    cases: u32,             // in the resident arrays
    in_dispatch: u32,       // slots in use
    nodes: u32,
    elements: u32,
    contact_points: u32,
    blocks: u32,            // upper block triangle of the tangent
    own_elements: u32,      // those of the sphere; an opponent that deforms has those after them
    materials: u32,         // sets of parameters: of all cases, then of their opponents, if they have any
    start_numbers: u32,     // of a case in starts: displacement [3 node + i], states [component][point]
    trial_numbers: u32,     // of a slot in trials: increment [3 node + i], det F - 1 [point]
    reserved_0: u32,
    reserved_1: u32,
}

// Numbers of a contact point's conditions: residual, force rows, displacement rows.
const ROWS: u32 = 21u;
// Numbers of a quadrature point's weighted stress.
const STRESS: u32 = 9u;

@group(0) @binding(0) var<uniform> dimensions: Dimensions;
// Slots of a dispatch at the most: what is small for each of them is a block of parameters, so that
// a kernel has its storage buffers for what is large. WebGPU promises eight of these.
const MOST_SLOTS: u32 = 1024u;

// For each slot: its case, and that case's geometry.
@group(0) @binding(1) var<uniform> active_cases: array<vec4<u32>, MOST_SLOTS>;
