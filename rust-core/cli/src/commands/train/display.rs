//! What a user sees while a run goes on.

use indicatif::{HumanDuration, ProgressBar, ProgressStyle};
use std::time::Duration;
use trapeze_train::Trainer;
use trapeze_train::backend::TrainingBackend;
use trapeze_train::config::DeformationTraining;
use trapeze_train::trainer::{Event, Proposal, Trial};

/// A bar with figures on a terminal; decisions as lines, there and elsewhere.
pub(super) struct Display {
    bar: ProgressBar,
}

impl Display {
    /// Says what begins.
    pub(super) fn new<B: TrainingBackend>(trainer: &Trainer<B>) -> Self {
        let memory = trainer.memory();
        eprintln!(
            "{}; {} splats to begin with; about {} MB at most",
            trainer.progress().dataset,
            trainer.splat_count(),
            memory.total().div_ceil(1 << 20),
        );
        if let Some(deformation) = &trainer.config().deformation {
            eprintln!("{}", describe_deformation(deformation));
        }
        let style = ProgressStyle::with_template("{wide_bar} {pos}/{len} {msg}")
            .unwrap_or_else(|_| ProgressStyle::default_bar());
        let bar = ProgressBar::new(trainer.config().steps.into()).with_style(style);
        bar.set_position(trainer.step().into());
        Self { bar }
    }

    pub(super) fn set_step(&self, step: u32) {
        self.bar.set_position(step.into());
    }

    pub(super) fn show(&self, event: &Event) {
        match event {
            Event::Report(report) => {
                let left = Duration::try_from_secs_f64(report.seconds_left()).unwrap_or_default();
                self.bar.set_message(format!(
                    "{:.1} it/s, loss {:.4}, {:.2} dB, {} splats{}, {} left",
                    report.steps_per_second,
                    report.loss,
                    report.psnr,
                    report.splats,
                    if report.is_trial { " (trial)" } else { "" },
                    HumanDuration(left),
                ));
            }
            Event::Saved { .. } => {}
            Event::RolledBack { step, to, rate_factor, reason } => self.line(&format!(
                "step {step}: {reason}; back to step {to}, learning rates times {rate_factor:.3e}"
            )),
            Event::Trial(trial) => self.line(&describe(trial)),
            Event::SearchEnded { step, splats, sh_degree } => self.line(&format!(
                "step {step}: {splats} splats and SH degree {sh_degree} are what pays"
            )),
        }
    }

    pub(super) fn finish(&self) {
        self.bar.finish_and_clear();
    }

    fn line(&self, text: &str) {
        self.bar.suspend(|| eprintln!("{text}"));
    }
}

fn describe_deformation(deformation: &DeformationTraining) -> String {
    let noise = if deformation.time_noise > 0.0 {
        let (noise, steps) = (deformation.time_noise, deformation.noisy_steps);
        format!("times with noise of {noise:.2e} that fades over {steps} steps")
    } else {
        "exact times".into()
    };
    format!("the scene moves: its network takes part from step {} on, {noise}", deformation.warm_up)
}

fn describe(trial: &Trial) -> String {
    let change = match trial.proposal {
        Proposal::Splats(splats) => format!("{} splats to {splats}", trial.splats),
        Proposal::ShDegree(degree) => format!("SH degree {} to {degree}", trial.sh_degree),
    };
    format!(
        "step {}: {change}: {:.3} dB without, {:.3} dB with, {:+.3} of {:.3} required: {}",
        trial.step,
        trial.psnr_without,
        trial.psnr_with,
        trial.psnr_with - trial.psnr_without,
        trial.required_gain,
        if trial.kept { "kept" } else { "undone" },
    )
}
