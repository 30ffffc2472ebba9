//! What a file holds, by name: for people who look for a name to choose by.

use super::document::Document;
use super::{Report, container};
use crate::diag::Diagnostics;
use crate::files::Files;
use serde_json::Value;
use std::path::Path;

/// Names of the elements of a file, in its order; what has no name is called by its table and number.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Contents {
    /// Scenes, for [`super::GltfOptions::scene`].
    pub scenes: Vec<String>,
    /// Nodes, for [`super::GltfOptions::node`].
    pub nodes: Vec<String>,
    /// Material variants, for [`super::GltfOptions::variant`].
    pub variants: Vec<String>,
    /// Animations, with the seconds of their last keys; 0 where the file does not say.
    pub animations: Vec<(String, f64)>,
}

/// Lists what a glTF or GLB file holds. `None` if it cannot be read; [`super::load`] tells why.
pub fn contents(path: &Path, files: &dyn Files) -> Option<Contents> {
    let mut diags = Diagnostics::default();
    let mut report = Report {
        file: path.display().to_string(),
        diags: &mut diags,
        failed: false,
        lenient: false,
    };
    let container = container::read(path, files, &mut report)?;
    let doc = Document::new(container.json, &mut report);
    let names = |table: &str| (0..doc.len(table)).map(|i| doc.name(table, i)).collect();
    let variants = doc.extension("KHR_materials_variants").and_then(|e| e.get("variants"));
    let variants = variants.and_then(Value::as_array).into_iter().flatten();
    let name_of = |v: &Value| v.get("name").and_then(Value::as_str).unwrap_or_default().to_owned();
    Some(Contents {
        scenes: names("scenes"),
        nodes: names("nodes"),
        variants: variants.map(name_of).collect(),
        animations: (0..doc.len("animations"))
            .map(|i| (doc.name("animations", i), seconds(&doc, i)))
            .collect(),
    })
}

/// When the last key of an animation is, as the accessors' bounds say.
fn seconds(doc: &Document, animation: usize) -> f64 {
    let samplers = doc
        .top("animations")
        .and_then(|a| a.get(animation)?.get("samplers")?.as_array());
    let end = |sampler: &Value| {
        let input = usize::try_from(sampler.get("input")?.as_u64()?).ok()?;
        doc.top("accessors")?.get(input)?.get("max")?.get(0)?.as_f64()
    };
    let ends = samplers.into_iter().flatten().filter_map(end);
    ends.fold(0.0, f64::max)
}
