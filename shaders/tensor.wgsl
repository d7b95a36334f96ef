// Symmetric second-order tensors: tensor components, no engineering factors, in the order xx, yy,
// zz | xy, yz, zx.
struct Sym {
    diagonal: vec3<real>,
    shear: vec3<real>,
}

// factor * a
fn sym_scale(factor: real, a: Sym) -> Sym {
    return Sym(factor * a.diagonal, factor * a.shear);
}

// a + factor * 1
fn sym_add_identity(a: Sym, factor: real) -> Sym {
    return Sym(a.diagonal + vec3<real>(factor), a.shear);
}

// a : b
fn sym_dot(a: Sym, b: Sym) -> real {
    return dot(a.diagonal, b.diagonal) + 2.0 * dot(a.shear, b.shear);
}

// det a
fn sym_determinant(a: Sym) -> real {
    let d = a.diagonal;
    let s = a.shear;
    return d.x * (d.y * d.z - s.y * s.y) - s.x * (s.x * d.z - s.y * s.z) + s.z * (s.x * s.y - d.y * s.z);
}

// a as a matrix
fn sym_matrix(a: Sym) -> mat3x3<real> {
    let d = a.diagonal;
    let s = a.shear;
    return mat3x3<real>(vec3<real>(d.x, s.x, s.z), vec3<real>(s.x, d.y, s.y), vec3<real>(s.z, s.y, d.z));
}

// Component k of the order above.
fn sym_component(a: Sym, k: u32) -> real {
    if k < 3u {
        return a.diagonal[k];
    }
    return a.shear[k - 3u];
}
