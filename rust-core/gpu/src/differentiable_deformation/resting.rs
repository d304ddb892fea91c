//! Splats that the network is not evaluated for.

use trapeze_scene::deformation::RestingSplats;

use super::chunk::{Chunk, chunks};
use super::{DEFORMED_BYTES, DifferentiableDeformation};
use crate::GpuError;

impl DifferentiableDeformation {
    /// From the next [`forward`](Self::forward) on, the network is evaluated for the splats that move;
    /// the others get what they hold. `None` moves all. Work that was submitted is not affected.
    ///
    /// # Errors
    /// [`GpuError::OutOfMemory`] when there are more splats than it has room for,
    /// [`GpuError::Device`] when the device is lost.
    pub fn set_resting(&mut self, resting: Option<&RestingSplats>) -> Result<(), GpuError> {
        self.evaluated = None;
        let Some(resting) = resting else {
            if self.moving.take().is_some() {
                let all: Vec<u32> = (0..self.capacity).collect();
                self.gpu.write(&self.buffers.order, &all)?;
            }
            return Ok(());
        };
        self.check_room(resting.splats() as u32)?;
        let order: Vec<u32> = resting.moving().iter().copied().chain(resting.resting()).collect();
        self.gpu.write(&self.buffers.order, &order)?;
        self.gpu.write(&self.buffers.held, resting.held())?;
        self.moving = Some(resting.moving().len() as u32);
        Ok(())
    }

    pub(super) fn check_room(&self, splats: u32) -> Result<(), GpuError> {
        if splats <= self.capacity {
            return Ok(());
        }
        let bytes = |splats| u64::from(splats) * DEFORMED_BYTES;
        let (need, have) = (bytes(splats), bytes(self.capacity));
        Err(GpuError::OutOfMemory { what: "deformed splats", need, have })
    }

    /// The splats that move in chunks, and those that rest as one more.
    pub(super) fn chunks(&self, splats: u32) -> (Vec<Chunk>, Chunk) {
        let moving = self.moving.map_or(splats, |moving| moving.min(splats));
        let chunks = chunks(moving, self.columns);
        let resting = Chunk {
            index: chunks.len() as u32,
            first: moving,
            splats: splats - moving,
            columns: 0,
        };
        (chunks, resting)
    }
}
