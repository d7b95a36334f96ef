//! A case that has ended makes room for the next one: its place in a batch is taken by another of
//! the same connectivity, and nothing is allocated or compiled for it.

use super::backend::Gpu;
use super::batch::Batch;
use super::buffers::DeviceReal;
use super::error::GpuError;
use crate::compute::{CaseModel, ComputeError};

impl<R: DeviceReal> Gpu<R> {
    /// What [`crate::compute::Call::Replace`] asks for.
    pub(super) fn take_in(&mut self, case: usize, model: CaseModel) -> Result<bool, ComputeError> {
        if !model.is_alike(&self.models[case]) {
            return Err(ComputeError::Connectivity { case });
        }
        let before = std::mem::replace(&mut self.models[case], model);
        let taken = match &mut self.batch {
            Some(batch) => batch.replace(case, &self.models),
            None => Ok(false),
        };
        if !matches!(taken, Ok(true)) {
            self.models[case] = before;
            return taken;
        }
        self.committed[case].fill(0.0);
        (self.fresh[case], self.current[case], self.largest[case]) = (true, 0, [0.0; 2]);
        Ok(true)
    }
}

impl<R: DeviceReal> Batch<R> {
    /// Puts `models[case]` in the place of what this case was, in its virgin state; `false`, and
    /// nothing done, where there is no room for its geometry or its hardening table.
    ///
    /// # Errors
    /// [`ComputeError::InvertedMesh`]; the device's fault.
    fn replace(&mut self, case: usize, models: &[CaseModel]) -> Result<bool, ComputeError> {
        let nowhere = || GpuError::Length { what: "the cases of the batch".into(), expected: models.len(), given: case + 1 };
        let (sizes, all) = (self.sizes(), models);
        let group = self.groups.iter().position(|(r, _)| (r.first..r.first + r.count).contains(&case)).ok_or_else(nowhere)?;
        let resident = &mut self.groups[group].0;
        let (models, index) = (&models[resident.first..resident.first + resident.count], case - resident.first);
        let Some(geometry) = resident.replace(&self.context, sizes, index, models)? else { return Ok(false) };
        self.linear.iter().try_for_each(|linear| linear.face(&self.context, all))?;
        let of_mesh = (geometry, &*models[index].mesh);
        self.tangents.replace(&self.context, sizes, group, models, of_mesh)?;
        if let Some(iterates) = &self.iterates {
            iterates.groups[group].0.replace(&self.context, sizes, index, of_mesh)?;
        }
        Ok(true)
    }
}
