use super::butterfly::{BOTTOM, Butterfly, SIDE};
use super::geometry::Geometry;
use super::layout::stereographic;
use super::*;
use crate::mesh::connectivity::{FACES, boundary_faces};
use crate::mesh::hierarchy::{Blocks, COARSEST_NODES, Site, coarse_cells};
use crate::mesh::quality;
use std::f64::consts::PI;

fn spec(contact_radius: f64, elements_per_contact_radius: usize, fine_zone: f64) -> SphereSpec {
    SphereSpec { contact_radius, elements_per_contact_radius, fine_zone, skin_levels: 0, first_layer: 1.0 }
}

/// Root mean square and largest relative difference between the area tributary to the nodes closer
/// to the axis than rho and the spherical cap's, for rho over `range`.
fn entry_ripple(mesh: &Mesh, range: [f64; 2]) -> (f64, f64) {
    let nodes = mesh.contact_nodes.iter().map(|&n| mesh.nodes[n as usize]);
    let mut entries: Vec<(f64, f64)> = nodes.zip(&mesh.contact_area).map(|(x, &area)| (x[0].hypot(x[1]), area)).collect();
    entries.sort_by(|a, b| a.0.total_cmp(&b.0));
    let samples = 4000;
    let (mut sum, mut largest) = (0.0, 0f64);
    for k in 0..samples {
        let rho = range[0] + (range[1] - range[0]) * (k as f64 + 0.5) / samples as f64;
        let inside: f64 = entries.iter().take_while(|e| e.0 < rho).map(|e| e.1).sum();
        // Half of the cap's 2 pi z, z = 1 - sqrt(1 - rho^2).
        let error = inside * (1.0 + (1.0 - rho * rho).sqrt()) / (PI * rho * rho) - 1.0;
        sum += error * error;
        largest = largest.max(error.abs());
    }
    ((sum / samples as f64).sqrt(), largest)
}

/// Smallest scaled Jacobian within 1.5 contact radii of the pole and overall, and whether all
/// Jacobians are positive.
fn quality_of(mesh: &Mesh, contact_radius: f64) -> (f64, f64, bool) {
    let (mut fine, mut all, mut positive) = (1f64, 1f64, true);
    for e in 0..mesh.elements.len() {
        let x = mesh.corners(e);
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
    for contact_radius in [0.0005, 0.005, 0.01, 0.05, 0.2087, 0.3, 0.4, 0.65] {
        for elements_per_contact_radius in [4, 5, 6, 7, 8, 11, 16] {
            for fine_zone in [1.1, 1.3, 3.0] {
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
        assert!(fine > 0.58 && all > 0.58, "{spec:?}: scaled Jacobians {fine} and {all}");
        assert_eq!(mesh.elements.len(), element_count(&spec).unwrap(), "{spec:?}");
    }
}

#[test]
fn the_volume_converges_at_second_order() {
    let coarse = Layout::new(&spec(0.2087, 4, 1.3)).unwrap();
    let error = |layout: &Layout| 1.0 - quality::volume(&mesh_with(layout, layout)) / (PI / 3.0);
    let middle = coarse.halved();
    let errors = [error(&coarse), error(&middle), error(&middle.halved())];
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((1.8..2.2).contains(&order), "{errors:?}");
    }
}

#[test]
fn the_mesh_is_symmetric_bit_by_bit_and_repeatable() {
    let spec = spec(0.2087, 8, 1.3);
    let mesh = sphere_mesh(&spec).unwrap();
    let blocks = Layout::new(&spec).unwrap().blocks;
    let sites = blocks.sites();
    assert_eq!(sites.len(), mesh.nodes.len());
    assert_eq!(sites.len(), blocks.node_count());
    for (n, site) in sites.into_iter().enumerate() {
        assert_eq!(blocks.number(site) as usize, n);
        let mirror = mesh.nodes[blocks.number(blocks.mirrored(site)) as usize];
        let [x, y, z] = mesh.nodes[n];
        assert_eq!([-x, y, z], mirror);
        assert!(y >= 0.0 && (0.0..=1.0).contains(&z));
    }
    assert_eq!(mesh, sphere_mesh(&spec).unwrap());
}

#[test]
fn a_flat_is_a_half_ball_whose_half_sphere_is_the_plate() {
    for spec in [spec(0.2087, 8, 1.3), spec(0.01, 6, 1.3), spec(0.65, 8, 1.1), spec(0.1, 5, 3.0)] {
        let (mesh, ball) = (flat_mesh(&spec).unwrap(), sphere_mesh(&spec).unwrap());
        let (fine, all, positive) = quality_of(&mesh, spec.contact_radius);
        assert!(positive && fine > 0.58 && all > 0.5, "{spec:?}: scaled Jacobians {fine} and {all}");
        // A quarter of the ball of radius 2, less what its facets cut off.
        let share = quality::volume(&mesh) / (8.0 * PI / 3.0);
        assert!((0.94..1.0).contains(&share), "{spec:?}: {share}");
        assert!(mesh.contact_nodes.iter().all(|&n| mesh.nodes[n as usize][2] == 0.0));
        let distance = |x: [f64; 3]| x[0].hypot(x[1]).hypot(x[2]);
        let far: Vec<u32> = (0..).zip(&mesh.nodes).filter(|(_, x)| distance(**x) > 2.0 - 1e-12).map(|(n, _)| n).collect();
        assert_eq!(far, mesh.plate_nodes);
        assert!(mesh.nodes.iter().all(|x| x[1] >= 0.0 && x[2] >= 0.0 && distance(*x) < 2.0 + 1e-12));
        let half_disc = PI * (mesh.fine_radius * CONTACT_MARGIN).powi(2) / 2.0;
        assert!(mesh.contact_area.iter().sum::<f64>() > 0.9 * half_disc);
        assert_eq!((mesh.hierarchy.len(), ball.plate_nodes.is_empty()), (ball.hierarchy.len(), false));
    }
}

/// A face turned so that its smallest node comes first.
fn turned(mut face: [u32; 4]) -> [u32; 4] {
    let first = (0..4).min_by_key(|&k| face[k]).unwrap();
    face.rotate_left(first);
    face
}

#[test]
fn every_boundary_face_is_sphere_plate_or_symmetry_plane() {
    for spec in [spec(0.2087, 8, 1.3), spec(0.01, 4, 1.1), spec(0.65, 5, 3.0)] {
        let blocks = Layout::new(&spec).unwrap().blocks;
        let mesh = sphere_mesh(&spec).unwrap();
        let faces: Vec<[u32; 4]> = boundary_faces(&mesh.elements).into_iter().map(turned).collect();
        let count =
            |on: &dyn Fn(&[f64; 3]) -> bool| faces.iter().filter(|f| f.iter().all(|&n| on(&mesh.nodes[n as usize]))).count();
        let on_sphere = |x: &[f64; 3]| (x[0].hypot(x[1]).hypot(1.0 - x[2]) - 1.0).abs() < 5e-16;
        let (sphere, plate, symmetry) = (count(&on_sphere), count(&|x| x[2] == 1.0), count(&|x| x[1] == 0.0));
        let around = blocks.perimeter_cells();
        assert_eq!(sphere, blocks.nx * blocks.ny + around * blocks.nr);
        assert_eq!(plate, blocks.nx * blocks.ny + around * blocks.nd);
        assert_eq!(symmetry, blocks.nx * (blocks.nd + blocks.nr) + 2 * blocks.nr * blocks.nd);
        assert_eq!(sphere + plate + symmetry, faces.len());
        assert_eq!(mesh.plate_nodes.len(), (blocks.nx + 1) * (blocks.ny + 1) + blocks.nd * (around + 1));
        for &face in &mesh.contact_faces {
            assert!(faces.contains(&turned(face)), "the same turn as the element's own face");
        }
    }
}

#[test]
fn inner_faces_are_shared_by_two_elements_and_lists_agree() {
    let mesh = sphere_mesh(&spec(0.1, 6, 1.3)).unwrap();
    let mut faces: Vec<[u32; 4]> = Vec::new();
    for element in &mesh.elements {
        faces.extend(FACES.iter().map(|local| {
            let mut face = local.map(|l| element[l]);
            face.sort_unstable();
            face
        }));
    }
    faces.sort_unstable();
    let shares: Vec<usize> = faces.chunk_by(|a, b| a == b).map(<[_]>::len).collect();
    assert!(shares.iter().all(|&n| n <= 2));
    assert_eq!(shares.iter().filter(|&&n| n == 1).count(), boundary_faces(&mesh.elements).len());
    let lists = &mesh.node_elements;
    assert_eq!(lists.entry.len(), 8 * mesh.elements.len());
    for n in 0..mesh.nodes.len() {
        let list = &lists.entry[lists.list(n)];
        assert!(!list.is_empty() && list.is_sorted());
        assert!(list.iter().all(|&entry| mesh.elements[entry as usize / 8][entry as usize % 8] == n as u32));
    }
}

#[test]
fn contact_covers_the_fine_zone_with_its_areas() {
    for spec in specs() {
        let mesh = sphere_mesh(&spec).unwrap();
        assert_eq!(mesh.fine_radius, (spec.fine_zone * spec.contact_radius).min(0.85));
        assert!(mesh.contact_nodes.is_sorted() && mesh.contact_nodes.iter().all(|n| mesh.plate_nodes.binary_search(n).is_err()));
        // Every node of the sphere's surface up to the end of the fine zone, and the end of the
        // fine zone itself.
        let position = |n: &u32| mesh.nodes[*n as usize];
        let rho = |x: [f64; 3]| x[0].hypot(x[1]);
        assert!(mesh.contact_nodes.iter().map(|n| rho(position(n))).fold(0.0, f64::max) > mesh.fine_radius);
        for (n, &x) in (0u32..).zip(&mesh.nodes) {
            let on_sphere = (rho(x).hypot(1.0 - x[2]) - 1.0).abs() < 1e-14;
            assert!(!(on_sphere && rho(x) < mesh.fine_radius) || mesh.contact_nodes.binary_search(&n).is_ok(), "{spec:?}: {x:?}");
        }
        // Of the projection, which is true at the pole.
        let spacing = stereographic(spec.contact_radius) / spec.elements_per_contact_radius as f64;
        let areas = &mesh.contact_area;
        assert!(areas.len() == mesh.contact_nodes.len() && mesh.contact_size.len() == areas.len());
        let pole = mesh.contact_nodes.iter().position(|n| position(n) == [0.0; 3]).unwrap();
        assert!((mesh.contact_size[pole] / spacing - 1.0).abs() < 0.08, "{spec:?}: {}", mesh.contact_size[pole] / spacing);
        assert!((areas[pole] / (mesh.contact_size[pole].powi(2) / 2.0) - 1.0).abs() < 0.05, "half, on the symmetry plane");
        for face in &mesh.contact_faces {
            let [a, b, _, d] = face.map(|n| position(&n));
            let (u, v) = ([0, 1, 2].map(|k| b[k] - a[k]), [0, 1, 2].map(|k| d[k] - a[k]));
            let normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
            assert!(normal[0] * a[0] + normal[1] * a[1] + normal[2] * (a[2] - 1.0) > 0.0);
        }
    }
}

/// Whatever is linear in a block's logical indices is interpolated exactly, on every level.
#[test]
fn interpolation_keeps_linear_functions_of_the_indices() {
    let layouts = [spec(0.2087, 16, 1.3), spec(0.01, 6, 1.3), spec(0.65, 4, 1.1), spec(0.3, 7, 2.0)];
    let whole = layouts.map(|spec| Layout::new(&spec).unwrap().blocks);
    for blocks in whole.into_iter().chain(whole.map(|blocks| blocks.right_half())) {
        let mut fine = blocks;
        let levels = crate::mesh::hierarchy::hierarchy(fine);
        assert!(blocks.half || !levels.is_empty());
        assert!(levels.last().map_or(fine.node_count(), |p| p.coarse_nodes) <= COARSEST_NODES, "{blocks:?}");
        for p in &levels {
            let coarse = fine.with_cells(&fine.cells().iter().map(|&n| coarse_cells(n)).collect::<Vec<_>>());
            assert_eq!((p.coarse_nodes, p.row_start.len()), (coarse.node_count(), fine.node_count() + 1));
            let mut columns_hit = vec![false; p.coarse_nodes];
            for block in [butterfly::BOTTOM, butterfly::SIDE, butterfly::CORE] {
                let ends = |b: &Butterfly| match block {
                    butterfly::BOTTOM => [b.nx, b.ny, b.nd],
                    butterfly::SIDE => [b.perimeter_cells(), b.nr, b.nd],
                    _ => [b.nx, b.ny, b.nr],
                };
                // The fine indices of the coarse nodes; around the perimeter, those of the centre
                // block.
                let logical = |b: &Butterfly, [s, q, c]: [usize; 3]| match block {
                    butterfly::SIDE => (b.on_perimeter(s), q, c),
                    _ => ((s, q), 0, c),
                };
                let kept = |i: usize, cells: usize| (2 * i).min(cells) as f64;
                let mut value = vec![[f64::NAN; 4]; p.coarse_nodes];
                for at in grid(ends(&coarse)) {
                    let ((i, j), q, c) = logical(&coarse, at);
                    let last = if block == butterfly::CORE { fine.nr } else { fine.nd };
                    value[coarse.number(Site { block, at }) as usize] =
                        [kept(i, fine.nx), kept(j, fine.ny), kept(q, fine.nr), kept(c, last)];
                }
                for at in grid(ends(&fine)) {
                    let ((i, j), q, c) = logical(&fine, at);
                    let row = fine.number(Site { block, at }) as usize;
                    let entries = p.row_start[row] as usize..p.row_start[row + 1] as usize;
                    assert!((1..=8).contains(&entries.len()) && p.column[entries.clone()].is_sorted_by(|a, b| a < b));
                    let mut sum = 0.0;
                    let mut found = [0.0; 4];
                    for e in entries.clone() {
                        sum += p.weight[e];
                        for (f, v) in found.iter_mut().zip(value[p.column[e] as usize]) {
                            *f += p.weight[e] * v;
                        }
                        columns_hit[p.column[e] as usize] |= entries.len() == 1 && p.weight[e] == 1.0;
                    }
                    assert!((sum - 1.0).abs() < 1e-15);
                    for (f, expected) in found.iter().zip([i, j, q, c]) {
                        assert!((f - expected as f64).abs() < 1e-12, "{blocks:?} block {block} at {at:?}: {found:?}");
                    }
                }
            }
            assert!(columns_hit.iter().all(|&hit| hit), "every coarse node is a fine node and injects there");
            fine = coarse;
        }
    }
}

/// All indices from 0 to `ends`, inclusive.
fn grid(ends: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
    (0..=ends[2]).flat_map(move |c| (0..=ends[1]).flat_map(move |b| (0..=ends[0]).map(move |a| [a, b, c])))
}

#[test]
fn the_standard_mesh_has_the_size_that_the_design_asks_for() {
    let mesh = sphere_mesh(&spec(0.2087, 16, 1.3)).unwrap();
    assert!((12_000..=16_000).contains(&mesh.elements.len()), "{}", mesh.elements.len());
    assert!((45_000..=50_000).contains(&(3 * mesh.nodes.len())), "{}", mesh.nodes.len());
    assert!(element_count(&spec(0.01, 16, 1.3)).unwrap() < 25_000);
}

#[test]
fn impossible_descriptions_are_errors() {
    for a in [0.0004, 0.66, f64::NAN, -0.1] {
        assert!(matches!(sphere_mesh(&spec(a, 16, 1.3)), Err(MeshError::ContactRadius(_))));
    }
    for count in [0, 1, 33, usize::MAX] {
        assert!(matches!(element_count(&spec(0.2, count, 1.3)), Err(MeshError::ElementsPerContactRadius(_))));
    }
    for fine_zone in [1.0, 3.1, f64::INFINITY, f64::NAN] {
        assert!(matches!(sphere_mesh(&spec(0.2, 16, fine_zone)), Err(MeshError::FineZone(_))));
    }
}

/// Against circles and against a spread alone, the contact area grows evenly wherever the contact's
/// edge may be.
#[test]
fn the_contact_area_enters_evenly() {
    // Elements per contact radius; bounds on the ripple's root mean square over 0.5 to 1 and 0.8 to
    // 1.3 contact radii.
    for (count, all, near) in [(4, 0.05, 0.04), (5, 0.04, 0.03), (8, 0.014, 0.010), (16, 0.004, 0.003), (24, 0.002, 0.0015)] {
        let spec = spec(0.2087, count, 1.3);
        let ripple = |layout: &Layout, from: f64, to: f64| entry_ripple(&mesh_with(layout, layout), [from * 0.2087, to * 0.2087]);
        let spread = Layout::new(&spec).unwrap();
        let chosen = spread.clone().touching_evenly();
        let circles = Layout { spread: 0.0, ..spread.clone() };
        let (rms, largest) = ripple(&chosen, 0.5, 1.0);
        assert!(rms < all && largest < 4.0 * all, "{count}: {rms} {largest}");
        assert!(rms < 0.46 * ripple(&spread, 0.5, 1.0).0 && rms < 0.3 * ripple(&circles, 0.5, 1.0).0, "{count}: {rms}");
        let (rms, largest) = ripple(&chosen, 0.8, 1.3);
        assert!(rms < near && largest < 4.0 * near, "{count}: {rms} {largest}");
    }
}

/// The mesh is alike on both sides of its diagonal but for images that touch one after the other,
/// and of these neither side comes first.
#[test]
fn neither_side_of_the_diagonal_lies_further_out() {
    // In spacings, the mean over three rings of by how much images differ in radius: 0.06 to 0.09.
    const MEAN: f64 = 0.1;
    // Elements per contact radius; halved at the surface; a bound on the root mean square (0.3
    // where rings are spread from x to y).
    let meshes = [(5, false, 0.22), (8, false, 0.15), (10, false, 0.12), (16, false, 0.09), (20, false, 0.08)];
    for (count, finer, all) in meshes.into_iter().chain([(5, true, 0.14), (10, true, 0.08)]) {
        let layout = Layout::new(&spec(0.2087, count, 1.3)).unwrap();
        let layout = if finer { layout.halved() } else { layout }.touching_evenly();
        let (geometry, m) = (Geometry::new(&layout), layout.m);
        let radius = |block, at| {
            let [x, y, _] = geometry.on_surface(Site { block, at });
            x.hypot(y)
        };
        let of_squares = (1..=m).map(|big| {
            let of = |small| radius(BOTTOM, [m + big, small, 0]) - radius(BOTTOM, [m + small, big, 0]);
            (0..big).map(of).collect::<Vec<f64>>()
        });
        let of_rings = (1..=layout.fine_rings).map(|r| {
            let of = |s| radius(SIDE, [s, r, 0]) - radius(SIDE, [2 * m - s, r, 0]);
            (0..m).map(of).collect::<Vec<f64>>()
        });
        let rings: Vec<Vec<f64>> = of_squares.chain(of_rings).collect();
        let mean_of = |all: &[f64]| all.iter().sum::<f64>() / all.len() as f64 / layout.spacing;
        let squares: Vec<f64> = rings.concat().iter().map(|d| d * d).collect();
        let rms = (mean_of(&squares) / layout.spacing).sqrt();
        let largest = rings.windows(3).map(|three| mean_of(&three.concat()).abs()).fold(0.0, f64::max);
        assert!(rms < all && largest < MEAN, "{count}: {rms} {largest}");
    }
}

#[test]
fn nodes_move_by_a_spacing_at_most_to_touch_evenly() {
    for spec in specs() {
        let layout = Layout::new(&spec).unwrap().touching_evenly();
        assert!(!layout.shifts.is_empty());
        assert!(layout.shifts.iter().all(|s| s.abs() < 1.0001 * layout.spacing), "{spec:?}");
    }
}

#[test]
fn the_half_has_the_nodes_at_positive_x_and_its_levels_keep_the_plane() {
    for spec in specs() {
        let mesh = sphere_mesh(&spec).unwrap();
        let half = mesh.half.as_ref().unwrap();
        let mut nodes = half.node.clone();
        nodes.sort_unstable();
        let expected: Vec<u32> = (0u32..).zip(&mesh.nodes).filter(|(_, x)| x[0] >= 0.0).map(|(n, _)| n).collect();
        assert_eq!(nodes, expected, "{spec:?}");
        let mut on_plane: Vec<bool> = half.node.iter().map(|&n| mesh.nodes[n as usize][0] == 0.0).collect();
        for p in &half.hierarchy {
            assert_eq!(p.row_start.len(), on_plane.len() + 1);
            let mut coarse = vec![false; p.coarse_nodes];
            for (i, _) in on_plane.iter().enumerate().filter(|(_, on)| **on) {
                p.column[p.row_start[i] as usize..p.row_start[i + 1] as usize].iter().for_each(|&j| coarse[j as usize] = true);
            }
            // Coarse nodes are fine nodes: those that a node at x = 0 takes from are at x = 0.
            for i in (0..on_plane.len()).filter(|&i| !on_plane[i] && p.row_start[i + 1] - p.row_start[i] == 1) {
                assert!(!coarse[p.column[p.row_start[i] as usize] as usize], "{spec:?}");
            }
            on_plane = coarse;
        }
    }
}
