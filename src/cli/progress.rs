//! Progress on standard error, when it is a terminal.

use crate::experiment::Tick;
use crate::trainer::Progress;
use indicatif::{ProgressBar, ProgressStyle};

/// A bar of rounds.
pub struct Bar(ProgressBar);

impl Bar {
    /// A bar for what `name` does; hidden when `quiet`, or when standard error is no terminal.
    pub fn new(name: &str, quiet: bool) -> Self {
        let bar = if quiet { ProgressBar::hidden() } else { ProgressBar::new(1) };
        let style = ProgressStyle::with_template("{msg} round {pos}/{len} {bar:30} {elapsed} passed, {eta} left");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.set_message(name.to_owned());
        bar.enable_steady_tick(std::time::Duration::from_millis(200));
        Bar(bar)
    }

    /// Shows how far training has come.
    pub fn show(&self, progress: &Progress) {
        self.0.set_length(progress.rounds as u64);
        self.0.set_position(progress.round as u64);
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}

/// A bar of an experiment's work.
pub struct Work(ProgressBar);

impl Work {
    /// A bar for what `name` does; hidden when `quiet`, or when standard error is no terminal.
    pub fn new(name: &str, quiet: bool) -> Self {
        let bar = if quiet { ProgressBar::hidden() } else { ProgressBar::new(1) };
        let style = ProgressStyle::with_template("{prefix} {percent}% {bar:30} {elapsed} passed, {eta} left; {msg}");
        bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()));
        bar.set_prefix(name.to_owned());
        bar.enable_steady_tick(std::time::Duration::from_millis(200));
        Work(bar)
    }

    /// Shows how far it has come.
    pub fn show(&self, tick: &Tick) {
        self.0.set_length(tick.all);
        self.0.set_position(tick.done);
        self.0.set_message(tick.what.clone());
    }
}

impl Drop for Work {
    fn drop(&mut self) {
        self.0.finish_and_clear();
    }
}
