//! Packs the charting library that the HTML reports embed.
//!
//! The crate `plotly` carries the text of Plotly.js (MIT licence). It is taken out of it here once, compressed, and written in
//! base64, which a page unpacks by itself; nothing is compressed when a report is written.

use std::io::Write;
use std::path::Path;
use std::{env, fs};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::GzEncoder;
use sha2::{Digest, Sha256};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("cargo:rerun-if-changed=build.rs");
    let scripts = plotly::Plot::offline_js_sources();
    // Two scripts: the library, and one that sets formulas, which no report has.
    let library = scripts
        .split_once("</script>")
        .and_then(|(first, _)| first.split_once('>'))
        .map(|(_, text)| text.trim())
        .filter(|text| text.contains("plotly.js v"))
        .ok_or("the crate plotly has no script of Plotly.js first")?;
    let mut packed = GzEncoder::new(Vec::new(), Compression::best());
    packed.write_all(library.as_bytes())?;
    let text = STANDARD.encode(packed.finish()?);
    let out = env::var("OUT_DIR")?;
    fs::write(Path::new(&out).join("plotly.js.gz.base64"), text)?;
    fs::write(Path::new(&out).join("plotly.js.sha256"), STANDARD.encode(Sha256::digest(library.as_bytes())))?;
    Ok(())
}
