//! What a step shows: contact pressure and stresses at the end of a press: `cargo
//! run --release --example fields`.

use asperity::case::Segment;
use asperity::output::ContactStatus;
use asperity::{Case, Simulation};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut case = Case::load("fixtures/cases/ideal.toml".as_ref(), &[])?;
    case.mesh = case.mesh.uniform(5);
    case.solver.error_estimate = false;
    case.path = vec![Segment::Indentation { indentation: 0.01 }];

    let mut simulation = Simulation::new(&case)?;
    simulation.run()?;
    let mut closed: Vec<_> = simulation.contact().into_iter().filter(|point| point.status != ContactStatus::Open).collect();
    closed.sort_by(|a, b| a.reference_x.hypot(a.reference_y).total_cmp(&b.reference_x.hypot(b.reference_y)));
    println!("     r  pressure  status");
    for point in closed.iter().step_by(8) {
        println!("{:.4}  {:8.1}  {:?}", point.reference_x.hypot(point.reference_y), point.pressure, point.status);
    }
    let force: f64 = closed.iter().map(|point| point.pressure * point.area).sum();
    println!("sum of pressure times area {force:.3}, F_N {:.3}", simulation.history().last().map_or(0.0, |row| row.f_n));

    let fields = simulation.fields()?.ok_or("no step was taken")?;
    let plastic = fields.alpha.iter().filter(|alpha| **alpha > 0.0).count();
    let largest = fields.mises.iter().copied().fold(0.0, f64::max);
    println!("{plastic} of {} elements have yielded; largest Mises stress {largest:.1}", fields.elements.len());
    Ok(())
}
