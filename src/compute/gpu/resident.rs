//! What stays on the device: the geometry, parameters and committed state of a group of cases.

use std::sync::Arc;

use super::block_plan::BlockPlan;
use super::buffers::{DeviceReal, StorageBuffer};
use super::context::GpuContext;
use super::error::GpuError;
use super::layout::{COORDINATES, HISTORY, STATE};
use super::material::flatten;
use crate::compute::{CaseModel, ComputeError};
use crate::contact::coulomb::{CONTACT_WEIGHT, Friction};
use crate::element::hex8::{Geometry, NODES, QUADRATURE_POINTS};
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
pub struct Sizes {
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

impl Sizes {
    /// Quadrature points of a case.
    pub fn points(&self) -> usize {
        QUADRATURE_POINTS * self.elements
    }

    /// Bodies that deform.
    pub fn bodies(&self) -> usize {
        if self.own_elements < self.elements { 2 } else { 1 }
    }

    /// Bytes a case keeps on the device, with its own geometry: the widest array, and all together.
    pub fn resident_bytes<R>(&self) -> (u64, u64) {
        let widest = HISTORY * self.points();
        let all = widest
            + (1 + STATE) * self.points()
            + (COORDINATES + 1) * self.elements
            + 3 * self.nodes
            + 2 * self.contact_points
            + MATERIAL_ROOM * self.bodies();
        ((widest * size_of::<R>()) as u64, (all * size_of::<R>()) as u64)
    }
}

/// The lists of a connectivity, on the device.
#[derive(Debug)]
pub struct Connectivity {
    /// Sizes of a case.
    pub sizes: Sizes,
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
    /// Node of each contact point.
    pub contact_node: StorageBuffer<u32>,
    /// Whether each contact point lies on the symmetry plane.
    pub on_symmetry_plane: StorageBuffer<u32>,
}

impl Connectivity {
    /// Sends a mesh's lists.
    ///
    /// # Errors
    /// As [`GpuContext::array`].
    pub fn new(context: &GpuContext, mesh: &Mesh, plan: &BlockPlan) -> Result<Self, GpuError> {
        let [nodes, around] = with_hanging(mesh)?;
        let mut on_plane = vec![0u32; mesh.nodes.len()];
        mesh.symmetry_nodes.iter().for_each(|&n| on_plane[n as usize] = 1);
        let on_plane: Vec<u32> = mesh.contact_nodes.iter().map(|&n| on_plane[n as usize]).collect();
        Ok(Self {
            sizes: Sizes {
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
            contact_node: context.array("contact nodes", &mesh.contact_nodes)?.whole(),
            on_symmetry_plane: context.array("contact points on the symmetry plane", &on_plane)?.whole(),
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
    pub(super) coordinates: StorageBuffer<R>,
    pub(super) volume: StorageBuffer<R>,
    pub(super) committed: StorageBuffer<R>,
    pub(super) parameters: StorageBuffer<R>,
    pub(super) table: StorageBuffer<R>,
    /// The states from which the present step starts.
    pub(super) state: StorageBuffer<R>,
    /// Committed states and last flows.
    pub(super) history: StorageBuffer<R>,
    /// Weight of the last flow in `state`, a case.
    pub(super) anticipated: StorageBuffer<R>,
    pub(super) plastic_work: StorageBuffer<R>,
    pub(super) weight: StorageBuffer<R>,
    pub(super) friction: StorageBuffer<R>,
    pub(super) gap: StorageBuffer<R>,
}

impl<R: DeviceReal> Resident<R> {
    /// Sends `models`, the cases from `first` on, in their virgin state.
    ///
    /// # Errors
    /// [`ComputeError::InvertedMesh`]; what [`GpuContext::array`] says.
    pub fn new(context: &GpuContext, sizes: Sizes, first: usize, models: &[CaseModel]) -> Result<Self, ComputeError> {
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
        let (coordinates, volume) = send_geometry::<R>(context, sizes, &meshes)?;
        let weight = context.zeros("contact weights", meshes.len() * sizes.contact_points)?.each(meshes.len());
        for (index, mesh) in meshes.iter().enumerate() {
            context.upload_at(&weight, index * sizes.contact_points, &contact_weights::<R>(mesh))?;
        }
        let (parameters, table) = send_materials::<R>(context, sizes, models)?;
        let friction: Vec<R> = models.iter().map(|m| friction(m.friction)).collect();
        let resident = Self {
            first,
            count,
            geometry_of,
            coordinates,
            volume,
            weight,
            committed: context.zeros("committed displacements", count * 3 * sizes.nodes)?.each(count),
            parameters,
            table,
            state: context.zeros("states at the start", count * STATE * points)?.each(count),
            history: context.zeros("committed states", count * HISTORY * points)?.each(count),
            anticipated: context.zeros("weights of the last flow", count)?,
            plastic_work: context.zeros("plastic work", count * sizes.elements)?.each(count),
            friction: context.array("coefficients of friction", &friction)?,
            gap: context.zeros("gaps at the start of the step", count * sizes.contact_points)?.each(count),
        };
        let still = vec![0.0; 3 * sizes.nodes];
        for (index, model) in models.iter().enumerate() {
            resident.set_displacement(context, sizes, index, &model.mesh, &still)?;
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
        sizes: Sizes,
        index: usize,
        models: &[CaseModel],
    ) -> Result<Option<usize>, ComputeError> {
        let (mesh, points) = (&models[index].mesh, sizes.points());
        let Some(geometry) = self.free_geometry(index, sizes) else { return Ok(None) };
        let (positions, volumes) = flatten_geometry::<R>(mesh)?;
        if !replace_materials(context, sizes, models, (&self.parameters, &self.table))? {
            return Ok(None);
        }
        context.upload_at(&self.coordinates, geometry * COORDINATES * sizes.elements, &positions)?;
        context.upload_at(&self.volume, geometry * points, &volumes)?;
        context.upload_at(&self.weight, geometry * sizes.contact_points, &contact_weights::<R>(mesh))?;
        context.upload_at(&self.friction, index, &[friction::<R>(models[index].friction)])?;
        let mut list = context.record();
        list.clear(&self.state, index * STATE * points, STATE * points)?;
        list.clear(&self.history, index * HISTORY * points, HISTORY * points)?;
        list.clear(&self.anticipated, index, 1)?;
        list.clear(&self.plastic_work, index * sizes.elements, sizes.elements)?;
        list.submit()?;
        self.set_displacement(context, sizes, index, mesh, &vec![0.0; 3 * sizes.nodes])?;
        self.geometry_of[index] = geometry as u32;
        Ok(Some(geometry))
    }

    /// The geometry of a case, if no other case has it too, or one that no case has.
    fn free_geometry(&self, index: usize, sizes: Sizes) -> Option<usize> {
        let others = |geometry: u32| self.geometry_of.iter().enumerate().all(|(case, &g)| case == index || g != geometry);
        let all = self.volume.len() / sizes.points().max(1);
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
        sizes: Sizes,
        models: &[CaseModel],
    ) -> Result<(StorageBuffer<T>, StorageBuffer<T>), ComputeError> {
        let count = self.geometry_of.iter().max().map_or(0, |last| *last + 1);
        let first_with = |geometry: u32| self.geometry_of.iter().position(|&g| g == geometry);
        let meshes: Vec<&Arc<Mesh>> = (0..count).filter_map(first_with).map(|case| &models[self.first + case].mesh).collect();
        send_geometry(context, sizes, &meshes)
    }

    /// Sends the committed displacement of the group's case `index`, rounded once, and the gaps
    /// that it leaves, formed in f64.
    ///
    /// # Errors
    /// The device's fault.
    pub fn set_displacement(
        &self,
        context: &GpuContext,
        sizes: Sizes,
        index: usize,
        mesh: &Mesh,
        displacement: &[f64],
    ) -> Result<(), GpuError> {
        let rounded: Vec<R> = displacement.iter().map(|&u| R::of(u)).collect();
        context.upload_at(&self.committed, index * 3 * sizes.nodes, &rounded)?;
        let gaps: Vec<R> = mesh
            .contact_nodes
            .iter()
            .map(|&n| R::of(crate::contact::plane::gap(mesh.nodes[n as usize][2], displacement[3 * n as usize + 2])))
            .collect();
        context.upload_at(&self.gap, index * sizes.contact_points, &gaps)
    }
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

/// The parameters and hardening tables of cases, with room for those of others.
///
/// # Errors
/// As [`GpuContext::array`].
pub fn send_materials<T: DeviceReal>(
    context: &GpuContext,
    sizes: Sizes,
    models: &[CaseModel],
) -> Result<(StorageBuffer<T>, StorageBuffer<T>), GpuError> {
    let (parameters, table) = flatten(&materials::<T>(sizes, models));
    let room = 3 * TABLE_ROOM * sizes.bodies() * models.len();
    let parameters = context.array("material parameters", &parameters)?;
    let tables = context.zeros("hardening tables", table.len().max(room))?;
    context.upload_at(&tables, 0, &table)?;
    Ok((parameters, tables))
}

/// Writes those of other cases in their place; `false`, and nothing written, where their tables are
/// too long.
///
/// # Errors
/// The device's fault.
pub fn replace_materials<T: DeviceReal>(
    context: &GpuContext,
    sizes: Sizes,
    models: &[CaseModel],
    (parameters, tables): (&StorageBuffer<T>, &StorageBuffer<T>),
) -> Result<bool, GpuError> {
    let (numbers, table) = flatten(&materials::<T>(sizes, models));
    if table.len() > tables.len() {
        return Ok(false);
    }
    context.upload(parameters, &numbers)?;
    context.upload_at(tables, 0, &table)?;
    Ok(true)
}

/// The materials of cases, then those of their opponents, if they have any that deform.
fn materials<T: DeviceReal>(sizes: Sizes, models: &[CaseModel]) -> Vec<Material<T>> {
    let own = models.iter().map(|model| &model.material);
    let opponents = models.iter().map(|model| model.opponent.as_ref().unwrap_or(&model.material));
    own.chain(opponents).take(sizes.bodies() * models.len()).map(Material::cast).collect()
}

/// Reference positions of the corners `[mesh][3 a + i][element]` and volumes `[mesh][point]` of
/// meshes, on the device.
fn send_geometry<R: DeviceReal>(
    context: &GpuContext,
    sizes: Sizes,
    meshes: &[&Arc<Mesh>],
) -> Result<(StorageBuffer<R>, StorageBuffer<R>), ComputeError> {
    let points = sizes.points();
    let zeros = |what: &str, of_mesh: usize| Ok::<_, GpuError>(context.zeros(what, meshes.len() * of_mesh)?.each(meshes.len()));
    let coordinates = zeros("reference positions", COORDINATES * sizes.elements)?;
    let volume = zeros("reference volumes", points)?;
    for (index, mesh) in meshes.iter().enumerate() {
        write_geometry(context, sizes, (&coordinates, &volume), (index, mesh))?;
    }
    Ok((coordinates, volume))
}

/// Writes those of one mesh, the one of number `index`.
///
/// # Errors
/// [`ComputeError::InvertedMesh`], and nothing written; the device's fault.
pub fn write_geometry<R: DeviceReal>(
    context: &GpuContext,
    sizes: Sizes,
    (coordinates, volume): (&StorageBuffer<R>, &StorageBuffer<R>),
    (index, mesh): (usize, &Mesh),
) -> Result<(), ComputeError> {
    let (positions, volumes) = flatten_geometry::<R>(mesh)?;
    context.upload_at(coordinates, index * COORDINATES * sizes.elements, &positions)?;
    context.upload_at(volume, index * sizes.points(), &volumes)?;
    Ok(())
}

/// Positions of the corners relative to the element's first one `[3 a + i][element]`, which keep
/// their digits far from the origin, and volumes `[point]` of a mesh.
fn flatten_geometry<R: DeviceReal>(mesh: &Mesh) -> Result<(Vec<R>, Vec<R>), ComputeError> {
    let elements = mesh.elements.len();
    let mut coordinates = vec![R::ZERO; COORDINATES * elements];
    let mut volume = vec![R::ZERO; QUADRATURE_POINTS * elements];
    for e in 0..elements {
        let positions = mesh.corners(e);
        let geometry = Geometry::<R>::new(&positions)
            .map_err(|invalid| ComputeError::InvertedMesh { element: e, point: invalid.point() })?;
        volume[QUADRATURE_POINTS * e..][..QUADRATURE_POINTS].copy_from_slice(&geometry.volume.0);
        for (a, position) in positions.iter().enumerate() {
            for i in 0..3 {
                coordinates[(3 * a + i) * elements + e] = R::of(position[i] - positions[0][i]);
            }
        }
    }
    Ok((coordinates, volume))
}
