//! The standard includes, written for this program: the same names with the same meanings as POV-Ray's.

/// Name and text of each.
pub const FILES: &[(&str, &str)] = &[
    ("colors.inc", include_str!("colors.inc")),
    ("consts.inc", include_str!("consts.inc")),
];
