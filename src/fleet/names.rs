//! Paths and checksums in a plan file: a path is text where it can be, and bytes elsewhere.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum Name {
    Text(String),
    Bytes(Vec<u8>),
}

impl Name {
    fn of(path: &Path) -> Name {
        match path.to_str() {
            Some(text) => Name::Text(text.to_owned()),
            None => Name::Bytes(path.as_os_str().as_encoded_bytes().to_vec()),
        }
    }

    fn path(self) -> PathBuf {
        match self {
            Name::Text(text) => text.into(),
            #[cfg(unix)]
            Name::Bytes(bytes) => {
                let name: std::ffi::OsString = std::os::unix::ffi::OsStringExt::from_vec(bytes);
                name.into()
            }
            // Elsewhere it names no file, and the run stops there.
            #[cfg(not(unix))]
            Name::Bytes(bytes) => String::from_utf8_lossy(&bytes).into_owned().into(),
        }
    }
}

/// Lists of paths.
pub mod paths {
    use super::{Deserialize, Name, PathBuf, Serialize};
    use serde::{Deserializer, Serializer};

    pub fn serialize<S: Serializer>(paths: &[PathBuf], to: S) -> Result<S::Ok, S::Error> {
        paths.iter().map(|path| Name::of(path)).collect::<Vec<_>>().serialize(to)
    }

    pub fn deserialize<'d, D: Deserializer<'d>>(from: D) -> Result<Vec<PathBuf>, D::Error> {
        Ok(Vec::<Name>::deserialize(from)?.into_iter().map(Name::path).collect())
    }
}

/// Lists of files with their checksums.
pub mod sources {
    use super::{Deserialize, Name, Serialize};
    use crate::train::Source;
    use serde::{Deserializer, Serializer};

    pub fn serialize<S: Serializer>(sources: &[Source], to: S) -> Result<S::Ok, S::Error> {
        sources.iter().map(|source| (Name::of(&source.path), source.sha256)).collect::<Vec<_>>().serialize(to)
    }

    pub fn deserialize<'d, D: Deserializer<'d>>(from: D) -> Result<Vec<Source>, D::Error> {
        let all = Vec::<(Name, [u8; 32])>::deserialize(from)?;
        Ok(all.into_iter().map(|(name, sha256)| Source { path: name.path(), sha256 }).collect())
    }
}
