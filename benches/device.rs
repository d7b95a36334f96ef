//! Times of the evaluations on CPU and device, and of the device's first ones, which compile the kernels.
//!
//! `cargo bench --bench device` takes a mesh of 16 elements a contact radius; with `-- --test` one of 4, once each. An empty
//! `MESA_SHADER_CACHE_DIR` shows what compiling costs on software Vulkan.

use asperity::case::Case;
use asperity::compute::cpu::Cpu;
use asperity::compute::gpu::{DeviceReal, DeviceRequest, Gpu, GpuContext};
use asperity::compute::handle::{CaseHandle, Evaluate};
use asperity::compute::{CaseModel, Compute};
use asperity::contact::coulomb::{Friction, Point, contact_rows};
use asperity::mesh::pattern::Pattern;
use asperity::simulation::problem::Problem;
use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

/// Milliseconds of the first call and the least of those after it, for force, contact, tangent and commit.
fn times(backend: &mut dyn Compute, model: &CaseModel, repeats: usize) -> [[f64; 2]; 4] {
    let mesh = &model.mesh;
    // squeezed by 2 % against the plane: plastic everywhere
    let squeeze = |s: f64| -> Vec<f64> { mesh.nodes.iter().flat_map(|x| [0.0, 0.0, -s * x[2]]).collect() };
    let mut force = vec![0.0; 3 * mesh.nodes.len()];
    let mut blocks = vec![[0.0; 9]; Pattern::from_elements(mesh.nodes.len(), &mesh.elements).entries()];
    let none = Point { force: [0.0; 3], gap: 0.0, slip: [0.0; 2], weight: 0.0, on_symmetry_plane: false };
    let mut rows = vec![contact_rows(Friction::Coulomb(0.0), &none); mesh.contact_nodes.len()];
    let mut out = [[0.0, f64::INFINITY]; 4];
    let mut case = CaseHandle { backend, case: 0 };
    for i in 0..=repeats {
        let u = squeeze(0.02 + 1e-4 * i as f64);
        for (kind, out) in out.iter_mut().enumerate() {
            let start = Instant::now();
            match kind {
                0 => drop(case.internal_force(&u, &mut force)),
                1 => drop(case.contact(&u, &force, &mut rows)),
                2 => drop(case.tangent(&u, &mut blocks)),
                _ => drop(case.commit(&u)),
            }
            let ms = 1e3 * start.elapsed().as_secs_f64();
            if i == 0 { out[0] = ms } else { out[1] = out[1].min(ms) }
        }
    }
    out
}

fn report(name: &str, times: [[f64; 2]; 4]) {
    for (kind, [first, later]) in ["force", "contact", "tangent", "commit"].into_iter().zip(times) {
        println!("{name:30} {kind:8} first {first:9.1} ms   later {later:9.2} ms");
    }
}

fn on_device<R: DeviceReal>(context: &Arc<GpuContext>, model: &CaseModel, repeats: usize) {
    let start = Instant::now();
    match Gpu::<R>::new(context.clone(), vec![model.clone()]) {
        Ok(mut backend) => {
            println!("{:30} set-up {:.0} ms", R::NAME, 1e3 * start.elapsed().as_secs_f64());
            let name = format!("{} {}", context.adapter().name, R::NAME);
            report(&name, times(&mut backend, model, repeats));
        }
        Err(error) => println!("{}: {error}", R::NAME),
    }
}

fn main() {
    let quick = std::env::args().any(|a| a == "--test");
    let (elements, repeats) = if quick { (4, 1) } else { (16, 5) };
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/cases/power.toml");
    let problem = Case::load(&file, &[format!("mesh.elements_per_contact_radius={elements}")]).map(|case| Problem::new(&case));
    let Ok(Ok(problem)) = problem else { return eprintln!("{} makes no problem", file.display()) };
    let model = &problem.model;
    println!("{} elements, {} contact points", model.mesh.elements.len(), model.mesh.contact_nodes.len());
    match Cpu::<f64>::new(vec![model.clone()]) {
        Ok(mut cpu) => report(&format!("{} f64", cpu.description().device), times(&mut cpu, model, repeats)),
        Err(error) => println!("CPU f64: {error}"),
    }
    match Cpu::<f32>::new(vec![model.clone()]) {
        Ok(mut cpu) => report(&format!("{} f32", cpu.description().device), times(&mut cpu, model, repeats)),
        Err(error) => println!("CPU f32: {error}"),
    }
    match GpuContext::open(DeviceRequest::Gpu) {
        // as in a release build
        Ok(Some(context)) => {
            let context = Arc::new(context.with_checks(false));
            on_device::<f64>(&context, model, repeats);
            on_device::<f32>(&context, model, repeats);
        }
        Ok(None) => println!("no device"),
        Err(error) => println!("{error}"),
    }
}
