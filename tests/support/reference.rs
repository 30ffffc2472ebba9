//! An independent, deliberately simple f64 path tracer for scenes made of spheres, and the classic Cornell box
//! of spheres as its first scene. No light sampling, no acceleration, no shared code with the renderer under test:
//! what both agree on is right for different reasons. It keeps the lecture's geometry and camera; it differs in
//! that Fresnel is exact (Schlick on request), Russian roulette is driven by throughput and unbiased, and no
//! epsilon keeps a ray from the sphere it leaves (one of the two roots is known to be 0 there).

use super::estimate::{Estimate, Region};
use glam::DVec3;
use rayon::prelude::*;

/// How a sphere scatters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Finish {
    /// Lambert, albedo = colour.
    Diffuse,
    /// Mirror, reflectance = colour.
    Mirror,
    /// Smooth dielectric of this index of refraction against 1.
    Glass(f64),
}

/// A sphere; rays see it from both sides, it emits to both sides.
#[derive(Clone, Copy, Debug)]
pub struct Ball {
    /// Centre.
    pub center: DVec3,
    /// Radius.
    pub radius: f64,
    /// Emitted radiance.
    pub emission: DVec3,
    /// Albedo, reflectance, or tint per crossing.
    pub color: DVec3,
    /// Scattering.
    pub finish: Finish,
}

/// A pinhole camera with the picture's vectors written out.
#[derive(Clone, Copy, Debug)]
pub struct Pinhole {
    /// Where rays start.
    pub location: DVec3,
    /// Towards the centre of the picture.
    pub direction: DVec3,
    /// Width of the picture at `direction`'s length.
    pub right: DVec3,
    /// Height of the picture at `direction`'s length.
    pub up: DVec3,
    /// Distance along each ray at which it begins to see.
    pub near: f64,
}

/// What differs between the lecture's program and ours.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Glass {
    /// Exact Fresnel; colour tints what is transmitted only.
    #[default]
    Exact,
    /// Schlick's approximation (transmitted cosine on the way out); colour tints reflection too.
    Lecture,
}

/// A scene of spheres with its camera.
#[derive(Clone, Debug)]
pub struct Balls {
    /// The spheres.
    pub balls: Vec<Ball>,
    /// The camera.
    pub camera: Pinhole,
    /// Model of glass.
    pub glass: Glass,
}

/// The classic box: six walls of radius 1e5, a mirror ball, a glass ball and a lamp of radius 600 that looks through
/// the ceiling. `aspect` is width/height of the picture.
pub fn cornell(aspect: f64) -> Balls {
    let wall = |x: f64, y: f64, z: f64, color: [f64; 3]| Ball {
        center: DVec3::new(x, y, z),
        radius: 1e5,
        emission: DVec3::ZERO,
        color: color.into(),
        finish: Finish::Diffuse,
    };
    let ball = |x: f64, z: f64, finish| Ball {
        center: DVec3::new(x, 16.5, z),
        radius: 16.5,
        emission: DVec3::ZERO,
        color: DVec3::splat(0.999),
        finish,
    };
    let lamp = Ball {
        center: DVec3::new(50.0, 681.6 - 0.27, 81.6),
        radius: 600.0,
        emission: DVec3::splat(12.0),
        color: DVec3::ZERO,
        finish: Finish::Diffuse,
    };
    let direction = DVec3::new(0.0, -0.042612, -1.0).normalize();
    let right = DVec3::X * 0.5135 * aspect;
    Balls {
        balls: vec![
            wall(1e5 + 1.0, 40.8, 81.6, [0.75, 0.25, 0.25]),
            wall(-1e5 + 99.0, 40.8, 81.6, [0.25, 0.25, 0.75]),
            wall(50.0, 40.8, 1e5, [0.75; 3]),
            wall(50.0, 40.8, -1e5 + 170.0, [0.0; 3]),
            wall(50.0, 1e5, 81.6, [0.75; 3]),
            wall(50.0, -1e5 + 81.6, 81.6, [0.75; 3]),
            ball(27.0, 47.0, Finish::Mirror),
            ball(73.0, 78.0, Finish::Glass(1.5)),
            lamp,
        ],
        camera: Pinhole {
            location: DVec3::new(50.0, 52.0, 295.6),
            direction,
            right,
            up: right.cross(direction).normalize() * 0.5135,
            near: 140.0,
        },
        glass: Glass::Exact,
    }
}

/// Parts of the classic box's picture in which one thing is seen.
pub const CORNELL_REGIONS: [Region; 7] = [
    region("red wall", [0.02, 0.15, 0.15, 0.75]),
    region("blue wall", [0.85, 0.15, 0.98, 0.6]),
    region("back wall", [0.3, 0.25, 0.7, 0.5]),
    region("ceiling", [0.25, 0.02, 0.4, 0.09]),
    region("floor", [0.25, 0.85, 0.55, 0.98]),
    region("mirror ball", [0.28, 0.55, 0.42, 0.75]),
    region("glass ball", [0.62, 0.62, 0.8, 0.85]),
];

const fn region(name: &'static str, bounds: [f64; 4]) -> Region {
    Region { name, bounds }
}

/// Renders with a box filter. Each pixel has its own stream, so the result does not depend on threads.
pub fn render(scene: &Balls, width: usize, height: usize, spp: u32, seed: u64) -> Estimate {
    let pixels: Vec<([f64; 3], [f64; 3])> = (0..height)
        .into_par_iter()
        .flat_map_iter(|y| (0..width).map(move |x| pixel(scene, [width, height], [x, y], spp, seed)))
        .collect();
    let (mean, variance) = pixels.into_iter().unzip();
    Estimate {
        width,
        height,
        mean,
        variance,
    }
}

/// Mean and variance of the mean of one pixel (Welford).
fn pixel(scene: &Balls, size: [usize; 2], at: [usize; 2], spp: u32, seed: u64) -> ([f64; 3], [f64; 3]) {
    let mut rng = Rng::new(seed, (at[1] * size[0] + at[0]) as u64);
    let (mut mean, mut m2) = (DVec3::ZERO, DVec3::ZERO);
    for n in 1..=spp {
        let px = (at[0] as f64 + rng.uniform()) / size[0] as f64;
        let py = (at[1] as f64 + rng.uniform()) / size[1] as f64;
        let c = &scene.camera;
        let d = (c.direction + (px - 0.5) * c.right + (0.5 - py) * c.up).normalize();
        let value = radiance(scene, c.location + d * c.near, d, &mut rng);
        let delta = value - mean;
        mean += delta / f64::from(n);
        m2 += delta * (value - mean);
    }
    let n = f64::from(spp);
    (mean.to_array(), (m2 / (n - 1.0) / n).to_array())
}

/// One estimate of the radiance arriving at `origin` against the unit direction `dir`.
fn radiance(scene: &Balls, mut origin: DVec3, mut dir: DVec3, rng: &mut Rng) -> DVec3 {
    let (mut total, mut throughput, mut from) = (DVec3::ZERO, DVec3::ONE, usize::MAX);
    for depth in 0u32.. {
        let Some((t, i)) = nearest(&scene.balls, origin, dir, from) else {
            break;
        };
        let ball = &scene.balls[i];
        let outward = (origin + dir * t - ball.center) / ball.radius;
        let outward = outward.normalize();
        // The point is put back onto the sphere, so the root at 0 is a root at 0.
        let point = ball.center + outward * ball.radius;
        let facing = if outward.dot(dir) < 0.0 { outward } else { -outward };
        total += throughput * ball.emission;

        match ball.finish {
            Finish::Diffuse => {
                throughput *= ball.color;
                dir = cosine_direction(facing, rng);
            }
            Finish::Mirror => {
                throughput *= ball.color;
                dir = reflect(dir, facing);
            }
            Finish::Glass(ior) => {
                let entering = outward.dot(dir) < 0.0;
                let (next, tint) = glass(dir, facing, if entering { ior } else { 1.0 / ior }, scene.glass, rng);
                dir = next;
                if tint {
                    throughput *= ball.color;
                }
            }
        }
        if throughput == DVec3::ZERO {
            break;
        }
        if depth >= 4 {
            let survival = throughput.max_element().min(0.95);
            if rng.uniform() >= survival {
                break;
            }
            throughput /= survival;
        }
        origin = point;
        from = i;
    }
    total
}

/// The nearest hit in front. On the sphere a ray leaves, one root of t² − 2bt = 0 is 0 and the other 2b.
fn nearest(balls: &[Ball], origin: DVec3, dir: DVec3, from: usize) -> Option<(f64, usize)> {
    let mut best: Option<(f64, usize)> = None;
    for (i, ball) in balls.iter().enumerate() {
        let to_center = ball.center - origin;
        let b = to_center.dot(dir);
        let t = if i == from {
            2.0 * b
        } else {
            let discriminant = b * b - to_center.length_squared() + ball.radius * ball.radius;
            if discriminant < 0.0 {
                continue;
            }
            let s = discriminant.sqrt();
            if b - s > 0.0 { b - s } else { b + s }
        };
        if t > 0.0 && best.is_none_or(|(nearest, _)| t < nearest) {
            best = Some((t, i));
        }
    }
    best
}

fn reflect(d: DVec3, n: DVec3) -> DVec3 {
    (d - n * (2.0 * n.dot(d))).normalize()
}

/// Direction after a dielectric boundary and whether it passed. `n` faces the ray, `eta` = n_transmitted/n_incident.
fn glass(d: DVec3, n: DVec3, eta: f64, model: Glass, rng: &mut Rng) -> (DVec3, bool) {
    let cos_i = -n.dot(d);
    let sin2_t = (1.0 - cos_i * cos_i) / (eta * eta);
    if sin2_t >= 1.0 {
        return (reflect(d, n), model == Glass::Lecture);
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    let reflectance = match model {
        Glass::Exact => {
            let s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
            let p = (cos_t - eta * cos_i) / (cos_t + eta * cos_i);
            0.5 * (s * s + p * p)
        }
        Glass::Lecture => {
            let r0 = ((eta - 1.0) / (eta + 1.0)).powi(2);
            let c = 1.0 - if eta > 1.0 { cos_i } else { cos_t };
            r0 + (1.0 - r0) * c.powi(5)
        }
    };
    if rng.uniform() < reflectance {
        (reflect(d, n), model == Glass::Lecture)
    } else {
        ((d / eta + n * (cos_i / eta - cos_t)).normalize(), true)
    }
}

/// Cosine-distributed direction about `n`: a uniform point on the unit sphere added to the normal.
fn cosine_direction(n: DVec3, rng: &mut Rng) -> DVec3 {
    let z = 1.0 - 2.0 * rng.uniform();
    let phi = std::f64::consts::TAU * rng.uniform();
    let r = (1.0 - z * z).max(0.0).sqrt();
    let d = n + DVec3::new(r * phi.cos(), r * phi.sin(), z);
    d.try_normalize().unwrap_or(n) // exactly opposite: a measure-zero draw
}

/// SplitMix64, one stream per pixel: a generator of its own, so that not even random numbers are shared.
/// Source: Steele, Lea, Flood, Fast Splittable Pseudorandom Number Generators, 2014.
struct Rng(u64);

impl Rng {
    fn new(seed: u64, stream: u64) -> Rng {
        let mut rng = Rng(seed ^ stream.wrapping_mul(0xD134_2543_DE82_EF95));
        rng.0 = rng.next();
        rng
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// In [0, 1).
    fn uniform(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }
}
