//! Emitters in the very same place: a ray sees one of them, so only that one may be sampled.
//!
//! Two copies of a lamp at the same spot would both pass the shadow test, because each ignores what is at its own
//! distance, and count twice; rays that hit them by chance find the one with the lower primitive. Models that contain
//! a mesh twice are common enough for this to matter.

use super::{Aim, Light, Receiver, SphereLight};
use crate::render::ray::PrimRef;

/// The shape of an emitter, bit by bit, with a number for its kind, and its primitive.
fn shape_of(light: &Light) -> Option<([u64; 11], PrimRef)> {
    let mut key = [0; 11];
    let mut fill = |kind: u64, values: &[f64]| {
        key[0] = kind;
        for (k, v) in key[1..].iter_mut().zip(values) {
            *k = v.to_bits();
        }
    };
    let prim = match light {
        Light::Point(_)
        | Light::Spot(_)
        | Light::Directional(_)
        | Light::Area(_)
        | Light::Environment(_)
        | Light::Moving(_) => {
            return None;
        }
        Light::Sphere(l) => {
            fill(1, &[l.center.x, l.center.y, l.center.z, l.radius]);
            l.prim
        }
        Light::SphereCap(l) => return shape_of(&Light::Sphere(l.sphere)),
        Light::Triangle(l) => {
            let v = [l.p0, l.e1.as_dvec3(), l.e2.as_dvec3()].map(|v| v.to_array());
            fill(2, v.as_flattened());
            l.prim
        }
        Light::Parallelogram(l) => {
            let v = [l.p0, l.e1.as_dvec3(), l.e2.as_dvec3()].map(|v| v.to_array());
            fill(3, v.as_flattened());
            l.prim
        }
        Light::Disc(l) => {
            let v = [l.center, l.axis1, l.axis2].map(|v| v.to_array());
            fill(4, v.as_flattened());
            key[10] = l.hole.to_bits();
            l.prim
        }
    };
    Some((key, prim))
}

/// Which lights are copies of each other, by light.
pub(crate) struct Copies {
    /// Whether another emitter of exactly its shape and place, with a lower primitive, hides it.
    pub hidden: Vec<bool>,
    /// Whether it hides another in this way.
    pub hiding: Vec<bool>,
}

/// Finds emitters in the very same place.
pub(crate) fn copies(lights: &[Light]) -> Copies {
    let mut hidden = vec![false; lights.len()];
    let mut hiding = hidden.clone();
    let mut order: Vec<(u64, u32)> = (0u32..)
        .zip(lights)
        .filter_map(|(i, l)| Some((hash(&shape_of(l)?.0), i)))
        .collect();
    order.sort_unstable();
    for group in order.chunk_by(|a, b| a.0 == b.0).filter(|g| g.len() > 1) {
        // Equal hashes are nearly always equal shapes; sorting tells for sure.
        let mut members: Vec<([u64; 11], PrimRef, usize)> = group
            .iter()
            .filter_map(|&(_, i)| shape_of(&lights[i as usize]).map(|(key, prim)| (key, prim, i as usize)))
            .collect();
        members.sort_unstable();
        for pair in members.windows(2) {
            hidden[pair[1].2] = pair[0].0 == pair[1].0;
            hiding[pair[0].2] |= pair[0].0 == pair[1].0;
        }
    }
    Copies { hidden, hiding }
}

/// The end of a shadow ray to a sphere that hides a copy of itself, which must not block. What rounding moves across the
/// ray moves the copy's hit along it by up to 1/cos as much, cos that of the angle at the light. As the cosine vanishes
/// nothing blocks, nor is there light; and nothing of a sphere is nearer than |d − R|, however flat the ray meets it.
/// Rays to flat lights end early enough anyway.
pub(crate) fn shadow_end(light: &Light, at: &Receiver, aim: &Aim) -> f32 {
    let w = aim.wi.as_dvec3();
    let round = |sphere: &SphereLight| {
        let from_center = at.p.as_dvec3() - sphere.center;
        let normal = (from_center + w * f64::from(aim.distance)) / sphere.radius;
        (w.dot(normal).abs(), (from_center.length() - sphere.radius).abs())
    };
    let (cos, nearest) = match light {
        Light::Sphere(l) => round(l),
        Light::SphereCap(l) => round(&l.sphere),
        Light::Triangle(_)
        | Light::Parallelogram(_)
        | Light::Disc(_)
        | Light::Point(_)
        | Light::Spot(_)
        | Light::Directional(_)
        | Light::Area(_)
        | Light::Environment(_)
        | Light::Moving(_) => return aim.t_max,
    };
    let margin = aim.distance - aim.t_max;
    let end = aim.t_max - margin * (1.0 / cos.min(1.0) - 1.0) as f32;
    end.max(nearest as f32 - margin)
}

/// FNV-1a over words, with a final mix.
fn hash(key: &[u64; 11]) -> u64 {
    let h = key.iter().fold(0xcbf2_9ce4_8422_2325u64, |h, &k| {
        (h ^ k ^ (k >> 32)).wrapping_mul(0x0000_0100_0000_01b3).rotate_left(29)
    });
    h ^ (h >> 31)
}
