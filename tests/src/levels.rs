//! Ways to run the same frame: instruction sets and thread counts.

use fearless_simd::Level;

/// Every SIMD level that this machine can run, best first, ending with scalar code.
#[must_use]
pub fn available_levels() -> Vec<(&'static str, Level)> {
    let best = Level::new();
    let mut levels = Vec::new();
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    levels.extend(
        [
            ("AVX-512", best.as_avx512().map(Level::Avx512)),
            ("AVX2", best.as_avx2().map(Level::Avx2)),
            ("SSE4.2", best.as_sse4_2().map(Level::Sse4_2)),
            ("SSE2", best.as_sse2().map(Level::Sse2)),
        ]
        .into_iter()
        .filter_map(|(name, level)| level.map(|level| (name, level))),
    );
    #[cfg(target_arch = "aarch64")]
    levels.extend(best.as_neon().map(|token| ("NEON", Level::Neon(token))));
    if levels.is_empty() && !best.is_fallback() {
        levels.push(("best", best));
    }
    levels.push(("scalar", Level::fallback()));
    levels
}

/// Runs `work` in a pool of its own with `threads` threads.
///
/// # Panics
/// When the threads cannot be started.
pub fn on_threads<R: Send>(threads: usize, work: impl FnOnce() -> R + Send) -> R {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
    pool.expect("a thread pool for the test").install(work)
}
