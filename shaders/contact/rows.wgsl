// The conditions of a contact point as `rows` has them, component by component, `at` being the
// place of its first; and status and fixed components as one number.

fn store_rows(at: u32, rows: Rows) {
    store(at, 0u, rows.residual);
    for (var i = 0u; i < 3u; i++) {
        store(at, 3u + 3u * i, rows.force_rows[i]);
        store(at, 12u + 3u * i, rows.displacement_rows[i]);
    }
}

fn store(at: u32, first: u32, v: vec3<real>) {
    let points = dimensions.contact_points;
    rows[at + first * points] = v.x;
    rows[at + (first + 1u) * points] = v.y;
    rows[at + (first + 2u) * points] = v.z;
}

// Status + 4, 8, 16 for fixed x, y, z.
fn status_code(rows: Rows) -> u32 {
    let fixed = select(vec3<u32>(), vec3<u32>(4u, 8u, 16u), rows.fixed);
    return rows.status + fixed.x + fixed.y + fixed.z;
}
