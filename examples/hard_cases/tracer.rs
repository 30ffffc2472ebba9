//! A path tracer as a first one is written: f32, spheres and triangles, a fixed epsilon, light by the cone of a ball.

use crate::naive;
use glam::Vec3;
use pts::math::stats::Pcg;
use pts::math::warp::cosine_hemisphere;

/// What a surface is made of.
#[derive(Clone, Copy)]
pub enum Look {
    /// Lambert of this albedo.
    Diffuse(f32),
    /// Smooth glass of this index, Schlick's curve with the incident cosine.
    Glass(f32),
    /// Shines and scatters nothing.
    Glow(f32),
}

/// A ball or a triangle.
#[derive(Clone, Copy)]
pub enum Form {
    Ball(Vec3, f32),
    Triangle([Vec3; 3]),
}

/// What is rendered.
pub struct World {
    pub things: Vec<(Form, Look)>,
    /// Radiance of the sky.
    pub sky: f32,
    /// A ball of `things` that is sampled as a lamp.
    pub lamp: Option<usize>,
    /// Determinants up to this are refused.
    pub det_eps: f32,
}

const DEEPEST: u32 = 12;

impl World {
    fn closest(&self, o: Vec3, d: Vec3) -> Option<(f32, usize)> {
        let mut best: Option<(f32, usize)> = None;
        for (i, (form, _)) in self.things.iter().enumerate() {
            let t = match form {
                Form::Ball(center, radius) => naive::sphere(o, d, *center, *radius, naive::EPS),
                Form::Triangle(corners) => naive::triangle(o, d, *corners, self.det_eps).filter(|t| *t > naive::EPS),
            };
            if let Some(t) = t.filter(|t| best.is_none_or(|(b, _)| *t < b)) {
                best = Some((t, i));
            }
        }
        best
    }

    /// The radiance along a ray.
    pub fn radiance(&self, mut o: Vec3, mut d: Vec3, rng: &mut Pcg) -> f32 {
        let (mut sum, mut throughput, mut sees_lamp) = (0.0, 1.0, true);
        for _ in 0..DEEPEST {
            let Some((t, i)) = self.closest(o, d) else {
                return sum + throughput * self.sky;
            };
            let (form, look) = self.things[i];
            let p = o + d * t;
            let n = match form {
                Form::Ball(center, _) => (p - center).normalize(),
                Form::Triangle([a, b, c]) => (b - a).cross(c - a).normalize(),
            };
            let facing = if n.dot(d) < 0.0 { n } else { -n };
            match look {
                Look::Glow(l) => {
                    let counted = self.lamp == Some(i) && !sees_lamp;
                    return sum + if counted { 0.0 } else { throughput * l };
                }
                Look::Diffuse(albedo) => {
                    throughput *= albedo;
                    sum += throughput * self.lit(p, facing, rng);
                    sees_lamp = false;
                    let [s, t] = naive::basis(facing);
                    let w = cosine_hemisphere(rng.next_vec2());
                    (o, d) = (p, (s * w.x + t * w.y + facing * w.z).normalize());
                }
                Look::Glass(n_inside) => {
                    let eta = if n.dot(d) < 0.0 { n_inside } else { 1.0 / n_inside };
                    let cos = -facing.dot(d);
                    let k = 1.0 - (1.0 - cos * cos) / (eta * eta);
                    let reflects = k < 0.0 || rng.next_f32() < naive::schlick(cos, eta);
                    sees_lamp = true;
                    d = if reflects {
                        d + facing * (2.0 * cos)
                    } else {
                        (d / eta + facing * (cos / eta - k.sqrt())).normalize()
                    };
                    o = p;
                }
            }
        }
        sum
    }

    /// Light of the lamp by a direction in its cone, over π.
    fn lit(&self, p: Vec3, n: Vec3, rng: &mut Pcg) -> f32 {
        let Some(lamp) = self.lamp else { return 0.0 };
        let (Form::Ball(center, radius), Look::Glow(l)) = self.things[lamp] else {
            return 0.0;
        };
        let to = center - p;
        let axis = to.normalize();
        let x = naive::one_minus_cos(radius, to.length());
        let u = rng.next_vec2();
        let (cos, sin) = (1.0 - u.x * x, naive::sine_in_cone(u.x, x));
        let (sin_phi, cos_phi) = (std::f32::consts::TAU * u.y).sin_cos();
        let [s, t] = naive::basis(axis);
        let wi = (s * (sin * cos_phi) + t * (sin * sin_phi) + axis * cos).normalize();
        match self.closest(p, wi) {
            Some((_, i)) if i == lamp => l * wi.dot(n).max(0.0) * 2.0 * x,
            _ => 0.0,
        }
    }
}
