//! The tiers: what is left out first when a scene does not fit into a budget.

use trapeze_scene::ShDegree;

use super::plan::{MemoryPlan, SceneSize, initial_entries};
use crate::{Gpu, GpuError, HarmonicsStorage, RendererOptions};

/// What there is room for, and what has to fit in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MemoryRequest {
    /// Bytes for all buffers of a renderer, in every frame.
    pub budget: u64,
    /// Largest image, pixels across and down.
    pub image: [u32; 2],
    /// Whether depths and top contributors are wanted.
    pub layers: bool,
}

/// Smallest share of the splats that still stands for the scene.
const LEAST_SHARE: u32 = 8;
/// Bytes of a tile entry with its part of the sort's counts, at most (four words, and two counts of
/// 256 words per 1024 entries).
const ENTRY_BYTES: u64 = 16 + 2;

impl RendererOptions {
    /// The best tier of a scene that stays within a budget on a device, and its plan. In this order
    /// it gives up: SH coefficients in 32 bits, in 16 bits, SH bands from the highest on, splats
    /// from the least contributing on down to an eighth. Precision and other choices of `self`
    /// stay. Frames with more tile entries than the budget leaves room for are drawn in regions.
    ///
    /// # Errors
    /// [`GpuError::OutOfMemory`] with need and have when the last tier does not fit either.
    pub fn within(
        self,
        gpu: &Gpu,
        size: &SceneSize,
        request: &MemoryRequest,
    ) -> Result<(Self, MemoryPlan), GpuError> {
        let fits = |options: Self| fit(options, gpu, size, request);
        let tiers = self.tiers(size);
        if let Some(found) = tiers.iter().find_map(|&options| fits(options).ok()) {
            return Ok(found);
        }
        let smallest = tiers.last().copied().unwrap_or(self);
        // More splats need more: the most that fit, by bisection.
        let least = size.splats.div_ceil(LEAST_SHARE);
        let (mut low, mut high) = (least, size.splats);
        let of = |splats| Self { max_splats: Some(splats), ..smallest };
        let mut best = fits(of(low))?;
        while high - low > 1 {
            let middle = low + (high - low) / 2;
            match fits(of(middle)) {
                Ok(found) => (low, best) = (middle, found),
                Err(_) => high = middle,
            }
        }
        Ok(best)
    }

    /// These options in all storages of the harmonics, then with fewer bands.
    fn tiers(self, size: &SceneSize) -> Vec<Self> {
        let degree = size.sh_degree.min(self.max_sh_degree);
        let storages = HarmonicsStorage::ALL.into_iter();
        let storages = storages.filter(|&s| s as u32 >= self.harmonics as u32);
        let full = storages.map(|harmonics| Self { harmonics, ..self });
        let fewer = ShDegree::ALL.into_iter().rev().filter(|&fewer| fewer < degree);
        let fewer = fewer.map(|max_sh_degree| Self {
            harmonics: HarmonicsStorage::Byte,
            max_sh_degree,
            ..self
        });
        full.chain(fewer).collect()
    }
}

/// The options with room for as many tile entries as the budget leaves, at most the usual number at
/// first, and the plan; an error when there is less room than one tile may need.
fn fit(
    options: RendererOptions,
    gpu: &Gpu,
    size: &SceneSize,
    request: &MemoryRequest,
) -> Result<(RendererOptions, MemoryPlan), GpuError> {
    let plan =
        |options: &RendererOptions| MemoryPlan::new(size, options, request.image, request.layers);
    let splats = size.splats.min(options.max_splats.unwrap_or(u32::MAX)).max(1);
    // All splats may lie over one tile, and a tile is the smallest region.
    let least = RendererOptions { max_entries: Some(splats), ..options };
    let least_plan = plan(&least);
    least_plan.check(gpu)?;
    let refused = |need| GpuError::OutOfMemory { what: "the scene", need, have: request.budget };
    let spare =
        request.budget.checked_sub(least_plan.total()).ok_or(refused(least_plan.total()))?;
    // Counts come in whole blocks.
    let more = u64::from(splats) + spare.saturating_sub(4096) / ENTRY_BYTES;
    let entries = more.min(u64::from(options.max_entries.unwrap_or(u32::MAX))) as u32;
    let first = initial_entries(splats, &options).min(entries);
    let chosen =
        RendererOptions { max_entries: Some(entries), initial_entries: Some(first), ..options };
    Ok((chosen, plan(&chosen)))
}
