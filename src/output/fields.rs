//! The fields of one step: what `fields/step_0020.vtu` shows.

use super::space::{Space, bodies, stresses_in_space};
use super::{ContactPoint, ContactStatus, Field, Grid, Half, OutputError, Units, write_vtu};
use crate::compute::CaseFields;
use crate::mesh::Mesh;
use std::path::Path;

/// Writes what is meshed (half, y >= 0, of which the other is the mirror image, as the file says,
/// or all) at its reference positions with, on the nodes, `displacement`, `contact_pressure`,
/// `contact_traction`, `gap` and `contact_status` (0 open or away from the contact surface, 1
/// stick, 2 slip; the gap is -1 away from it) and, on the elements, `stress` (Cauchy), `mises`,
/// `alpha` and `plastic` (1 where the element has yielded), in the user's units; of two bodies also
/// `body` (0 the sphere, 1 the opponent). `displacement` and `fields` are scaled, `points` are in
/// the user's units.
pub fn write_fields(
    path: &Path,
    mesh: &Mesh,
    displacement: &[f64],
    fields: &CaseFields,
    points: &[ContactPoint],
    units: &Units,
) -> Result<(), OutputError> {
    let (nodes, space) = (mesh.nodes.len(), Space::new(mesh));
    let in_units = |vectors: &[[f64; 3]]| -> Vec<[f64; 3]> { space.vectors(vectors).iter().map(|x| units.vector(x)).collect() };
    let (positions, moved) = (in_units(&mesh.nodes), in_units(displacement.as_chunks::<3>().0));

    let mut pressure = vec![0.0; positions.len()];
    let mut traction = vec![[0.0; 3]; positions.len()];
    let mut gap = vec![-1.0; positions.len()];
    let mut status = vec![0; positions.len()];
    for point in points.iter().filter(|point| point.half != Half::Mirrored) {
        let node = point.point;
        if node >= nodes {
            let problem = format!("a contact point names node {node} of {nodes}");
            return Err(OutputError::Inconsistent { path: path.to_path_buf(), problem });
        }
        pressure[node] = point.pressure;
        traction[node] = [point.traction_x, point.traction_y, 0.0];
        gap[node] = point.gap;
        status[node] = match point.status {
            ContactStatus::Open => 0,
            ContactStatus::Stick => 1,
            ContactStatus::Slip => 2,
        };
    }

    let stress: Vec<[f64; 6]> = stresses_in_space(mesh, &fields.stress).iter().map(|stress| units.stress(stress)).collect();
    let point_fields = [
        Field::vector("displacement", &moved),
        Field::scalar("contact_pressure", pressure),
        Field::vector("contact_traction", &traction),
        Field::scalar("gap", gap),
        Field::integer("contact_status", status),
    ];
    let mut cell_fields = vec![
        Field::symmetric_tensor("stress", &stress),
        Field::scalar("mises", stress.iter().map(mises).collect()),
        Field::scalar("alpha", fields.alpha.clone()),
        Field::integer("plastic", fields.alpha.iter().map(|&alpha| i32::from(alpha > 0.0)).collect()),
    ];
    cell_fields.extend(bodies(mesh).map(|bodies| Field::integer("body", bodies)));
    let cells = space.elements();
    write_vtu(
        path,
        &Grid { points: &positions, cells: &cells, symmetry_plane: (mesh.copies == 2).then_some(0.0) },
        &point_fields,
        &cell_fields,
    )
}

/// Mises' equivalent stress sqrt(3/2 s:s) of xx, yy, zz, xy, yz, zx.
pub fn mises(stress: &[f64; 6]) -> f64 {
    let [xx, yy, zz, xy, yz, zx] = *stress;
    let normal = (xx - yy).powi(2) + (yy - zz).powi(2) + (zz - xx).powi(2);
    (0.5 * normal + 3.0 * (xy * xy + yz * yz + zx * zx)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::Orientation;
    use crate::mesh::brick::brick;

    #[test]
    fn a_step_is_written_whole_and_a_wild_point_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("fields/step_0001.vtu");
        let mesh = brick(2, 1, 1, [2.0, 1.0, 1.0]).unwrap();
        let displacement = vec![0.01; 3 * mesh.nodes.len()];
        let fields = CaseFields { stress: vec![[1e-3; 6], [0.0; 6]], alpha: vec![0.02, 0.0], max_alpha: 0.03 };
        let units = Units { radius: 2.0, youngs_modulus: 100.0, bodies: 1.0, orientation: Orientation::ALONG_X };
        let mut point = ContactPoint {
            point: 3,
            reference_x: 0.0,
            reference_y: 0.0,
            current_x: 0.0,
            current_y: 0.0,
            gap: 0.0,
            pressure: 5.0,
            traction_x: -1.0,
            traction_y: 0.0,
            area: 0.1,
            status: ContactStatus::Slip,
            half: Half::Meshed,
        };
        write_fields(&path, &mesh, &displacement, &fields, std::slice::from_ref(&point), &units).unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        let names = [
            "displacement",
            "contact_pressure",
            "contact_traction",
            "gap",
            "contact_status",
            "stress",
            "mises",
            "alpha",
            "plastic",
        ];
        assert!(names.iter().all(|name| text.contains(&format!("Name=\"{name}\""))), "{text}");
        assert!(text.contains("NumberOfPoints=\"12\" NumberOfCells=\"2\""), "{text}");
        assert!(text.contains("Half of the body"), "{text}");
        // The images of its points are on no node.
        let images = ContactPoint::whole(vec![point.clone()]);
        write_fields(&path, &mesh, &displacement, &fields, &images, &units).unwrap();
        assert_eq!((images.len(), std::fs::read_to_string(&path).unwrap()), (2, text));

        point.point = 12;
        let error = write_fields(&path, &mesh, &displacement, &fields, std::slice::from_ref(&point), &units).unwrap_err();
        assert!(error.to_string().contains("node 12 of 12"), "{error}");
        let error = write_fields(&path, &mesh, &displacement[..9], &fields, &[], &units).unwrap_err();
        assert!(error.to_string().contains("displacement has 9 numbers"), "{error}");
    }

    #[test]
    fn mises_of_known_states() {
        assert_eq!(mises(&[-7.0; 6].map(|x: f64| x)), (3.0f64 * 3.0 * 49.0).sqrt());
        assert_eq!(mises(&[5.0, 5.0, 5.0, 0.0, 0.0, 0.0]), 0.0);
        assert_eq!(mises(&[-400.0, 0.0, 0.0, 0.0, 0.0, 0.0]), 400.0);
        assert!((mises(&[0.0, 0.0, 0.0, 0.0, 0.0, 2.0]) - 12f64.sqrt()).abs() < 1e-15);
    }
}
