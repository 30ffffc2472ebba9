//! The torus about the y axis.
//!
//! Along a line the torus is a quartic. Its stationary points, found from the cubic's and the quadratic's in turn, cut the
//! line into pieces on which it is monotonic; a sign change of the (precisely evaluated) function then brackets each
//! root. Nothing is missed but a touch within rounding, and nothing is invented.

use super::Line;
use super::candidates::Candidates;
use glam::DVec3;

/// Offers all intersections of the ray with the torus.
pub fn intersect(major: f64, minor: f64, line: Line, shift: f64, found: &mut Candidates) {
    // Unit of length: the outer radius, so that the coefficients are of order one.
    let size = major + minor;
    let (ring, tube) = (major / size, minor / size);
    let length = line.d.length();
    let (o, d) = (line.o / size, line.d / length);
    // Parameter s is measured from the foot of the perpendicular; the torus lies within |s| ≤ √(1 − |foot|²).
    let middle = -o.dot(d);
    let foot = o + d * middle;
    const ROOM: f64 = 1e-9; // far more than the rounding of the foot, and costs nothing
    let half = 1.0 + ROOM - foot.length_squared();
    if half.is_nan() || half < 0.0 {
        return;
    }
    let half = half.sqrt();
    let start = (-half).max(-shift * length / size - middle);
    if start >= half {
        return;
    }
    // With foot·d = 0: s⁴ + p·s² + q·s + r.
    let gap = foot.length_squared() + (ring - tube) * (ring + tube);
    let four = 4.0 * ring * ring;
    let p = 2.0 * gap - four * (d.x * d.x + d.z * d.z);
    let q = -2.0 * four * (foot.x * d.x + foot.z * d.z);
    let cuts = stationary_points(p, q, start, half);
    // The ray's own start is evaluated from the ray, not from the foot: its side of the surface must be right.
    let value = |s: f64| implicit(ring, tube, o + d * (s + middle));
    let mut low = start;
    let mut f_low = value(low);
    for high in cuts.into_iter().flatten().chain([half]) {
        let f_high = value(high);
        if (f_low < 0.0) != (f_high < 0.0) {
            let s = bracketed_root(low, f_low, high, &value);
            found.offer(shift + (s + middle) * size / length, 0);
        }
        (low, f_low) = (high, f_high);
    }
}

/// ((ρ − R)² + y² − r²)·((ρ + R)² + y² − r²): zero on the torus, negative inside the tube (between the lobes
/// of a self-crossing torus it is positive again). Precise to 2⁻⁵²·R in distance.
fn implicit(ring: f64, tube: f64, p: DVec3) -> f64 {
    let rho = (p.x * p.x + p.z * p.z).sqrt();
    let factor = |w: f64| {
        let r = (w * w + p.y * p.y).sqrt();
        (r - tube) * (r + tube)
    };
    factor(rho - ring) * factor(rho + ring)
}

/// Where 4s³ + 2p·s + q is zero within (low, high), ascending; up to three.
fn stationary_points(p: f64, q: f64, low: f64, high: f64) -> [Option<f64>; 3] {
    let slope = |s: f64| (4.0 * s * s + 2.0 * p) * s + q;
    let turn = (-p / 6.0).max(0.0).sqrt(); // where the slope itself is stationary
    let mut ends = [low, (-turn).clamp(low, high), turn.clamp(low, high), high];
    ends.sort_by(f64::total_cmp);
    let mut points = [None; 3];
    for (i, point) in points.iter_mut().enumerate() {
        let (a, b) = (ends[i], ends[i + 1]);
        let f_a = slope(a);
        if a < b && (f_a < 0.0) != (slope(b) < 0.0) {
            *point = Some(bracketed_root(a, f_a, b, &slope));
        }
    }
    points
}

/// The sign change of `f` in [a, b], where f(a) = `f_a`, to the last bits: regula falsi (Illinois) kept honest by bisection.
fn bracketed_root(mut a: f64, mut f_a: f64, mut b: f64, f: &impl Fn(f64) -> f64) -> f64 {
    let mut f_b = f(b);
    let negative = f_a < 0.0;
    let mut bisect = false;
    // Every second step halves the bracket: 128 steps end at neighbouring numbers at the latest.
    for _ in 0..128 {
        let middle = 0.5 * (a + b);
        if middle <= a || middle >= b {
            break;
        }
        let secant = a + (b - a) * (f_a / (f_a - f_b));
        let m = if bisect || secant.is_nan() || secant <= a || secant >= b {
            middle
        } else {
            secant
        };
        let before = b - a;
        let f_m = f(m);
        if f_m == 0.0 {
            return m;
        }
        if (f_m < 0.0) == negative {
            (a, f_a) = (m, f_m);
            f_b *= 0.5;
        } else {
            (b, f_b) = (m, f_m);
            f_a *= 0.5;
        }
        bisect = b - a > 0.5 * before;
    }
    0.5 * (a + b)
}

/// The point of the torus next to `p`, and its normal.
///
/// A self-crossing torus has an inner sheet, made by the tube on the far side of the axis; what it encloses counts
/// as outside, so there the normal points to the axis.
pub fn project(major: f64, minor: f64, p: DVec3) -> (DVec3, DVec3) {
    let rho = (p.x * p.x + p.z * p.z).sqrt();
    let (cx, cz) = if rho > 0.0 { (p.x / rho, p.z / rho) } else { (1.0, 0.0) };
    let off = |center: f64| (((rho - center) * (rho - center) + p.y * p.y).sqrt() - minor).abs();
    let inner = major < minor && off(-major) < off(major);
    let center = if inner { -major } else { major };
    let (w, h) = (rho - center, p.y);
    let reach = (w * w + h * h).sqrt();
    let (w, h) = if reach > 0.0 {
        (w / reach, h / reach)
    } else {
        (1.0, 0.0)
    };
    let n = DVec3::new(cx * w, h, cz * w);
    let out = center + minor * w;
    (DVec3::new(cx * out, minor * h, cz * out), if inner { -n } else { n })
}
