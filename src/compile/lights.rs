//! Lamps and the environment become the engine's lights.

use super::images::Images;
use crate::diag::{Anomaly, Diagnostic, Diagnostics};
use crate::render::light::{
    AreaLamp, DirectionalLamp, EnvironmentImage, EnvironmentLight, Falloff, Light, MovingLight, PointLamp, SpotLamp,
    SpotProfile,
};
use crate::scene;
use crate::scene::{EnvironmentKind, Handedness, LightKind, Scene};
use glam::{DVec3, Vec3};

/// All lamps of the scene, relative to `origin`. One whose light is no number is left out, and so is one that is nowhere
/// above 0 and somewhere below: there is no negative light. Black ones are [`super::prune`]'s business.
pub fn lamps(scene: &Scene, origin: DVec3, diags: &mut Diagnostics) -> Vec<Light> {
    let (sound, bad): (Vec<_>, Vec<_>) = scene.lights.iter().partition(|l| l.color.as_vec3().is_finite());
    if !bad.is_empty() {
        let message = format!("{} lamps are brighter than numbers go: they are left out", bad.len());
        diags.push(Diagnostic::warning("C0106", message).counting(Anomaly::DroppedShape, bad.len() as u64));
    }
    let shines = |l: &&scene::Light| l.color.max_element() > 0.0 || l.color == DVec3::ZERO;
    sound.into_iter().filter(shines).map(|l| lamp(l, origin)).collect()
}

/// A lamp, moving if it really does; all its keys are of one kind.
fn lamp(light: &scene::Light, origin: DVec3) -> Light {
    let keys = light.motion.iter().map(|key| still_lamp(light, key, origin));
    let moving = light.moves().then(|| MovingLight::new(keys.collect())).flatten();
    match moving {
        Some(moving) => Light::Moving(Box::new(moving)),
        None => still_lamp(light, &light.kind, origin),
    }
}

fn still_lamp(light: &scene::Light, kind: &LightKind, origin: DVec3) -> Light {
    let color = light.color.as_vec3();
    let casts_shadows = light.casts_shadows;
    match kind.clone() {
        LightKind::Point { position, falloff: f } => Light::Point(Box::new(PointLamp {
            position: position - origin,
            color,
            falloff: falloff(f),
            casts_shadows,
        })),
        LightKind::Spot {
            position,
            axis,
            profile: p,
            falloff: f,
        } => Light::Spot(Box::new(SpotLamp {
            position: position - origin,
            axis,
            color,
            profile: profile(p),
            falloff: falloff(f),
            casts_shadows,
        })),
        LightKind::Directional { direction } => Light::Directional(DirectionalLamp {
            direction: direction.as_vec3(),
            color,
            casts_shadows,
        }),
        LightKind::Area {
            position,
            axis1,
            axis2,
            circular,
            spot,
            falloff: f,
        } => Light::Area(Box::new(AreaLamp {
            position: position - origin,
            axis1,
            axis2,
            circular,
            spot: spot.map(|(axis, p)| (axis, profile(p))),
            color,
            falloff: falloff(f),
            casts_shadows,
        })),
    }
}

fn falloff(f: scene::Falloff) -> Falloff {
    match f {
        scene::Falloff::None => Falloff::None,
        scene::Falloff::Fade { distance, power } => Falloff::Fade { distance, power },
        scene::Falloff::InverseSquare { range } => Falloff::InverseSquare { range },
    }
}

fn profile(p: scene::SpotProfile) -> SpotProfile {
    match p {
        scene::SpotProfile::Pov {
            radius,
            falloff,
            tightness,
        } => SpotProfile::Pov {
            radius,
            falloff,
            tightness,
        },
        scene::SpotProfile::Punctual { inner, outer } => SpotProfile::Punctual { inner, outer },
    }
}

/// The environment as a light, if it lights the scene, and what camera rays see instead of it, if that differs.
pub fn environment(scene: &Scene, images: &mut Images<'_>, diags: &mut Diagnostics) -> (Option<Light>, Option<Vec3>) {
    let environment = &scene.environment;
    let light = match &environment.kind {
        EnvironmentKind::Black => None,
        EnvironmentKind::Constant(c) => Some(EnvironmentLight::Constant(c.as_vec3())),
        EnvironmentKind::Image {
            image,
            strength,
            rotation,
        } => images
            .radiance(*image, *strength, diags)
            .and_then(|(width, height, texels)| {
                let right_handed = scene.handedness == Handedness::Right;
                EnvironmentImage::new(width, height, texels, *rotation, right_handed).map(EnvironmentLight::Image)
            }),
    };
    let mut backdrop = environment.backdrop.map(|c| c.as_vec3());
    if !environment.illuminates
        && let (None, EnvironmentKind::Constant(c)) = (backdrop, &environment.kind)
    {
        backdrop = Some(c.as_vec3());
    }
    let light = light.filter(|_| environment.illuminates);
    (light.map(|l| Light::Environment(Box::new(l))), backdrop)
}
