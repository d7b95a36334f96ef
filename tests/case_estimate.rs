//! The case room's estimate of the mesh, and the range of contact radii that it allows, against the
//! meshes themselves.

use asperity::case::{Case, estimated_elements, estimated_memory};
use asperity::internals::mesh::{self, SphereSpec};

fn case(elements: usize, fine_zone: f64, contact_radius: f64) -> Case {
    case_with(elements, 0, fine_zone, contact_radius)
}

fn case_with(elements: usize, skin_levels: usize, fine_zone: f64, contact_radius: f64) -> Case {
    let settings = [
        format!("mesh.surface_elements_per_contact_radius={}", elements << skin_levels),
        format!("mesh.elements_per_contact_radius={elements}"),
        format!("mesh.fine_zone={fine_zone:?}"),
        format!("mesh.contact_radius={contact_radius:?}"),
    ];
    let text = include_str!("../fixtures/cases/ideal.toml");
    Case::parse(text, "ideal.toml", &settings).unwrap_or_else(|error| panic!("{settings:?}: {error}"))
}

#[test]
fn the_estimate_is_within_a_quarter_of_the_mesh() {
    let mut worst: f64 = 0.0;
    for (elements_per_contact_radius, skin_levels) in [(8, 0), (16, 0), (24, 0), (32, 0), (6, 1), (6, 2), (8, 1), (8, 3), (16, 1)]
    {
        for fine_zone in [1.1, 1.3, 2.0, 3.0] {
            for contact_radius in [0.005, 0.05, 0.2, 0.3] {
                let spec = SphereSpec { contact_radius, elements_per_contact_radius, fine_zone, skin_levels };
                let meshed = mesh::element_count(&spec).expect("in range") as f64;
                let estimated =
                    estimated_elements(&case_with(elements_per_contact_radius, skin_levels, fine_zone, contact_radius)) as f64;
                worst = worst.max((estimated / meshed - 1.0).abs());
                assert!((estimated / meshed - 1.0).abs() < 0.25, "{spec:?}: {estimated} against {meshed}");
            }
        }
    }
    println!("worst {worst:.3}");
    assert!(
        estimated_memory(&case(32, 3.0, 0.005)) < 8.0,
        "where the system does not tell what there is, every mesh in range is allowed"
    );
}

#[test]
fn every_contact_radius_that_a_case_may_give_can_be_meshed() {
    for contact_radius in [0.005, 0.65] {
        let case = case(16, 1.3, contact_radius);
        let spec = SphereSpec { contact_radius, elements_per_contact_radius: 16, fine_zone: case.mesh.fine_zone, skin_levels: 0 };
        assert!(mesh::element_count(&spec).is_ok(), "{spec:?}");
    }
}
