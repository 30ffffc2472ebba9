//! `KHR_materials_variants`: which material a primitive wears in the chosen variant.

use super::Loader;
use super::document::extension;
use crate::diag::Diagnostic;
use serde_json::Value;

const NAME: &str = "KHR_materials_variants";

impl Loader<'_> {
    /// The number of the variant that the caller asked for. An unknown name is an error that lists the known ones.
    pub(super) fn choose_variant(&mut self) -> Option<usize> {
        let wanted = self.options.variant.as_deref()?;
        let list = self.doc.extension(NAME).and_then(|e| e.get("variants"));
        let list = list.and_then(Value::as_array).map_or(&[][..], Vec::as_slice);
        let names: Vec<&str> = list
            .iter()
            .map(|v| v.get("name").and_then(Value::as_str).unwrap_or(""))
            .collect();
        let found = names.iter().position(|n| *n == wanted);
        if found.is_none() {
            let d = Diagnostic::error("G0708", format!("there is no material variant \"{wanted}\""));
            self.report.push("", d.hint(known("variants", &names)));
        }
        found
    }

    /// The mapping that gives a primitive its material in the chosen variant, if there is one.
    pub(super) fn variant_mapping<'v>(&self, primitive: &'v Value) -> Option<&'v Value> {
        let variant = self.variant? as u64;
        let mappings = extension(primitive, NAME)?.get("mappings")?.as_array()?;
        let is_ours = |m: &&Value| {
            let variants = m.get("variants").and_then(Value::as_array);
            variants.is_some_and(|v| v.iter().any(|v| v.as_u64() == Some(variant)))
        };
        mappings.iter().find(is_ours)
    }
}

/// A hint that lists what could have been meant.
pub(super) fn known(what: &str, names: &[&str]) -> String {
    if names.is_empty() {
        return format!("the file has no {what}");
    }
    let shown: Vec<String> = names.iter().take(12).map(|n| format!("\"{n}\"")).collect();
    let rest = if names.len() > shown.len() { ", …" } else { "" };
    format!("its {what} are {}{rest}", shown.join(", "))
}
