//! Progress of a run: a bar on a terminal, plain lines elsewhere.

use std::fmt;
use std::io::{IsTerminal, Write, stderr};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use indicatif::{HumanDuration, ProgressBar, ProgressStyle};

/// Time between plain lines.
const EVERY: Duration = Duration::from_secs(10);

/// Where progress is reported.
#[derive(Clone, Default)]
pub enum ProgressTarget {
    /// To standard error: a bar on a terminal, plain lines elsewhere.
    #[default]
    Terminal,
    /// Nowhere.
    Nothing,
    /// A function, often and from any thread.
    Call(Arc<dyn Fn(Count) + Send + Sync>),
}

/// How far a run is, in cases.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Count {
    /// Done, failed ones included.
    pub done: u64,
    /// Those that failed; a train that cannot be read is one.
    pub failed: u64,
    /// In all.
    pub total: u64,
}

impl fmt::Debug for ProgressTarget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            ProgressTarget::Terminal => "Terminal",
            ProgressTarget::Nothing => "Nothing",
            ProgressTarget::Call(_) => "Call(..)",
        })
    }
}

/// Counts and reports cases that are done.
pub struct Progress {
    telling: ProgressTarget,
    bar: Option<ProgressBar>,
    start: Instant,
    last: Mutex<Instant>,
    total: u64,
    done: AtomicUsize,
    failed: AtomicUsize,
}

impl Progress {
    /// Of so many cases.
    pub fn new(total: u64, telling: &ProgressTarget) -> Progress {
        let style = "{bar:30} {pos}/{len} cases, {msg}, {per_sec}, {eta} left";
        let wanted = matches!(telling, ProgressTarget::Terminal) && stderr().is_terminal();
        let bar = wanted.then(|| {
            let style = ProgressStyle::with_template(style).unwrap_or_else(|_| ProgressStyle::default_bar());
            ProgressBar::new(total).with_style(style).with_message("0 failed")
        });
        let now = Instant::now();
        let (done, failed) = (AtomicUsize::new(0), AtomicUsize::new(0));
        Progress { telling: telling.clone(), bar, start: now, last: Mutex::new(now), total, done, failed }
    }

    /// So many more cases are done, and so many of them failed.
    pub fn add(&self, cases: usize, failed: usize) {
        let done = self.done.fetch_add(cases, Ordering::Relaxed) + cases;
        let failed = self.failed.fetch_add(failed, Ordering::Relaxed) + failed;
        match &self.telling {
            ProgressTarget::Terminal => {}
            ProgressTarget::Nothing => return,
            ProgressTarget::Call(function) => {
                return function(Count { done: done as u64, failed: failed as u64, total: self.total });
            }
        }
        if let Some(bar) = &self.bar {
            bar.set_message(format!("{failed} failed"));
            bar.inc(cases as u64);
            return;
        }
        // If another thread has the lock, it writes the line.
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
        // A failure could not be reported either.
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
