//! Ctrl-C and SIGTERM: the program ends, but not while it is replacing files.

/// From now on the first signal calls `notify` and ends the program once no files are being replaced, within
/// milliseconds. A second one ends it at once. The exit status is the shell's for a signal: 130 and 143.
#[cfg(unix)]
pub fn handle_signals(notify: impl FnOnce() + Send + 'static) {
    use signal_hook::consts::{SIGINT, SIGTERM};
    use trainsafe::report::between_writes;
    // If that fails, a signal ends the program at once; the next run removes what it left.
    let Ok(mut signals) = signal_hook::iterator::Signals::new([SIGINT, SIGTERM]) else { return };
    std::thread::spawn(move || {
        let mut signals = signals.forever();
        if let Some(signal) = signals.next() {
            notify();
            std::thread::spawn(move || {
                let _whole = between_writes();
                std::process::exit(128 + signal)
            });
        }
        if let Some(signal) = signals.next() {
            std::process::exit(128 + signal)
        }
    });
}

/// Elsewhere a signal ends the program at once; the next run removes what it left.
#[cfg(not(unix))]
pub fn handle_signals(_: impl FnOnce() + Send + 'static) {}
