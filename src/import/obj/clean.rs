//! A tolerant pass over the statements that leaves a text `tobj` reads without loss.
//!
//! `tobj` knows neither smoothing groups nor line numbers, gives up on the first malformed statement, and keeps
//! f32. Here every statement is checked with its line; faces are written with absolute indices, positions around
//! an origin of the model's own, and what `tobj` would lose is kept in [`Cleaned`], one entry a face.

use super::lines::{after_keyword, number, statements, text, words};
use super::report::Report;
use crate::diag::{Anomaly, Diagnostic};
use crate::math::robust::try_normalize_f64;
use glam::DVec3;
use std::collections::HashMap;
use std::io::Write;

/// What a face carries besides its corners.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FaceInfo {
    /// Line of its statement.
    pub line: u32,
    /// Index into [`Cleaned::objects`].
    pub object: u32,
    /// Index into [`Cleaned::materials`], if `usemtl` named one.
    pub material: Option<u32>,
    /// Smoothing group; 0 is off.
    pub smoothing: u32,
}

/// A name with the line it was first used on.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Named {
    pub name: String,
    pub line: u32,
}

/// A model in the form `tobj` reads, and what that form cannot say.
#[derive(Debug, Default)]
pub(super) struct Cleaned {
    /// Statements `v`, `vt`, `vn` and `f` alone, all valid. The first `vt` and `vn` are ours and stand for none.
    pub obj: Vec<u8>,
    /// Added to every position.
    pub origin: DVec3,
    /// Faces in order.
    pub faces: Vec<FaceInfo>,
    /// Objects; the first has an empty name and holds what comes before any `o`.
    pub objects: Vec<Named>,
    /// Materials that `usemtl` names.
    pub materials: Vec<Named>,
    /// What follows each `mtllib`.
    pub libraries: Vec<Named>,
    /// Whether vertices have colours.
    pub has_colors: bool,
    /// How many `v`, `vt` and `vn` there were.
    pub counts: [u64; 3],
    other_elements: u64,
}

impl Cleaned {
    /// What there is, for a message.
    pub fn inventory(&self) -> String {
        let ([v, ..], other) = (self.counts, self.other_elements);
        format!("{v} vertices and {other} points, lines or curves")
    }
}

/// Vertex statistics that must be known before the first vertex is written.
struct Scan {
    origin: DVec3,
    has_colors: bool,
    /// 1, or 255 for files that write bytes.
    color_scale: f64,
}

fn scan(bytes: &[u8]) -> Scan {
    let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (mut has_colors, mut brightest) = (false, 0.0_f64);
    for (_, statement) in statements(bytes) {
        let mut words = words(&statement);
        if words.next() != Some(b"v") {
            continue;
        }
        let mut values = words.map_while(number);
        if let (Some(x), Some(y), Some(z)) = (values.next(), values.next(), values.next()) {
            let p = DVec3::new(x, y, z);
            if p.is_finite() {
                (min, max) = (min.min(p), max.max(p));
            }
        }
        if let (Some(r), Some(g), Some(b)) = (values.next(), values.next(), values.next()) {
            has_colors = true;
            brightest = brightest.max(r).max(g).max(b);
        }
    }
    // A model about the origin keeps its numbers; one that stands far away keeps its precision.
    let (center, extent) = (min * 0.5 + max * 0.5, max - min);
    let origin = |c: f64, e: f64| if c.is_finite() && c.abs() > e { c } else { 0.0 };
    let origin = DVec3::new(
        origin(center.x, extent.x),
        origin(center.y, extent.y),
        origin(center.z, extent.z),
    );
    let color_scale = if brightest > 1.0 { 255.0 } else { 1.0 };
    Scan {
        origin,
        has_colors,
        color_scale,
    }
}

/// Checks all statements. With errors in the report the result is not complete.
pub(super) fn clean(bytes: &[u8], report: &mut Report) -> Cleaned {
    let scan = scan(bytes);
    let mut pass = Pass {
        out: Cleaned {
            origin: scan.origin,
            has_colors: scan.has_colors,
            objects: vec![Named {
                name: String::new(),
                line: 1,
            }],
            ..Cleaned::default()
        },
        scan,
        report,
        state: FaceInfo {
            line: 1,
            object: 0,
            material: None,
            smoothing: 0,
        },
        material_ids: HashMap::new(),
        corners: Vec::new(),
    };
    pass.emit(format_args!("vt 0 0\nvn 0 0 0"));
    for (line, statement) in statements(bytes) {
        pass.state.line = line;
        pass.statement(&statement);
    }
    pass.out
}

/// The state of the pass over a model.
pub(super) struct Pass<'a> {
    pub out: Cleaned,
    scan: Scan,
    report: &'a mut Report,
    /// What the next face will carry.
    pub state: FaceInfo,
    material_ids: HashMap<String, u32>,
    /// Corners of the face at hand: indices from 1 in the text for `tobj`.
    pub corners: Vec<[u64; 3]>,
}

impl Pass<'_> {
    fn emit(&mut self, line: std::fmt::Arguments<'_>) {
        // Writing to memory does not fail.
        let _ = writeln!(self.out.obj, "{line}");
    }

    /// Reports something about the statement at hand.
    pub fn push(&mut self, diagnostic: Diagnostic) {
        self.report.push(self.state.line, diagnostic);
    }

    fn statement(&mut self, statement: &[u8]) {
        let mut words = words(statement);
        let Some(keyword) = words.next() else { return };
        match keyword {
            b"v" => self.vertex(statement),
            b"vt" => self.texcoord(statement),
            b"vn" => self.normal(statement),
            b"f" | b"fo" => self.face(statement),
            b"o" => self.object(text(after_keyword(statement))),
            b"s" => self.smoothing(after_keyword(statement)),
            b"usemtl" => self.material(text(after_keyword(statement))),
            b"mtllib" => {
                let (name, line) = (text(after_keyword(statement)), self.state.line);
                self.out.libraries.push(Named { name, line });
            }
            b"p" | b"l" => self.other_element("points and lines have no surface and are left out"),
            b"curv" | b"curv2" | b"surf" => {
                self.other_element("free-form curves and surfaces are not supported and left out; export polygons");
            }
            b"call" | b"csh" => {
                let message = format!("`{}` is not carried out", text(keyword));
                self.push(Diagnostic::warning("O0110", message));
            }
            // Names of groups mean nothing to a renderer; the rest belongs to free-form geometry or to display.
            b"g" | b"mg" | b"vp" | b"cstype" | b"deg" | b"bmat" | b"step" | b"parm" | b"trim" | b"hole" | b"scrv"
            | b"sp" | b"end" | b"con" | b"bevel" | b"c_interp" | b"d_interp" | b"lod" | b"usemap" | b"maplib"
            | b"shadow_obj" | b"trace_obj" | b"ctech" | b"stech" => {}
            _ => self.unknown(keyword),
        }
    }

    fn unknown(&mut self, keyword: &[u8]) {
        let shown: String = text(keyword).chars().take(24).filter(|c| !c.is_control()).collect();
        let message = format!("OBJ statement `{shown}` is not known and left out");
        self.push(Diagnostic::warning("O0111", message));
    }

    fn other_element(&mut self, what: &str) {
        if self.out.other_elements == 0 {
            self.push(Diagnostic::warning("O0112", what));
        }
        self.out.other_elements += 1;
    }

    /// The numbers after the keyword; reports the first word that is none.
    fn numbers(&mut self, statement: &[u8], least: usize, what: &str) -> Option<Vec<f64>> {
        let mut values = Vec::with_capacity(8);
        for word in words(statement).skip(1) {
            match number(word) {
                Some(v) => values.push(v),
                None => {
                    let shown = text(word);
                    let message = format!("{what} has a malformed number: found `{shown}`, expected digits");
                    let mut diagnostic = Diagnostic::error("O0101", message);
                    if shown.contains(',') {
                        diagnostic =
                            diagnostic.hint("numbers take a decimal point; export again with English number format");
                    } else {
                        diagnostic = diagnostic.hint("correct the line or export the model again");
                    }
                    self.push(diagnostic);
                    return None;
                }
            }
        }
        if values.len() < least {
            let message = format!("{what} has {} numbers, expected at least {least}", values.len());
            let hint = "the line or the whole file may have been cut off; export the model again";
            self.push(Diagnostic::error("O0102", message).hint(hint));
            return None;
        }
        Some(values)
    }

    fn vertex(&mut self, statement: &[u8]) {
        self.out.counts[0] += 1;
        let Some(values) = self.numbers(statement, 3, "vertex `v`") else {
            return;
        };
        let mut p = DVec3::new(values[0], values[1], values[2]);
        if let [_, _, _, w] = values[..] {
            // A fourth number is a homogeneous weight.
            if w != 0.0 {
                p /= w;
            } else {
                let message = "vertex `v` has the weight 0 and is taken as if it had 1";
                self.push(Diagnostic::warning("O0103", message).counting(Anomaly::MovedValue, 1));
            }
        }
        if !p.is_finite() {
            self.push(Diagnostic::warning(
                "O0104",
                "vertex `v` is not finite; faces that use it are left out",
            ));
        }
        let local = (p - self.scan.origin).as_vec3();
        if self.scan.has_colors {
            let color = match values[..] {
                [_, _, _, r, g, b, ..] => [r, g, b].map(|v| (v / self.scan.color_scale) as f32),
                _ => [1.0; 3],
            };
            let [r, g, b] = color;
            self.emit(format_args!("v {} {} {} {r} {g} {b}", local.x, local.y, local.z));
        } else {
            self.emit(format_args!("v {} {} {}", local.x, local.y, local.z));
        }
    }

    fn texcoord(&mut self, statement: &[u8]) {
        self.out.counts[1] += 1;
        let Some(values) = self.numbers(statement, 1, "texture coordinate `vt`") else {
            return;
        };
        let mut uv = [values[0], values.get(1).copied().unwrap_or(0.0)];
        if uv.iter().any(|v| !v.is_finite()) {
            let message = "texture coordinate `vt` is not finite and taken as 0 0";
            self.push(Diagnostic::warning("O0105", message).counting(Anomaly::MovedValue, 1));
            uv = [0.0; 2];
        }
        self.emit(format_args!("vt {} {}", uv[0] as f32, uv[1] as f32));
    }

    fn normal(&mut self, statement: &[u8]) {
        self.out.counts[2] += 1;
        let Some(values) = self.numbers(statement, 3, "normal `vn`") else {
            return;
        };
        // Exporters write zero normals for degenerate faces; the zero vector means "none" from here on.
        let n = try_normalize_f64(DVec3::new(values[0], values[1], values[2])).unwrap_or_else(|| {
            let message = "normal `vn` has no direction; that of its face is used";
            self.push(Diagnostic::note("O0115", message).counting(Anomaly::ReplacedNormal, 1));
            DVec3::ZERO
        });
        let n = n.as_vec3();
        self.emit(format_args!("vn {} {} {}", n.x, n.y, n.z));
    }

    fn object(&mut self, name: String) {
        let line = self.state.line;
        self.out.objects.push(Named { name, line });
        self.state.object = self.out.objects.len() as u32 - 1;
    }

    fn smoothing(&mut self, argument: &[u8]) {
        self.state.smoothing = match argument {
            b"off" | b"OFF" | b"null" | b"0" | b"" => 0,
            b"on" => 1,
            other => match std::str::from_utf8(other).ok().and_then(|t| t.parse::<u32>().ok()) {
                Some(group) => group,
                None => {
                    let message = format!("smoothing group `s {}` is no number and taken as off", text(other));
                    self.push(Diagnostic::warning("O0113", message));
                    0
                }
            },
        };
    }

    fn material(&mut self, name: String) {
        if name.is_empty() {
            self.push(Diagnostic::warning(
                "O0114",
                "`usemtl` names no material; the default is used from here on",
            ));
            self.state.material = None;
            return;
        }
        let line = self.state.line;
        let materials = &mut self.out.materials;
        let id = *self.material_ids.entry(name).or_insert_with_key(|name| {
            materials.push(Named {
                name: name.clone(),
                line,
            });
            materials.len() as u32 - 1
        });
        self.state.material = Some(id);
    }
}
