//! The border between the trainer and what it trains on: one trait, implemented for the CPU and
//! for the GPU.
//!
//! # Why it looks like this
//!
//! On a GPU a step takes about a millisecond, and a round trip to the CPU about as long. A loop
//! that asks "what was the loss? how many splats are there?" after every step runs at half speed.
//! So the trait is cut along what has to be known where:
//!
//! * **The trainer decides from step numbers alone.** Rates, SH degree, background, view, when and
//!   to how many splats the set grows: all of a [`StepPlan`] or [`DensifyPlan`] is a function of
//!   (configuration, step). Densification moves splats but removes none, so even the number of
//!   splats is known without asking. Nothing that a backend has to be *told* depends on anything
//!   that it has to be *asked*.
//! * **The backend decides what depends on parameters.** Which splats are dead and where they go
//!   is drawn from counter-based random numbers with integer weights
//!   ([`random`](crate::random), [`densify`](crate::densify)): the same choice wherever it is made.
//! * **Orders return at once.** [`step`](TrainingBackend::step) and
//!   [`densify`](TrainingBackend::densify) only have to be carried out in order. The CPU does the
//!   work inside the call; the GPU records it, and keeps submissions short for the watchdog.
//! * **Answers come late, at a fixed distance.** [`reports`](TrainingBackend::reports) gives what
//!   was measured up to a step. The trainer asks at step s for the reports up to s −
//!   [`REPORT_LAG`], whether newer ones are there or not. A backend that is less than the lag behind
//!   never waits, one that is further behind waits there, which also bounds its queue; and the
//!   decisions that a report causes (roll back, stop early) fall on the same step on every machine,
//!   fast or slow. A decision that read whatever happened to have arrived could not be reproduced.
//! * **Until the answer is there, the state must stay sound.** A parameter whose gradient or new
//!   value is not finite keeps its old value and is counted
//!   ([`adam_step`](crate::optimizer::adam_step)); the trainer sees the count
//!   [`REPORT_LAG`] steps later and loads the last good checkpoint.
//! * **Only three calls wait**, and each is rare: [`state`](TrainingBackend::state) (checkpoints and
//!   the result), [`render`](TrainingBackend::render) (evaluation, previews) and
//!   [`load`](TrainingBackend::load) (start, resume, roll-back).
//!
//! Photographs are handed over once per view, not once per step: a backend keeps as many as its
//! budget allows and says which it has, so that the loader decodes only what is missing.
//!
//! A view of the splats that a renderer can draw without a copy is not part of the trait: its type
//! is the backend's own (buffers on the GPU), and who wants it knows which backend it holds.

use std::sync::Arc;

use fearless_simd::Level;
use thiserror::Error;
use trapeze_scene::deformation::RestingSplats;
use trapeze_scene::{Camera, Frame, FrameSettings, Scene, ShDegree};

use crate::TrainingState;
use crate::loss::{LossValue, TargetImage};
use crate::rest::{Look, look_at};
use crate::schedule::{DensifyPlan, StepPlan};

/// Steps between a measurement and the decisions that may use it. Enough for a GPU to run ahead
/// (a few milliseconds of work), little enough that a diverging run is caught within a blink.
pub const REPORT_LAG: u32 = 16;

/// One training view. Its photograph is known to the backend by `id`.
#[derive(Clone, Debug, PartialEq)]
pub struct TrainingView {
    /// Index among the training views.
    pub id: u32,
    /// The camera, relative to the origin of the splats.
    pub camera: Camera,
    /// Time in 0–1, for scenes that move.
    pub time: f32,
}

/// What one step measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepReport {
    /// The step, from 0.
    pub step: u32,
    /// Loss of the step's view before the update, regularisers not included.
    pub loss: LossValue,
    /// Parameters that kept their value because something was not finite.
    pub not_finite: u32,
    /// Splats that touched at least one pixel.
    pub visible: u32,
}

impl StepReport {
    /// Whether the step was sound: a finite loss and no parameter left behind.
    #[must_use]
    pub fn is_sound(&self) -> bool {
        self.loss.total.is_finite() && self.not_finite == 0
    }
}

/// Why a backend could not go on. The trainer returns to the last checkpoint or stops with the
/// message; it never continues from a state that it has not loaded.
#[derive(Debug, Error)]
pub enum BackendError {
    /// The device was lost, or taken away by the system.
    #[error("the device was lost: {0}")]
    DeviceLost(String),
    /// The splats, images or working memory do not fit.
    #[error("{what}: {needed} bytes are needed, {available} are available")]
    OutOfMemory {
        /// What did not fit.
        what: String,
        /// Bytes that it takes.
        needed: u64,
        /// Bytes that are left.
        available: u64,
    },
    /// A step was asked for a view whose photograph is not resident.
    #[error("view {id}: its photograph is not resident")]
    MissingTarget {
        /// The view.
        id: u32,
    },
    /// A frame that cannot be rendered.
    #[error("{0}")]
    Render(String),
    /// A photograph and a camera that do not fit together, or a camera that cannot project.
    #[error("view {id}: {reason}")]
    View {
        /// The view.
        id: u32,
        /// What does not fit.
        reason: String,
    },
}

/// Holds the parameters, the optimiser and the photographs, and takes steps.
///
/// Calls are carried out in the order in which they are made. After an error other than
/// [`BackendError::MissingTarget`] the resident state is lost; [`load`](Self::load) starts again.
pub trait TrainingBackend {
    /// Bytes of working memory that it takes at most, beyond parameters, moments, gradients and
    /// photographs, for `splats` splats and views of `pixels` pixels: what the estimate before a run
    /// is made of. The default is that of a backend which keeps 256 bytes a splat and 64 a pixel.
    fn working_bytes(&self, splats: u32, pixels: u64) -> u64 {
        256 * u64::from(splats) + 64 * pixels
    }

    /// Bytes of working memory that training a deformation network takes on top, for the same
    /// estimate. The default is that of a backend which keeps the activations of every splat.
    fn network_working_bytes(&self, splats: u32) -> u64 {
        // Ten layers of 256 numbers.
        10 * 256 * 4 * u64::from(splats)
    }

    /// Bytes of photographs that it keeps at most, for the same estimate.
    fn target_budget(&self) -> u64 {
        u64::MAX
    }

    /// Replaces the resident state. Reports of earlier steps are dropped. Photographs stay. The state
    /// is given away: a copy of it would be among the largest things of a run.
    ///
    /// # Errors
    /// [`BackendError::OutOfMemory`] when `capacity` splats and their optimiser do not fit;
    /// `capacity` is the largest number of splats that the run will ask for.
    fn load(&mut self, state: TrainingState, capacity: u32) -> Result<(), BackendError>;

    /// A copy of the resident state after every step that was asked for. Waits.
    ///
    /// # Errors
    /// [`BackendError`] when the device fails.
    fn state(&mut self) -> Result<TrainingState, BackendError>;

    /// The same without a copy, where the state is in memory that it can be taken out of. Until it is
    /// [put back](Self::put_back) or another one is loaded, nothing else may be asked for.
    ///
    /// # Errors
    /// [`BackendError`] when the device fails.
    fn take_state(&mut self) -> Result<TrainingState, BackendError> {
        self.state()
    }

    /// Puts back, unchanged, what [`take_state`](Self::take_state) gave.
    fn put_back(&mut self, _state: TrainingState) {}

    /// Frees what another state will need that is loaded next. Until then nothing else may be asked for.
    fn release(&mut self) {}

    /// Whether the photograph of this view is resident.
    fn has_target(&self, view: u32) -> bool;

    /// Makes a photograph resident; others may be dropped for it, except the one before it.
    ///
    /// # Errors
    /// [`BackendError::OutOfMemory`] when this one alone does not fit.
    fn admit_target(&mut self, view: u32, target: Arc<TargetImage>) -> Result<(), BackendError>;

    /// Takes one step: render, loss, backward, regularisers, update, noise; raises the SH degree
    /// first where the plan asks for more bands. Need not wait.
    ///
    /// # Errors
    /// [`BackendError::MissingTarget`] when the photograph has to be admitted first.
    fn step(&mut self, plan: &StepPlan, view: &TrainingView) -> Result<(), BackendError>;

    /// Changes the set of splats: the dead move, then the set grows to the plan's count; all move with
    /// the network again. Need not wait, but for splats that rest.
    ///
    /// # Errors
    /// [`BackendError`] when the device fails.
    fn densify(&mut self, plan: &DensifyPlan) -> Result<(), BackendError>;

    /// Number of splats after everything that was asked for; never waits.
    fn splat_count(&self) -> u32;

    /// The reports, in order, that have not been given yet of all steps up to and including
    /// `step`. Waits only for these.
    ///
    /// # Errors
    /// [`BackendError`] when the device fails.
    fn reports(&mut self, step: u32) -> Result<Vec<StepReport>, BackendError>;

    /// The geometry of all resident splats at some times, as the network deforms it; none rests until
    /// the next [`rest`](Self::rest). Waits. The default evaluates the network on the processor.
    ///
    /// # Errors
    /// [`BackendError`] when the device fails.
    fn look(&mut self, times: &[f32]) -> Result<Look, BackendError> {
        let state = self.state()?;
        let deformation = state.network.map(|trained| trained.network);
        let scene = Scene { deformation, ..Scene::from_splats(state.splats) };
        Ok(look_at(&scene, Level::new(), times))
    }

    /// From the next step on, the network is evaluated for the splats that move only; the others keep
    /// the outputs that they hold. A change of the set ends it, and so does `None`. The default goes
    /// on evaluating it for all.
    ///
    /// # Errors
    /// [`BackendError`] when these are not the resident splats, or the device fails.
    fn rest(&mut self, resting: Option<RestingSplats>) -> Result<(), BackendError> {
        let _ = resting;
        Ok(())
    }

    /// ∂L/∂(opacity logit) of every resident splat, for ∂L/∂(r, g, b premultiplied over black, alpha)
    /// of every pixel of a view, drawn with SH bands up to `sh_degree`. Waits.
    ///
    /// # Errors
    /// [`BackendError`] when the view cannot be drawn, the gradient has another size, or the device
    /// fails.
    fn opacity_gradient(
        &mut self,
        view: &TrainingView,
        sh_degree: ShDegree,
        by_image: &[[f32; 4]],
    ) -> Result<Vec<f32>, BackendError>;

    /// Renders the resident splats. Waits.
    ///
    /// # Errors
    /// [`BackendError`] when the camera cannot project or the device fails.
    fn render(&mut self, camera: &Camera, settings: &FrameSettings) -> Result<Frame, BackendError>;
}
