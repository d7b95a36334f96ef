//! Eight-node hexahedron with mean dilatation: internal force, symmetric tangent, energies and
//! state update.
//!
//! The stored energy of an element of reference volume V is `sum_q W_dev(b_e-bar) V_q + V U(Theta)`
//! with the mean dilatation `Theta = v/V` (Nagtegaal, Parks & Rice 1974; Simo, Taylor & Pister
//! 1985; the three-field formulation with constant pressure and dilatation of Simo & Hughes 1998,
//! chapter 9). The deviatoric Kirchhoff stress is the material's, point by point; the pressure `p =
//! U'(Theta)` is one number an element, which is what keeps the element from locking when plastic
//! flow is isochoric.
//!
//! Everything is computed from displacement gradients: `f - I = dH F_n^-1` with `dH` the gradient
//! of the increment, so that small strains keep their digits (see `material::j2`).

use super::lanes::{Lanes, array};
use crate::material::j2::{Response, deviatoric_tangent, return_mapping_of_eight};
use crate::material::multistep::{Flow, anticipate, complete};
use crate::material::{Material, PointState, Refusal, elastic_energy_deviatoric, elastic_energy_volumetric, pressure};
use crate::real::Real;

/// Nodes of an element.
pub const NODES: usize = 8;
/// Quadrature points of an element (2 x 2 x 2 Gauss).
pub const QUADRATURE_POINTS: usize = 8;
/// Blocks of the upper triangle of an element tangent: pairs (a, b) with a <= b.
pub const PAIRS: usize = 36;

/// Local coordinates of the nodes in VTK order; the quadrature points are these over sqrt(3), in
/// the same order.
pub use crate::mesh::quality::CORNERS;

/// Three displacements (or forces) for each node of an element.
pub type Nodal<R> = [[R; 3]; NODES];

/// What an element needs of its reference shape: computed once, in f64, then rounded.
#[derive(Clone, Debug)]
pub struct ElementGeometry<R> {
    /// Reference gradients dN_a/dX_j at the quadrature points, `[a][j]`.
    pub gradient: [[Lanes<R>; 3]; NODES],
    /// Reference volume of each quadrature point.
    pub volume: Lanes<R>,
    /// Sum of the volumes.
    pub total_volume: R,
}

/// States of an element's quadrature points.
pub type Points<R> = [PointState<R>; QUADRATURE_POINTS];

/// Committed state of an element's quadrature points.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ElementState<R> {
    /// Elastic strain and hardening variable of each point.
    pub points: Points<R>,
    /// What flowed in the last step.
    pub flow: [Flow<R>; QUADRATURE_POINTS],
    /// Plastic work done so far in the element, an energy.
    pub plastic_work: R,
}

impl<R: Real> ElementState<R> {
    /// The states from which the next step starts, with `weight` times the last flow anticipated
    /// (see `material::multistep`).
    pub fn start(&self, weight: R) -> Points<R> {
        std::array::from_fn(|q| anticipate(&self.points[q], &self.flow[q], weight))
    }
}

/// Why an element could not be evaluated at a trial displacement. The solver backtracks; it is no
/// error of the program.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Invalid {
    /// The Jacobian of the deformation is not positive at this quadrature point.
    Inverted(usize),
    /// It is not a number, or infinite.
    NotFinite(usize),
    /// The material refused the deformation at this quadrature point.
    Material(usize, Refusal),
}

impl Invalid {
    /// The quadrature point.
    pub fn point(self) -> usize {
        match self {
            Self::Inverted(point) | Self::NotFinite(point) | Self::Material(point, _) => point,
        }
    }
}

/// Symmetric pair of tensor indices to the index in [xx, yy, zz, xy, yz, zx].
pub const VOIGT: [[usize; 3]; 3] = [[0, 3, 5], [3, 1, 4], [5, 4, 2]];

/// Derivatives dN_a/dxi at local coordinates.
fn shape_derivatives(xi: [f64; 3]) -> [[f64; 3]; NODES] {
    CORNERS.map(|c| {
        let [p, q, r] = std::array::from_fn(|i| 1.0 + c[i] * xi[i]);
        [0.125 * c[0] * q * r, 0.125 * c[1] * p * r, 0.125 * c[2] * p * q]
    })
}

impl<R: Real> ElementGeometry<R> {
    /// Gradients and volumes of the element with these nodes, or the quadrature point at which its
    /// shape is inverted.
    pub fn new(nodes: &[[f64; 3]; NODES]) -> Result<Self, Invalid> {
        let mut gradient = [[Lanes::ZERO; 3]; NODES];
        let mut volume = Lanes::ZERO;
        let mut total = 0.0;
        // Positions relative to the first node: the gradients of a small element far from the
        // origin keep their digits.
        let local = nodes.map(|x| [x[0] - nodes[0][0], x[1] - nodes[0][1], x[2] - nodes[0][2]]);
        for q in 0..QUADRATURE_POINTS {
            let xi = CORNERS[q].map(|c| c / 3.0_f64.sqrt());
            let derivative = shape_derivatives(xi);
            let mut jacobian = [[0.0; 3]; 3];
            for (d, x) in derivative.iter().zip(&local) {
                for i in 0..3 {
                    for j in 0..3 {
                        jacobian[i][j] += x[i] * d[j];
                    }
                }
            }
            let (inverse, det) = invert(&jacobian.map(|r| r.map(|v| Lanes([v; 8]))));
            let det = det.0[0];
            if !(det > 0.0) {
                return Err(Invalid::Inverted(q));
            }
            for a in 0..NODES {
                for j in 0..3 {
                    let g: f64 = (0..3).map(|k| derivative[a][k] * inverse[k][j].0[0]).sum();
                    gradient[a][j].0[q] = R::of(g);
                }
            }
            volume.0[q] = R::of(det);
            total += det;
        }
        Ok(Self { gradient, volume, total_volume: R::of(total) })
    }
}

type Tensor<R> = [[Lanes<R>; 3]; 3];

/// Inverse and determinant by cofactors.
#[inline(always)]
fn invert<R: Real>(m: &Tensor<R>) -> (Tensor<R>, Lanes<R>) {
    let c = |i: usize, j: usize, k: usize, l: usize| m[i][j] * m[k][l] - m[i][l] * m[k][j];
    let c00 = c(1, 1, 2, 2);
    let c01 = -c(1, 0, 2, 2);
    let c02 = c(1, 0, 2, 1);
    let det = m[0][0] * c00 + m[0][1] * c01 + m[0][2] * c02;
    let s = det.reciprocal();
    let inverse = [
        [c00 * s, -c(0, 1, 2, 2) * s, c(0, 1, 1, 2) * s],
        [c01 * s, c(0, 0, 2, 2) * s, -c(0, 0, 1, 2) * s],
        [c02 * s, -c(0, 0, 2, 1) * s, c(0, 0, 1, 1) * s],
    ];
    (inverse, det)
}

/// det(I + h) - 1, expanded so that small h keep their digits.
#[inline(always)]
fn jacobian_minus_one<R: Real>(h: &Tensor<R>) -> Lanes<R> {
    let minor = |i: usize, j: usize| h[i][i] * h[j][j] - h[i][j] * h[j][i];
    let det = h[0][0] * (h[1][1] * h[2][2] - h[1][2] * h[2][1]) - h[0][1] * (h[1][0] * h[2][2] - h[1][2] * h[2][0])
        + h[0][2] * (h[1][0] * h[2][1] - h[1][1] * h[2][0]);
    (h[0][0] + h[1][1] + h[2][2]) + (minor(0, 1) + minor(1, 2) + minor(0, 2)) + det
}

/// Gradient of nodal values with respect to the reference position, `[i][j] = d u_i / d X_j`.
#[inline(always)]
fn displacement_gradient<R: Real>(geometry: &ElementGeometry<R>, u: &Nodal<R>) -> Tensor<R> {
    let mut h = [[Lanes::ZERO; 3]; 3];
    for a in 0..NODES {
        for i in 0..3 {
            for j in 0..3 {
                h[i][j] = h[i][j].plus_scaled(u[a][i], geometry.gradient[a][j]);
            }
        }
    }
    h
}

#[inline(always)]
fn identity_plus<R: Real>(h: &Tensor<R>) -> Tensor<R> {
    let mut f = *h;
    for (i, row) in f.iter_mut().enumerate() {
        row[i] += Lanes::splat(R::ONE);
    }
    f
}

/// The deformation of an element at a trial displacement.
struct Kinematics<R> {
    /// f - I of each point, f = F F_n^-1.
    relative: Tensor<R>,
    /// Gradients dN_a/dx_j in the trial configuration.
    gradient: [[Lanes<R>; 3]; NODES],
    /// det F - 1.
    j_minus_1: Lanes<R>,
    /// Theta - 1, the mean dilatation.
    theta_minus_1: R,
}

#[inline(always)]
fn kinematics<R: Real>(geometry: &ElementGeometry<R>, committed: &Nodal<R>, increment: &Nodal<R>) -> Kinematics<R> {
    let h_n = displacement_gradient(geometry, committed);
    let dh = displacement_gradient(geometry, increment);
    let (f_n_inverse, _) = invert(&identity_plus(&h_n));
    let mut relative = [[Lanes::ZERO; 3]; 3];
    let mut h = h_n;
    for i in 0..3 {
        for j in 0..3 {
            relative[i][j] = dh[i][0] * f_n_inverse[0][j] + dh[i][1] * f_n_inverse[1][j] + dh[i][2] * f_n_inverse[2][j];
            h[i][j] += dh[i][j];
        }
    }
    let j_minus_1 = jacobian_minus_one(&h);
    let (f_inverse, _) = invert(&identity_plus(&h));
    let mut gradient = geometry.gradient;
    for a in 0..NODES {
        let g = geometry.gradient[a];
        for j in 0..3 {
            gradient[a][j] = g[0] * f_inverse[0][j] + g[1] * f_inverse[1][j] + g[2] * f_inverse[2][j];
        }
    }
    let theta_minus_1 = (j_minus_1 * geometry.volume).sum() / geometry.total_volume;
    Kinematics { relative, gradient, j_minus_1, theta_minus_1 }
}

impl<R: Real> Kinematics<R> {
    /// An error if a point is turned inside out, or no number: the rest means nothing then. It
    /// stands apart because a `Result` of the whole would be copied, in every element.
    #[inline(always)]
    fn check(&self) -> Result<(), Invalid> {
        // The negated comparison catches NaN as well.
        let inverted = self.j_minus_1.0.iter().position(|&j| !(j > -R::ONE && j.is_finite()));
        inverted
            .map_or(Ok(()), |q| Err(if self.j_minus_1.0[q].is_finite() { Invalid::Inverted(q) } else { Invalid::NotFinite(q) }))
    }
}

#[inline(always)]
fn relative_gradient<R: Real>(k: &Kinematics<R>, q: usize) -> [[R; 3]; 3] {
    std::array::from_fn(|i| std::array::from_fn(|j| k.relative[i][j].0[q]))
}

#[inline(always)]
fn respond<R: Real>(material: &Material<R>, k: &Kinematics<R>, start: &Points<R>) -> Result<Response<Lanes<R>>, Invalid> {
    return_mapping_of_eight(material, &k.relative, &PointState::of_eight(start))
        .map_err(|(q, why)| Invalid::Material(q, why.into()))
}

/// f_a = sum_q V_q tau_q . grad N_a with the Kirchhoff stress [xx, yy, zz, xy, yz, zx] already
/// weighted by the volumes.
#[inline(always)]
fn divergence<R: Real>(gradient: &[[Lanes<R>; 3]; NODES], weighted: &[Lanes<R>; 6]) -> Nodal<R> {
    array([R::ZERO; 3], |a| {
        array(R::ZERO, |i| {
            let g = &gradient[a];
            (weighted[VOIGT[i][0]] * g[0]).plus(weighted[VOIGT[i][1]], g[1]).plus(weighted[VOIGT[i][2]], g[2]).sum()
        })
    })
}

/// Internal force of the element on its nodes, dW/du, at the displacement `committed + increment`.
///
/// `committed` is the displacement of the last committed state, `start` the states from which the
/// step starts. Force unit: stress times area of the scaled problem.
pub fn internal_force<R: Real>(
    geometry: &ElementGeometry<R>,
    material: &Material<R>,
    start: &Points<R>,
    committed: &Nodal<R>,
    increment: &Nodal<R>,
) -> Result<Nodal<R>, Invalid> {
    let k = kinematics(geometry, committed, increment);
    k.check()?;
    let mut stress = respond(material, &k, start)?.stress;
    let (p, _) = pressure(&material.elasticity, k.theta_minus_1);
    let p_j = Lanes::from_fn(|q| p * (R::ONE + k.j_minus_1.0[q]));
    for (c, s) in stress.iter_mut().enumerate() {
        if c < 3 {
            *s += p_j;
        }
        *s = *s * geometry.volume;
    }
    Ok(divergence(&k.gradient, &stress))
}

/// The upper triangle of an element tangent: block `pair(a, b)` is d f_a / d u_b, row-major, for a
/// <= b.
pub type Tangent<R> = [[R; 9]; PAIRS];

/// Position of the pair (a, b), a <= b, in a [`Tangent`].
#[inline(always)]
pub const fn pair(a: usize, b: usize) -> usize {
    a * (2 * NODES - a + 1) / 2 + (b - a)
}

/// Symmetric consistent tangent of [`internal_force`] (the deviatoric moduli are the symmetrised
/// ones of Simo & Hughes, box 9.2).
///
/// Returns about how far the displacement gradient may change before a point begins to yield: 0
/// where one does, infinite in an elastic material.
pub fn tangent<R: Real>(
    geometry: &ElementGeometry<R>,
    material: &Material<R>,
    start: &Points<R>,
    committed: &Nodal<R>,
    increment: &Nodal<R>,
    out: &mut Tangent<R>,
) -> Result<R, Invalid> {
    let k = kinematics(geometry, committed, increment);
    k.check()?;
    let (p, dp) = pressure(&material.elasticity, k.theta_minus_1);
    let response = respond(material, &k, start)?;
    let v = geometry.volume;
    let p_j = Lanes::from_fn(|q| p * (R::ONE + k.j_minus_1.0[q]));
    let stress: [Lanes<R>; 6] = array(v, |i| v * if i < 3 { response.stress[i] + p_j } else { response.stress[i] });
    let mut moduli = deviatoric_tangent(&response);
    moduli.iter_mut().flatten().for_each(|c| *c = v * *c);
    // d(p J grad N) at fixed p: p J (1 (x) 1 - 2 I_sym), with p J I among the stresses of the
    // geometric term.
    let v_p_j = v * p_j;
    for i in 0..3 {
        for j in 0..3 {
            moduli[i][j] += if i == j { -v_p_j } else { v_p_j };
        }
        moduli[i + 3][i + 3] += -v_p_j;
    }
    let g = &k.gradient;
    let by_node = ByNode::new(g);
    // Volume change: h_a = sum_q V J grad N_a, the derivative of the current volume.
    let v_j = Lanes::from_fn(|q| geometry.volume.0[q] * (R::ONE + k.j_minus_1.0[q]));
    let h = by_node.volume_change(&v_j);
    let bulk = dp / geometry.total_volume;
    for b in 0..NODES {
        // c : grad N_b, [Voigt row][j]. Where both directions are the same, tau grad N_b of the
        // geometric term is added, [i][k].
        let mut d = [[Lanes::ZERO; 3]; 6];
        for (row, m) in d.iter_mut().zip(&moduli) {
            for j in 0..3 {
                row[j] = (m[VOIGT[j][0]] * g[b][0]).plus(m[VOIGT[j][1]], g[b][1]).plus(m[VOIGT[j][2]], g[b][2]);
            }
        }
        let t: [Lanes<R>; 3] =
            array(v, |i| (stress[VOIGT[i][0]] * g[b][0]).plus(stress[VOIGT[i][1]], g[b][1]).plus(stress[VOIGT[i][2]], g[b][2]));
        let same: Tensor<R> = array([v; 3], |i| array(v, |k| d[VOIGT[i][k]][i] + t[k]));
        let factor = |q: usize, k: usize, i: usize, j: usize| if i == j { same[i][k].0[q] } else { d[VOIGT[i][k]][j].0[q] };
        let volume = |i: usize, j: usize| (bulk * h[j][b], h[i]);
        // Nodes a after b are not asked for: up to the fourth, half a register will do.
        if b < 4 {
            let block = row_blocks(
                R::mul_add_four,
                factor,
                |q, k| first_four(by_node.gradient[q][k]),
                |i, j| {
                    let (factor, h) = volume(i, j);
                    (factor, first_four(h))
                },
            );
            (0..=b).for_each(|a| out[pair(a, b)] = array(R::ZERO, |m| block[m][a]));
        } else {
            let block = row_blocks(R::mul_add_eight, factor, |q, k| by_node.gradient[q][k], volume);
            (0..=b).for_each(|a| out[pair(a, b)] = array(R::ZERO, |m| block[m][a]));
        }
    }
    // A stretch at constant volume by that much takes the whole reserve, a shear less of it.
    let reserve = response.reserve.0.iter().fold(response.reserve.0[0], |least, &reserve| least.min(reserve));
    Ok(reserve.max(R::ZERO) / (R::of(3.0) * material.elasticity.shear))
}

/// Blocks of several nodes a with one node b, `[3 i + j][a]`: the sum of `factor(q, k, i, j)
/// dN_a/dx_k` over points and directions, and the change of volume, a factor and the nodes' own.
#[inline(always)]
fn row_blocks<R: Real, const N: usize>(
    mul_add: impl Fn([R; N], [R; N], [R; N]) -> [R; N],
    factor: impl Fn(usize, usize, usize, usize) -> R,
    gradient: impl Fn(usize, usize) -> [R; N],
    volume: impl Fn(usize, usize) -> (R, [R; N]),
) -> [[R; N]; 9] {
    let mut block = [[R::ZERO; N]; 9];
    for q in 0..QUADRATURE_POINTS {
        for k in 0..3 {
            let gradient = gradient(q, k);
            for i in 0..3 {
                for j in 0..3 {
                    block[3 * i + j] = mul_add([factor(q, k, i, j); N], gradient, block[3 * i + j]);
                }
            }
        }
    }
    for i in 0..3 {
        for j in 0..3 {
            let (factor, h) = volume(i, j);
            block[3 * i + j] = mul_add([factor; N], h, block[3 * i + j]);
        }
    }
    block
}

#[inline(always)]
fn first_four<R: Copy>(x: [R; NODES]) -> [R; 4] {
    [x[0], x[1], x[2], x[3]]
}

/// Gradients of the shape functions with the nodes side by side instead of the quadrature points:
/// sums over points are then sums of vectors.
struct ByNode<R> {
    /// Gradients dN_a/dx_k: `[q][k][a]`.
    gradient: [[[R; NODES]; 3]; QUADRATURE_POINTS],
}

impl<R: Real> ByNode<R> {
    #[inline(always)]
    fn new(gradient: &[[Lanes<R>; 3]; NODES]) -> Self {
        let nodes = |q: usize, k: usize| array(R::ZERO, |a| gradient[a][k].0[q]);
        let none = [R::ZERO; NODES];
        Self { gradient: array([none; 3], |q| array(none, |k| nodes(q, k))) }
    }

    /// sum_q weight grad N_a, `[i][a]`.
    #[inline(always)]
    fn volume_change(&self, weight: &Lanes<R>) -> [[R; NODES]; 3] {
        let mut sum = [[R::ZERO; NODES]; 3];
        for (&weight, gradient) in weight.0.iter().zip(&self.gradient) {
            for (sum, gradient) in sum.iter_mut().zip(gradient) {
                *sum = R::mul_add_eight([weight; NODES], *gradient, *sum);
            }
        }
        sum
    }
}

/// The state at the end of a step that went from `committed` by `increment`, and whose trial states
/// were found from `start`; and the elastic energy of the element there.
pub fn update<R: Real>(
    geometry: &ElementGeometry<R>,
    material: &Material<R>,
    state: &ElementState<R>,
    start: &Points<R>,
    committed: &Nodal<R>,
    increment: &Nodal<R>,
) -> Result<(ElementState<R>, R), Invalid> {
    let k = kinematics(geometry, committed, increment);
    k.check()?;
    let mut next = *state;
    let responses = respond(material, &k, start)?;
    for q in 0..QUADRATURE_POINTS {
        let response = responses.point(q);
        let (response, flow) = complete(material, &relative_gradient(&k, q), &state.points[q], &start[q], response)
            .map_err(|why| Invalid::Material(q, why.into()))?;
        next.points[q] = response.state;
        next.flow[q] = flow;
        next.plastic_work += response.plastic_work * geometry.volume.0[q];
    }
    let energy = elastic_energy(geometry, material, &next.points, k.theta_minus_1);
    Ok((next, energy))
}

/// Elastic energy of an element with these states and this mean dilatation.
#[inline(always)]
fn elastic_energy<R: Real>(geometry: &ElementGeometry<R>, material: &Material<R>, points: &Points<R>, theta_minus_1: R) -> R {
    let mut energy = R::ZERO;
    for (point, &volume) in points.iter().zip(&geometry.volume.0) {
        energy += elastic_energy_deviatoric(&material.elasticity, &point.be) * volume;
    }
    energy + elastic_energy_volumetric(&material.elasticity, theta_minus_1) * geometry.total_volume
}

/// What an element shows of itself at a committed state.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ElementFields<R> {
    /// Cauchy stress [xx, yy, zz, xy, yz, zx] at each quadrature point, scaled by E.
    pub stress: [[R; 6]; QUADRATURE_POINTS],
    /// Elastic energy of the element.
    pub elastic_energy: R,
}

/// Cauchy stress and elastic energy of a committed state at its displacement.
pub fn fields<R: Real>(
    geometry: &ElementGeometry<R>,
    material: &Material<R>,
    points: &Points<R>,
    committed: &Nodal<R>,
) -> Result<ElementFields<R>, Invalid> {
    let k = kinematics(geometry, committed, &[[R::ZERO; 3]; NODES]);
    k.check()?;
    let (p, _) = pressure(&material.elasticity, k.theta_minus_1);
    let mut out = ElementFields::default();
    let third = R::ONE / R::of(3.0);
    for q in 0..QUADRATURE_POINTS {
        let be = &points[q].be;
        let mean = third * (be[0] + be[1] + be[2]);
        let j = R::ONE + k.j_minus_1.0[q];
        for c in 0..6 {
            let s = material.elasticity.shear * (be[c] - if c < 3 { mean } else { R::ZERO });
            out.stress[q][c] = s / j + if c < 3 { p } else { R::ZERO };
        }
    }
    out.elastic_energy = elastic_energy(geometry, material, points, k.theta_minus_1);
    Ok(out)
}
