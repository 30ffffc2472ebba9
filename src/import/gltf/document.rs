//! The JSON as tables of elements that are typed when they are looked up.

use super::Report;
use crate::diag::Diagnostic;
use gltf::json;
use serde_json::Value;

const EXPORT_AGAIN: &str = "export the model as glTF 2.0, or convert it with a glTF tool";

/// The parsed JSON of one file.
pub(super) struct Document {
    root: Value,
}

impl Document {
    /// Takes the JSON; reports an `asset.version` that this reader cannot know.
    pub fn new(root: Value, report: &mut Report) -> Document {
        let version = |key: &str| root.get("asset").and_then(|a| a.get(key)).map(|v| (version_of(v), v));
        match version("version") {
            None if root.get("meshes").is_some_and(Value::is_object) => {
                let d = Diagnostic::error("G0201", "the file is glTF 1.0 by its form, only glTF 2.0 is read");
                report.push("asset", d.hint(EXPORT_AGAIN));
            }
            None => report.warning("G0201", "asset", "`version` is missing; the file is read as glTF 2.0"),
            Some((Some((2, _)), _)) => {}
            Some((_, found)) => {
                let d = Diagnostic::error("G0201", format!("glTF {found} is not supported, only \"2.0\" is"));
                report.push("asset.version", d.hint(EXPORT_AGAIN));
            }
        }
        if let Some((Some(least), found)) = version("minVersion")
            && least > (2, 0)
        {
            let d = Diagnostic::error(
                "G0201",
                format!("the file asks for glTF {found}, this program reads 2.0"),
            );
            report.push("asset.minVersion", d);
        }
        Document { root }
    }

    /// The whole file as one element.
    pub fn root(&self) -> &Value {
        &self.root
    }

    /// A member of the top level.
    pub fn top(&self, key: &str) -> Option<&Value> {
        self.root.get(key)
    }

    /// How many elements a table has.
    pub fn len(&self, table: &str) -> usize {
        self.root.get(table).and_then(Value::as_array).map_or(0, Vec::len)
    }

    /// The JSON of an element; `at` is the place that refers to it. Out of range is an error.
    pub fn raw(&self, table: &str, index: usize, at: &str, report: &mut Report) -> Option<&Value> {
        let items = self.root.get(table);
        if let Some(element) = items.and_then(|t| t.get(index)) {
            return Some(element);
        }
        let message = match items {
            Some(Value::Array(_)) => format!("is {index}, but `{table}` has {} elements", self.len(table)),
            Some(_) => format!("refers to `{table}`, which is not an array"),
            None => format!("refers to `{table}[{index}]`, but the file has no `{table}`"),
        };
        let d = Diagnostic::error("G0202", message);
        report.push(
            at,
            d.hint("indices count from 0; export the model again, or check the tool that edited it"),
        );
        None
    }

    /// An element as the type that the schema gives it, without its extensions and extras.
    pub fn get<T: Element>(&self, index: usize, at: &str, report: &mut Report) -> Option<T> {
        let raw = self.raw(T::TABLE, index, at, report)?;
        match T::read(core(raw)) {
            Ok(element) => Some(element),
            Err(error) => {
                report.error(
                    "G0203",
                    &format!("{}[{index}]", T::TABLE),
                    format!("is malformed: {error}"),
                );
                None
            }
        }
    }

    /// The name of an element, or `table[index]`.
    pub fn name(&self, table: &str, index: usize) -> String {
        let element = self.root.get(table).and_then(|t| t.get(index));
        match element.and_then(|e| e.get("name")).and_then(Value::as_str) {
            Some(name) if !name.is_empty() => name.to_owned(),
            _ => format!("{table}[{index}]"),
        }
    }

    /// An extension of the file itself.
    pub fn extension(&self, name: &str) -> Option<&Value> {
        extension(&self.root, name)
    }
}

/// A typed element of the schema with the table it stands in.
pub(super) trait Element: Sized {
    /// Name of the table at the top level.
    const TABLE: &'static str;

    /// Reads the element from its JSON.
    fn read(value: Value) -> serde_json::Result<Self>;
}

macro_rules! elements {
    ($($type:ty => $table:literal),* $(,)?) => {
        $(impl Element for $type {
            const TABLE: &'static str = $table;

            fn read(value: Value) -> serde_json::Result<Self> {
                serde_json::from_value(value)
            }
        })*
    };
}

elements! {
    json::Accessor => "accessors",
    json::buffer::View => "bufferViews",
    json::Camera => "cameras",
    json::Material => "materials",
    json::Mesh => "meshes",
    json::Node => "nodes",
    json::Skin => "skins",
    json::texture::Sampler => "samplers",
    json::Texture => "textures",
}

/// An extension of an element.
pub(super) fn extension<'v>(element: &'v Value, name: &str) -> Option<&'v Value> {
    element.get("extensions")?.get(name)
}

/// An optional index of an element; something else than an index is an error.
pub(super) fn index_of(element: &Value, key: &str, at: &str, report: &mut Report) -> Option<usize> {
    let found = element.get(key)?;
    let index = found.as_u64().and_then(|i| usize::try_from(i).ok());
    if index.is_none() {
        report.error(
            "G0203",
            &format!("{at}.{key}"),
            format!("is {found}, expected an index"),
        );
    }
    index
}

/// The element without `extensions` and `extras`, which we read ourselves or not at all.
fn core(value: &Value) -> Value {
    match value {
        Value::Object(members) => members
            .iter()
            .filter(|(key, _)| *key != "extensions" && *key != "extras")
            .map(|(key, member)| (key.clone(), core(member)))
            .collect(),
        Value::Array(items) => items.iter().map(core).collect(),
        other => other.clone(),
    }
}

/// `"2.0"` → (2, 0).
fn version_of(value: &Value) -> Option<(u32, u32)> {
    let (major, minor) = value.as_str()?.split_once('.')?;
    Some((major.parse().ok()?, minor.parse().ok()?))
}
