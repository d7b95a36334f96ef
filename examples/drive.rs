use asperity::compute::{Compute, cpu::Cpu};
use asperity::simulation::drive::*;
use asperity::simulation::problem::Problem;
struct O {
    case: asperity::case::Case,
    t: std::time::Instant,
}
impl Observer for O {
    fn step(&mut self, v: &mut StepView<'_>) -> Result<(), Box<dyn std::error::Error + Send + Sync>> {
        let r = v.record;
        let (e, l) = (self.case.material.youngs_modulus, self.case.sphere.radius);
        let f = e * l * l;
        println!(
            "{:3} {} h {:.6} d {:.6} FN {:10.5} FT {:9.5} ratio {:.4} a {:.5} am {:.5} c {:.4} it {} kr {} cut {} m {:.1e} n {}/{} W {:.4e} {:.4e} {:.4e} {:.4e} t {:.1}",
            r.step,
            r.segment,
            r.h,
            r.delta_t,
            r.f_n * f,
            r.f_t * f,
            r.f_t / r.f_n,
            r.a,
            r.a_moment,
            r.stick_radius,
            r.newton_iterations,
            r.krylov_iterations,
            r.cutbacks,
            r.merit,
            r.slipping_points,
            r.contact_points,
            r.work_external * f,
            r.energy_elastic * f,
            r.work_plastic * f,
            r.work_friction * f,
            self.t.elapsed().as_secs_f64()
        );
        Ok(())
    }
    fn note(&mut self, t: &str) {
        println!("NOTE {t}");
    }
}
fn main() {
    env_logger::init();
    let args: Vec<String> = std::env::args().collect();
    let sets: Vec<String> = args[2..].to_vec();
    let case = asperity::case::Case::load(std::path::Path::new(&args[1]), &sets).unwrap_or_else(|e| {
        eprintln!("{e}");
        std::process::exit(2)
    });
    let p = Problem::new(&case).unwrap();
    println!(
        "elements {} nodes {} contact {} levels {} a_pred {}",
        p.model.mesh.elements.len(),
        p.model.mesh.nodes.len(),
        p.model.mesh.contact_nodes.len(),
        p.model.mesh.hierarchy.len(),
        p.predicted_contact_radius
    );
    let mut b: Cpu<f64> = Cpu::new(vec![p.model.clone()]).unwrap();
    println!("{:?}", b.description());
    let n = p.newton().unwrap();
    let mut d = Drive::new(&p, &mut b, 0, n);
    let r = d.run(&mut O { case, t: std::time::Instant::now() });
    println!("{:?} full slip {:?}", r, d.full_slip());
}
