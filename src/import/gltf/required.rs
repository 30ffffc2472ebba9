//! `extensionsRequired`: what the file cannot be drawn without.

use super::Report;
use super::document::Document;
use crate::diag::Diagnostic;
use serde_json::Value;

/// Extensions that are drawn as they ask, or that change nothing in a still picture.
const KNOWN: &[&str] = &[
    "EXT_mesh_features",
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_structural_metadata",
    "EXT_texture_webp",
    "KHR_animation_pointer",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_anisotropy",
    "KHR_materials_clearcoat",
    "KHR_materials_diffuse_transmission",
    "KHR_materials_dispersion",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_iridescence",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_variants",
    "KHR_materials_volume",
    "KHR_materials_volume_scatter",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_node_visibility",
    "KHR_texture_basisu",
    "KHR_texture_transform",
    "KHR_xmp",
    "KHR_xmp_json_ld",
];

/// Materials and pictures that only look different without them.
const APPROXIMATED: &[&str] = &["EXT_texture_avif", "MSFT_texture_dds"];

/// Reports each required extension that this reader does not know.
pub(super) fn check(doc: &Document, report: &mut Report) {
    let Some(list) = doc.top("extensionsRequired") else {
        return;
    };
    let Some(names) = list.as_array() else {
        report.error("G0204", "extensionsRequired", "is not an array of names");
        return;
    };
    for (i, name) in names.iter().enumerate() {
        let at = format!("extensionsRequired[{i}]");
        match name.as_str() {
            Some(name) if KNOWN.contains(&name) => {}
            Some(name) if APPROXIMATED.contains(&name) => {
                report.warning(
                    "G0205",
                    &at,
                    format!("{name} is not supported; the model is drawn without it"),
                );
            }
            Some(name) => report.push(&at, unknown(name)),
            None => report.error("G0204", &at, format!("is {}, expected a name", kind(name))),
        }
    }
}

fn unknown(name: &str) -> Diagnostic {
    let d = Diagnostic::error(
        "G0204",
        format!("the model needs the extension {name}, which is not supported"),
    );
    d.hint(
        "export the model without it, or remove it from `extensionsRequired` to draw the model as if it were not there",
    )
}

/// What sort of JSON value this is, for messages.
fn kind(value: &Value) -> &'static str {
    match value {
        Value::Null => "null",
        Value::Bool(_) => "a boolean",
        Value::Number(_) => "a number",
        Value::String(_) => "a string",
        Value::Array(_) => "an array",
        Value::Object(_) => "an object",
    }
}
