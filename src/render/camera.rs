//! Rays from the camera: pinhole and thin lens, perspective and orthographic, moving or not, and the pixel filter.

use super::motion::step;
use super::ray::{Ray, ray_mask, split_direction};
use super::settings::Filter;
use crate::math::robust::UNIT_ROUNDOFF;
use crate::math::warp::disc_concentric;
use glam::{DVec3, Vec2, Vec3};

/// A camera; camera-relative space has its origin where it stands when the shutter opens.
#[derive(Clone, Debug)]
pub struct Camera {
    /// Parallel rays instead of rays through one point.
    pub orthographic: bool,
    /// Where it stands and looks when the shutter opens.
    pub pose: Pose,
    /// The same at equal steps of the time that the shutter is open, the first at its opening, linear in between; empty
    /// for a camera that stands still.
    pub keys: Vec<Pose>,
}

/// Where a camera stands and looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Where it stands, from where it stands when the shutter opens.
    pub location: DVec3,
    /// To the centre of the image plane.
    pub direction: DVec3,
    /// Width of the image plane, to the right of the picture.
    pub right: DVec3,
    /// Height of the image plane, to the top of the picture.
    pub up: DVec3,
    /// Radius of the lens; 0 is a pinhole.
    pub lens_radius: f64,
    /// Distance of the plane in focus along the view axis, > 0, may be infinite.
    pub focus_distance: f64,
}

impl Camera {
    /// Whether it moves while the shutter is open.
    pub fn moves(&self) -> bool {
        self.keys.len() > 1
    }

    /// Where it stands and looks at a time in [0, 1].
    pub fn pose_at(&self, time: f32) -> Pose {
        if !self.moves() {
            return self.pose;
        }
        let (i, w) = step(self.keys.len(), time);
        self.keys[i].towards(&self.keys[i + 1], w)
    }

    /// Where it stands at a time in [0, 1].
    pub fn location_at(&self, time: f32) -> DVec3 {
        self.pose_at(time).location
    }

    /// The unit view axis when the shutter opens.
    pub fn axis(&self) -> Vec3 {
        self.axis_at(0.0)
    }

    /// The unit view axis at a time in [0, 1].
    pub fn axis_at(&self, time: f32) -> Vec3 {
        self.pose_at(time).direction.normalize().as_vec3()
    }

    /// The box of all places where it stands, rounded outward.
    pub fn reach(&self) -> (Vec3, Vec3) {
        let places = self.keys.iter().chain([&self.pose]).map(|pose| pose.location.as_vec3());
        let (min, max) = places.fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(min, max), p| {
            (min.min(p), max.max(p))
        });
        let error = min.abs().max(max.abs()) * (2.0 * UNIT_ROUNDOFF);
        (min - error, max + error)
    }

    /// The ray through (x, y) of the picture, both in units of its width and height from the centre: x in
    /// [−½, ½] to the right, y in [−½, ½] upwards. `lens` is uniform in the unit square, `time` in [0, 1) of the time that
    /// the shutter is open.
    #[inline(always)]
    pub fn ray(&self, x: f64, y: f64, lens: Vec2, time: f32) -> Ray {
        if self.moves() {
            return self.moving_ray(x, y, lens, time);
        }
        self.ray_from(&self.pose, x, y, lens, time)
    }

    /// Apart from cameras that stand still.
    #[inline(never)]
    fn moving_ray(&self, x: f64, y: f64, lens: Vec2, time: f32) -> Ray {
        self.ray_from(&self.pose_at(time), x, y, lens, time)
    }

    #[inline(always)]
    fn ray_from(&self, pose: &Pose, x: f64, y: f64, lens: Vec2, time: f32) -> Ray {
        let across = pose.right * x + pose.up * y;
        let (mut origin, mut dir) = if self.orthographic {
            (across, pose.direction)
        } else {
            (DVec3::ZERO, pose.direction + across)
        };
        if pose.lens_radius > 0.0 {
            let axis = pose.direction.normalize();
            let (s, t) = pose.lens_axes(axis);
            let p = disc_concentric(lens).as_dvec2() * pose.lens_radius;
            let offset = s * p.x + t * p.y;
            // The point in focus is origin + d·F with d·axis = 1; seen from the lens point it lies along
            // d·F − offset, or d − offset/F: finite for every F, the pinhole's direction for F → ∞.
            dir = dir / dir.dot(axis) - offset / pose.focus_distance;
            origin += offset;
        }
        // Far away a pixel of a narrow view is smaller than the rounding of a direction.
        let (dir, dir_low) = split_direction(dir.normalize());
        let mut ray = Ray::new((pose.location + origin).as_vec3(), dir);
        ray.dir_low = dir_low;
        ray.mask = ray_mask::CAMERA;
        ray.time = time;
        ray
    }
}

impl Pose {
    /// A pose part of the way to another, all its numbers in proportion; of a lens that is focused infinitely far away
    /// the focus stays there.
    fn towards(&self, other: &Pose, w: f64) -> Pose {
        let mix = |a: DVec3, b: DVec3| a * (1.0 - w) + b * w;
        // Reciprocals: 1/∞ is a number, and a focus between two is between them all the same.
        let focus = 1.0 / ((1.0 - w) / self.focus_distance + w / other.focus_distance);
        Pose {
            location: mix(self.location, other.location),
            direction: mix(self.direction, other.direction),
            right: mix(self.right, other.right),
            up: mix(self.up, other.up),
            lens_radius: self.lens_radius * (1.0 - w) + other.lens_radius * w,
            focus_distance: focus,
        }
    }

    /// Two unit vectors that span the lens, perpendicular to the axis.
    fn lens_axes(&self, axis: DVec3) -> (DVec3, DVec3) {
        let s = (self.right - axis * axis.dot(self.right)).normalize_or(axis.any_orthonormal_vector());
        (s, axis.cross(s))
    }
}

/// Where a point of a pixel lies along one axis of a picture of `size` pixels, from its middle, in units of its size:
/// in [-½, ½] for points inside. `offset` is counted from the pixel's centre, in pixels.
///
/// The centre is exact and the offset is added in f64, so that pixel 99 999 has as many places as pixel 0; in f32 the
/// last pixel of 16 384 has 1025. A point of [-½, ½) stays in its pixel, up to its very edge.
#[inline]
pub fn place_in_picture(pixel: u32, size: u32, offset: f32) -> f64 {
    let size = f64::from(size);
    ((f64::from(pixel) + 0.5 - 0.5 * size) + f64::from(offset)) / size
}

/// Offsets from the pixel's centre, in pixels, distributed like a filter.
#[derive(Clone, Debug)]
pub struct FilterSampler {
    /// Inverse of the distribution along one axis at equal steps of probability; empty for the box.
    inverse: Vec<f32>,
}

/// Steps of the tabulated inverse; linear between them.
const FILTER_STEPS: usize = 1024;

impl FilterSampler {
    /// A sampler for a filter.
    pub fn new(filter: Filter) -> FilterSampler {
        let radius = 1.5;
        let density: &dyn Fn(f64) -> f64 = match filter {
            Filter::Box => return FilterSampler { inverse: Vec::new() },
            Filter::Gaussian => &|x: f64| libm::exp(-x * x / (2.0 * 0.25)) - libm::exp(-radius * radius / 0.5),
            Filter::BlackmanHarris => &|x: f64| {
                let w = std::f64::consts::TAU * (x / (2.0 * radius) + 0.5);
                0.35875 - 0.48829 * libm::cos(w) + 0.14128 * libm::cos(2.0 * w) - 0.01168 * libm::cos(3.0 * w)
            },
        };
        // The distribution function on a fine grid by the midpoint rule, then its inverse at equal steps.
        let fine = 64 * FILTER_STEPS;
        let step = 2.0 * radius / fine as f64;
        let mut cdf = Vec::with_capacity(fine + 1);
        cdf.push(0.0);
        let mut sum = 0.0;
        for i in 0..fine {
            sum += density(-radius + (i as f64 + 0.5) * step).max(0.0);
            cdf.push(sum);
        }
        let mut at = 0;
        let inverse = (0..=FILTER_STEPS).map(|i| {
            let want = sum * i as f64 / FILTER_STEPS as f64;
            while at + 1 < fine && cdf[at + 1] < want {
                at += 1;
            }
            let inside = if cdf[at + 1] > cdf[at] {
                (want - cdf[at]) / (cdf[at + 1] - cdf[at])
            } else {
                0.5
            };
            (-radius + (at as f64 + inside.clamp(0.0, 1.0)) * step) as f32
        });
        FilterSampler {
            inverse: inverse.collect(),
        }
    }

    /// An offset from the pixel's centre along one axis, for u in [0, 1).
    pub fn offset(&self, u: f32) -> f32 {
        if self.inverse.is_empty() {
            return u - 0.5;
        }
        let x = u * FILTER_STEPS as f32;
        let i = (x as usize).min(FILTER_STEPS - 1);
        let (a, b) = (self.inverse[i], self.inverse[i + 1]);
        a + (b - a) * (x - i as f32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera(lens_radius: f64, focus_distance: f64) -> Camera {
        Camera {
            orthographic: false,
            pose: Pose {
                location: DVec3::ZERO,
                direction: DVec3::new(0.0, 0.0, 2.0),
                right: DVec3::X,
                up: DVec3::Y,
                lens_radius,
                focus_distance,
            },
            keys: Vec::new(),
        }
    }

    /// Geometry: every ray of a pixel passes through the same point of the plane in focus.
    #[test]
    fn all_lens_rays_meet_in_the_focus_plane() {
        let cam = camera(0.3, 7.0);
        let pinhole = camera(0.0, 7.0).ray(0.2, -0.4, Vec2::ZERO, 0.0);
        let focus = pinhole.dir * (7.0 / pinhole.dir.z);
        for u in [Vec2::ZERO, Vec2::new(0.9, 0.1), Vec2::new(0.3, 0.7)] {
            let ray = cam.ray(0.2, -0.4, u, 0.0);
            let at = ray.origin + ray.dir * ((7.0 - ray.origin.z) / ray.dir.z);
            assert!((at - focus).length() < 1e-5, "{at} instead of {focus}");
        }
    }

    /// The pinhole's direction up to one rounding, from a point of the lens. The textbook's difference of two points
    /// 1e20 away is 0 or NaN.
    #[test]
    fn a_lens_focused_very_far_away_gives_parallel_rays() {
        for focus in [1e20, 1e38, 1e300, f64::INFINITY] {
            for u in [Vec2::ZERO, Vec2::new(0.9, 0.5), Vec2::splat(0.3)] {
                let ray = camera(0.3, focus).ray(0.2, 0.1, u, 0.0);
                let off = ray.dir - camera(0.0, 1.0).ray(0.2, 0.1, Vec2::ZERO, 0.0).dir;
                assert!(off.abs().max_element() <= UNIT_ROUNDOFF, "focus {focus}: off by {off}");
                assert!(ray.origin != Vec3::ZERO, "focus {focus}: no lens");
            }
        }
    }

    /// Bit for bit, wherever the focus is.
    #[test]
    fn a_lens_without_a_radius_is_a_pinhole() {
        let plain = camera(0.0, 1.0).ray(0.2, 0.1, Vec2::ZERO, 0.0);
        for focus in [1e-20, 1.0, 1e20, f64::INFINITY] {
            for u in [Vec2::ZERO, Vec2::new(0.9, 0.5)] {
                assert_eq!(camera(0.0, focus).ray(0.2, 0.1, u, 0.0), plain);
            }
        }
    }

    /// A thousand sub-pixel places are what f32 leaves in the last pixel of 16 384; here 2²⁰ numbers are 2²⁰ places, in
    /// the pixel that they belong to, to its very edge: the border is rounded like the places, and division is monotone.
    #[test]
    fn pixels_of_wide_pictures_have_all_their_places_and_keep_them() {
        let filter = FilterSampler::new(Filter::Box);
        for size in [1, 16_384, 100_000, 1 << 24] {
            for pixel in [0, size / 3, size / 2, size - 1] {
                let border = |x: f64| (x - 0.5 * f64::from(size)) / f64::from(size);
                let (low, high) = (border(f64::from(pixel)), border(f64::from(pixel) + 1.0));
                let mut last = f64::NEG_INFINITY;
                for k in 0..1 << 20 {
                    // All steps of 2⁻²⁰, ending with the largest number there is.
                    let u = ((k as f32 + 1.0) / 1_048_576.0).min(1.0 - UNIT_ROUNDOFF);
                    let at = place_in_picture(pixel, size, filter.offset(u));
                    assert!(low <= at && at < high, "pixel {pixel} of {size}: {at} at {u}");
                    assert!(at > last, "pixel {pixel} of {size}: two numbers for one place, {at}");
                    last = at;
                }
                assert_eq!(place_in_picture(pixel, size, filter.offset(0.0)), low);
            }
        }
    }

    /// The directions at the edges of the picture open the field of view, from 1e-4° to 179.9°: rounded once per
    /// component, u in the direction; of the angle that is u over it.
    #[test]
    fn extreme_fields_of_view_are_as_wide_as_they_say() {
        for degrees in [1e-4, 1e-2, 1.0, 90.0, 179.0, 179.9, 179.9999f64] {
            let half = (0.5 * degrees).to_radians();
            let mut camera = camera(0.0, 1.0);
            camera.pose.direction = DVec3::Z * (0.5 / half.tan());
            for x in [-0.5, 0.5] {
                let d = camera.ray(x, 0.0, Vec2::ZERO, 0.0).dir.as_dvec3();
                let found = d.x.abs().atan2(d.z);
                let off = (found - half).abs();
                let u = f64::from(UNIT_ROUNDOFF);
                assert!(
                    off <= u * half.min(1.0) + u * half.cos(),
                    "{degrees}°: {found} instead of {half}"
                );
                assert!((d.length() - 1.0).abs() <= 2.0 * u);
            }
        }
    }

    /// Moments: the box has variance 1/12; the others are computed by quadrature of their definitions.
    #[test]
    fn filters_have_their_variance_and_support() {
        for (filter, want) in [
            (Filter::Box, 1.0 / 12.0),
            (Filter::Gaussian, 0.22945),
            (Filter::BlackmanHarris, 0.17266),
        ] {
            let sampler = FilterSampler::new(filter);
            let n = 100_000;
            let x = |i| f64::from(sampler.offset((i as f32 + 0.5) / n as f32));
            let mean = (0..n).map(x).sum::<f64>() / f64::from(n);
            let var = (0..n).map(|i| x(i) * x(i)).sum::<f64>() / f64::from(n);
            assert!(mean.abs() < 1e-4, "{filter:?}: mean {mean}");
            assert!((var - want).abs() < 1e-3, "{filter:?}: variance {var}");
            assert!((0..n).all(|i| x(i).abs() <= 1.5));
        }
    }
}
