//! How far a run is: a bar on a terminal, plain lines elsewhere.

use std::io::{IsTerminal, Write, stderr};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar, ProgressStyle};

/// Time between plain lines.
const EVERY: Duration = Duration::from_secs(10);

/// Counts cases that are done, and says so on standard error.
pub struct Progress {
    bar: Option<ProgressBar>,
    start: Instant,
    last: Mutex<Instant>,
    total: u64,
    done: AtomicUsize,
    failed: AtomicUsize,
}

impl Progress {
    /// Of so many cases.
    pub fn new(total: u64) -> Progress {
        let style = "{bar:30} {pos}/{len} cases, {msg}, {per_sec}, {eta} left";
        let bar = stderr().is_terminal().then(|| {
            let style = ProgressStyle::with_template(style).unwrap_or_else(|_| ProgressStyle::default_bar());
            ProgressBar::new(total).with_style(style).with_message("0 failed")
        });
        let now = Instant::now();
        let (done, failed) = (AtomicUsize::new(0), AtomicUsize::new(0));
        Progress { bar, start: now, last: Mutex::new(now), total, done, failed }
    }

    /// So many more cases are done, and so many of them failed.
    pub fn add(&self, cases: usize, failed: usize) {
        let done = self.done.fetch_add(cases, Ordering::Relaxed) + cases;
        let failed = self.failed.fetch_add(failed, Ordering::Relaxed) + failed;
        if let Some(bar) = &self.bar {
            bar.set_message(format!("{failed} failed"));
            bar.inc(cases as u64);
            return;
        }
        // Whoever finds the lock taken leaves the line to the other.
        let Ok(mut last) = self.last.try_lock() else { return };
        if last.elapsed() >= EVERY {
            *last = Instant::now();
            self.line(done, failed);
        }
    }

    fn line(&self, done: usize, failed: usize) {
        let seconds = self.start.elapsed().as_secs_f64();
        let rate = done as f64 / seconds;
        let left = Duration::from_secs_f64((self.total.saturating_sub(done as u64) as f64 / rate).min(1e9));
        let of = self.total;
        // Nobody is left to hear of it if that fails.
        let _ = writeln!(
            stderr(),
            "{done} of {of} cases, {failed} failed, {rate:.0} cases/s, {} left",
            HumanDuration(left)
        );
    }

    /// Leaves the terminal as it was.
    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
