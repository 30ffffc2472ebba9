//! What moves while the shutter is open, as the engine meets it. What stays where it is costs nothing.

use super::flatten::Leaf;
use crate::diag::{Diagnostic, Diagnostics};
use crate::render::geometry::LightMap;
use crate::render::light::{Light, MovingLight};
use crate::render::motion::Motion;
use glam::{DAffine3, DMat3};

/// Where a leaf stands in camera-relative space, and how it moves from there: `world` without its motion, changed only
/// where all keys say the same. A motion that leaves the numbers is none, with a warning.
pub fn of_leaf(leaf: &Leaf<'_>, world: DAffine3, diags: &mut Diagnostics) -> (DAffine3, Option<Box<Motion>>) {
    let Some(first) = leaf.motion.first() else {
        return (world, None);
    };
    if leaf.motion.iter().all(|key| key == first) {
        let stays = *first == DAffine3::IDENTITY || !first.is_finite();
        return (if stays { world } else { world * *first }, None);
    }
    let back = world.inverse();
    let carried = |key: &DAffine3| match key.matrix3 == DMat3::IDENTITY {
        // A translation stays one: no rounding of the inverse comes in.
        true => DAffine3::from_translation(world.transform_vector3(key.translation)),
        false => world * *key * back,
    };
    let keys: Vec<DAffine3> = leaf.motion.iter().map(carried).collect();
    if !keys.iter().all(|key| key.is_finite() && key.inverse().is_finite()) {
        let message = "an object's motion is singular or not finite: it stands still";
        diags.push(super::at_place(
            Diagnostic::warning("C0107", message).hint("a scale factor may become zero while the shutter is open"),
            &leaf.object.place,
        ));
        return (world, None);
    }
    (world, Motion::new(keys).map(Box::new))
}

/// Lets the lights from index `first` on, those of one object, move with it. If one cannot, rays find them all by chance:
/// spheres that are turned or stretched are ellipsoids on their way, which nobody can aim at.
pub fn of_lights(lights: &mut Vec<Light>, first: usize, map: LightMap, motion: Option<&Motion>) -> LightMap {
    let Some(motion) = motion else { return map };
    let moving: Option<Vec<MovingLight>> = lights[first..]
        .iter()
        .map(|light| MovingLight::with_object(light, motion))
        .collect();
    lights.truncate(first);
    match moving {
        Some(moving) => {
            lights.extend(moving.into_iter().map(|light| Light::Moving(Box::new(light))));
            map
        }
        None => LightMap::None,
    }
}

/// A name for a motion by which equal ones are known: its numbers, bit by bit.
pub fn bits(motion: Option<&Motion>) -> Vec<u64> {
    let keys = motion.map_or(&[][..], Motion::keys);
    keys.iter()
        .flat_map(|key| key.to_cols_array())
        .map(f64::to_bits)
        .collect()
}
