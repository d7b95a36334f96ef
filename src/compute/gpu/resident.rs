//! What stays on the device: the geometry, parameters and committed state of a group of cases.

use std::sync::Arc;

use super::block_plan::BlockPlan;
use super::buffers::{DeviceReal, StorageBuffer};
use super::context::GpuContext;
use super::error::GpuError;
use super::layout::{COORDINATES, FACING, GAP_AND_POSITION, HISTORY, ON_SYMMETRY_PLANE, PARAMETERS, STATE};
use super::material::flatten;
use crate::compute::{CaseModel, ComputeError};
use crate::contact::coulomb::{CONTACT_WEIGHT, Friction};
use crate::element::hex8::{ElementGeometry, NODES, QUADRATURE_POINTS};
use crate::material::Material;
use crate::mesh::{Hanging, Mesh};

/// Rows of hardening tables that there is room for, a material: those of the batch may be replaced.
const TABLE_ROOM: usize = 64;
/// The coefficient of friction that stands for full stick in `coulomb.wgsl`.
pub(super) const FULL_STICK: f64 = -1.0;

/// Numbers of a material, with those of its table.
pub const MATERIAL_ROOM: usize = 32 + 3 * TABLE_ROOM;

/// Of an entry of the nodes that an element names, as in `hanging.wgsl`: some corner of it hangs.
pub(super) const SOME_HANG: u32 = 1 << 29;
/// The bits that the first three entries have of the element's octant.
pub(super) const OCTANT_AT: u32 = 30;
/// The bit of a corner that hangs.
pub(super) const HANGS_AT: u32 = 31;
/// Of an element in the list of a node, as in `node_force.wgsl`: some corner of it hangs.
pub(super) const HAS_HANGING: u32 = 1 << 31;

/// Sizes that all cases of a batch share.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BatchSizes {
    /// Nodes.
    pub nodes: usize,
    /// Elements.
    pub elements: usize,
    /// Those of the sphere: an opponent that deforms has those after them.
    pub own_elements: usize,
    /// Points that can touch.
    pub contact_points: usize,
    /// Blocks of the tangent's upper triangle.
    pub blocks: usize,
}

impl BatchSizes {
    /// Quadrature points of a case.
    pub fn points(&self) -> usize {
        QUADRATURE_POINTS * self.elements
    }

    /// Numbers of a case in `start`: displacement `[3 node + i]`, states `[component][point]`.
    pub fn start_numbers(&self) -> usize {
        3 * self.nodes + STATE * self.points()
    }

    /// Numbers of a slot in `trial`: increment `[3 node + i]`, det F - 1 `[point]`.
    pub fn trial_numbers(&self) -> usize {
        3 * self.nodes + self.points()
    }

    /// Numbers of a geometry: reference positions of the corners `[3 a + i][element]`, volumes
    /// `[point]`.
    pub fn geometry_numbers(&self) -> usize {
        COORDINATES * self.elements + self.points()
    }

    /// Bodies that deform.
    pub fn bodies(&self) -> usize {
        if self.own_elements < self.elements { 2 } else { 1 }
    }

    /// Bytes a case keeps on the device, with its own geometry: the widest array, and all together.
    pub fn resident_bytes<R>(&self) -> (u64, u64) {
        let (history, start) = (HISTORY * self.points(), self.start_numbers());
        let widest = history.max(start);
        let all = history
            + start
            + self.geometry_numbers()
            + self.elements
            + (1 + FACING) * self.contact_points
            + MATERIAL_ROOM * self.bodies();
        ((widest * size_of::<R>()) as u64, (all * size_of::<R>()) as u64)
    }
}

/// The lists of a connectivity, on the device.
#[derive(Debug)]
pub struct Connectivity {
    /// Sizes of a case.
    pub sizes: BatchSizes,
    /// Nodes that each element names, and which of its corners hang, as `hanging.wgsl` reads them.
    pub element_nodes: StorageBuffer<u32>,
    /// Starts of the nodes' lists of elements.
    pub node_start: StorageBuffer<u32>,
    /// The lists, as `node_force.wgsl` reads them.
    pub node_entry: StorageBuffer<u32>,
    /// Starts of the blocks' lists of element blocks.
    pub block_start: StorageBuffer<u32>,
    /// The lists.
    pub block_entry: StorageBuffer<u32>,
    /// Node of each contact point, and whether that lies on the symmetry plane; then the number of
    /// the plate's nodes, and they.
    pub surface: StorageBuffer<u32>,
}

impl Connectivity {
    /// Sends a mesh's lists.
    ///
    /// # Errors
    /// As [`GpuContext::array`].
    pub fn new(context: &GpuContext, mesh: &Mesh, plan: &BlockPlan) -> Result<Self, GpuError> {
        let [nodes, around] = with_hanging(mesh)?;
        let mut on_plane = vec![0u32; mesh.nodes.len()];
        mesh.symmetry_nodes.iter().for_each(|&n| on_plane[n as usize] = ON_SYMMETRY_PLANE);
        let of_point = |&n: &u32| n | on_plane[n as usize];
        let plate = std::iter::once(mesh.plate_nodes.len() as u32).chain(mesh.plate_nodes.iter().copied());
        let surface: Vec<u32> = mesh.contact_nodes.iter().map(of_point).chain(plate).collect();
        Ok(Self {
            sizes: BatchSizes {
                nodes: mesh.nodes.len(),
                elements: mesh.elements.len(),
                own_elements: mesh.own_elements(),
                contact_points: mesh.contact_nodes.len(),
                blocks: plan.blocks(),
            },
            element_nodes: context.array("element nodes", &nodes)?.whole(),
            node_start: context.array("elements around nodes: starts", &mesh.node_elements.start)?.whole(),
            node_entry: context.array("elements around nodes", &around)?.whole(),
            block_start: context.array("blocks of the tangent: starts", &plan.start)?.whole(),
            block_entry: context.array("blocks of the tangent", &plan.entry)?.whole(),
            surface: context.array("contact nodes and plate nodes", &surface)?.whole(),
        })
    }
}

/// A group of cases whose arrays the device binds together: all of a batch, or as many as one
/// binding holds.
#[derive(Debug)]
pub struct Resident<R> {
    /// First case of the batch.
    pub first: usize,
    /// Number of cases.
    pub count: usize,
    /// Index of each case's geometry among those of the group.
    pub geometry_of: Vec<u32>,
    pub(super) geometries: StorageBuffer<R>,
    /// Parameters and hardening tables.
    pub(super) materials: StorageBuffer<R>,
    /// What the present step starts from: committed displacements, and states.
    pub(super) start: StorageBuffer<R>,
    /// Committed states and last flows.
    pub(super) history: StorageBuffer<R>,
    /// Weight of the last flow in the states of `start`, a case.
    pub(super) anticipated: StorageBuffer<R>,
    pub(super) plastic_work: StorageBuffer<R>,
    pub(super) weight: StorageBuffer<R>,
    pub(super) friction: StorageBuffer<R>,
    /// What is known of contact points before they move, as `facing.wgsl` has it.
    pub(super) facing: StorageBuffer<R>,
}

impl<R: DeviceReal> Resident<R> {
    /// Sends `models`, the cases from `first` on, in their virgin state.
    ///
    /// # Errors
    /// [`ComputeError::InvertedMesh`]; what [`GpuContext::array`] says.
    pub fn new(context: &GpuContext, sizes: BatchSizes, first: usize, models: &[CaseModel]) -> Result<Self, ComputeError> {
        let count = models.len();
        let mut meshes: Vec<&Arc<Mesh>> = Vec::new();
        let geometry_of: Vec<u32> = models
            .iter()
            .map(|model| {
                let known = meshes.iter().position(|m| Arc::ptr_eq(m, &model.mesh));
                known.unwrap_or_else(|| {
                    meshes.push(&model.mesh);
                    meshes.len() - 1
                }) as u32
            })
            .collect();
        let points = sizes.points();
        let geometries = send_geometry::<R>(context, sizes, &meshes)?;
        let weight = context.zeros("contact weights", meshes.len() * sizes.contact_points)?.each(meshes.len());
        for (index, mesh) in meshes.iter().enumerate() {
            context.upload_at(&weight, index * sizes.contact_points, &contact_weights::<R>(mesh))?;
        }
        let materials = send_materials::<R>(context, sizes, models)?;
        let friction: Vec<R> = models.iter().map(|m| friction(m.friction)).collect();
        let resident = Self {
            first,
            count,
            geometry_of,
            geometries,
            weight,
            materials,
            start: context.zeros("displacements and states at the start", count * sizes.start_numbers())?.each(count),
            history: context.zeros("committed states", count * HISTORY * points)?.each(count),
            anticipated: context.zeros("weights of the last flow", count)?,
            plastic_work: context.zeros("plastic work", count * sizes.elements)?.each(count),
            friction: context.array("coefficients of friction", &friction)?,
            facing: context.zeros("contact points before they move", count * FACING * sizes.contact_points)?.each(count),
        };
        let still = vec![0.0; 3 * sizes.nodes];
        for (index, model) in models.iter().enumerate() {
            resident.set_undeformed(context, sizes, index, model)?;
            resident.set_displacement(context, sizes, index, model, &still)?;
        }
        Ok(resident)
    }

    /// Puts another case in the place of the group's case `index`, in its virgin state; `models`
    /// are the cases of the group with it. What comes back is the number of its geometry: none
    /// where the place shares one with another case and no other is free, or where its hardening
    /// table is too long, and then nothing was done.
    ///
    /// # Errors
    /// [`ComputeError::InvertedMesh`]; the device's fault.
    pub fn replace(
        &mut self,
        context: &GpuContext,
        sizes: BatchSizes,
        index: usize,
        models: &[CaseModel],
    ) -> Result<Option<usize>, ComputeError> {
        let (mesh, points) = (&models[index].mesh, sizes.points());
        let Some(geometry) = self.free_geometry(index, sizes) else { return Ok(None) };
        let numbers = flatten_geometry::<R>(mesh)?;
        if !replace_materials(context, sizes, models, &self.materials)? {
            return Ok(None);
        }
        context.upload_at(&self.geometries, geometry * sizes.geometry_numbers(), &numbers)?;
        context.upload_at(&self.weight, geometry * sizes.contact_points, &contact_weights::<R>(mesh))?;
        context.upload_at(&self.friction, index, &[friction::<R>(models[index].friction)])?;
        let mut list = context.record();
        list.clear(&self.start, index * sizes.start_numbers() + 3 * sizes.nodes, STATE * points)?;
        list.clear(&self.history, index * HISTORY * points, HISTORY * points)?;
        list.clear(&self.anticipated, index, 1)?;
        list.clear(&self.plastic_work, index * sizes.elements, sizes.elements)?;
        list.submit()?;
        self.set_undeformed(context, sizes, index, &models[index])?;
        self.set_displacement(context, sizes, index, &models[index], &vec![0.0; 3 * sizes.nodes])?;
        self.geometry_of[index] = geometry as u32;
        Ok(Some(geometry))
    }

    /// The geometry of a case, if no other case has it too, or one that no case has.
    fn free_geometry(&self, index: usize, sizes: BatchSizes) -> Option<usize> {
        let others = |geometry: u32| self.geometry_of.iter().enumerate().all(|(case, &g)| case == index || g != geometry);
        let all = self.geometries.len() / sizes.geometry_numbers().max(1);
        let own = self.geometry_of[index];
        std::iter::once(own).chain(0..all as u32).find(|&geometry| others(geometry)).map(|geometry| geometry as usize)
    }

    /// The geometries of the group in another precision; `models` are all cases of the batch.
    ///
    /// # Errors
    /// As [`Resident::new`].
    pub fn geometry<T: DeviceReal>(
        &self,
        context: &GpuContext,
        sizes: BatchSizes,
        models: &[CaseModel],
    ) -> Result<StorageBuffer<T>, ComputeError> {
        let count = self.geometry_of.iter().max().map_or(0, |last| *last + 1);
        let first_with = |geometry: u32| self.geometry_of.iter().position(|&g| g == geometry);
        let meshes: Vec<&Arc<Mesh>> = (0..count).filter_map(first_with).map(|case| &models[self.first + case].mesh).collect();
        send_geometry(context, sizes, &meshes)
    }

    /// Sends the committed displacement of the group's case `index`, rounded once, and the gaps and
    /// positions of contact points that it leaves, formed in f64.
    ///
    /// # Errors
    /// The device's fault.
    pub fn set_displacement(
        &self,
        context: &GpuContext,
        sizes: BatchSizes,
        index: usize,
        model: &CaseModel,
        displacement: &[f64],
    ) -> Result<(), GpuError> {
        let rounded: Vec<R> = displacement.iter().map(|&u| R::of(u)).collect();
        context.upload_at(&self.start, index * sizes.start_numbers(), &rounded)?;
        let moved = gaps_and_positions(model, |n, i| displacement[3 * n + i]);
        context.upload_at(&self.facing, FACING * index * sizes.contact_points, &moved)
    }

    /// Sends gaps and positions of the contact points of the group's case `index`, undeformed, and
    /// the curvature of its opponent.
    fn set_undeformed(&self, context: &GpuContext, sizes: BatchSizes, index: usize, model: &CaseModel) -> Result<(), GpuError> {
        let mut numbers = gaps_and_positions(model, |_, _| 0.0);
        numbers.resize(numbers.len() + sizes.contact_points, R::of(model.surface.curvature));
        context.upload_at(&self.facing, (FACING * index + GAP_AND_POSITION) * sizes.contact_points, &numbers)
    }
}

/// Gaps and positions `[component][point]` of contact points whose nodes have moved so.
fn gaps_and_positions<R: DeviceReal>(model: &CaseModel, moved: impl Fn(usize, usize) -> f64) -> Vec<R> {
    let place = |&n: &u32| -> [f64; 3] { std::array::from_fn(|i| model.mesh.nodes[n as usize][i] + moved(n as usize, i)) };
    let places: Vec<[f64; 3]> = model.mesh.contact_nodes.iter().map(place).collect();
    let gaps = places.iter().map(|x| R::of(model.surface.gap(x)));
    gaps.chain((0..3).flat_map(|i| places.iter().map(move |x| R::of(x[i])))).collect()
}

/// The nodes that elements name and the elements around nodes, with the bits of corners that hang.
///
/// # Errors
/// [`GpuError::TooLarge`] where numbers take the place of these bits.
fn with_hanging(mesh: &Mesh) -> Result<[Vec<u32>; 2], GpuError> {
    let largest = mesh.nodes.len().max(2 * mesh.elements.len()) as u64;
    if largest > u64::from(SOME_HANG) {
        let of = |nodes: u64| nodes * size_of::<[f32; 3]>() as u64;
        return Err(GpuError::TooLarge { what: "displacements".to_owned(), bytes: of(largest), limit: of(SOME_HANG.into()) });
    }
    let entries = |(nodes, &hanging): (&[u32; NODES], &Hanging)| -> [u32; NODES] {
        std::array::from_fn(|a| {
            let bits = u32::from(hanging.hangs(a)) << HANGS_AT | (hanging.octant() as u32 >> a & 1) << OCTANT_AT;
            nodes[a] | if hanging.is_none() { 0 } else { bits | SOME_HANG }
        })
    };
    let nodes = mesh.elements.iter().zip(&mesh.hanging).flat_map(entries).collect();
    let with = |&entry: &u32| if mesh.hanging[entry as usize / NODES].is_none() { entry } else { entry | HAS_HANGING };
    Ok([nodes, mesh.node_elements.entry.iter().map(with).collect()])
}

/// The weights of the contact conditions of a mesh's contact points.
fn contact_weights<R: DeviceReal>(mesh: &Mesh) -> Vec<R> {
    mesh.contact_size.iter().map(|&h| R::of(CONTACT_WEIGHT * h)).collect()
}

fn friction<R: DeviceReal>(friction: Friction<f64>) -> R {
    match friction {
        Friction::Coulomb(mu) => R::of(mu),
        Friction::Stick => R::of(FULL_STICK),
    }
}

/// The materials of cases, with room for those of others.
///
/// # Errors
/// As [`GpuContext::array`].
pub fn send_materials<T: DeviceReal>(
    context: &GpuContext,
    sizes: BatchSizes,
    models: &[CaseModel],
) -> Result<StorageBuffer<T>, GpuError> {
    let numbers = flatten(&materials::<T>(sizes, models));
    let room = (PARAMETERS + 3 * TABLE_ROOM) * sizes.bodies() * models.len();
    let materials = context.zeros("materials", numbers.len().max(room))?;
    context.upload_at(&materials, 0, &numbers)?;
    Ok(materials)
}

/// Writes those of other cases in their place; `false`, and nothing written, where their tables are
/// too long.
///
/// # Errors
/// The device's fault.
pub fn replace_materials<T: DeviceReal>(
    context: &GpuContext,
    sizes: BatchSizes,
    models: &[CaseModel],
    to: &StorageBuffer<T>,
) -> Result<bool, GpuError> {
    let numbers = flatten(&materials::<T>(sizes, models));
    if numbers.len() > to.len() {
        return Ok(false);
    }
    context.upload_at(to, 0, &numbers)?;
    Ok(true)
}

/// The materials of cases, then those of their opponents, if they have any that deform.
fn materials<T: DeviceReal>(sizes: BatchSizes, models: &[CaseModel]) -> Vec<Material<T>> {
    let own = models.iter().map(|model| &model.material);
    let opponents = models.iter().map(|model| model.opponent.as_ref().unwrap_or(&model.material));
    own.chain(opponents).take(sizes.bodies() * models.len()).map(Material::cast).collect()
}

/// Reference positions of the corners `[3 a + i][element]` and volumes `[point]` of meshes, one
/// after the other, on the device.
fn send_geometry<R: DeviceReal>(
    context: &GpuContext,
    sizes: BatchSizes,
    meshes: &[&Arc<Mesh>],
) -> Result<StorageBuffer<R>, ComputeError> {
    let geometries =
        context.zeros("reference positions and volumes", meshes.len() * sizes.geometry_numbers())?.each(meshes.len());
    for (index, mesh) in meshes.iter().enumerate() {
        write_geometry(context, sizes, &geometries, (index, mesh))?;
    }
    Ok(geometries)
}

/// Writes those of one mesh, the one of number `index`.
///
/// # Errors
/// [`ComputeError::InvertedMesh`], and nothing written; the device's fault.
pub fn write_geometry<R: DeviceReal>(
    context: &GpuContext,
    sizes: BatchSizes,
    geometries: &StorageBuffer<R>,
    (index, mesh): (usize, &Mesh),
) -> Result<(), ComputeError> {
    let numbers = flatten_geometry::<R>(mesh)?;
    context.upload_at(geometries, index * sizes.geometry_numbers(), &numbers)?;
    Ok(())
}

/// Positions of the corners relative to the element's first one `[3 a + i][element]`, which keep
/// their digits far from the origin, and volumes `[point]` of a mesh.
fn flatten_geometry<R: DeviceReal>(mesh: &Mesh) -> Result<Vec<R>, ComputeError> {
    let elements = mesh.elements.len();
    let mut numbers = vec![R::ZERO; (COORDINATES + QUADRATURE_POINTS) * elements];
    let (coordinates, volume) = numbers.split_at_mut(COORDINATES * elements);
    for e in 0..elements {
        let positions = mesh.corners(e);
        let geometry = ElementGeometry::<R>::new(&positions)
            .map_err(|invalid| ComputeError::InvertedMesh { element: e, point: invalid.point() })?;
        volume[QUADRATURE_POINTS * e..][..QUADRATURE_POINTS].copy_from_slice(&geometry.volume.0);
        for (a, position) in positions.iter().enumerate() {
            for i in 0..3 {
                coordinates[(3 * a + i) * elements + e] = R::of(position[i] - positions[0][i]);
            }
        }
    }
    Ok(numbers)
}
