//! Uniaxial stress to finite strain against the exact curve of every law, shear, and reversal.

use super::*;
use crate::material::MaterialError;
use crate::material::point::{self, MaterialPoint, PointRecord, along, simple_shear};

fn uniaxial(material: &Material<f64>, strain: f64, steps: usize) -> Result<Vec<PointRecord>, MaterialError> {
    point::uniaxial(material, strain, steps).collect()
}

/// a of b_e_bar = diag(a, a^-1/2, a^-1/2) in uniaxial stress: mu (a - a^-1/2) = sigma.
fn elastic_stretch(material: &Material<f64>, stress: f64) -> f64 {
    let shear = material.elasticity.shear;
    let mut a = 1.0_f64;
    for _ in 0..50 {
        let root = a.sqrt();
        a -= (shear * (a - 1.0 / root) - stress) / (shear * (1.0 + 0.5 / (a * root)));
    }
    a
}

/// d eps_p/d alpha = (a + 2 a^-1/2)/(2 a + a^-1/2), from L_v b_e_bar = -2/3 gamma tr(b_e_bar) n: 1
/// but for the elastic strain.
fn plastic_rate(material: &Material<f64>, stress: f64) -> f64 {
    let a = elastic_stretch(material, stress);
    let lateral = 1.0 / a.sqrt();
    (a + 2.0 * lateral) / (2.0 * a + lateral)
}

/// The exact solution at the end of monotonic uniaxial tension with equivalent plastic strain
/// `alpha`: logarithmic strain and axial Kirchhoff stress, with J from J U'(J) = sigma/3.
fn exact(material: &Material<f64>, alpha: f64) -> (f64, f64) {
    // Midpoints in t with alpha = end t^4, for the infinite slope of power laws at 0.
    let n = 4000;
    let plastic: f64 = (0..n)
        .map(|i| {
            let t = (f64::from(i) + 0.5) / f64::from(n);
            let stress = material.hardening.flow_stress(alpha * t.powi(4));
            plastic_rate(material, stress) * alpha * 4.0 * t.powi(3) / f64::from(n)
        })
        .sum();
    let stress = material.hardening.flow_stress(alpha);
    let jacobian = (1.0 + 2.0 * stress / (3.0 * material.elasticity.bulk)).sqrt();
    (0.5 * elastic_stretch(material, stress).ln() + plastic + jacobian.ln() / 3.0, stress)
}

fn kirchhoff(record: &PointRecord) -> f64 {
    let f = &record.deformation_gradient;
    record.cauchy[0] * f[0][0] * f[1][1] * f[2][2]
}

#[test]
fn every_law_follows_its_exact_curve() {
    for (name, hardening) in laws::<f64>().into_iter().skip(1) {
        let material = material(hardening);
        for alpha in [1e-3, 0.1, 1.0] {
            let (strain, stress) = exact(&material, alpha);
            let errors: Vec<(f64, f64)> = [10, 100, 1000]
                .map(|steps| {
                    let last = *uniaxial(&material, strain, steps).unwrap().last().unwrap();
                    assert!(last.cauchy[1..].iter().all(|s| s.abs() < 1e-15), "{name}: {:?}", last.cauchy);
                    ((kirchhoff(&last) / stress - 1.0).abs(), (last.alpha / alpha - 1.0).abs())
                })
                .into();
            let context = format!("{name} to {strain}: {errors:?}");
            // The return overshoots by half a strain increment, relatively, and no more.
            for (error, steps) in errors.iter().zip([10.0, 100.0, 1000.0]) {
                assert!(error.1 < 0.55 * strain / steps + 1e-6 && error.0 <= error.1 + 1e-6, "{context}");
            }
            // First order or better: ten times the steps, a tenth of the error, until rounding and
            // the quadrature.
            for (coarse, fine) in errors.iter().zip(&errors[1..]) {
                assert!(fine.1 < 0.15 * coarse.1 + 3e-7, "{context}");
                assert!(fine.0 < 0.15 * coarse.0 + 3e-7, "{context}");
            }
        }
    }
}

#[test]
fn small_strain_limit_is_the_textbook() {
    // E -> infinity at fixed sigma: alpha = eps - sigma/E, and compression mirrors tension.
    let material = material(FlowStress::linear(2e-6, 1e-5).unwrap());
    for strain in [3e-6, 1e-4, 0.01] {
        let pull = *uniaxial(&material, strain, 500).unwrap().last().unwrap();
        let alpha = (strain - 2e-6) / (1.0 + 1e-5);
        assert!((pull.alpha / alpha - 1.0).abs() < 1e-4, "{} {alpha}", pull.alpha);
        assert!((pull.cauchy[0] / (2e-6 + 1e-5 * alpha) - 1.0).abs() < 1e-5);
        let push = *uniaxial(&material, -strain, 500).unwrap().last().unwrap();
        assert!((push.cauchy[0] / pull.cauchy[0] + 1.0).abs() < 1e-5);
    }
    // Hooke below yield: sigma = E eps, lateral strain -nu eps.
    let elastic = *uniaxial(&material, 1e-6, 3).unwrap().last().unwrap();
    assert_eq!(elastic.alpha, 0.0);
    assert!((elastic.cauchy[0] / 1e-6 - 1.0).abs() < 3e-6);
    assert!(((elastic.deformation_gradient[1][1] - 1.0) / -0.3e-6 - 1.0).abs() < 1e-5);
    assert!((elastic.elastic_energy / 0.5e-12 - 1.0).abs() < 1e-5);
}

#[test]
fn reversal_yields_at_the_opposite_stress() {
    let material = material(FlowStress::linear(2e-3, 0.05).unwrap());
    let mut point = MaterialPoint::new(material.clone());
    for step in 1..=20 {
        point.stretch(0.005 * f64::from(step)).unwrap();
    }
    let top = point.stretch(0.101).unwrap();
    let reached = kirchhoff(&top);
    assert!((reached - material.hardening.flow_stress(top.alpha)).abs() < 1e-15);
    // Back in small steps: elastic until the stress is the opposite one.
    let (mut last, mut step) = (top, 0);
    let yielded = loop {
        step += 1;
        let now = point.stretch(0.101 - 2e-5 * f64::from(step)).unwrap();
        if now.alpha > top.alpha {
            break now;
        }
        last = now;
        assert!(step < 2000, "never yielded in reverse");
    };
    assert!(kirchhoff(&last) < 0.0);
    assert!((kirchhoff(&yielded) / -reached - 1.0).abs() < 4e-3, "{} {reached}", kirchhoff(&yielded));
    assert!((kirchhoff(&last) / -reached - 1.0).abs() < 4e-3, "{} {reached}", kirchhoff(&last));
    assert!((-kirchhoff(&yielded) - material.hardening.flow_stress(yielded.alpha)).abs() < 1e-15);
}

#[test]
fn work_is_conserved() {
    // External work = elastic energy + dissipation; plastic work counts sigma d alpha, dissipation
    // sigma d eps_p.
    for (name, hardening) in laws::<f64>() {
        let material = material(hardening);
        let records = uniaxial(&material, 0.2, 2000).unwrap();
        let external: f64 = records
            .windows(2)
            .map(|pair| {
                let strain = |r: &PointRecord| r.deformation_gradient[0][0].ln();
                0.5 * (kirchhoff(&pair[0]) + kirchhoff(&pair[1])) * (strain(&pair[1]) - strain(&pair[0]))
            })
            .sum();
        let last = records.last().unwrap();
        let shortfall: f64 = records
            .windows(2)
            .map(|pair| {
                let stress = 0.5 * (kirchhoff(&pair[0]) + kirchhoff(&pair[1]));
                (plastic_rate(&material, stress) - 1.0) * (pair[1].plastic_work - pair[0].plastic_work)
            })
            .sum();
        let stored = last.elastic_energy + last.plastic_work + shortfall;
        assert!((stored / external - 1.0).abs() < 1e-4, "{name}: {stored} {external}");
    }
}

#[test]
fn simple_shear_stays_on_the_yield_surface_and_counts_its_rotation() {
    let material = material(FlowStress::ideal(2e-3).unwrap());
    let records: Vec<PointRecord> = simple_shear(&material, 1.0, 500).map(Result::unwrap).collect();
    assert_eq!(records.len(), 501);
    let last = records.last().unwrap();
    assert!((last.von_mises - 2e-3).abs() < 1e-15);
    // Rigid-plastic: tau = sigma_Y/sqrt(3), alpha = gamma/sqrt(3), no pressure.
    assert!((last.cauchy[3] / (2e-3 / 3.0_f64.sqrt()) - 1.0).abs() < 1e-4, "{:?}", last.cauchy);
    assert!((last.alpha * 3.0_f64.sqrt() - 1.0).abs() < 5e-3, "{}", last.alpha);
    assert!((last.cauchy[0] + last.cauchy[1] + last.cauchy[2]).abs() < 1e-15);
    // The same through a given path.
    let path = records[1..].iter().map(|r| r.deformation_gradient);
    let again: Vec<PointRecord> = along(&material, path).map(Result::unwrap).collect();
    assert!((again[500].alpha - last.alpha).abs() < 1e-12 && again[500].step == 500);
}

#[test]
fn huge_steps_have_answers() {
    for (name, hardening) in laws::<f64>() {
        let material = material(hardening);
        for strain in [0.5, -0.5, 1.5] {
            let last = *uniaxial(&material, strain, 1).unwrap().last().unwrap();
            if name != "elastic" {
                let flow = material.hardening.flow_stress(last.alpha);
                assert!((kirchhoff(&last).abs() / flow - 1.0).abs() < 1e-12, "{name} {strain}");
                // First order in a step far beyond its range: the right size, no more.
                assert!(last.alpha > 0.3 * strain.abs() && last.alpha < 3.0 * strain.abs(), "{name} {strain}: {}", last.alpha);
            }
        }
    }
}

#[test]
fn impossible_paths_name_the_step() {
    let material = material(FlowStress::ideal(2e-3).unwrap());
    let mirrored = [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let mut answers = along(&material, [IDENTITY, mirrored, IDENTITY]);
    assert!(answers.next().unwrap().is_ok() && answers.next().unwrap().is_ok());
    assert_eq!(answers.next(), Some(Err(MaterialError::Gradient { step: 2, determinant: -1.0 })));
    assert_eq!(answers.next(), None);
    let error = along(&material, [[[f64::NAN; 3]; 3]]).last().unwrap().unwrap_err();
    assert!(error.to_string().starts_with("step 1"), "{error}");
    // Strains without a finite stretch.
    for strain in [f64::NAN, 800.0, -800.0] {
        assert!(uniaxial(&material, strain, 1).is_err(), "{strain}");
    }
    // A lateral stretch that F - I no longer holds is refused, not answered.
    for record in point::uniaxial(&material, 1000.0, 100).map_while(Result::ok) {
        assert!(record.cauchy[1].abs() < 1e-9 && (record.von_mises / record.cauchy[0] - 1.0).abs() < 1e-5 || record.step == 0);
    }
}
