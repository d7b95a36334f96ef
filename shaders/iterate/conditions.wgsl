// The conditions of an iterate's contact points, for those who only read them.

@group(0) @binding(8) var<storage, read> rows: array<real>;     // [case][iterate][CONDITIONS][point]

// Status + 4, 8, 16 for fixed x, y, z.
fn code_of(case_index: u32, iterate: u32, point: u32) -> u32 {
    return u32(rows[conditions_place(case_index, iterate, point) + CODE * dimensions.contact_points]);
}

fn status_of(case_index: u32, iterate: u32, point: u32) -> u32 {
    return code_of(case_index, iterate, point) % 4u;
}
