//! The standard includes, written for this program: the same names with the same meanings as POV-Ray's.

/// Name and text of each.
pub const FILES: &[(&str, &str)] = &[
    ("colors.inc", include_str!("colors.inc")),
    ("consts.inc", include_str!("consts.inc")),
    ("finish.inc", include_str!("finish.inc")),
    ("functions.inc", include_str!("functions.inc")),
    ("glass.inc", include_str!("glass.inc")),
    ("golds.inc", include_str!("golds.inc")),
    ("math.inc", include_str!("math.inc")),
    ("metals.inc", include_str!("metals.inc")),
    ("rand.inc", include_str!("rand.inc")),
    ("shapes.inc", include_str!("shapes.inc")),
    ("skies.inc", include_str!("skies.inc")),
    ("stdinc.inc", include_str!("stdinc.inc")),
    ("stones.inc", include_str!("stones.inc")),
    ("strings.inc", include_str!("strings.inc")),
    ("textures.inc", include_str!("textures.inc")),
    ("transforms.inc", include_str!("transforms.inc")),
    ("woods.inc", include_str!("woods.inc")),
];
