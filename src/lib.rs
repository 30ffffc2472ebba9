//! A path tracer as a pipeline, like a compiler's:
//!
//! ```text
//! text ──lang──▶ Scene ──compile──▶ CompiledScene ──render──▶ Picture + Report ──output──▶ files
//! glTF, OBJ ──import──▶ ┘
//! ```
//!
//! [`scene`] is the description, plain data with places; [`render`] is the engine, which knows no names and no files;
//! only [`compile`] sees both. [`load`] chooses the front end by a file's ending, [`study`] compares pictures, [`cli`] is
//! the program. Everything below uses [`math`], [`diag`] (messages with places), [`files`] (the one door to the disk)
//! and [`pictures`] (image files).
//!
//! ```no_run
//! # use pts::{compile::compile, diag::*, files::DiskFiles, load::*, render::{driver, report::Silent, settings::Settings}};
//! let (files, mut sources, mut diags) = (DiskFiles::default(), SourceMap::default(), Diagnostics::default());
//! let scene = load("scene.pts".as_ref(), &files, &LoadOptions::default(), &mut sources, &mut diags);
//! let ready = compile(&scene.expect("no errors"), &files, 640, 480, &mut diags).expect("can be drawn");
//! let (picture, report) = driver::render(&ready, &Settings::new(640, 480, 64), &Silent);
//! println!("{:?} after {} s, error {:?}", picture.rgb[0], report.seconds, report.error);
//! ```

pub mod cli;
pub mod compile;
pub mod diag;
pub mod files;
pub mod import;
pub mod lang;
pub mod load;
pub mod math;
pub mod output;
pub mod pictures;
pub mod render;
pub mod scene;
pub mod study;
