//! Cases of surfaces, lenses, media and sums.

use crate::case::Case;
use crate::naive;
use glam::{DVec3, Vec2, Vec3};
use pts::math::frame::Frame;
use pts::math::robust::UNIT_ROUNDOFF;
use pts::render::bsdf::fresnel::fresnel_dielectric;
use pts::render::bsdf::microfacet::Ggx;
use pts::render::camera::{Camera, Pose};
use pts::render::film::TileFilm;
use pts::render::medium::Medium;
use std::f64::consts::PI;

const U: f64 = UNIT_ROUNDOFF as f64;

/// All cases.
pub fn cases() -> Vec<Case> {
    let mut cases = vec![matched(), inside_out()];
    cases.extend([1e-3, 3e-4].map(facets));
    cases.push(basis());
    cases.push(lens());
    cases.push(absorption());
    cases.push(sum());
    cases.push(variance());
    cases.push(roulette());
    cases
}

fn matched() -> Case {
    Case {
        item: "51",
        what: "reflectance of an index-matched surface at cos = 1e-4".into(),
        naive: f64::from(naive::fresnel(1e-4, 1.0)),
        pts: f64::from(fresnel_dielectric(1e-4, 1.0)),
        exact: 0.0,
        tolerance: 0.0,
        because: "nothing is there",
    }
}

/// From inside glass of 1.5 at 40°, near total reflection.
fn inside_out() -> Case {
    let cos = 40f64.to_radians().cos();
    let sin_t = 1.5 * 40f64.to_radians().sin();
    let cos_t = (1.0 - sin_t * sin_t).sqrt();
    let s = (1.5 * cos - cos_t) / (1.5 * cos + cos_t);
    let p = (cos - 1.5 * cos_t) / (cos + 1.5 * cos_t);
    Case {
        item: "L, 50",
        what: "reflectance from inside glass at 40°, by Schlick with the cosine inside".into(),
        naive: f64::from(naive::schlick(cos as f32, 1.0 / 1.5)),
        pts: f64::from(fresnel_dielectric(cos as f32, 1.0 / 1.5)),
        exact: 0.5 * (s * s + p * p),
        tolerance: 1e-5,
        because: "1e-5 away from the critical angle",
    }
}

fn facets(alpha: f64) -> Case {
    let exact = 1.0 / (PI * alpha * alpha);
    Case {
        item: "54",
        what: format!("density of facets along the normal, α = {alpha:e}"),
        naive: f64::from(naive::ggx(1.0, alpha as f32)),
        pts: Ggx::isotropic(alpha as f32).map_or(f64::NAN, |g| f64::from(g.d(Vec3::Z))),
        exact,
        tolerance: 8.0 * U * exact,
        because: "8u relative, α's own rounding included",
    }
}

/// |T·Tᵗ − I|, the largest entry.
fn off_orthonormal(rows: [Vec3; 3]) -> f64 {
    let rows = rows.map(|v| v.as_dvec3());
    crate::case::worst((0..9).map(|k| {
        let (i, j) = (k / 3, k % 3);
        (rows[i].dot(rows[j]) - f64::from(u8::from(i == j))).abs()
    }))
}

fn basis() -> Case {
    let n = Vec3::new(1e-4, 0.0, -1.0).normalize();
    let ours = Frame::from_normal(n);
    let [s, t] = naive::basis(n);
    Case {
        item: "46",
        what: "how far a basis about (1e-4, 0, −1) is from orthonormal".into(),
        naive: off_orthonormal([s, t, n]),
        pts: off_orthonormal([ours.t, ours.b, ours.n]),
        exact: 0.0,
        tolerance: 4.0 * U,
        because: "4u",
    }
}

fn lens() -> Case {
    let camera = Camera {
        orthographic: false,
        pose: Pose {
            location: DVec3::ZERO,
            direction: DVec3::Z,
            right: DVec3::X,
            up: DVec3::Y,
            lens_radius: 0.5,
            focus_distance: 1e20,
        },
        keys: Vec::new(),
    };
    let mut pinhole = camera.clone();
    pinhole.pose.lens_radius = 0.0;
    let u = Vec2::new(0.9, 0.3);
    let (ray, exact) = (camera.ray(0.3, 0.2, u, 0.0), pinhole.ray(0.3, 0.2, u, 0.0));
    let by_point = naive::lens(exact.dir, ray.origin, 1e20);
    let off = |d: Vec3| f64::from((d - exact.dir).length());
    Case {
        item: "78",
        what: "how far a ray of a lens focused at 1e20 is from the pinhole's".into(),
        naive: off(by_point),
        pts: off(ray.dir),
        exact: 0.0,
        tolerance: 2.0 * U,
        because: "2u",
    }
}

fn absorption() -> Case {
    Case {
        item: "82",
        what: "light left after an endless way through clear glass".into(),
        naive: f64::from((-0.0f32 * f32::INFINITY).exp()),
        pts: f64::from(Medium::CLEAR.transmittance(f32::INFINITY).x),
        exact: 1.0,
        tolerance: 0.0,
        because: "clear is clear",
    }
}

/// The mean of ten million samples of 0.1 in one pixel.
fn sum() -> Case {
    const N: u32 = 10_000_000;
    let mut total = 0.0f32;
    (0..N).for_each(|_| total += 0.1);
    let mut film = TileFilm::new(1, 1, 1, 0);
    film.extend(N, |_, _, out| out[0] = f64::from(0.1f32));
    let mut sums = [0.0];
    film.net_sum(0, 0, &mut sums);
    let exact = f64::from(0.1f32);
    Case {
        item: "72",
        what: "mean of 1e7 samples of 0.1 in a pixel".into(),
        naive: f64::from(total) / f64::from(N),
        pts: sums[0] / f64::from(N),
        exact,
        // Sixteen to a leaf, then a tree of 20 levels.
        tolerance: exact * 36.0 * f64::EPSILON / 2.0,
        because: "36 roundings of f64 on the longest way",
    }
}

/// The variance of samples around 1e4, whose squares hide it.
fn variance() -> Case {
    const N: usize = 100_000;
    // Evenly 1e4 ± 1: the population's variance is 1.
    let sample = |i: usize| if i.is_multiple_of(2) { 10_001.0f32 } else { 9_999.0 };
    let (mut sum, mut squares) = (0.0f32, 0.0f32);
    let mut film = TileFilm::new(1, 1, 2, 0);
    film.extend(N as u32, |_, i, out| {
        let x = f64::from(sample(i as usize));
        (out[0], out[1]) = (x, x * x);
    });
    for x in (0..N).map(sample) {
        sum += x;
        squares += x * x;
    }
    let n = N as f32;
    let mut sums = [0.0; 2];
    film.net_sum(0, 0, &mut sums);
    let mean = sums[0] / N as f64;
    Case {
        item: "74",
        what: "variance of samples 1e4 ± 1 from their sums".into(),
        naive: f64::from(squares / n - (sum / n) * (sum / n)),
        pts: sums[1] / N as f64 - mean * mean,
        exact: 1.0,
        tolerance: 1e8 * 64.0 * f64::EPSILON,
        because: "64 roundings of f64 of a square of 1e8",
    }
}

/// A room of albedo 0.9 that glows with 1: 1 + 0.9 + 0.9² + … The slide calls q the probability to end and divides by
/// q: read like that, a path goes on with 1 − q and gains 1/q.
fn roulette() -> Case {
    let (albedo, q) = (0.9f64, 0.9f64);
    let as_told = 1.0 / (1.0 - albedo * (1.0 - q) / q);
    // Seen from both sides, since the mesh is open as far as emission is concerned.
    let scene = "camera { location <0.1, 0.2, 0.3> look_at <0.5, 0.4, 1> right x up y angle 90 }
        #declare A = <-1,-1,-1>; #declare B = <1,-1,-1>; #declare C = <1,1,-1>; #declare D = <-1,1,-1>;
        #declare E = <-1,-1,1>;  #declare F = <1,-1,1>;  #declare G = <1,1,1>;  #declare H = <-1,1,1>;
        mesh {
          triangle {A,B,C} triangle {A,C,D} triangle {E,G,F} triangle {E,H,G}
          triangle {A,E,F} triangle {A,F,B} triangle {D,C,G} triangle {D,G,H}
          triangle {A,D,H} triangle {A,H,E} triangle {B,F,G} triangle {B,G,C}
          material { diffuse { color rgb 0.9 } emission rgb 1 }
        }";
    let (mean, stderr) = crate::pictures::mean(scene, [16, 16], 1024);
    Case {
        item: "L, 68",
        what: "radiance in a closed room of albedo 0.9 that glows with 1, roulette as the slide words it".into(),
        naive: as_told,
        pts: mean,
        exact: 10.0,
        tolerance: 5.0 * stderr,
        because: "five standard errors",
    }
}
