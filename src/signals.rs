//! Ctrl-C and SIGTERM: the program ends, but not while it is replacing files.

/// From now on a signal waits until files that are being replaced are all there, which takes milliseconds, and `told` says what
/// there is to say. A second one does not wait. The exit status is the shell's for a signal: 130 and 143.
#[cfg(unix)]
pub fn heed(told: impl FnOnce() + Send + 'static) {
    use signal_hook::consts::{SIGINT, SIGTERM};
    use trainsafe::report::between_writes;
    // Without them a signal ends the program as it would any other, and the next run tidies up.
    let Ok(mut signals) = signal_hook::iterator::Signals::new([SIGINT, SIGTERM]) else { return };
    std::thread::spawn(move || {
        let mut signals = signals.forever();
        if let Some(signal) = signals.next() {
            told();
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

/// Elsewhere a signal ends the program as it would any other, and the next run tidies up.
#[cfg(not(unix))]
pub fn heed(_: impl FnOnce() + Send + 'static) {}
