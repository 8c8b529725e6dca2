//! The train file on the disk: read, and replaced by the text of the page.

use std::fs;
use std::path::Path;

use axum::http::StatusCode;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::{Refusal, State};
use crate::consist::Files;
use crate::error::{InputError, printable_path};
use crate::report::{between_writes, files};
use crate::train::hex;

/// The train file as it was read.
#[derive(Serialize)]
pub(super) struct OnDisk {
    text: String,
    /// SHA-256 of its bytes, in hexadecimal.
    digest: String,
}

/// A text to save.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Save {
    text: String,
    /// The digest of the file that the text was made from.
    digest: String,
}

pub(super) fn read(state: &State) -> Result<OnDisk, InputError> {
    let files = Files::default();
    let text = files.main(&state.path)?;
    let digest = files.list().first().map_or(String::new(), |source| hex(&source.sha256));
    state.notice_line_ends(&text);
    Ok(OnDisk { text: text.to_string(), digest })
}

/// Writes the text beside the train file and gives it that name, if the file is still the one that was read. Returns the new digest.
pub(super) fn save(state: &State, asked: &Save) -> Result<String, Refusal> {
    let shown = printable_path(&state.path);
    let failed =
        |what: &dyn std::fmt::Display| (StatusCode::INTERNAL_SERVER_ERROR, format!("cannot write {shown}: {what}"));
    // One save at a time, none while the program ends.
    let _whole = between_writes();
    let bytes =
        fs::read(&state.real).map_err(|e| (StatusCode::CONFLICT, format!("{shown} can no longer be read: {e}")))?;
    if hex(&Sha256::digest(&bytes)) != asked.digest {
        let what = "has changed on the disk since it was read, and was not replaced: copy what you need, then load the page anew";
        return Err((StatusCode::CONFLICT, format!("{shown} {what}")));
    }
    let content = state.as_in_file(&asked.text);
    let folder = state.real.parent().unwrap_or(Path::new("/"));
    let file = files::stage(folder, content.as_bytes()).map_err(|e| failed(&e))?;
    let about = fs::metadata(&state.real).map_err(|e| failed(&e))?;
    file.as_file().set_permissions(about.permissions()).map_err(|e| failed(&e))?;
    file.as_file().sync_all().map_err(|e| failed(&e))?;
    file.persist(&state.real).map_err(|e| failed(&e.error))?;
    Ok(hex(&Sha256::digest(content.as_bytes())))
}
