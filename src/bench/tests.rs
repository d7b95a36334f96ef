use super::input::{laws, material_points, models, side_by_side, squeezed};
use super::report::On;
use super::timing::Patience;
use super::traffic::Sizes;
use super::*;
use crate::compute::Evaluated;
use crate::compute::cpu::Cpu;
use crate::compute::handle::at;
use crate::material::{FlowStress, return_mapping};
use crate::real::Real;

/// So small that debug builds do it in a second.
fn options() -> Options {
    let patience = Patience { least: 1, most: 1, seconds: 0.0, enough: 0.0 };
    Options { batches: vec![1, 2], points: 64, copied: 1 << 20, patience, ..Options::quick(BenchDevice::Cpu, 2) }
}

#[test]
fn every_point_yields_and_input_is_the_same_in_every_run() {
    fn check<R: Real>() {
        for (name, material) in laws::<R>().unwrap() {
            let points = material_points(&material, 200);
            assert_eq!(points, material_points(&material, 200), "{name}");
            let yields = |p: &input::BenchPoint<R>| return_mapping(&material, &p.relative, &p.state).unwrap().yielding;
            let elastic = matches!(material.hardening, FlowStress::Elastic);
            assert!(points.iter().all(|p| yields(p) != elastic), "{name}");
            assert_eq!(side_by_side(&points).len(), 25);
            assert_eq!(side_by_side(&points)[3].relative[1][2].0[5], points[29].relative[1][2]);
        }
    }
    check::<f64>();
    check::<f32>();
}

/// The squeeze yields at every quadrature point of every case, and so does what a commit adds.
#[test]
fn every_quadrature_point_of_a_batch_yields() {
    let mesh = input::mesh(4).unwrap();
    let models = models(&mesh, 3).unwrap();
    let mut cpu = Cpu::<f64>::new(models.clone()).unwrap();
    for (case, model) in models.iter().enumerate() {
        let mut before = at(&mut cpu, case).state().unwrap();
        for strain in [0.02, 0.0201] {
            let (_, outcome) = at(&mut cpu, case).commit(&squeezed(&model.mesh, strain)).unwrap();
            assert_eq!(outcome, Evaluated::Valid);
            let after = at(&mut cpu, case).state().unwrap();
            let alphas = |s: &crate::compute::CaseState| s.points.iter().flatten().map(|p| p.alpha).collect::<Vec<_>>();
            assert!(alphas(&before).iter().zip(alphas(&after)).all(|(a, b)| b > *a), "case {case} at {strain}");
            before = after;
        }
    }
    assert!(models[0].material != models[1].material && models[0].mesh.nodes != models[1].mesh.nodes);
}

#[test]
fn every_evaluation_has_its_rows_and_numbers() {
    let options = options();
    let mut said = Vec::new();
    let report = run(&options, &mut |text: &str| said.push(text.to_owned())).unwrap();
    assert!(report.header.adapter.is_none() && report.header.no_device.is_none());
    // seven laws and four evaluations, in two precisions, two batches, on one core and all
    assert_eq!(report.rows.len(), (7 + 4) * 2 * 2 * 2);
    for row in &report.rows {
        let m = row.measured().unwrap();
        let numbers = [m.items_per_s, m.bytes_per_s, m.operations_per_s, m.share_of_copy, m.call.median_ms, m.call.first_ms];
        assert!(numbers.iter().all(|x| x.is_finite() && *x > 0.0), "{row:?}");
        assert!(row.on != On::Device && row.items % row.batch == 0 && row.bytes > 0 && row.operations > 0);
    }
    // A case of a batch costs what it costs alone, and f32 moves about half of the bytes for the
    // same operations.
    let of = |evaluation: &str, law: &str, precision: &str, batch: usize| {
        let mut rows = report.rows.iter();
        let row = rows.find(|r| (r.evaluation, r.law, r.precision, r.batch) == (evaluation, law, precision, batch)).unwrap();
        (row.bytes as f64, row.operations as f64)
    };
    for (evaluation, law) in
        [("return mapping", "linear"), ("tangent", "power"), ("internal force", "power"), ("commit", "power")]
    {
        let (one, two, single) = (of(evaluation, law, "f64", 1), of(evaluation, law, "f64", 2), of(evaluation, law, "f32", 1));
        assert!(two.0 == 2.0 * one.0 && (two.1 / one.1 - 2.0).abs() < 1e-3, "{evaluation}");
        assert!((0.45..0.75).contains(&(single.0 / one.0)) && single.1 == one.1, "{evaluation}: {single:?} {one:?}");
    }
    let table = table::table(&report);
    assert!(table.contains("rows are the CPU's") && table.lines().filter(|l| l.starts_with('|')).count() == 2 + 44, "{table}");
}

#[test]
fn bytes_are_those_of_the_arrays() {
    let sizes = Sizes { nodes: 10, elements: 2, contact_points: 3, blocks: 100 };
    use crate::compute::gpu::Evaluation;
    // contact: weight, friction's symmetry flag, gap, six numbers there, 21 back, a status
    assert!(sizes.on_device(Evaluation::Contact, 8) >= 3 * 8 * (2 + 6 + 21));
    // the tangent's blocks alone are 55 upper ones of nine numbers
    let [wide, narrow] = [8, 4].map(|word| sizes.on_device(Evaluation::Tangent, word));
    assert!(wide > 8 * 9 * 55 && wide < 2 * narrow && narrow < wide);
    assert!(wide > sizes.on_device(Evaluation::InternalForce, 8));
    assert_eq!(traffic::point_on_device(8), 8 * (9 + 7 + 30 + 36) + 4);
    assert_eq!(traffic::point_on_cpu(4), 4 * (9 + 7 + 6 + 7 + 36));
}
