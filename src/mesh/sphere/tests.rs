use super::*;
use crate::mesh::connectivity::{FACES, boundary_faces};
use crate::mesh::hierarchy::Blocks;
use crate::mesh::quality;
use std::f64::consts::PI;

fn spec(contact_radius: f64, elements_per_contact_radius: usize, fine_zone: f64) -> SphereSpec {
    SphereSpec { contact_radius, elements_per_contact_radius, fine_zone }
}

/// Root mean square and largest relative difference between the area tributary to the nodes closer than rho and the spherical cap's,
/// for rho over [0.4 a, fine radius].
fn entry_ripple(mesh: &Mesh, contact_radius: f64) -> (f64, f64) {
    let mut entries: Vec<(f64, f64)> = mesh
        .contact_nodes
        .iter()
        .zip(&mesh.contact_area)
        .map(|(&n, &area)| (mesh.nodes[n as usize][0].hypot(mesh.nodes[n as usize][1]), area))
        .collect();
    entries.sort_by(|a, b| a.0.total_cmp(&b.0));
    let samples = 4000;
    let (mut sum, mut largest) = (0.0, 0f64);
    for k in 0..samples {
        let share = (k as f64 + 0.5) / samples as f64;
        let rho = contact_radius * 0.4 + share * (mesh.fine_radius - contact_radius * 0.4);
        let inside: f64 = entries.iter().take_while(|e| e.0 < rho).map(|e| e.1).sum();
        let cap = PI * rho * rho / (1.0 + (1.0 - rho * rho).sqrt());
        let error = inside / cap - 1.0;
        sum += error * error;
        largest = largest.max(error.abs());
    }
    ((sum / samples as f64).sqrt(), largest)
}

fn quality_of(mesh: &Mesh, contact_radius: f64) -> (f64, f64, bool) {
    let (mut fine, mut all, mut positive) = (1f64, 1f64, true);
    for e in 0..mesh.elements.len() {
        let x = quality::corners(mesh, e);
        let q = quality::scaled_jacobian(&x);
        positive &= quality::smallest_jacobian(&x) > 0.0;
        all = all.min(q);
        let c = [0, 1, 2].map(|k| x.iter().map(|v| v[k]).sum::<f64>() / 8.0);
        if (c[0] * c[0] + c[1] * c[1] + c[2] * c[2]).sqrt() < 1.5 * contact_radius {
            fine = fine.min(q);
        }
    }
    (fine, all, positive)
}

/// The range that users can ask for.
fn specs() -> Vec<SphereSpec> {
    let mut specs = Vec::new();
    for contact_radius in [0.005, 0.01, 0.05, 0.1, 0.2087, 0.3, 0.4, 0.5, 0.65] {
        for elements_per_contact_radius in [4, 5, 6, 7, 8, 11, 12, 16] {
            for fine_zone in [1.1, 1.3, 2.0, 3.0] {
                specs.push(spec(contact_radius, elements_per_contact_radius, fine_zone));
            }
        }
        for elements_per_contact_radius in [24, 32] {
            specs.push(spec(contact_radius, elements_per_contact_radius, 1.3));
        }
    }
    specs
}

#[test]
fn elements_are_positive_and_well_shaped_over_the_range() {
    for spec in specs() {
        let mesh = sphere_mesh(&spec).unwrap();
        let (fine, all, positive) = quality_of(&mesh, spec.contact_radius);
        assert!(positive, "{spec:?}");
        assert!(fine > 0.55 && all > 0.5, "{spec:?}: scaled Jacobians {fine} and {all}");
        assert_eq!(mesh.elements.len(), estimated_elements(&spec).unwrap(), "{spec:?}");
    }
}

#[test]
fn the_volume_converges_at_second_order() {
    let error = |count| 1.0 - quality::volume(&sphere_mesh(&spec(0.2087, count, 1.3)).unwrap()) / (PI / 3.0);
    let (coarse, fine) = (error(4), error(8));
    assert!(fine > 0.0 && coarse > 1.8 * fine, "{coarse} {fine}");
}

#[test]
fn the_mesh_is_symmetric_bit_by_bit_and_repeatable() {
    let spec = spec(0.2087, 8, 1.3);
    let mesh = sphere_mesh(&spec).unwrap();
    let layout = Layout::new(&spec).unwrap();
    for (n, site) in layout.blocks.sites().into_iter().enumerate() {
        assert_eq!(layout.blocks.number(site) as usize, n);
        let mirror = mesh.nodes[layout.blocks.number(layout.blocks.mirrored(site)) as usize];
        let [x, y, z] = mesh.nodes[n];
        assert_eq!([-x, y, z], mirror);
        assert!(y >= 0.0 && (0.0..=1.0).contains(&z));
    }
    assert_eq!(mesh, sphere_mesh(&spec).unwrap());
}

#[test]
fn every_boundary_face_is_sphere_plate_or_symmetry_plane() {
    let spec = spec(0.2087, 8, 1.3);
    let blocks = Layout::new(&spec).unwrap().blocks;
    let mesh = sphere_mesh(&spec).unwrap();
    let faces = boundary_faces(&mesh.elements);
    let count = |on: &dyn Fn(&[f64; 3]) -> bool| faces.iter().filter(|f| f.iter().all(|&n| on(&mesh.nodes[n as usize]))).count();
    let on_sphere = |x: &[f64; 3]| (x[0].hypot(x[1]).hypot(1.0 - x[2]) - 1.0).abs() < 4e-16;
    let (sphere, plate, symmetry) = (count(&on_sphere), count(&|x| x[2] == 1.0), count(&|x| x[1] == 0.0));
    let around = blocks.perimeter_cells();
    assert_eq!(sphere, blocks.nx * blocks.ny + around * blocks.nr);
    assert_eq!(plate, blocks.nx * blocks.ny + around * blocks.nd);
    assert_eq!(symmetry, blocks.nx * (blocks.nd + blocks.nr) + 2 * blocks.nr * blocks.nd);
    assert_eq!(sphere + plate + symmetry, faces.len());
    assert_eq!(mesh.plate_nodes.len(), (blocks.nx + 1) * (blocks.ny + 1) + blocks.nd * (around + 1));
    assert!(mesh.contact_faces.iter().all(|f| faces.contains(f) || faces.contains(&[f[1], f[2], f[3], f[0]]) || {
        let mut turned = *f;
        (0..4).any(|_| {
            turned.rotate_left(1);
            faces.contains(&turned)
        })
    }));
    assert!(mesh.contact_nodes.iter().all(|n| mesh.plate_nodes.binary_search(n).is_err()));
    assert_eq!(mesh.contact_nodes.len(), mesh.contact_area.len());
    assert_eq!(FACES.len(), 6);
}

#[test]
fn impossible_descriptions_are_errors() {
    for a in [0.004, 0.66, f64::NAN, -0.1] {
        assert!(matches!(sphere_mesh(&spec(a, 16, 1.3)), Err(MeshError::ContactRadius(_))));
    }
    for count in [0, 3, 33, usize::MAX] {
        assert!(matches!(estimated_elements(&spec(0.2, count, 1.3)), Err(MeshError::ElementsPerContactRadius(_))));
    }
    for fine_zone in [1.0, 3.1, f64::INFINITY, f64::NAN] {
        assert!(matches!(sphere_mesh(&spec(0.2, 16, fine_zone)), Err(MeshError::FineZone(_))));
    }
}

#[test]
fn the_contact_area_enters_smoothly() {
    let (rms, largest) = entry_ripple(&sphere_mesh(&spec(0.2087, 16, 1.3)).unwrap(), 0.2087);
    assert!(rms < 0.015 && largest < 0.07, "{rms} {largest}");
}
