//! The deformation stage: what is kept between frames, and one frame's evaluation.

use fearless_simd::{Level, Simd, dispatch};
use rayon::prelude::*;
use trapeze_scene::deformation::{PositionHead, RestingSplats};
use trapeze_scene::{DeformationNetwork, Scene};

use super::apply::{HeadMeaning, apply_outputs};
use super::deformed::{Deformed, SplatPose};
use super::group::{BLOCK, Row};
use super::network::{BATCH, MAX_HEAD_OUTPUTS, PackedNetwork, Scratch, TimeTerms};
use super::order::spatial_order;

/// Choices that trade memory for time; none of them changes the result.
#[derive(Clone, Copy, Debug)]
pub struct DeformationOptions {
    /// SIMD instructions to use: the best that the machine has, by default.
    pub level: Level,
    /// Most bytes to spend on what depends on the positions alone (2 KB per splat in the standard
    /// network, about a fifth of the multiply–adds of a frame). Scenes that need more compute it in
    /// each frame.
    pub position_term_budget: usize,
}

impl Default for DeformationOptions {
    fn default() -> Self {
        Self { level: Level::new(), position_term_budget: 256 << 20 }
    }
}

/// Poses the splats of one scene at any time.
///
/// Without a deformation network that is done once, and a frame costs nothing.
#[derive(Debug)]
pub struct DeformationStage {
    /// The state of the last frame.
    deformed: Deformed,
    /// The moment that `deformed` shows; `None` before the first frame.
    shown: Option<Shown>,
    moving: Option<MovingSplats>,
    mask: Option<Mask>,
}

/// What is kept for a scene with a network.
#[derive(Debug)]
struct MovingSplats {
    level: Level,
    network: PackedNetwork,
    meaning: HeadMeaning,
    /// As stored, activated.
    canonical: Deformed,
    /// The state at t = 0, from the first masked frame on.
    initial: Option<Deformed>,
    /// Splat index of each rank in spatial order.
    order: Vec<u32>,
    all_ranks: Vec<u32>,
    position_terms: PositionTerms,
    /// Working memory: the poses of a frame, in the order of their ranks.
    poses: Vec<SplatPose>,
}

/// The part of the input sums that depends on the position alone, by rank.
#[derive(Debug)]
enum PositionTerms {
    /// [`PackedNetwork::position_term_rows`] rows per splat.
    Kept(Vec<Row>),
    ComputedPerFrame,
}

/// The dynamic splats at the last frame's threshold.
#[derive(Debug)]
struct Mask {
    threshold: f32,
    dynamic_ranks: Option<Vec<u32>>,
}

/// A moment of the scene.
#[derive(Debug, PartialEq)]
struct Shown {
    time: f32,
    /// The splats that are at `time`, ascending in spatial rank; `None` is all of them.
    dynamic_ranks: Option<Vec<u32>>,
}

impl DeformationStage {
    /// Prepares a scene, with the default options.
    #[must_use]
    pub fn new(scene: &Scene) -> Self {
        Self::with_options(scene, DeformationOptions::default())
    }

    /// Prepares a scene.
    #[must_use]
    pub fn with_options(scene: &Scene, options: DeformationOptions) -> Self {
        let canonical = Deformed::from_static(&scene.splats);
        Self {
            moving: scene
                .deformation
                .as_ref()
                .map(|network| MovingSplats::new(scene, network, canonical.clone(), options)),
            deformed: canonical,
            shown: None,
            mask: None,
        }
    }

    /// Poses the splats for a frame: at `time`, or, for the splats whose motion value is at most
    /// `static_threshold`, at t = 0. A scene without motion values has no static splats.
    ///
    /// `scene` is the scene that the stage was made for.
    pub fn deform(&mut self, scene: &Scene, time: f32, static_threshold: Option<f32>) -> &Deformed {
        let dynamic_ranks = match (&self.moving, &scene.motion, static_threshold) {
            (Some(moving), Some(motion), Some(threshold)) => {
                let same = |mask: &Mask| mask.threshold.to_bits() == threshold.to_bits();
                let mask = self.mask.take().filter(same).unwrap_or_else(|| Mask {
                    threshold,
                    dynamic_ranks: moving.ranks_of(&motion.dynamic_indices(threshold)),
                });
                self.mask.insert(mask).dynamic_ranks.clone()
            }
            _ => None,
        };
        self.show(Shown { time, dynamic_ranks })
    }

    /// Poses the splats `dynamic` (all of them for `None`) at `time`, and the others at t = 0,
    /// whatever was evaluated before. Time NaN or infinite is taken as 0.
    ///
    /// # Panics
    /// When an index of `dynamic` is out of range.
    pub fn evaluate(&mut self, time: f32, dynamic: Option<&[u32]>) -> &Deformed {
        let dynamic_ranks = match &self.moving {
            Some(moving) => dynamic.and_then(|indices| moving.ranks_of(indices)),
            None => None,
        };
        self.show(Shown { time, dynamic_ranks })
    }

    /// Poses the splats that move at `time`; the others get what they hold, and the network is not
    /// evaluated for them. Time NaN or infinite is taken as 0.
    ///
    /// # Panics
    /// When `resting` is of other splats.
    pub fn evaluate_beside(&mut self, time: f32, resting: &RestingSplats) -> &Deformed {
        let Some(moving) = &mut self.moving else { return &self.deformed };
        self.shown = None;
        for (i, held) in resting.resting().zip(resting.held()) {
            let mut outputs = [0.0; MAX_HEAD_OUTPUTS];
            outputs[..held.len()].copy_from_slice(held);
            let canonical = moving.canonical.pose(i as usize);
            let pose = apply_outputs(&canonical, &outputs, &moving.meaning);
            self.deformed.set(i as usize, &pose);
        }
        let ranks = moving.ranks_of(resting.moving());
        moving.evaluate(time, ranks.as_deref(), &mut self.deformed);
        &self.deformed
    }

    /// Nothing is computed that `deformed` holds already: the same frame again, or the static
    /// splats of the same mask.
    fn show(&mut self, wanted: Shown) -> &Deformed {
        if let Some(moving) = &mut self.moving
            && self.shown.as_ref() != Some(&wanted)
        {
            let held = self.shown.take().is_some_and(|s| s.dynamic_ranks == wanted.dynamic_ranks);
            if wanted.dynamic_ranks.is_some() && !held {
                self.deformed.clone_from(moving.initial());
            }
            moving.evaluate(wanted.time, wanted.dynamic_ranks.as_deref(), &mut self.deformed);
            self.shown = Some(wanted);
        }
        &self.deformed
    }
}

impl MovingSplats {
    fn new(
        scene: &Scene,
        network: &DeformationNetwork,
        canonical: Deformed,
        options: DeformationOptions,
    ) -> Self {
        let order = spatial_order(&scene.splats.positions);
        let mut moving = Self {
            level: options.level,
            network: PackedNetwork::new(network),
            meaning: HeadMeaning {
                screw: matches!(network.position_head, PositionHead::Screw { .. }),
                rotation_rule: network.rotation_rule,
                origin: scene.origin.to_array(),
            },
            canonical,
            initial: None,
            all_ranks: (0..order.len() as u32).collect(),
            order,
            position_terms: PositionTerms::ComputedPerFrame,
            poses: Vec::new(),
        };
        let bytes = moving.order.len() * moving.network.position_term_rows() * size_of::<Row>();
        if bytes <= options.position_term_budget {
            moving.position_terms = PositionTerms::Kept(moving.compute_position_terms());
        }
        moving
    }

    fn compute_position_terms(&self) -> Vec<Row> {
        let rows = self.network.position_term_rows();
        let mut terms = vec![[0.0; BLOCK]; self.order.len() * rows];
        terms.par_chunks_mut(BATCH * rows).zip(self.all_ranks.par_chunks(BATCH)).for_each_init(
            || self.network.scratch(),
            |scratch, (terms, ranks)| {
                let positions = self.world_positions(ranks);
                dispatch!(self.level, simd => {
                    self.network.position_terms(simd, &positions[..ranks.len()], scratch);
                });
                for (s, rows) in terms.chunks_mut(rows).enumerate() {
                    scratch.store_position_terms(s, rows);
                }
            },
        );
        terms
    }

    /// World positions of up to [`BATCH`] splats, in the first entries.
    fn world_positions(&self, ranks: &[u32]) -> [[f64; 3]; BATCH] {
        let mut positions = [[0.0; 3]; BATCH];
        for (position, &rank) in positions.iter_mut().zip(ranks) {
            let stored = self.canonical.positions[self.order[rank as usize] as usize];
            *position = std::array::from_fn(|c| f64::from(stored[c]) + self.meaning.origin[c]);
        }
        positions
    }

    /// Ranks of the splats at `indices`, ascending; `None` when these are all splats.
    fn ranks_of(&self, indices: &[u32]) -> Option<Vec<u32>> {
        let mut wanted = vec![false; self.order.len()];
        for &i in indices {
            wanted[i as usize] = true;
        }
        let ranks = self.all_ranks.iter().zip(&self.order);
        let ranks: Vec<u32> =
            ranks.filter(|&(_, &i)| wanted[i as usize]).map(|(&rank, _)| rank).collect();
        (ranks.len() < self.order.len()).then_some(ranks)
    }

    /// The state at t = 0.
    fn initial(&mut self) -> &Deformed {
        if self.initial.is_none() {
            let mut initial = self.canonical.clone();
            self.evaluate(0.0, None, &mut initial);
            self.initial = Some(initial);
        }
        self.initial.as_ref().unwrap_or(&self.canonical)
    }

    /// Writes the poses of the splats at `ranks` (all of them for `None`) at `time`.
    fn evaluate(&mut self, time: f32, ranks: Option<&[u32]>, deformed: &mut Deformed) {
        let mut poses = std::mem::take(&mut self.poses);
        let ranks = ranks.unwrap_or(&self.all_ranks);
        poses.resize(ranks.len(), SplatPose::default());
        let time = self.network.time_terms(f64::from(time));
        poses.par_chunks_mut(BATCH).zip(ranks.par_chunks(BATCH)).for_each_init(
            || self.network.scratch(),
            |scratch, (poses, ranks)| {
                dispatch!(self.level, simd => {
                    self.evaluate_batch(simd, &time, ranks, scratch, poses);
                });
            },
        );
        let splats = || ranks.iter().map(|&rank| self.order[rank as usize] as usize);
        rayon::join(
            || splats().zip(&poses).for_each(|(i, p)| deformed.positions[i] = p.position),
            || {
                for (i, pose) in splats().zip(&poses) {
                    deformed.rotations[i] = pose.rotation;
                    deformed.rotation_lengths[i] = pose.rotation_length;
                    deformed.scales[i] = pose.scale;
                }
            },
        );
        self.poses = poses;
    }

    #[inline(always)]
    fn evaluate_batch<S: Simd>(
        &self,
        simd: S,
        time: &TimeTerms,
        ranks: &[u32],
        scratch: &mut Scratch,
        poses: &mut [SplatPose],
    ) {
        match &self.position_terms {
            PositionTerms::Kept(terms) => {
                let rows = self.network.position_term_rows();
                for (s, &rank) in ranks.iter().enumerate() {
                    scratch.load_position_terms(s, &terms[rank as usize * rows..][..rows]);
                }
            }
            PositionTerms::ComputedPerFrame => {
                let positions = self.world_positions(ranks);
                self.network.position_terms(simd, &positions[..ranks.len()], scratch);
            }
        }
        let mut outputs = [[0.0; MAX_HEAD_OUTPUTS]; BATCH];
        self.network.evaluate(simd, time, scratch, &mut outputs[..ranks.len()]);
        for ((&rank, pose), outputs) in ranks.iter().zip(poses).zip(&outputs) {
            let canonical = self.canonical.pose(self.order[rank as usize] as usize);
            *pose = apply_outputs(&canonical, outputs, &self.meaning);
        }
    }
}
