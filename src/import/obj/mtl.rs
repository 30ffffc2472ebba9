//! Material libraries (MTL) as they are written. Nothing in them stops the import: what is malformed is left out
//! and reported with its line.

use super::clean::Named;
use super::find_file;
use super::lines::{after_keyword, number, statements, text, words};
use super::report::Report;
use crate::diag::Diagnostic;
use crate::files::Files;
use crate::scene::Channel;
use glam::DVec3;
use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

/// A texture with its options.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Map {
    /// The file as written.
    pub file: String,
    /// `-s`: factors on u and v.
    pub scale: [f64; 2],
    /// `-o`: added to u and v.
    pub offset: [f64; 2],
    /// `-clamp on`.
    pub clamp: bool,
    /// `-bm`.
    pub bump: f64,
    /// `-imfchan`.
    pub channel: Option<Channel>,
    /// The second number of `-mm`, a factor on the texel.
    pub gain: f64,
    /// The first number of `-mm`, added to it; only where a single channel is read.
    pub base: f64,
    /// `model.mtl:17`.
    pub place: String,
    /// Directory that file names are relative to.
    pub directory: PathBuf,
}

/// One material, each property `None` where it is not written.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Mtl {
    /// `model.mtl:17`, the line of `newmtl`.
    pub place: String,
    /// Colours by keyword in lower case: `ka kd ks ke tf`.
    pub colors: HashMap<&'static str, DVec3>,
    /// Numbers by keyword in lower case: `ns ni d tr illum pr pm ps pc pcr aniso anisor`.
    pub numbers: HashMap<&'static str, f64>,
    /// Textures by keyword in lower case, `map_bump` under `bump`.
    pub maps: HashMap<&'static str, Map>,
    /// Set where Blender wrote the library.
    pub blender: Option<Blender>,
}

/// Blender's own reading of MTL's words, which differs from everyone else's and is known exactly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Blender {
    /// `Ns` of a roughness of 0; Ns = most·(1 − roughness)².
    pub most_ns: f64,
}

impl Blender {
    /// Told by the comment that its exporters put at the head: "# Blender 5.0.1 MTL File: …" of today's scales `Ns` up to
    /// 1000, "# Blender MTL File: …" of the one before 3.2 up to 900.
    fn of(bytes: &[u8]) -> Option<Blender> {
        let first = bytes.split(|b| matches!(b, b'\r' | b'\n')).find(|l| !l.is_empty())?;
        let comment = text(first.strip_prefix(b"#")?);
        let mut words = comment.split_whitespace();
        if words.next() != Some("Blender") {
            return None;
        }
        let is_old = words.next() == Some("MTL");
        Some(Blender {
            most_ns: if is_old { 900.0 } else { 1000.0 },
        })
    }
}

/// All materials of a model by name.
pub(super) type Library = HashMap<String, Mtl>;

const COLORS: [&str; 5] = ["ka", "kd", "ks", "ke", "tf"];
const NUMBERS: [&str; 12] = [
    "ns", "ni", "d", "tr", "illum", "pr", "pm", "ps", "pc", "pcr", "aniso", "anisor",
];
const MAPS: [&str; 10] = [
    "map_kd", "map_ks", "map_ke", "map_d", "map_pr", "map_pm", "map_ps", "bump", "norm", "map_tr",
];
/// Known, but without meaning in a path tracer.
const IGNORED: [&str; 3] = ["map_ka", "sharpness", "map_aat"];
/// Known, and missed in the picture.
const UNSUPPORTED: [&str; 7] = ["decal", "disp", "map_disp", "refl", "map_refl", "map_tf", "map_ns"];

/// Most material libraries of one model; a statement may name several.
const MOST_LIBRARIES: usize = 1000;

/// Reads the libraries that the model names. One `mtllib` may name several files; names may hold blanks.
pub(super) fn load_libraries(libraries: &[Named], directory: &Path, files: &dyn Files, report: &mut Report) -> Library {
    let mut library = Library::new();
    let (mut asked, mut met) = (HashSet::new(), HashSet::new());
    let new = libraries.iter().filter(|named| asked.insert(named.name.as_str()));
    for Named { name, line } in new.take(MOST_LIBRARIES) {
        let mut names: Vec<&str> = vec![name.as_str()];
        if find_file(files, directory, name).is_none() {
            names = name.split_whitespace().collect();
        }
        if names.is_empty() {
            report.push(*line, Diagnostic::warning("O0200", "`mtllib` names no file"));
        }
        for name in names.into_iter().take(MOST_LIBRARIES) {
            let found = find_file(files, directory, name);
            if found.as_ref().is_some_and(|path| !met.insert(path.clone())) {
                continue; // read already
            }
            let read = found.map(|path| (files.read(&path), path));
            match read {
                Some((Ok(bytes), path)) => parse(&bytes, &path, &mut library, report),
                Some((Err(e), _)) => {
                    let message = format!("material library {name:?} cannot be read: {e}; its materials are white");
                    report.push(*line, Diagnostic::warning("O0201", message));
                }
                None => {
                    let message = format!("material library {name:?} is missing; its materials are white");
                    let hint = "put the .mtl file beside the .obj file, or override the material";
                    report.push(*line, Diagnostic::warning("O0201", message).hint(hint));
                }
            }
        }
    }
    library
}

/// Adds the materials of one library. Of two with the same name the first counts.
fn parse(bytes: &[u8], path: &Path, library: &mut Library, report: &mut Report) {
    let mut parser = Parser {
        file: path.display().to_string(),
        directory: path.parent().map(Path::to_owned).unwrap_or_default(),
        line: 1,
        report,
    };
    let blender = Blender::of(bytes);
    let mut current: Option<(String, Mtl)> = None;
    let mut found = 0_usize;
    let mut keep = |done: Option<(String, Mtl)>| {
        if let Some((name, mtl)) = done {
            library.entry(name).or_insert(mtl);
        }
    };
    for (line, statement) in statements(bytes) {
        parser.line = line;
        let Some(keyword) = words(&statement).next() else {
            continue;
        };
        let keyword = text(keyword).to_ascii_lowercase();
        if keyword == "newmtl" {
            keep(current.take());
            found += 1;
            let place = parser.place();
            let mtl = Mtl {
                place,
                blender,
                ..Mtl::default()
            };
            current = Some((text(after_keyword(&statement)), mtl));
        } else if let Some((_, mtl)) = &mut current {
            parser.property(&keyword, &statement, mtl);
        } else {
            let shown: String = keyword.chars().take(24).filter(|c| !c.is_control()).collect();
            parser.warn("O0202", format!("`{shown}` stands before any `newmtl` and is left out"));
        }
    }
    keep(current);
    if found == 0 {
        parser.warn("O0203", "material library holds no material (`newmtl`)".to_owned());
    }
}

struct Parser<'a> {
    file: String,
    directory: PathBuf,
    line: u32,
    report: &'a mut Report,
}

impl Parser<'_> {
    fn place(&self) -> String {
        format!("{}:{}", self.file, self.line)
    }

    fn warn(&mut self, code: &'static str, message: String) {
        let place = self.place();
        self.report.push_at(place, Diagnostic::warning(code, message));
    }

    fn property(&mut self, keyword: &str, statement: &[u8], mtl: &mut Mtl) {
        let keyword = match keyword {
            "map_bump" | "bump" => "bump",
            "norm" | "map_norm" | "map_kn" => "norm",
            "map_opacity" => "map_d",
            other => other,
        };
        if let Some(key) = COLORS.into_iter().find(|k| *k == keyword) {
            if let Some(color) = self.color(statement) {
                mtl.colors.insert(key, color);
            }
        } else if let Some(key) = NUMBERS.into_iter().find(|k| *k == keyword) {
            if let Some(value) = self.scalar(statement) {
                mtl.numbers.insert(key, value);
            }
        } else if let Some(key) = MAPS.into_iter().find(|k| *k == keyword) {
            if let Some(map) = self.map(&text(after_keyword(statement))) {
                mtl.maps.insert(key, map);
            }
        } else if UNSUPPORTED.contains(&keyword) {
            self.warn(
                "O0216",
                format!("material property `{keyword}` is not supported and left out"),
            );
        } else if !IGNORED.contains(&keyword) {
            let shown: String = keyword.chars().take(24).filter(|c| !c.is_control()).collect();
            self.warn(
                "O0204",
                format!("material property `{shown}` is not known and left out"),
            );
        }
    }

    /// Three numbers, or one for grey. Negative and non-finite ones cannot be meant.
    fn color(&mut self, statement: &[u8]) -> Option<DVec3> {
        let shown = || text(statement.trim_ascii());
        let mut values = Vec::new();
        for word in words(statement).skip(1).take(3) {
            match number(word).filter(|v| v.is_finite() && *v >= 0.0) {
                Some(v) => values.push(v),
                None => {
                    self.warn(
                        "O0205",
                        format!(
                            "colour `{}` is left out: expected three numbers, none negative",
                            shown()
                        ),
                    );
                    return None;
                }
            }
        }
        match values[..] {
            [r, g, b] => Some(DVec3::new(r, g, b)),
            [grey] => Some(DVec3::splat(grey)),
            [r, g] => {
                self.warn(
                    "O0205",
                    format!("colour `{}` has two numbers, the second is taken for blue too", shown()),
                );
                Some(DVec3::new(r, g, g))
            }
            _ => {
                self.warn("O0205", format!("colour `{}` is left out: it has no numbers", shown()));
                None
            }
        }
    }

    /// The last word as a number: `d -halo 0.5` is written too.
    fn scalar(&mut self, statement: &[u8]) -> Option<f64> {
        let value = words(statement)
            .skip(1)
            .filter(|w| *w != b"-halo")
            .last()
            .and_then(number);
        let value = value.filter(|v| v.is_finite());
        if value.is_none() {
            let shown = text(statement.trim_ascii());
            self.warn(
                "O0206",
                format!("material property `{shown}` is left out: expected a number"),
            );
        }
        value
    }

    /// Options, then a file name that may hold blanks.
    fn map(&mut self, written: &str) -> Option<Map> {
        let mut map = Map {
            file: String::new(),
            scale: [1.0; 2],
            offset: [0.0; 2],
            clamp: false,
            bump: 1.0,
            channel: None,
            gain: 1.0,
            base: 0.0,
            place: self.place(),
            directory: self.directory.clone(),
        };
        let mut rest = written.trim();
        while rest.starts_with('-') {
            let option = next_word(&mut rest);
            match option {
                "-s" => leading_numbers(&mut rest, &mut map.scale),
                "-o" => leading_numbers(&mut rest, &mut map.offset),
                "-t" => leading_numbers(&mut rest, &mut [0.0; 2]),
                "-mm" => {
                    let mut base_gain = [0.0, map.gain];
                    leading_numbers(&mut rest, &mut base_gain);
                    [map.base, map.gain] = base_gain;
                }
                "-bm" => {
                    let mut value = [map.bump];
                    leading_numbers(&mut rest, &mut value);
                    [map.bump] = value;
                }
                "-clamp" => map.clamp = next_word(&mut rest).eq_ignore_ascii_case("on"),
                "-imfchan" => {
                    map.channel = match next_word(&mut rest).to_ascii_lowercase().as_str() {
                        "r" => Some(Channel::R),
                        "g" => Some(Channel::G),
                        "b" => Some(Channel::B),
                        "m" => Some(Channel::A),
                        _ => None,
                    };
                }
                "-blendu" | "-blendv" | "-cc" | "-boost" | "-texres" | "-type" | "-colorspace" => {
                    next_word(&mut rest);
                }
                other => {
                    self.warn("O0207", format!("texture option `{other}` is not known and left out"));
                }
            }
        }
        if rest.is_empty() {
            self.warn("O0208", format!("texture `{written}` names no file"));
            return None;
        }
        map.file = rest.to_owned();
        Some(map)
    }
}

/// Cuts the first word off.
fn next_word<'a>(rest: &mut &'a str) -> &'a str {
    let end = rest.find(char::is_whitespace).unwrap_or(rest.len());
    let (word, tail) = rest.split_at(end);
    *rest = tail.trim_start();
    word
}

/// Reads up to three numbers into the first entries of `into`; further ones (w) are dropped.
fn leading_numbers(rest: &mut &str, into: &mut [f64]) {
    for i in 0..3 {
        let mut tail = *rest;
        let Some(value) = number(next_word(&mut tail).as_bytes()).filter(|v| v.is_finite()) else {
            return;
        };
        if let Some(target) = into.get_mut(i) {
            *target = value;
        } else if into.len() == 1 {
            return;
        }
        *rest = tail;
    }
}
