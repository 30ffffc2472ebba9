//! The evaluator: pulls tokens through directives and macros and computes values.
//!
//! A file or macro body being run is a [`Frame`]; [`Interp::peek`] gives the next token that is neither a directive nor
//! a macro call, running those on the way, so they may stand anywhere, also inside a block or an expression. Parsing is
//! recursive descent on that stream; what blocks mean is decided by `lower`.

mod access;
mod arrays;
mod blocks;
mod colors;
mod declare;
mod directives;
mod errors;
mod expr;
mod functions;
mod include;
mod loops;
mod macros;
mod random;
mod run;
mod scope;
mod stream;
mod strings;
mod unread;
mod user_functions;
mod value;
mod vector_functions;

pub use errors::{Parsed, Stop, nearest};
pub use stream::{T, Tok};
pub use value::{Array, Function, Macro, Num, Value};

use crate::diag::{Diagnostics, SourceMap, Span};
use crate::files::Files;
use crate::lang::LoadOptions;
use crate::lang::desc::SceneDesc;
use crate::lang::syntax::{Interner, TokenFile};
use scope::Scopes;
use std::collections::{HashMap, HashSet};
use std::path::PathBuf;
use std::rc::Rc;
use stream::Frame;

/// Macro calls and includes that may be open at once.
const MAX_FRAMES: usize = 256;
/// Blocks, parentheses, vectors and directives that may be nested; the loader's stack holds several times as many.
const MAX_NESTING: u32 = 600;
/// Bytes of the stack that scenes are loaded on.
pub const STACK_BYTES: usize = 256 << 20;
/// Runs of one loop's body.
const MAX_LOOP_RUNS: u64 = 3_000_000;
/// Runs of all loops together.
const MAX_RUNS: u64 = 20_000_000;
/// Calls of all macros.
const MAX_CALLS: u64 = 5_000_000;
/// Tokens pulled in all.
const MAX_STEPS: u64 = 4_000_000_000;
/// Elements of all arrays made.
const MAX_ARRAY_ITEMS: usize = 1 << 24;
/// Bytes of one string.
const MAX_TEXT: usize = 1 << 20;
/// Objects described; about 1 KiB each.
const MAX_OBJECTS: usize = 2_000_000;
/// Unions in unions, mixes in mixes.
pub const MAX_DEPTH: u32 = 200;
/// Errors after which reading stops.
const MAX_ERRORS: usize = 100;

/// Whether an expression may lead to an image: `0.2 + 0.8 * image_map { … }`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ImageFactor {
    /// It is a value.
    No,
    /// It may.
    May,
    /// It does: the expression has ended in front of the image, and its value is the image's factor. What is added to the
    /// product, with its place.
    Met(Option<(f64, Span)>),
}

/// The state of reading one scene.
pub struct Interp<'a> {
    /// Where files come from.
    pub files: &'a dyn Files,
    /// What the caller asks for.
    pub options: &'a LoadOptions<'a>,
    /// Texts read.
    pub sources: &'a mut SourceMap,
    /// Where messages go.
    pub diags: &'a mut Diagnostics,
    /// Names.
    pub names: Interner,
    /// Identifiers.
    pub scopes: Scopes,
    /// Whether `transmit` behind a colour belongs to what holds the colour.
    pub colors_end_at_transmit: bool,
    /// Whether an image may follow a factor.
    pub image_factor: ImageFactor,
    /// The scene as described so far.
    pub scene: SceneDesc,
    /// The language version in force, e.g. 3.7.
    pub version: f64,
    /// The version the main file asks for: defaults go by it, whatever an include sets for itself.
    pub scene_version: f64,
    /// Whether a `#version` in an include counts for the whole scene too, as in POV-Ray.
    pub includes_set_version: bool,
    /// Whether the scene used `image_width` or `image_height`, and where.
    pub size_used: Option<Span>,
    /// Directory of the main file.
    pub scene_dir: PathBuf,
    /// Models whose file is not there, by the path that they would have; it is an error only where one is drawn.
    pub missing_models: Vec<(PathBuf, crate::diag::Diagnostic)>,
    /// Images and models that the text names, with what they are and where: nobody may draw them.
    pub named_files: Vec<(&'static str, PathBuf, Span)>,
    frames: Vec<Frame>,
    /// The next token, if it is known.
    ahead: Option<Tok>,
    /// The frame whose expression ends at a directive, see `declare`.
    hold: Option<usize>,
    /// Frames below this one are not left: a function's body is being evaluated.
    floor: usize,
    /// Open braces.
    braces: Vec<Span>,
    nesting: u32,
    muted: u32,
    /// Whether an error inside a macro call or directive was just reported, so that its consequence is not.
    failed: bool,
    /// Whether a failed block has just been skipped to its end.
    resumed: bool,
    /// Whether the failed block ends where the stream stands, its brace being missing.
    closed_early: bool,
    halted: bool,
    errors: usize,
    silent: usize,
    notes: usize,
    steps: u64,
    runs: u64,
    calls: u64,
    array_items: usize,
    objects: usize,
    functions_open: u32,
    generators: Vec<u32>,
    told: HashSet<String>,
    token_files: HashMap<PathBuf, Rc<TokenFile>>,
    unread: unread::Unread,
}

impl<'a> Interp<'a> {
    /// A fresh state.
    pub fn new(
        files: &'a dyn Files,
        options: &'a LoadOptions<'a>,
        sources: &'a mut SourceMap,
        diags: &'a mut Diagnostics,
    ) -> Interp<'a> {
        Interp {
            colors_end_at_transmit: false,
            image_factor: ImageFactor::No,
            files,
            options,
            sources,
            diags,
            names: Interner::default(),
            scopes: Scopes::default(),
            scene: SceneDesc::default(),
            version: 3.62,
            scene_version: 3.62,
            includes_set_version: true,
            size_used: None,
            scene_dir: PathBuf::new(),
            missing_models: Vec::new(),
            unread: unread::Unread::default(),
            named_files: Vec::new(),
            frames: Vec::new(),
            ahead: None,
            hold: None,
            floor: 0,
            braces: Vec::new(),
            nesting: 0,
            muted: 0,
            failed: false,
            resumed: false,
            closed_early: false,
            halted: false,
            errors: 0,
            silent: 0,
            notes: 0,
            steps: 0,
            runs: 0,
            calls: 0,
            array_items: 0,
            objects: 0,
            functions_open: 0,
            generators: Vec::new(),
            told: HashSet::new(),
            token_files: HashMap::new(),
        }
    }

    /// Runs a step one level deeper; fails at the limit, before the stack ends.
    pub fn nested<R>(&mut self, span: Span, step: impl FnOnce(&mut Self) -> Parsed<R>) -> Parsed<R> {
        if self.nesting >= MAX_NESTING {
            return Err(self.fatal("P0601", span, format!("nested deeper than {MAX_NESTING} levels")));
        }
        self.nesting += 1;
        let result = step(self);
        self.nesting -= 1;
        result
    }

    /// Counts an object; fails when there are too many to hold in memory.
    pub fn count_object(&mut self, span: Span) -> Parsed<()> {
        self.objects += 1;
        if self.objects > MAX_OBJECTS {
            return Err(self.fatal("P0602", span, format!("more than {MAX_OBJECTS} objects")));
        }
        Ok(())
    }
}
