//! Tests that treat all lights alike; each file holds one kind of oracle.

mod choosing;
mod densities;
mod flat;
mod irradiance;
mod lamps;
mod sky;
mod spheres;
mod strategies;
mod tables;

use super::*;
use crate::math::frame::Frame;
use glam::DVec3;

/// A hit of the oracle: distance and unit geometric normal.
type OracleHit = Option<(f64, DVec3)>;

/// Where a ray first meets a surface of the light that emits towards its origin, in f64.
fn oracle_hit(light: &Light, p: DVec3, w: DVec3) -> OracleHit {
    let plane = |q: DVec3, n: DVec3| {
        let t = (q - p).dot(n) / w.dot(n);
        (t > 0.0 && t.is_finite()).then(|| (t, p + w * t - q, n.normalize()))
    };
    let facing = |two_sided: bool, hit: (f64, DVec3)| (two_sided || hit.1.dot(w) < 0.0).then_some(hit);
    // Coordinates of d along two edges.
    let along = |d: DVec3, e1: DVec3, e2: DVec3| {
        let n = e1.cross(e2);
        (d.cross(e2).dot(n) / n.dot(n), e1.cross(d).dot(n) / n.dot(n))
    };
    match light {
        Light::Triangle(l) => {
            let (e1, e2) = (l.e1.as_dvec3(), l.e2.as_dvec3());
            let (t, d, n) = plane(l.p0, e1.cross(e2))?;
            let (a, b) = along(d, e1, e2);
            (a >= 0.0 && b >= 0.0 && a + b <= 1.0).then_some(())?;
            facing(l.two_sided, (t, n))
        }
        Light::Parallelogram(l) => {
            let (e1, e2) = (l.e1.as_dvec3(), l.e2.as_dvec3());
            let (t, d, n) = plane(l.p0, e1.cross(e2))?;
            let (a, b) = along(d, e1, e2);
            (0.0..=1.0).contains(&a).then_some(())?;
            (0.0..=1.0).contains(&b).then_some(())?;
            facing(l.two_sided, (t, n))
        }
        Light::Disc(l) => {
            let (t, d, n) = plane(l.center, l.axis1.cross(l.axis2))?;
            let (a, b) = along(d, l.axis1, l.axis2);
            let r = a.hypot(b);
            (l.hole <= r && r <= 1.0).then_some(())?;
            facing(l.two_sided, (t, n))
        }
        Light::Sphere(l) => {
            let o = p - l.center;
            let c = o.length_squared() - l.radius * l.radius;
            let (t0, t1) = crate::math::robust::roots_of_half_quadratic(1.0, o.dot(w), c)?;
            let t = if t0 > 0.0 { t0 } else { t1 };
            (t > 0.0).then_some(())?;
            facing(l.two_sided, (t, (o + w * t) / l.radius))
        }
        Light::SphereCap(l) => {
            let (t, n) = oracle_hit(&Light::Sphere(l.sphere), p, w)?;
            (n.dot(l.axis) >= 1.0 - l.one_minus_cos).then_some((t, n))
        }
        Light::Environment(_) => Some((f64::INFINITY, -w)),
        Light::Moving(l) => oracle_hit(l.opening(), p, w),
        Light::Point(_) | Light::Spot(_) | Light::Directional(_) | Light::Area(_) => None,
    }
}

/// The density the set states for a direction, through whatever the oracle says it hits.
fn stated_pdf(set: &LightSet, at: &Receiver, w: DVec3) -> f64 {
    let wi = w.as_vec3();
    let mut sum = 0.0;
    for (i, light) in (0u32..).zip(&set_lights(set)) {
        if let Light::Environment(_) = light {
            continue;
        }
        if let Some((t, n)) = oracle_hit(light, at.p.as_dvec3(), w) {
            let hit = HitOnLight {
                p: (at.p.as_dvec3() + w * t).as_vec3(),
                ng: n.as_vec3(),
                distance: t as f32,
                time: 0.0,
            };
            sum += f64::from(set.pdf(i, at.p, at.n, at.two_sided, wi, &hit));
        }
    }
    sum + f64::from(set.environment_pdf(at.p, at.n, at.two_sided, wi))
}

fn set_lights(set: &LightSet) -> Vec<Light> {
    (0..set.len() as u32).filter_map(|i| set.get(i).cloned()).collect()
}

fn receiver(p: Vec3, n: Vec3) -> Receiver {
    Receiver { p, n, two_sided: false }
}

fn sphere(center: DVec3, radius: f64) -> Light {
    Light::Sphere(SphereLight {
        center,
        radius,
        radiance: Vec3::ONE,
        two_sided: false,
        textured: false,
        prim: PrimRef { object: 3, prim: 0 },
    })
}

fn cap(center: DVec3, radius: f64, axis: DVec3, one_minus_cos: f64) -> Light {
    let Light::Sphere(sphere) = sphere(center, radius) else {
        panic!("not a sphere");
    };
    Light::SphereCap(Box::new(SphereCapLight {
        sphere,
        axis,
        one_minus_cos,
    }))
}

fn triangle(p0: Vec3, p1: Vec3, p2: Vec3, two_sided: bool) -> Light {
    Light::Triangle(TriangleLight {
        p0: p0.as_dvec3(),
        e1: p1 - p0,
        e2: p2 - p0,
        flipped: false,
        radiance: Vec3::ONE,
        two_sided,
        textured: false,
        prim: PrimRef { object: 1, prim: 7 },
    })
}

fn parallelogram(p0: Vec3, e1: Vec3, e2: Vec3) -> Light {
    Light::Parallelogram(ParallelogramLight {
        p0: p0.as_dvec3(),
        e1,
        e2,
        radiance: Vec3::ONE,
        two_sided: false,
        textured: false,
        prim: PrimRef { object: 2, prim: 0 },
    })
}

fn disc(center: DVec3, axis1: DVec3, axis2: DVec3, hole: f64) -> Light {
    Light::Disc(Box::new(DiscLight {
        center,
        axis1,
        axis2,
        hole,
        radiance: Vec3::ONE,
        two_sided: false,
        textured: false,
        prim: PrimRef { object: 4, prim: 0 },
    }))
}

fn point(position: DVec3, color: Vec3, falloff: Falloff) -> Light {
    Light::Point(Box::new(PointLamp {
        position,
        color,
        falloff,
        casts_shadows: true,
    }))
}

/// Irradiance at a receiver with a normal: the midpoint rule with `k`×`k` points over the numbers of `sample`.
fn irradiance(light: &Light, p: Vec3, n: Vec3, k: u32) -> f64 {
    let set = LightSet::new(vec![light.clone()]);
    let mut sum = 0.0;
    for i in 0..k * k {
        let u = Vec2::new((i % k) as f32 + 0.5, (i / k) as f32 + 0.5) / k as f32;
        if let Some(s) = set.sample(p, n, false, 0.5, u, 0.0) {
            let cos = s.wi.as_dvec3().dot(n.as_dvec3()).max(0.0);
            sum += cos * f64::from(s.radiance.x) / f64::from(s.pdf);
        }
    }
    sum / f64::from(k * k)
}

/// A frame whose z axis is n, in f64.
fn frame_of(n: Vec3) -> [DVec3; 3] {
    let f = Frame::from_normal(n);
    [f.t.as_dvec3(), f.b.as_dvec3(), f.n.as_dvec3()]
}
