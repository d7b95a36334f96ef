// The first step of the polynomial from x = 0.

@group(0) @binding(1) var<storage, read> inverse: array<real>;      // see diagonal.wgsl
@group(0) @binding(2) var<storage, read> b: array<real>;            // [slot][component][node]
@group(0) @binding(3) var<storage, read_write> last_step: array<real>;   // [slot][component][node]
@group(0) @binding(4) var<storage, read_write> next: array<real>;   // [slot][component][node]
@group(0) @binding(5) var<uniform> recurrence: vec2<real>;          // as in chebyshev.wgsl
@group(0) @binding(6) var<storage, read> records: array<Record>;

@compute @workgroup_size(192)
fn smooth_start(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) local: u32) {
    let slot = records[group.y].running;
    let node = NODES_IN_GROUP * group.x + local % NODES_IN_GROUP;
    if records[slot].done != RUNNING || node >= level.nodes {
        return;
    }
    let component = local / NODES_IN_GROUP;
    let first = (18u * slot + 3u * component) * level.nodes + node;
    let r = 3u * slot * level.nodes + node;
    let change = recurrence.y * (inverse[first] * b[r]
        + inverse[first + level.nodes] * b[r + level.nodes]
        + inverse[first + 2u * level.nodes] * b[r + 2u * level.nodes]);
    last_step[r + component * level.nodes] = change;
    next[r + component * level.nodes] = change;
}
