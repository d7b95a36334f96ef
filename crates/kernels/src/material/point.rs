//! One material point driven along a path of deformation: uniaxial stress, simple shear, or given
//! deformation gradients.

use super::hardening::increasing_root;
use super::j2::determinant_minus_one;
use super::{
    Material, MaterialError, PointError, PointState, Response, deviatoric_tangent, elastic_energy_deviatoric,
    elastic_energy_volumetric, pressure, return_mapping,
};

/// A deformation gradient or displacement gradient: rows are components, columns the direction of
/// the derivative.
type Gradient = [[f64; 3]; 3];

/// The point after one step. Stresses and energies are in the unit of the material's moduli.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointRecord {
    /// Counted from 0, the undeformed state.
    pub step: usize,
    /// F.
    pub deformation_gradient: Gradient,
    /// Cauchy stress, `[xx, yy, zz, xy, yz, zx]`.
    pub cauchy: [f64; 6],
    /// sqrt(3/2) |dev sigma|, of the Cauchy stress.
    pub von_mises: f64,
    /// Equivalent plastic strain.
    pub alpha: f64,
    /// Plastic work per reference volume, the integral of sigma d alpha.
    pub plastic_work: f64,
    /// U(J) + W(b_e_bar), energy per reference volume.
    pub elastic_energy: f64,
}

/// A point and its history.
#[derive(Clone, Debug)]
pub struct MaterialPoint {
    material: Material<f64>,
    state: PointState<f64>,
    /// F - I.
    displacement_gradient: Gradient,
    step: usize,
}

impl MaterialPoint {
    /// A virgin, undeformed point.
    pub fn new(material: Material<f64>) -> Self {
        Self { material, state: PointState::default(), displacement_gradient: Gradient::default(), step: 0 }
    }

    /// The undeformed point, as step 0.
    pub fn start(&self) -> PointRecord {
        self.record(&[0.0; 6])
    }

    /// Deforms the point to F, given as F - I, in one step.
    ///
    /// # Errors
    /// [`MaterialError`]; the point then is as before.
    pub fn advance(&mut self, displacement_gradient: &Gradient) -> Result<PointRecord, MaterialError> {
        let step = self.step + 1;
        let determinant = 1.0 + determinant_minus_one(displacement_gradient);
        // A NaN is refused too.
        if !(determinant > 0.0 && determinant.is_finite()) {
            return Err(MaterialError::Gradient { step, determinant });
        }
        let relative = relative(displacement_gradient, &self.displacement_gradient);
        let response =
            return_mapping(&self.material, &relative, &self.state).map_err(|source| MaterialError::Point { step, source })?;
        self.state = response.state;
        self.displacement_gradient = *displacement_gradient;
        self.step = step;
        Ok(self.record(&response.stress))
    }

    /// Stretches the point along x to the logarithmic strain `axial`, counted from the undeformed
    /// state, with the sides free of stress. F has to be diagonal with equal sides so far.
    ///
    /// The lateral strain is the root of the lateral Kirchhoff stress, by Newton's iteration on the
    /// consistent tangent (exact here: dev n^2 is parallel to n in uniaxial stress).
    ///
    /// # Errors
    /// [`MaterialError`]; the point then is as before.
    pub fn stretch(&mut self, axial: f64) -> Result<PointRecord, MaterialError> {
        let step = self.step + 1;
        let before = self.displacement_gradient;
        let (axial_before, lateral_before) = (before[0][0].ln_1p(), before[1][1].ln_1p());
        let increment = axial - axial_before;
        let relative = |lateral: f64| diagonal(increment.exp_m1(), lateral.exp_m1());
        let stress = |lateral: f64| -> Result<(f64, f64), PointError> {
            let response = return_mapping(&self.material, &relative(lateral), &self.state)?;
            Ok(self.lateral_stress(&response, axial + 2.0 * (lateral_before + lateral)))
        };
        // From -increment/2, which keeps the volume, this far each way.
        let reach = 0.5 + increment.abs();
        let middle = -0.5 * increment;
        let root = increasing_root(middle - reach, middle + reach, middle, |lateral| stress(lateral).unwrap_or((f64::NAN, 1.0)));
        let (value, derivative) = stress(root).map_err(|source| MaterialError::Point { step, source })?;
        let root = if derivative > 0.0 { root - value / derivative } else { root };
        let target = diagonal(axial.exp_m1(), (lateral_before + root).exp_m1());
        let after = return_mapping(&self.material, &relative(root), &self.state)
            .map_err(|source| MaterialError::Point { step, source })?;
        let elasticity = &self.material.elasticity;
        // From F as it is kept: a lateral stretch so small that F - I does not hold it is refused
        // here too.
        let j = determinant_minus_one(&target);
        let lateral_stress = after.stress[1] + (1.0 + j) * pressure(elasticity, j).0;
        let youngs_modulus = 9.0 * elasticity.bulk * elasticity.shear / (3.0 * elasticity.bulk + elasticity.shear);
        let residual = lateral_stress / youngs_modulus;
        if residual.is_nan() || residual.abs() > 1e-9 {
            return Err(MaterialError::Lateral { step, residual });
        }
        self.advance(&target)
    }

    /// The lateral Kirchhoff stress at ln J, and its derivative with respect to the logarithmic
    /// lateral strain.
    fn lateral_stress(&self, response: &Response<f64>, log_jacobian: f64) -> (f64, f64) {
        let j = log_jacobian.exp_m1();
        let jacobian = 1.0 + j;
        let (first, second) = pressure(&self.material.elasticity, j);
        let c = deviatoric_tangent(response);
        let volumetric = 2.0 * jacobian * (first + jacobian * second);
        (response.stress[1] + jacobian * first, c[1][1] + c[1][2] + 2.0 * response.stress[1] + volumetric)
    }

    fn record(&self, deviator: &[f64; 6]) -> PointRecord {
        let elasticity = &self.material.elasticity;
        let hardening = &self.material.hardening;
        let h = &self.displacement_gradient;
        let j = determinant_minus_one(h);
        let (pressure, _) = pressure(elasticity, j);
        let stress = deviator.map(|s| s / (1.0 + j));
        let [xx, yy, zz, xy, yz, zx] = stress;
        let alpha = self.state.alpha;
        PointRecord {
            step: self.step,
            deformation_gradient: std::array::from_fn(|i| std::array::from_fn(|k| h[i][k] + if i == k { 1.0 } else { 0.0 })),
            cauchy: [xx + pressure, yy + pressure, zz + pressure, xy, yz, zx],
            von_mises: (1.5 * super::j2::norm_squared(&stress)).sqrt(),
            alpha,
            plastic_work: hardening.plastic_work(alpha, hardening.flow_stress(alpha)),
            elastic_energy: elastic_energy_volumetric(elasticity, j) + elastic_energy_deviatoric(elasticity, &self.state.be),
        }
    }
}

/// What one step of a path asks of the point.
#[derive(Clone, Copy, Debug)]
enum StepTarget {
    /// The logarithmic strain along x, with free sides.
    Stretch(f64),
    /// F - I.
    Deform(Gradient),
}

/// The records of a path, from the undeformed point on; the last item is the error of a step that
/// has no answer.
fn drive(
    material: &Material<f64>,
    targets: impl IntoIterator<Item = StepTarget>,
) -> impl Iterator<Item = Result<PointRecord, MaterialError>> {
    let mut point = MaterialPoint::new(material.clone());
    let mut failed = false;
    let start = Ok(point.start());
    let steps = targets.into_iter().map_while(move |target| {
        if failed {
            return None;
        }
        let record = match target {
            StepTarget::Stretch(axial) => point.stretch(axial),
            StepTarget::Deform(gradient) => point.advance(&gradient),
        };
        failed = record.is_err();
        Some(record)
    });
    std::iter::once(start).chain(steps)
}

/// Uniaxial stress along x to the logarithmic strain `strain` (negative: compression) in `steps`
/// equal steps; the sides are free. The first record is the undeformed point; after the error of a
/// step the iterator ends.
pub fn uniaxial(material: &Material<f64>, strain: f64, steps: usize) -> impl Iterator<Item = Result<PointRecord, MaterialError>> {
    drive(material, (1..=steps).map(move |step| StepTarget::Stretch(strain * (step as f64 / steps as f64))))
}

/// Simple shear F = I + gamma e_x (x) e_y to gamma = `strain` in `steps` equal steps. The first
/// record is the undeformed point; after the error of a step the iterator ends.
pub fn simple_shear(
    material: &Material<f64>,
    strain: f64,
    steps: usize,
) -> impl Iterator<Item = Result<PointRecord, MaterialError>> {
    let targets = (1..=steps).map(move |step| {
        let mut gradient = Gradient::default();
        gradient[0][1] = strain * (step as f64 / steps as f64);
        StepTarget::Deform(gradient)
    });
    drive(material, targets)
}

/// Through the deformation gradients F of `path`, one step each. The first record is the undeformed
/// point; after the error of a step the iterator ends.
pub fn along(
    material: &Material<f64>,
    path: impl IntoIterator<Item = Gradient>,
) -> impl Iterator<Item = Result<PointRecord, MaterialError>> {
    let targets = path.into_iter().map(|gradient| {
        let identity = |i: usize, k: usize| if i == k { 1.0 } else { 0.0 };
        StepTarget::Deform(std::array::from_fn(|i| std::array::from_fn(|k| gradient[i][k] - identity(i, k))))
    });
    drive(material, targets)
}

fn diagonal(axial: f64, lateral: f64) -> Gradient {
    [[axial, 0.0, 0.0], [0.0, lateral, 0.0], [0.0, 0.0, lateral]]
}

/// f - I = (H - H_n) (I + H_n)^-1.
fn relative(new: &Gradient, old: &Gradient) -> Gradient {
    let [[a, b, c], [d, e, f], [g, h, i]] = *old;
    let (a, e, i) = (1.0 + a, 1.0 + e, 1.0 + i);
    let determinant = 1.0 + determinant_minus_one(old);
    let adjugate = [
        [e * i - f * h, c * h - b * i, b * f - c * e],
        [f * g - d * i, a * i - c * g, c * d - a * f],
        [d * h - e * g, b * g - a * h, a * e - b * d],
    ];
    std::array::from_fn(|r| {
        std::array::from_fn(|k| (0..3).map(|m| (new[r][m] - old[r][m]) * adjugate[m][k]).sum::<f64>() / determinant)
    })
}
