//! Lamps without a shape, and light from infinitely far away.

use super::{ImageId, Place};
use glam::{DMat3, DVec3};

/// How the irradiance of a lamp falls with the distance r. `color` is [`Light::color`], E is at normal incidence.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Falloff {
    /// E = π·color at any distance (POV-Ray without `fade_*`).
    None,
    /// E = π·color·2/(1 + (r/distance)^power) (POV-Ray's `fade_distance`, `fade_power`).
    Fade {
        /// Distance at which the factor is 1, > 0.
        distance: f64,
        /// Exponent, ≥ 0.
        power: f64,
    },
    /// E = color/r², color being radiant intensity (W/sr, candela); with a range the window of
    /// `KHR_lights_punctual`: max(min(1 − (r/range)⁴, 1), 0).
    InverseSquare {
        /// Where the light ends, if it does.
        range: Option<f64>,
    },
}

/// How the light of a spot falls with the angle from its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SpotProfile {
    /// POV-Ray: smoothstep of the angle between `radius` and `falloff` (half angles, radians) times cos^tightness.
    Pov {
        /// Half angle of the full-light cone.
        radius: f64,
        /// Half angle where it ends.
        falloff: f64,
        /// Exponent of the cosine.
        tightness: f64,
    },
    /// `KHR_lights_punctual`: (clamp((cos θ − cos outer)/(cos inner − cos outer)))², half angles in radians.
    Punctual {
        /// Half angle of the full-light cone, < outer.
        inner: f64,
        /// Half angle where it ends.
        outer: f64,
    },
}

/// What kind of lamp it is, in world space.
#[derive(Clone, Debug, PartialEq)]
pub enum LightKind {
    /// Shines everywhere from a point.
    Point {
        /// Where it is.
        position: DVec3,
        /// With the distance.
        falloff: Falloff,
    },
    /// Shines into a cone from a point.
    Spot {
        /// Where it is.
        position: DVec3,
        /// Unit direction of the axis, away from the lamp.
        axis: DVec3,
        /// With the angle.
        profile: SpotProfile,
        /// With the distance.
        falloff: Falloff,
    },
    /// Parallel light; E = π·color for POV-Ray's `parallel`, color is given so that E = π·color here too.
    Directional {
        /// Unit direction in which the light travels.
        direction: DVec3,
    },
    /// POV-Ray's `area_light`: points spread evenly over a parallelogram (or ellipse) that shine in every direction;
    /// E is as for a point at the sampled place.
    Area {
        /// Centre.
        position: DVec3,
        /// Whole first edge.
        axis1: DVec3,
        /// Whole second edge.
        axis2: DVec3,
        /// Elliptic instead of rectangular.
        circular: bool,
        /// Restriction to a cone, if it is also a spotlight: axis and profile.
        spot: Option<(DVec3, SpotProfile)>,
        /// With the distance.
        falloff: Falloff,
    },
}

/// A lamp that no ray can see.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// Name for messages, or empty.
    pub name: String,
    /// Linear RGB; its unit depends on the falloff, see [`Falloff`].
    pub color: DVec3,
    /// Kind, place, shape.
    pub kind: LightKind,
    /// Whether objects block it (off: `shadowless`).
    pub casts_shadows: bool,
    /// What it is at equal steps of the time that the shutter is open, the first at its opening: of the same kind as
    /// `kind`, of which places, axes and directions count, linear in between. Empty for a lamp that stands still.
    pub motion: Vec<LightKind>,
    /// Where it was written.
    pub place: Place,
}

/// What is infinitely far away.
#[derive(Clone, Debug, PartialEq, Default)]
pub enum EnvironmentKind {
    /// Nothing.
    #[default]
    Black,
    /// The same radiance from everywhere.
    Constant(DVec3),
    /// An equirectangular image: the centre column is towards `rotation · (+z)` in a left-handed scene and
    /// `rotation · (−z)` in a right-handed one, the top row is towards `rotation · (+y)`; seen from inside,
    /// columns grow to the right.
    Image {
        /// The image, linear radiance (8-bit images are sRGB).
        image: ImageId,
        /// Factor on the image.
        strength: f64,
        /// From the image's axes to the world.
        rotation: DMat3,
    },
}

/// Light from infinitely far away, seen by rays that leave the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Environment {
    /// Radiance by direction.
    pub kind: EnvironmentKind,
    /// Whether it lights the scene; otherwise only camera rays see it.
    pub illuminates: bool,
    /// Radiance that camera rays see instead, if the background differs from what lights the scene.
    pub backdrop: Option<DVec3>,
    /// Where it was written.
    pub place: Place,
}

impl Default for Environment {
    fn default() -> Environment {
        Environment {
            kind: EnvironmentKind::Black,
            illuminates: true,
            backdrop: None,
            place: Place::None,
        }
    }
}
