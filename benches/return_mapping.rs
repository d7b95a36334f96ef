//! Points per second of the material kernel on one core: return mapping and deviatoric tangent, every point yielding.
//!
//! `cargo bench --bench return_mapping`

use std::hint::black_box;

use asperity::material::{Elasticity, Hardening, Material, PointState, deviatoric_tangent, return_mapping};
use asperity::real::Real;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

const POINTS: usize = 4096;

type Point<R> = ([[R; 3]; 3], PointState<R>);

/// Committed states after a random plastic step of 1 %, and the next step of 1 %: plastic again in all but the elastic law.
fn points<R: Real>(material: &Material<R>) -> Vec<Point<R>> {
    let mut random = ChaCha8Rng::seed_from_u64(1);
    let mut points = Vec::with_capacity(POINTS);
    while points.len() < POINTS {
        let d: [[R; 3]; 3] = std::array::from_fn(|_| std::array::from_fn(|_| R::of(0.01 * random.random_range(-1.0..1.0))));
        let Ok(first) = return_mapping(material, &d, &PointState::default()) else { continue };
        // On along the same direction: still loading.
        if return_mapping(material, &d, &first.state).is_ok_and(|next| next.yielding == first.yielding) {
            points.push((d, first.state));
        }
    }
    points
}

fn bench_law<R: Real>(criterion: &mut Criterion, name: &str, hardening: Hardening<R>) {
    let material = Material { elasticity: Elasticity::new(1.0, 0.3), hardening };
    let points = points(&material);
    let mut group = criterion.benchmark_group(format!("{}/{name}", R::NAME));
    group.throughput(Throughput::Elements(POINTS as u64));
    group.bench_function("stress", |bencher| {
        bencher.iter(|| {
            for (d, state) in black_box(&points) {
                black_box(return_mapping(&material, d, state).ok());
            }
        });
    });
    group.bench_function("stress and tangent", |bencher| {
        bencher.iter(|| {
            for (d, state) in black_box(&points) {
                if let Ok(response) = return_mapping(&material, d, state) {
                    black_box(deviatoric_tangent(&response));
                    black_box(response.state);
                }
            }
        });
    });
    group.finish();
}

fn every_law<R: Real>(criterion: &mut Criterion) {
    let built = [
        ("elastic", Ok(Hardening::Elastic)),
        ("ideal", Hardening::ideal(2e-3)),
        ("linear", Hardening::linear(2e-3, 0.05)),
        ("power", Hardening::power(2e-3, 5e-3, 0.3)),
        ("hollomon", Hardening::hollomon(0.02, 3.0, 1.0)),
        ("voce", Hardening::voce(2e-3, 5e-3, 20.0)),
        ("table", Hardening::table(&[[0.0, 2e-3], [0.01, 3e-3], [0.05, 3.5e-3], [0.3, 5e-3]])),
    ];
    for (name, hardening) in built {
        match hardening {
            Ok(hardening) => bench_law::<R>(criterion, name, hardening),
            Err(error) => panic!("{name}: {error}"),
        }
    }
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(20).warm_up_time(std::time::Duration::from_millis(300)).measurement_time(std::time::Duration::from_secs(1));
    targets = every_law::<f64>, every_law::<f32>
}
criterion_main!(benches);
