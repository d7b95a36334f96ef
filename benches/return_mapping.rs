//! Points per second of the material kernel on one core: return mapping and consistent tangent,
//! every point yielding, eight side by side as the element calls it and one at a time.
//!
//! `cargo bench --bench return_mapping`: by processor time, so that other work on the machine
//! counts less.

use std::hint::black_box;

use asperity::internals::bench::input::{laws, material_points, side_by_side};
use asperity::internals::bench::material::{EightAnswers, map};
use asperity::internals::real::Real;
use asperity::material::{Material, deviatoric_tangent, return_mapping};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use processor::Processor;

mod processor;

const POINTS: usize = 4096;

fn bench_law<R: Real>(criterion: &mut Criterion<Processor>, name: &str, material: &Material<R>) {
    let points = material_points(material, POINTS);
    let groups = side_by_side(&points);
    // Used up at once, as the element does: memory is not what is measured.
    let mut answers = [EightAnswers::default(); 8];
    let mut group = criterion.benchmark_group(format!("{}/{name}", R::NAME));
    group.throughput(Throughput::Elements(POINTS as u64));
    group.bench_function("eight side by side", |bencher| {
        bencher.iter(|| {
            for groups in black_box(&groups).chunks(answers.len()) {
                map(material, groups, &mut answers);
                black_box(&mut answers);
            }
        });
    });
    group.bench_function("one at a time", |bencher| {
        bencher.iter(|| {
            for p in black_box(&points) {
                if let Ok(response) = return_mapping(material, &p.relative, &p.state) {
                    black_box(deviatoric_tangent(&response));
                    black_box(response.state);
                }
            }
        });
    });
    group.finish();
}

fn every_law<R: Real>(criterion: &mut Criterion<Processor>) {
    match laws::<R>() {
        Ok(laws) => laws.iter().for_each(|(name, material)| bench_law::<R>(criterion, name, material)),
        Err(error) => panic!("{error}"),
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().with_measurement(Processor).sample_size(20).warm_up_time(std::time::Duration::from_millis(300)).measurement_time(std::time::Duration::from_secs(1));
    targets = every_law::<f64>, every_law::<f32>
}
criterion_main!(benches);
