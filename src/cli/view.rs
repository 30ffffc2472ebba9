//! `--view`: what a view shows, in words.

use super::choices::ViewName;
use crate::math::words::{duration, rough_percent};
use crate::output::{View, ViewKind};

/// The kind of view that a word stands for.
pub fn kind(name: ViewName) -> ViewKind {
    match name {
        ViewName::Error => ViewKind::Error,
        ViewName::Time => ViewKind::Time,
        ViewName::Normal => ViewKind::Normal,
        ViewName::Albedo => ViewKind::Albedo,
        ViewName::Depth => ViewKind::Depth,
    }
}

/// What a view shows, with the ends of its scale: `relative error, 0.1 % dark … 100 % bright, logarithmic`.
pub fn about(view: &View) -> String {
    let name = match view.kind {
        ViewKind::Error => "relative error",
        ViewKind::Time => "time per sample",
        ViewKind::Normal => "normals, n/2 + 1/2 (red x, green y, blue z)",
        ViewKind::Albedo => "albedo",
        ViewKind::Depth => "depth",
    };
    let scale = match (view.kind, view.range) {
        (ViewKind::Normal | ViewKind::Albedo, _) => return name.to_owned(),
        (_, None) => return format!("{name}, not known for any pixel (grey)"),
        (ViewKind::Error, Some([low, high])) => {
            format!(
                "{} dark … {} bright, logarithmic",
                rough_percent(low),
                rough_percent(high)
            )
        }
        (ViewKind::Time, Some([low, high])) => {
            format!(
                "{} dark … {} bright, logarithmic",
                duration(1e-9 * low),
                duration(1e-9 * high)
            )
        }
        (ViewKind::Depth, Some([near, far])) => format!("{near:.4} bright … {far:.4} dark, linear"),
    };
    match view.unknown {
        0 => format!("{name}, {scale}"),
        n => format!("{name}, {scale}, {n} pixels not known (grey)"),
    }
}
