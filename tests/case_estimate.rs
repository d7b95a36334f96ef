//! The case room's estimate of the mesh, and the range of contact radii that it allows, against the
//! meshes themselves.

use asperity::case::{Case, estimated_elements, estimated_memory};
use asperity::internals::mesh::{self, SphereSpec};
use asperity::internals::simulation::problem::Problem;

fn case(elements: usize, fine_zone: f64, contact_radius: f64) -> Case {
    let settings = [
        format!("mesh.elements_per_contact_radius={elements}"),
        format!("mesh.fine_zone={fine_zone:?}"),
        format!("mesh.contact_radius={contact_radius:?}"),
    ];
    let text = include_str!("../fixtures/cases/ideal.toml");
    Case::parse(text, "ideal.toml", &settings).unwrap_or_else(|error| panic!("{settings:?}: {error}"))
}

#[test]
fn the_estimate_is_within_a_quarter_of_the_mesh() {
    let cases = [
        include_str!("../fixtures/cases/ideal.toml"),
        include_str!("../fixtures/cases/elastic.toml"),
        include_str!("../fixtures/cases/equal.toml"),
        include_str!("../fixtures/cases/unlike.toml"),
        include_str!("../fixtures/cases/voce.toml"),
    ];
    for text in cases {
        for (inside, at_surface) in [(4, 4), (8, 8), (16, 16), (4, 8), (6, 24), (10, 20)] {
            for fine_zone in [1.1, 2.0] {
                let settings = [
                    format!("mesh.elements_per_contact_radius={inside}"),
                    format!("mesh.surface_elements_per_contact_radius={at_surface}"),
                    format!("mesh.fine_zone={fine_zone:?}"),
                ];
                let case = Case::parse(text, "case.toml", &settings).unwrap_or_else(|error| panic!("{settings:?}: {error}"));
                let meshed = Problem::new(&case).expect("a mesh").model.mesh.elements.len() as f64;
                let ratio = estimated_elements(&case) as f64 / meshed;
                assert!((ratio - 1.0).abs() < 0.25, "{text}{settings:?}: {ratio} of {meshed}");
            }
        }
    }
    assert!(
        estimated_memory(&case(32, 3.0, 0.005)) < 8.0,
        "where the system does not tell what there is, every mesh in range is allowed"
    );
}

#[test]
fn every_contact_radius_that_a_case_may_give_can_be_meshed() {
    for contact_radius in [0.005, 0.65] {
        let case = case(16, 1.3, contact_radius);
        let spec = SphereSpec {
            contact_radius,
            elements_per_contact_radius: 16,
            fine_zone: case.mesh.fine_zone,
            skin_levels: 0,
            first_layer: 1.0,
        };
        assert!(mesh::element_count(&spec).is_ok(), "{spec:?}");
    }
}
