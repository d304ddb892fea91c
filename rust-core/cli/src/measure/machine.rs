//! The machine that figures were taken on: a figure without one means nothing.

use fearless_simd::Level;
use serde::Serialize;

/// What a figure depends on besides the program.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct Machine {
    pub(crate) cpu: String,
    pub(crate) threads: usize,
    pub(crate) simd: &'static str,
    pub(crate) os: &'static str,
    pub(crate) architecture: &'static str,
    /// Clock that the threads got, all busy, GHz: on a shared machine far below the nominal one, and
    /// another from minute to minute.
    pub(crate) effective_ghz: f64,
}

impl Machine {
    pub(crate) fn this() -> Self {
        Self {
            cpu: cpu_name(),
            threads: rayon::current_num_threads(),
            simd: level_name(Level::new()),
            os: std::env::consts::OS,
            architecture: std::env::consts::ARCH,
            effective_ghz: effective_ghz(),
        }
    }
}

/// Cycles of a dependent multiplication and addition in double precision on recent x86 and Arm cores.
const STEP_CYCLES: f64 = 8.0;

/// Mean clock of all threads, from a chain of roundings that no compiler may shorten.
fn effective_ghz() -> f64 {
    const STEPS: u32 = 2_000_000;
    let clocks = rayon::broadcast(|_| {
        let [mut x, factor, summand] = std::hint::black_box([1.0f64, 0.999_999, 1e-7]);
        let start = std::time::Instant::now();
        for _ in 0..STEPS {
            x = x * factor + summand;
        }
        std::hint::black_box(x);
        f64::from(STEPS) * STEP_CYCLES / start.elapsed().as_secs_f64() / 1e9
    });
    let mean = clocks.iter().sum::<f64>() / clocks.len() as f64;
    (mean * 100.0).round() / 100.0
}

/// The processor's own name, where the system tells it.
fn cpu_name() -> String {
    let from_linux = std::fs::read_to_string("/proc/cpuinfo").ok().and_then(|info| {
        let line = info.lines().find(|line| line.starts_with("model name"))?;
        Some(line.split_once(':')?.1.trim().to_owned())
    });
    let from_apple = || {
        let output = std::process::Command::new("sysctl")
            .args(["-n", "machdep.cpu.brand_string"])
            .output()
            .ok()
            .filter(|output| output.status.success())?;
        Some(String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    from_linux.or_else(from_apple).unwrap_or_else(|| "unknown".into())
}

/// Name of a SIMD level.
pub(crate) fn level_name(level: Level) -> &'static str {
    match level {
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        Level::Avx512(_) => "AVX-512",
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        Level::Avx2(_) => "AVX2",
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        Level::Sse4_2(_) => "SSE4.2",
        #[cfg(target_arch = "aarch64")]
        Level::Neon(_) => "NEON",
        _ => "scalar",
    }
}

/// The SIMD levels that this machine can run, best first; the last is scalar code.
pub(crate) fn simd_levels() -> Vec<Level> {
    let best = Level::new();
    let mut levels = vec![best];
    #[cfg(target_arch = "x86_64")]
    {
        if let (Some(_), Some(avx2)) = (best.as_avx512(), best.as_avx2()) {
            levels.push(Level::Avx2(avx2));
        }
        if let (Some(_), Some(sse)) = (best.as_avx2(), best.as_sse4_2()) {
            levels.push(Level::Sse4_2(sse));
        }
    }
    if !best.is_fallback() {
        levels.push(Level::fallback());
    }
    levels
}
