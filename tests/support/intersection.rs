//! Any bytes are a scene and some rays; what the engine hits must be what brute force in f64 finds.
//!
//! The brute force knows none of the engine's formulas: it walks along the ray in small steps, looks for changes of sign
//! of a function that is zero on the surface, and bisects. Triangles it meets after Möller and Trumbore. It speaks where it
//! is sure: at a clear crossing the engine must have found that or something nearer, and what the engine finds must lie on
//! a surface.

use glam::{DAffine3, DMat3, DVec3, Vec3};
use pts::render::accel::scene::Instructions;
use pts::render::geometry::{GeomObject, Geometry, MeshData};
use pts::render::ray::Ray;
use pts::render::shape::{Shape, Solid};

/// Unit roundoff of f32.
const U: f64 = 1.0 / 16_777_216.0;
/// Far more than f64 loses in shapes of size 1 and rays of some ten units, far less than f32 keeps.
const SURE: f64 = 1e-9;
/// Steps along a ray. Crossings closer to each other may go unseen, which asks less of the engine.
const STEPS: u32 = 300;

/// Numbers from bytes; zeros when they have run out.
struct Bytes<'a>(&'a [u8]);

impl Bytes<'_> {
    fn byte(&mut self) -> u8 {
        let Some((first, rest)) = self.0.split_first() else {
            return 0;
        };
        self.0 = rest;
        *first
    }

    /// In [−8, 8), often on a coarse grid, so that edges and axes are met.
    fn coordinate(&mut self) -> f64 {
        let (high, low) = (self.byte() as i8, self.byte());
        let fine = low.saturating_sub(128);
        f64::from(high) / 16.0 + f64::from(fine) / 4096.0
    }

    fn vector(&mut self) -> DVec3 {
        DVec3::new(self.coordinate(), self.coordinate(), self.coordinate())
    }

    /// In (0, 4].
    fn size(&mut self) -> f64 {
        (f64::from(self.byte()) + 1.0) / 64.0
    }

    /// A map with an inverse that loses little.
    fn map(&mut self) -> DAffine3 {
        let m = DMat3::from_cols(self.vector(), self.vector(), self.vector());
        let largest = [m.x_axis, m.y_axis, m.z_axis]
            .map(|c| c.abs().max_element())
            .into_iter()
            .fold(0.0, f64::max);
        let translation = self.vector();
        if largest > 0.0 && m.determinant().abs() > 0.02 * largest.powi(3) {
            DAffine3::from_mat3_translation(m, translation)
        } else {
            DAffine3::from_scale_rotation_translation(DVec3::splat(self.size()), glam::DQuat::IDENTITY, translation)
        }
    }
}

/// A surface as brute force sees it, in its own space.
enum Truth {
    Solid(Solid),
    Plane(DVec3, f64),
    Triangles(Vec<[DVec3; 3]>),
}

struct Object {
    truth: Truth,
    own_from_world: DAffine3,
}

fn object(bytes: &mut Bytes, scale: f64, meshes: &mut Vec<MeshData>) -> (Shape, Object) {
    let whole = DAffine3::from_scale(DVec3::splat(scale));
    let kind = bytes.byte() % 12;
    if kind == 0 {
        let (center, radius) = (bytes.vector() * scale, bytes.size() * scale);
        let map = DAffine3::from_scale_rotation_translation(DVec3::splat(radius), glam::DQuat::IDENTITY, center);
        let object = Object {
            truth: Truth::Solid(Solid::Sphere),
            own_from_world: map.inverse(),
        };
        return (Shape::Sphere { center, radius }, object);
    }
    if kind == 1 {
        let normal = bytes.vector().normalize_or(DVec3::Y);
        let distance = bytes.coordinate();
        let object = Object {
            truth: Truth::Plane(normal, distance),
            own_from_world: whole.inverse(),
        };
        return (
            Shape::Plane {
                normal,
                distance: distance * scale,
            },
            object,
        );
    }
    let map = whole * bytes.map();
    let own_from_world = map.inverse();
    if kind >= 9 {
        let mut mesh = MeshData::default();
        let corners: Vec<Vec3> = (0..3 + bytes.byte() % 8).map(|_| bytes.vector().as_vec3()).collect();
        for _ in 0..1 + bytes.byte() % 12 {
            mesh.triangles
                .push([(); 3].map(|_| u32::from(bytes.byte()) % corners.len() as u32));
        }
        let truth = mesh
            .triangles
            .iter()
            .map(|t| t.map(|i| corners[i as usize].as_dvec3()))
            .collect();
        mesh.positions = corners;
        meshes.push(mesh);
        let object = Object {
            truth: Truth::Triangles(truth),
            own_from_world,
        };
        return (Shape::mesh(meshes.len() as u32 - 1, map), object);
    }
    let open = bytes.byte() & 1 == 1;
    let solid = match kind {
        2 => Solid::Sphere,
        3 => Solid::Box {
            min: -DVec3::splat(bytes.size()),
            max: DVec3::splat(bytes.size()),
        },
        4 => Solid::Cylinder { open },
        5 | 6 => Solid::Cone {
            r0: if open { bytes.size() } else { 0.0 },
            r1: bytes.size(),
            open: bytes.byte() & 1 == 1,
        },
        7 => Solid::Disc {
            hole: if open { f64::from(bytes.byte()) / 256.0 } else { 0.0 },
        },
        _ => {
            let minor = bytes.size();
            Solid::Torus {
                major: minor + bytes.size(),
                minor,
            }
        }
    };
    let object = Object {
        truth: Truth::Solid(solid.clone()),
        own_from_world,
    };
    (Shape::placed(solid, map), object)
}

/// Zero on the surface, of either sign beside it, growing by at most `slope` a unit of length.
fn function(solid: &Solid, p: DVec3) -> f64 {
    let across = p.x.hypot(p.z);
    match *solid {
        Solid::Sphere => p.length() - 1.0,
        Solid::Box { min, max } => (p - max).max(min - p).max_element(),
        Solid::Cylinder { .. } => (across - 1.0).max((p.y - 0.5).abs() - 0.5),
        Solid::Cone { r0, r1, .. } => (across - (r0 + (r1 - r0) * p.y)).max((p.y - 0.5).abs() - 0.5),
        Solid::Disc { .. } => p.y,
        Solid::Torus { major, minor } => (across - major).hypot(p.y) - minor,
    }
}

/// By how much a point of the surface of `function` is inside what the shape has of it.
fn inside(solid: &Solid, p: DVec3) -> f64 {
    let across = p.x.hypot(p.z);
    match *solid {
        Solid::Cylinder { open: true } | Solid::Cone { open: true, .. } => p.y.min(1.0 - p.y),
        Solid::Disc { hole } => (1.0 - across).min(if hole > 0.0 { across - hole } else { 1.0 }),
        _ => f64::INFINITY,
    }
}

fn slope(solid: &Solid) -> f64 {
    match *solid {
        Solid::Cone { r0, r1, .. } => (r1 - r0).abs() + 1.0,
        _ => 1.0,
    }
}

/// A clear crossing: its t, and what the engine's t may be larger.
type Clear = Option<(f64, f64)>;

fn nearer(a: Clear, b: Clear) -> Clear {
    match (a, b) {
        (Some(x), Some(y)) => Some(if x.0 + x.1 <= y.0 + y.1 { x } else { y }),
        (a, b) => a.or(b),
    }
}

impl Object {
    fn line(&self, ray: &Ray) -> (DVec3, DVec3) {
        let o = self.own_from_world.transform_point3(ray.origin.as_dvec3());
        (o, self.own_from_world.transform_vector3(ray.dir.as_dvec3()))
    }

    fn first_clear(&self, ray: &Ray) -> Clear {
        let (o, d) = self.line(ray);
        match &self.truth {
            Truth::Plane(n, distance) => {
                let (height, fall) = (n.dot(o) - distance, n.dot(d));
                let t = -height / fall;
                let sure = height.abs() > 1e-6 && fall.abs() > 1e-6 * d.length();
                (sure && t > 0.0).then_some((t, t * 4.0 * U))
            }
            Truth::Solid(solid) => {
                let reach = solid.half_extent().length() + solid.center().length();
                let end = (o.length() + reach) / d.length();
                let at = |t: f64| function(solid, o + d * t);
                let sure = 1e-6 * (1.0 + reach);
                let step = end / f64::from(STEPS);
                let mut before = at(0.0);
                for i in 0..STEPS {
                    let (mut low, mut high) = (step * f64::from(i), step * f64::from(i + 1));
                    let after = at(high);
                    if before * after < 0.0 && before.abs() > sure && after.abs() > sure {
                        for _ in 0..60 {
                            let middle = 0.5 * (low + high);
                            if at(middle) * before > 0.0 {
                                low = middle
                            } else {
                                high = middle
                            }
                        }
                        if inside(solid, o + d * low) > sure {
                            return Some((low, low * 4.0 * U + SURE * end));
                        }
                    }
                    before = after;
                }
                None
            }
            Truth::Triangles(all) => all.iter().map(|t| clear_triangle(*t, o, d)).fold(None, nearer),
        }
    }

    /// How far the point at t is from the surface, and how far it may be.
    fn off(&self, ray: &Ray, t: f64, prim: u32) -> (f64, f64) {
        let (o, d) = self.line(ray);
        let p = o + d * t;
        let step = d.length() * t * 4.0 * U;
        match &self.truth {
            Truth::Plane(n, distance) => ((n.dot(p) - distance).abs(), step + SURE * (1.0 + p.length())),
            Truth::Solid(solid) => {
                let size = 1.0 + o.length() + solid.half_extent().length();
                let beside = (-inside(solid, p)).max(0.0);
                let bound = slope(solid) * (step + SURE * size);
                // The tangent plane of a torus or cylinder met at a flat angle; sheets cut off at their rims.
                (function(solid, p).abs().max(beside), bound)
            }
            Truth::Triangles(all) => {
                let [a, b, c] = all[prim as usize];
                let n = (b - a).cross(c - a);
                let longest = (a - b).length().max((b - c).length()).max((c - a).length());
                let far = longest + (a - o).length() + o.length() + a.length();
                let aspect = 1.0 + longest * longest / n.length();
                let from_plane = (p - a).dot(n.normalize_or_zero()).abs();
                (
                    from_plane,
                    step + (32.0 * U * far * aspect).min(4.0 * longest + 32.0 * U * far),
                )
            }
        }
    }
}

fn clear_triangle([a, b, c]: [DVec3; 3], o: DVec3, d: DVec3) -> Clear {
    let (e1, e2) = (b - a, c - a);
    let n = e1.cross(e2);
    let area = n.length();
    let longest = e1.length().max(e2.length()).max((c - b).length());
    let far = longest + (a - o).length() + o.length() + a.length();
    let cos = d.dot(n).abs() / (area * d.length());
    // Needles and flat angles are left to the tests that derive their bounds.
    if area.is_nan() || area < 0.01 * longest * longest || cos < 0.01 || area == 0.0 {
        return None;
    }
    let det = e1.dot(d.cross(e2));
    let s = o - a;
    let (u, v) = (s.dot(d.cross(e2)) / det, d.dot(s.cross(e1)) / det);
    let t = e2.dot(s.cross(e1)) / det;
    let slack = 256.0 * U * far / cos;
    let height = area / longest;
    let clear = u.min(v).min(1.0 - u - v) * height > slack && t * d.length() > slack;
    clear.then(|| (t, 100.0 * slack / d.length()))
}

/// Makes a scene of the bytes, shoots at it and compares. Panics where the engine is wrong; returns how many rays hit and
/// for how many brute force was sure of a crossing.
pub fn check(data: &[u8]) -> [usize; 2] {
    let (mut hits, mut crossings) = (0, 0);
    let mut bytes = Bytes(data);
    let scale = 2f64.powi(i32::from(bytes.byte() as i8) / 4);
    let mut meshes = Vec::new();
    let count = 1 + bytes.byte() % 4;
    let (shapes, objects): (Vec<Shape>, Vec<Object>) =
        (0..count).map(|_| object(&mut bytes, scale, &mut meshes)).unzip();
    let list = shapes.into_iter().map(|s| GeomObject::new(s, 0)).collect();
    let fastest = Geometry::build(list, meshes);
    let mut baseline = fastest.clone();
    baseline.use_instructions(Instructions::Baseline);
    for _ in 0..1 + bytes.byte() % 12 {
        let o = bytes.vector();
        let mut d = if bytes.byte() & 1 == 0 {
            bytes.vector()
        } else {
            bytes.vector() - o
        };
        let zeros = bytes.byte();
        for axis in 0..3 {
            if zeros >> axis & 0b1001 == 0b1001 {
                d[axis] = 0.0;
            }
        }
        if d == DVec3::ZERO {
            continue;
        }
        let ray = Ray::new((o * scale).as_vec3(), (d * scale).as_vec3());
        let hit = fastest.closest(&ray);
        assert_eq!(baseline.closest(&ray), hit, "instruction sets disagree: {ray:?}");
        assert_eq!(
            fastest.occluded(&ray),
            hit.is_some(),
            "any and nearest disagree: {ray:?}"
        );
        if let Some((t, more)) = objects.iter().map(|x| x.first_clear(&ray)).fold(None, nearer) {
            crossings += 1;
            let got = hit.map_or(f64::INFINITY, |h| f64::from(h.t));
            assert!(got <= t + more, "{got} found, {t} is there: {ray:?}");
        }
        if let Some(hit) = hit {
            hits += 1;
            let (off, bound) = objects[hit.prim.object as usize].off(&ray, f64::from(hit.t), hit.prim.prim);
            assert!(off <= bound, "{off} off the surface, {bound} granted: {ray:?}, {hit:?}");
            let s = fastest.surface(&ray, &hit);
            assert!(s.p.is_finite() && (s.ng.length() - 1.0).abs() < 1e-6, "{s:?}");
        }
    }
    [hits, crossings]
}
