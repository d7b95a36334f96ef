//! Memory of a batch on a device whose residuals are in double precision.

use crate::device::device;
use asperity::internals::compute::gpu::{Gpu, Precision};
use asperity::internals::compute::iterate::Keeps;
use asperity::internals::compute::{CaseModel, Compute};
use asperity::internals::contact::coulomb::Friction;
use asperity::internals::contact::rigid::Rigid;
use asperity::internals::mesh::{Mesh, SphereSpec, sphere_mesh};
use asperity::material::{Elasticity, FlowStress, Material};
use std::sync::Arc;

const MEGABYTE: u64 = 1_000_000;
const GIBIBYTE: u64 = 1 << 30;

/// The reference case's mesh.
#[test]
fn a_case_of_the_reference_mesh_takes_90_megabytes_and_32_take_three_gibibytes() {
    let name = "a_case_of_the_reference_mesh_takes_90_megabytes_and_32_take_three_gibibytes";
    let spec =
        SphereSpec { contact_radius: 0.2091, elements_per_contact_radius: 16, fine_zone: 1.3, skin_levels: 0, first_layer: 1.0 };
    let mesh = sphere_mesh(&spec).unwrap();
    assert!(mesh.nodes.len() >= 16_173, "{} nodes", mesh.nodes.len());
    let Some([one, of_case]) = memory(name, &mesh) else { return };
    let all = one + 31 * of_case;
    println!("32 cases take {:.2} GiB", all as f64 / GIBIBYTE as f64);
    assert!(of_case <= 90 * MEGABYTE, "a case takes {of_case} bytes");
    assert!(all <= 3 * GIBIBYTE, "32 cases take {all} bytes");
}

/// With the same elements at the surface, over larger ones: rows of nodes from which corners hang
/// are longer, and all have room for as many blocks.
#[test]
fn a_case_with_a_skin_takes_no_more_than_one_that_is_as_fine_inside() {
    let name = "a_case_with_a_skin_takes_no_more_than_one_that_is_as_fine_inside";
    for (elements_per_contact_radius, skin_levels) in [(8, 1), (4, 2)] {
        let spec =
            SphereSpec { contact_radius: 0.2091, elements_per_contact_radius, fine_zone: 1.3, skin_levels, first_layer: 1.0 };
        let Some([_, of_case]) = memory(name, &sphere_mesh(&spec).unwrap()) else { return };
        assert!(of_case <= 90 * MEGABYTE, "a case takes {of_case} bytes");
    }
}

/// Bytes of one case, with what all cases share, and of one more. Each case has a mesh of its own:
/// what cases of one mesh share is not counted on.
fn memory(name: &str, mesh: &Mesh) -> Option<[u64; 2]> {
    let used = [1, 2].map(|cases| {
        let context = device(name, Precision::F64)?;
        let model = || CaseModel {
            mesh: Arc::new(mesh.clone()),
            material: Material { elasticity: Elasticity::new(1.0, 0.3), hardening: FlowStress::ideal(2e-3).unwrap() },
            friction: Friction::Coulomb(0.3),
            opponent: None,
            image: None,
            surface: Rigid::default(),
        };
        let models = (0..cases).map(|_| model()).collect();
        let gpu = Gpu::<f64>::with_tangents_in_single(context.into(), models).unwrap();
        let slots = gpu.context().unwrap().budget().used();
        assert_eq!(gpu.about().keeps, Keeps::Steps);
        Some(slots)
    });
    let [Some(one), Some(two)] = used else { return None };
    let of_case = two - one;
    let (elements, nodes) = (mesh.elements.len(), mesh.nodes.len());
    println!("{elements} elements, {nodes} nodes: a case takes {:.1} MB", of_case as f64 / MEGABYTE as f64);
    Some([one, of_case])
}
