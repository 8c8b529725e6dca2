//! The command `serve`.

#[cfg(feature = "serve")]
use std::process::{Command, Stdio};

use super::cli::Serve;
use super::{Failure, say};

/// Serves the page of a train until Ctrl-C.
#[cfg(feature = "serve")]
pub fn run(args: &Serve) -> Result<(), Failure> {
    use trainsafe::serve::{ServeError, Server};
    let server = Server::open(&args.train, args.port).map_err(|e| match e {
        ServeError::Input(e) => {
            say(&e.render(true));
            Failure::Input
        }
        ServeError::Listen(_) => {
            say(&format!("error: {e}; choose another port with --port, or leave it out"));
            Failure::Output
        }
    })?;
    super::signals::handle_signals(|| ());
    super::print(&format!("{}\n", server.address()))?;
    say("open this address in a browser on this machine; Ctrl-C ends it");
    if !args.no_open {
        open(server.address());
    }
    server.run().map_err(|e| {
        say(&format!("error: cannot listen any more: {e}"));
        Failure::Output
    })
}

/// Says that this build has none.
#[cfg(not(feature = "serve"))]
pub fn run(_: &Serve) -> Result<(), Failure> {
    say("error: this trainsafe is built without serve: build it with `cargo install --path . --features serve`");
    Err(Failure::Input)
}

/// Opens the address in the user's browser; without a screen or a program for it, does nothing.
#[cfg(feature = "serve")]
fn open(address: &str) {
    let (program, args): (&str, &[&str]) = if cfg!(target_os = "macos") {
        ("open", &[])
    } else if cfg!(windows) {
        ("rundll32", &["url.dll,FileProtocolHandler"])
    } else {
        ("xdg-open", &[])
    };
    let screen =
        ["DISPLAY", "WAYLAND_DISPLAY"].iter().any(|name| std::env::var_os(name).is_some_and(|v| !v.is_empty()));
    if cfg!(all(unix, not(target_os = "macos"))) && !screen {
        return;
    }
    let mut command = Command::new(program);
    let quiet = command.args(args).arg(address).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    if let Ok(mut child) = quiet.spawn() {
        std::thread::spawn(move || child.wait());
    }
}
