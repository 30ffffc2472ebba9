//! Lights that move: at each time a light of the same kind, its places and edges on straight lines between keys.

use super::TriangleLight;
use super::bounds::LightBounds;
use super::{
    Aim, AreaLamp, DirectionalLamp, DiscLight, HitOnLight, Light, ParallelogramLight, PointLamp, Receiver, SphereLight,
    SpotLamp,
};
use crate::render::motion::{Motion, step};
use glam::{DAffine3, DVec3, Vec2, Vec3};

/// A light at equal steps of the time that the shutter is open.
#[derive(Clone, Debug)]
pub struct MovingLight {
    keys: Box<[Light]>,
}

impl MovingLight {
    /// A light through these keys, the first at time 0, the last at time 1. `None` unless there are two or more, all of
    /// one kind, which must be one that can move: the environment and caps of spheres cannot.
    pub fn new(keys: Vec<Light>) -> Option<MovingLight> {
        let is_one_kind = keys.windows(2).all(|pair| between(&pair[0], &pair[1], 0.0).is_some());
        (keys.len() >= 2 && is_one_kind).then(|| MovingLight { keys: keys.into() })
    }

    /// An emitting surface that is moved with its object. `None` if it does not stay what it is: a sphere that does not
    /// stay round, anything that is turned inside out.
    pub fn with_object(light: &Light, motion: &Motion) -> Option<MovingLight> {
        let keys: Option<Vec<Light>> = motion.keys().iter().map(|key| moved(light, key)).collect();
        MovingLight::new(keys?)
    }

    /// The light at the shutter's opening.
    pub fn opening(&self) -> &Light {
        &self.keys[0]
    }

    /// The light at equal steps of time.
    pub fn keys(&self) -> &[Light] {
        &self.keys
    }

    /// The light at a time in [0, 1].
    pub fn at(&self, time: f32) -> Light {
        let (i, w) = step(self.keys.len(), time);
        let (a, b) = (&self.keys[i], &self.keys[i + 1]);
        // `new` has seen that neighbours are of one kind.
        between(a, b, w).unwrap_or_else(|| a.clone())
    }

    /// A direction towards the light at a time. Apart from the code for lights that stand still.
    #[inline(never)]
    pub(crate) fn sample(&self, at: &Receiver, u: Vec2, time: f32) -> Option<Aim> {
        match self.at(time) {
            Light::Point(l) => l.sample(at),
            Light::Spot(l) => l.sample(at),
            Light::Directional(l) => Some(l.sample()),
            Light::Area(l) => l.sample(at, u),
            Light::Sphere(l) => l.sample(at, u),
            Light::Triangle(l) => l.sample(at, u),
            Light::Parallelogram(l) => l.sample(at, u),
            Light::Disc(l) => l.sample(at, u),
            Light::SphereCap(_) | Light::Environment(_) | Light::Moving(_) => None, // these do not move
        }
    }

    /// The density with which `sample` gives the direction `wi` at the time of the hit; 0 for what no ray can hit.
    #[inline(never)]
    pub(crate) fn pdf(&self, at: &Receiver, wi: Vec3, hit: &HitOnLight) -> f32 {
        match self.at(hit.time) {
            Light::Sphere(l) => l.pdf(at, wi),
            Light::Triangle(l) => l.pdf(at, wi, hit),
            Light::Parallelogram(l) => l.pdf(at, wi, hit),
            Light::Disc(l) => l.pdf(wi, hit),
            Light::Point(_)
            | Light::Spot(_)
            | Light::Directional(_)
            | Light::Area(_)
            | Light::SphereCap(_)
            | Light::Environment(_)
            | Light::Moving(_) => 0.0,
        }
    }

    /// Bounds over the whole time. Between two keys that look into different directions nothing is known of where it
    /// looks.
    pub(crate) fn bounds(&self) -> Option<LightBounds> {
        let first = LightBounds::of(self.opening())?;
        let mut all = first;
        let mut strength = first.intensity;
        let mut turns = false;
        for key in self.keys.iter().filter_map(LightBounds::of) {
            turns |= (key.axis, key.cos_o, key.cos_e) != (first.axis, first.cos_o, first.cos_e);
            strength = strength.max(key.intensity);
            (all.min, all.max) = (all.min.min(key.min), all.max.max(key.max));
        }
        all.intensity = strength;
        Some(if turns { all.in_every_direction() } else { all })
    }
}

/// A light part of the way between two of its kind; `None` for lights of different kinds or that cannot move.
fn between(a: &Light, b: &Light, w: f64) -> Option<Light> {
    let mix = |a: DVec3, b: DVec3| a * (1.0 - w) + b * w;
    let mix32 = |a: Vec3, b: Vec3| mix(a.as_dvec3(), b.as_dvec3()).as_vec3();
    // Directions are unit vectors; where two opposite ones cancel the first stands.
    let unit = |a: DVec3, b: DVec3| mix(a, b).normalize_or(a);
    Some(match (a, b) {
        (Light::Point(a), Light::Point(b)) => Light::Point(Box::new(PointLamp {
            position: mix(a.position, b.position),
            ..**a
        })),
        (Light::Spot(a), Light::Spot(b)) => Light::Spot(Box::new(SpotLamp {
            position: mix(a.position, b.position),
            axis: unit(a.axis, b.axis),
            ..**a
        })),
        (Light::Directional(a), Light::Directional(b)) => Light::Directional(DirectionalLamp {
            direction: unit(a.direction.as_dvec3(), b.direction.as_dvec3()).as_vec3(),
            ..*a
        }),
        (Light::Area(a), Light::Area(b)) => Light::Area(Box::new(AreaLamp {
            position: mix(a.position, b.position),
            axis1: mix(a.axis1, b.axis1),
            axis2: mix(a.axis2, b.axis2),
            spot: match (a.spot, b.spot) {
                (Some((a, profile)), Some((b, _))) => Some((unit(a, b), profile)),
                (spot, _) => spot,
            },
            ..**a
        })),
        (Light::Sphere(a), Light::Sphere(b)) => Light::Sphere(SphereLight {
            center: mix(a.center, b.center),
            radius: a.radius * (1.0 - w) + b.radius * w,
            ..*a
        }),
        (Light::Triangle(a), Light::Triangle(b)) => Light::Triangle(TriangleLight {
            p0: mix(a.p0, b.p0),
            e1: mix32(a.e1, b.e1),
            e2: mix32(a.e2, b.e2),
            ..*a
        }),
        (Light::Parallelogram(a), Light::Parallelogram(b)) => Light::Parallelogram(ParallelogramLight {
            p0: mix(a.p0, b.p0),
            e1: mix32(a.e1, b.e1),
            e2: mix32(a.e2, b.e2),
            ..*a
        }),
        (Light::Disc(a), Light::Disc(b)) => Light::Disc(Box::new(DiscLight {
            center: mix(a.center, b.center),
            axis1: mix(a.axis1, b.axis1),
            axis2: mix(a.axis2, b.axis2),
            ..**a
        })),
        _ => return None,
    })
}

/// An emitting surface under a map that keeps its sides; `None` where it does not stay what it is.
fn moved(light: &Light, map: &DAffine3) -> Option<Light> {
    if map.matrix3.determinant().partial_cmp(&0.0) != Some(std::cmp::Ordering::Greater) {
        return None;
    }
    let vector = |v: Vec3| map.transform_vector3(v.as_dvec3()).as_vec3();
    Some(match light {
        Light::Sphere(l) => {
            // A turned sphere is round at the key, but not on the straight way there.
            let scale = map.matrix3.x_axis.x;
            if map.matrix3 != glam::DMat3::from_diagonal(DVec3::splat(scale)) {
                return None;
            }
            Light::Sphere(SphereLight {
                center: map.transform_point3(l.center),
                radius: l.radius * scale,
                ..*l
            })
        }
        Light::Triangle(l) => Light::Triangle(TriangleLight {
            p0: map.transform_point3(l.p0),
            e1: vector(l.e1),
            e2: vector(l.e2),
            ..*l
        }),
        Light::Parallelogram(l) => Light::Parallelogram(ParallelogramLight {
            p0: map.transform_point3(l.p0),
            e1: vector(l.e1),
            e2: vector(l.e2),
            ..*l
        }),
        Light::Disc(l) => Light::Disc(Box::new(DiscLight {
            center: map.transform_point3(l.center),
            axis1: map.transform_vector3(l.axis1),
            axis2: map.transform_vector3(l.axis2),
            ..**l
        })),
        Light::Point(_)
        | Light::Spot(_)
        | Light::Directional(_)
        | Light::Area(_)
        | Light::SphereCap(_)
        | Light::Environment(_)
        | Light::Moving(_) => return None,
    })
}
