//! Tangents: in the precision of the residual, or in single precision beside a residual in double.
//! Newton's residual decides what is a solution, the tangent only how fast it is found; the linear
//! solver rounds it to single precision in any case.

use super::arguments::args;
use super::buffers::{DeviceReal, StorageBuffer};
use super::context::GpuContext;
use super::dispatch::Dispatch;
use super::error::GpuError;
use super::layout::{COORDINATES, ELEMENT_BLOCKS};
use super::pipelines::{Bound, KernelList};
use super::resident::{BatchSizes, Connectivity, MATERIAL_ROOM, Resident, replace_materials, send_materials, write_geometry};
use super::scratch::Scratch;
use super::shader_sources::{GATHER_TANGENT_BLOCKS, HEX8_JACOBIAN, HEX8_TANGENT, NARROW};
use crate::compute::{CaseModel, ComputeError};
use crate::mesh::Mesh;

/// The arrays of which tangents are made, in one precision.
struct Inputs<'a, T> {
    geometries: &'a StorageBuffer<T>,
    start: &'a StorageBuffer<T>,
    trial: &'a StorageBuffer<T>,
    materials: &'a StorageBuffer<T>,
}

/// The kernels of a group of cases.
#[derive(Debug)]
struct TangentKernels {
    jacobian: Bound,
    elements: Bound,
    blocks: Bound,
}

/// Tangents of all slots, and the kernels that make them.
#[derive(Debug)]
pub struct SlotTangents<T> {
    elements: StorageBuffer<T>,
    blocks: StorageBuffer<T>,
    groups: Vec<TangentKernels>,
}

impl<T: DeviceReal> SlotTangents<T> {
    fn new<R>(sizes: BatchSizes, scratch: &Scratch<R>, slots: usize) -> Result<Self, GpuError> {
        Ok(Self {
            elements: scratch.pools.vectors.view("tangents of elements", slots * ELEMENT_BLOCKS * sizes.elements)?.each(slots),
            blocks: scratch.pools.blocks.view("tangent blocks", slots * 9 * sizes.blocks)?.each(slots),
            groups: Vec::new(),
        })
    }

    fn bind<R>(
        &mut self,
        context: &GpuContext,
        mesh: &Connectivity,
        scratch: &Scratch<R>,
        inputs: &Inputs<'_, T>,
    ) -> Result<(), GpuError> {
        let shape = args! { dimensions: scratch.dimensions, active_cases: scratch.active };
        let jacobian = args! {
            element_nodes: mesh.element_nodes,
            geometries: inputs.geometries.partly(COORDINATES * mesh.sizes.elements),
            starts: inputs.start.partly(3 * mesh.sizes.nodes),
            trials: inputs.trial,
        };
        let elements = args! {
            element_nodes: mesh.element_nodes,
            geometries: inputs.geometries,
            starts: inputs.start,
            trials: inputs.trial,
            materials: inputs.materials,
            first_invalid: scratch.first_invalid,
            element_blocks: self.elements,
        };
        let gather = args! {
            block_start: mesh.block_start,
            block_entry: mesh.block_entry,
            element_blocks: self.elements,
            blocks: self.blocks,
        };
        self.groups.push(TangentKernels {
            jacobian: context.bind(&HEX8_JACOBIAN, T::PRECISION, &[&shape[..], &jacobian].concat())?,
            elements: context.bind(&HEX8_TANGENT, T::PRECISION, &[&shape[..], &elements].concat())?,
            blocks: context.bind(&GATHER_TANGENT_BLOCKS, T::PRECISION, &[&shape[..], &gather].concat())?,
        });
        Ok(())
    }

    fn append(&self, dispatch: &Dispatch, sizes: BatchSizes, list: &mut KernelList<'_>) -> Result<(), GpuError> {
        let (kernels, slots) = (&self.groups[dispatch.group], dispatch.cases.len());
        list.dispatch(&kernels.jacobian, sizes.points(), slots)?;
        list.dispatch(&kernels.elements, sizes.points(), slots)?;
        list.dispatch(&kernels.blocks, sizes.blocks, slots)
    }

    /// Upper blocks of the tangents, `[slot][3 i + j][block]`.
    pub fn blocks(&self) -> &StorageBuffer<T> {
        &self.blocks
    }
}

/// What a group of cases has in single precision as well.
#[derive(Debug)]
struct Narrowed {
    /// Numbers of a case or slot, with the kernel that copies them.
    copies: Vec<(usize, Bound)>,
    geometries: StorageBuffer<f32>,
    materials: StorageBuffer<f32>,
    _start: StorageBuffer<f32>,
}

/// Tangents in single precision beside residuals in another.
#[derive(Debug)]
pub struct Single {
    set: SlotTangents<f32>,
    groups: Vec<Narrowed>,
    _trial: StorageBuffer<f32>,
    _shapes: [StorageBuffer<[u32; 4]>; 2],
}

impl Single {
    /// The tangents themselves.
    pub fn set(&self) -> &SlotTangents<f32> {
        &self.set
    }
}

/// Memory of tangents.
#[derive(Clone, Copy, Debug)]
pub struct Bytes {
    /// Tangents of a slot's elements.
    pub elements: u64,
    /// Upper blocks of a slot.
    pub blocks: u64,
    /// What else there is of a slot.
    pub of_slot: u64,
    /// Copies in single precision of what a case has.
    pub of_case: u64,
}

/// The tangents of a batch.
#[derive(Debug)]
pub enum Tangents<R> {
    /// In the residual's precision.
    Same(Box<SlotTangents<R>>),
    /// In single precision.
    Single(Box<Single>),
}

impl<R: DeviceReal> Tangents<R> {
    /// What they take.
    pub fn bytes(sizes: BatchSizes, in_single: bool) -> Bytes {
        let number = if in_single { size_of::<f32>() } else { size_of::<R>() };
        let (elements, blocks) = (ELEMENT_BLOCKS * sizes.elements, 9 * sizes.blocks);
        let of_slot = if in_single { sizes.trial_numbers() } else { 0 };
        let of_case =
            if in_single { sizes.geometry_numbers() + sizes.start_numbers() + MATERIAL_ROOM * sizes.bodies() } else { 0 };
        let [elements, blocks, of_slot, of_case] = [elements, blocks, of_slot, of_case].map(|numbers| (number * numbers) as u64);
        Bytes { elements, blocks, of_slot, of_case }
    }

    /// The arrays of so many slots, and the kernels for all groups of cases.
    ///
    /// # Errors
    /// What the device says.
    pub fn new(
        context: &GpuContext,
        mesh: &Connectivity,
        scratch: &Scratch<R>,
        residents: &[Resident<R>],
        models: &[CaseModel],
        (slots, in_single): (usize, bool),
    ) -> Result<Self, ComputeError> {
        let sizes = mesh.sizes;
        if !in_single {
            let mut set = SlotTangents::new(sizes, scratch, slots)?;
            for r in residents {
                let (geometries, start, materials) = (&r.geometries, &r.start, &r.materials);
                let inputs = Inputs { geometries, start, trial: &scratch.trial, materials };
                set.bind(context, mesh, scratch, &inputs)?;
            }
            return Ok(Self::Same(Box::new(set)));
        }
        // Of increments the Jacobians are made anew.
        let [of_trial, of_start] = [sizes.trial_numbers(), sizes.start_numbers()];
        let shape = |count: usize, by_slot: u32, of: usize| {
            let block = context.block("shape of a copy")?;
            context.upload(&block, &[[count as u32, by_slot, of as u32, 0]])?;
            Ok::<_, GpuError>(block)
        };
        let (unknowns, shapes) = (3 * sizes.nodes, [shape(3 * sizes.nodes, 1, of_trial)?, shape(of_start, 0, of_start)?]);
        let mut set = SlotTangents::new(sizes, scratch, slots)?;
        let trial = context.zeros("increments and Jacobians in f32", slots * of_trial)?.each(slots);
        let mut groups = Vec::with_capacity(residents.len());
        for r in residents {
            let geometries = r.geometry::<f32>(context, sizes, models)?;
            let start = context.zeros("displacements and states in f32", r.count * of_start)?.each(r.count);
            let materials = send_materials::<f32>(context, sizes, &models[r.first..r.first + r.count])?;
            set.bind(
                context,
                mesh,
                scratch,
                &Inputs { geometries: &geometries, start: &start, trial: &trial, materials: &materials },
            )?;
            let pairs = [(unknowns, &scratch.trial, &trial), (of_start, &r.start, &start)];
            let copies = pairs
                .into_iter()
                .zip(&shapes)
                .map(|((count, wide, copy), shape)| {
                    let (wide, copy) = (wide.partly(count), copy.partly(count));
                    let arguments = args! { dimensions: scratch.dimensions, active_cases: scratch.active, shape, wide, copy };
                    Ok((count, context.bind(&NARROW, R::PRECISION, &arguments)?))
                })
                .collect::<Result<Vec<_>, GpuError>>()?;
            groups.push(Narrowed { copies, geometries, materials, _start: start });
        }
        Ok(Self::Single(Box::new(Single { set, groups, _trial: trial, _shapes: shapes })))
    }

    /// After [`Resident::replace`] with these `models`: sends what there is in single precision of
    /// the new case; `of_mesh` is its mesh with the number that it has.
    ///
    /// # Errors
    /// [`ComputeError::InvertedMesh`]; the device's fault.
    pub fn replace(
        &self,
        context: &GpuContext,
        sizes: BatchSizes,
        group: usize,
        models: &[CaseModel],
        of_mesh: (usize, &Mesh),
    ) -> Result<(), ComputeError> {
        let Self::Single(single) = self else { return Ok(()) };
        let narrowed = &single.groups[group];
        write_geometry(context, sizes, &narrowed.geometries, of_mesh)?;
        // The tables fit: those in the residual's precision did, and are as long.
        replace_materials(context, sizes, models, &narrowed.materials).map(drop)?;
        Ok(())
    }

    /// Appends the kernels that make the tangents at the increments that the slots have.
    ///
    /// # Errors
    /// The device's fault.
    pub fn append(&self, dispatch: &Dispatch, sizes: BatchSizes, list: &mut KernelList<'_>) -> Result<(), GpuError> {
        match self {
            Self::Same(set) => set.append(dispatch, sizes, list),
            Self::Single(single) => {
                for (count, copy) in &single.groups[dispatch.group].copies {
                    list.dispatch(copy, *count, dispatch.cases.len())?;
                }
                single.set.append(dispatch, sizes, list)
            }
        }
    }
}
