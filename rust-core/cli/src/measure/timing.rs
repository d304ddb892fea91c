//! Repeated timing.

use std::time::{Duration, Instant};

use serde::Serialize;

/// Statistics of repeated runs, milliseconds.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct Timing {
    pub(crate) runs: usize,
    pub(crate) median_ms: f64,
    pub(crate) p10_ms: f64,
    pub(crate) p90_ms: f64,
    pub(crate) min_ms: f64,
}

impl Timing {
    /// Statistics of at least one duration.
    pub(crate) fn of(durations: &[Duration]) -> Self {
        let mut ms: Vec<f64> = durations.iter().map(|d| d.as_secs_f64() * 1e3).collect();
        ms.sort_unstable_by(f64::total_cmp);
        let at = |share: f64| {
            let rank = share * ms.len().saturating_sub(1) as f64;
            let (low, high) = (rank.floor() as usize, rank.ceil() as usize);
            ms.get(low).map_or(0.0, |&a| a + (ms[high] - a) * rank.fract())
        };
        Self {
            runs: ms.len(),
            median_ms: at(0.5),
            p10_ms: at(0.1),
            p90_ms: at(0.9),
            min_ms: at(0.0),
        }
    }
}

/// A GPU takes this long to raise its clocks.
const GPU_WARM_UP: Duration = Duration::from_secs(1);

/// Repeats `work` until the clocks of an idle GPU are up: what is timed comes after it.
pub(crate) fn warm_up_gpu<T, E>(mut work: impl FnMut() -> Result<T, E>) -> Result<(), E> {
    let start = Instant::now();
    while start.elapsed() < GPU_WARM_UP {
        work()?;
    }
    Ok(())
}

/// Runs `work` twice to warm up, then `runs` times, and times those.
pub(crate) fn time_runs<E>(
    runs: usize,
    mut work: impl FnMut() -> Result<(), E>,
) -> Result<Timing, E> {
    for _ in 0..2 {
        work()?;
    }
    let mut durations = Vec::with_capacity(runs);
    for _ in 0..runs.max(1) {
        let start = Instant::now();
        work()?;
        durations.push(start.elapsed());
    }
    Ok(Timing::of(&durations))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn percentiles_interpolate_between_runs() {
        let ms: Vec<Duration> = (1..=5).map(|i| Duration::from_millis(i * 10)).collect();
        let timing = Timing::of(&ms);
        assert_eq!((timing.median_ms, timing.min_ms), (30.0, 10.0));
        assert!((timing.p10_ms - 14.0).abs() < 1e-9 && (timing.p90_ms - 46.0).abs() < 1e-9);
    }
}
