//! `trainsafe serve`: the report's page on this machine, with the program behind it.
//!
//! | request | answer |
//! | --- | --- |
//! | `GET /TOKEN/` | the page, with the train file as it is on the disk |
//! | `POST /TOKEN/analyze` | the text's problems, or its report and the numbers of its figures |
//! | `POST /TOKEN/save` | the text has replaced the train file |
//!
//! It listens on 127.0.0.1 alone. A request without the token, a random number in the address, or with another host's
//! name gets status 403. Files that a train names are read in the train's folder alone, and nothing but the train file
//! is written.

mod answer;
mod controls;
mod edit;
mod guard;
mod page;
mod save;

use std::io;
use std::net::{Ipv4Addr, TcpListener};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use axum::body::Bytes;
use axum::extract::{DefaultBodyLimit, State as Shared};
use axum::http::{StatusCode, header};
use axum::response::{Html, IntoResponse, Response};
use axum::routing::{get, post};
use axum::{Router, middleware};
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::consist::Files;
use crate::error::InputError;

/// Larger requests are refused, bytes.
const MOST_BYTES: usize = 8 << 20;

/// Why the page cannot be served.
#[derive(Debug, thiserror::Error)]
pub enum ServeError {
    /// The train file cannot be read.
    #[error("{}", .0.render(false))]
    Input(#[from] InputError),
    /// This machine does not let the program listen.
    #[error("cannot listen on 127.0.0.1: {0}")]
    Listen(#[from] io::Error),
}

/// A page of one train file, on this machine.
pub struct Server {
    listener: TcpListener,
    address: String,
    state: Arc<State>,
}

/// What every request needs.
struct State {
    /// The train file as it was named, and without symbolic links.
    path: PathBuf,
    real: PathBuf,
    token: String,
    /// Whether the file's lines end in CR and LF, as the page does not keep them.
    crlf: AtomicBool,
    turn: Mutex<()>,
}

impl State {
    /// Waits until no analysis runs.
    fn turn(&self) -> MutexGuard<'_, ()> {
        self.turn.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Files, read in the train's folder only.
    fn files(&self) -> io::Result<Files> {
        let folder = self.path.parent().filter(|folder| !folder.as_os_str().is_empty());
        Files::within(folder.unwrap_or(Path::new(".")))
    }

    fn notice_line_ends(&self, text: &str) {
        self.crlf.store(text.contains("\r\n"), Ordering::Relaxed);
    }

    /// A text of the page with the line ends that the file has.
    fn as_in_file(&self, text: &str) -> String {
        let text = text.replace("\r\n", "\n");
        if self.crlf.load(Ordering::Relaxed) { text.replace('\n', "\r\n") } else { text }
    }
}

impl Server {
    /// Listens on a port of 127.0.0.1; on a free one if it is 0.
    ///
    /// # Errors
    /// A train file that cannot be read as text (what is wrong in it is told on the page), or a port that is taken.
    pub fn open(train: &Path, port: u16) -> Result<Server, ServeError> {
        let unreadable = |e| InputError::of_file(train, format!("the file cannot be read: {e}"), "");
        let mut bytes = [0; 16];
        getrandom::fill(&mut bytes).map_err(|e| io::Error::other(e.to_string()))?;
        let token: String = crate::train::hex(&bytes);
        // Refused as by `check`.
        Files::default().main(train)?;
        let real = train.canonicalize().map_err(unreadable)?;
        let path = train.to_owned();
        let state = State { path, real, token, crlf: AtomicBool::new(false), turn: Mutex::new(()) };
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))?;
        listener.set_nonblocking(true)?;
        let address = format!("http://{}/{}/", listener.local_addr()?, state.token);
        Ok(Server { listener, address, state: Arc::new(state) })
    }

    /// Where the page is, token included.
    pub fn address(&self) -> &str {
        &self.address
    }

    /// Answers requests until the process ends.
    ///
    /// # Errors
    /// The program cannot listen any more.
    pub fn run(self) -> io::Result<()> {
        let Server { listener, state, .. } = self;
        let at = |what: &str| format!("/{}/{what}", state.token);
        let router = Router::new()
            .route(&at(""), get(page))
            .route(&at("analyze"), post(analyze))
            .route(&at("save"), post(save))
            .layer(DefaultBodyLimit::max(MOST_BYTES))
            .layer(middleware::from_fn_with_state(state.clone(), guard::guard))
            .with_state(state);
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        runtime.block_on(async { axum::serve(tokio::net::TcpListener::from_std(listener)?, router).await })
    }
}

/// A status other than 200, with what is wrong.
type Refusal = (StatusCode, String);

async fn page(Shared(state): Shared<Arc<State>>) -> Result<Html<String>, Refusal> {
    let page = blocking(move |_| save::read(&state).map(|on_disk| page::page(&state, &on_disk))).await?;
    page.map(Html).map_err(|e| (StatusCode::INTERNAL_SERVER_ERROR, e.render(false)))
}

async fn analyze(Shared(state): Shared<Arc<State>>, body: Bytes) -> Result<Response, Refusal> {
    let request = parsed(&body)?;
    let reply = blocking(move |cancelled| answer::answer(&state, request, cancelled)).await?;
    json(&reply)
}

async fn save(Shared(state): Shared<Arc<State>>, body: Bytes) -> Result<Response, Refusal> {
    let asked: save::Save = parsed(&body)?;
    let digest = blocking(move |_| save::save(&state, &asked)).await??;
    json(&serde_json::json!({ "digest": digest }))
}

/// A flag that is set when it is dropped: when nobody waits for the answer any more.
struct CancelOnDrop(Arc<AtomicBool>);

impl Drop for CancelOnDrop {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

/// Does work on a thread of its own.
async fn blocking<T: Send + 'static>(work: impl FnOnce(&AtomicBool) -> T + Send + 'static) -> Result<T, Refusal> {
    let cancelled = CancelOnDrop(Arc::default());
    let told = cancelled.0.clone();
    tokio::task::spawn_blocking(move || work(&told)).await.map_err(fault)
}

fn parsed<T: DeserializeOwned>(body: &[u8]) -> Result<T, Refusal> {
    let refusal = |e| (StatusCode::BAD_REQUEST, format!("the request is not what is expected: {e}"));
    serde_json::from_slice(body).map_err(refusal)
}

fn json(value: &impl Serialize) -> Result<Response, Refusal> {
    let text = serde_json::to_string(value).map_err(fault)?;
    Ok(([(header::CONTENT_TYPE, "application/json")], text).into_response())
}

fn fault(error: impl std::fmt::Display) -> Refusal {
    (StatusCode::INTERNAL_SERVER_ERROR, format!("a fault in trainsafe, and the request was not done: {error}"))
}
