//! Where the light tree parts a list of lights in two.

use super::bounds::LightBounds;
use glam::Vec3;

/// Below this depth lists are halved, so that with at most 2³¹ lights no path is longer than 62 bits.
const HALVE_FROM_DEPTH: u32 = 31;
const BUCKETS: usize = 12;

/// A light during the build.
#[derive(Clone, Copy)]
pub(crate) struct Item {
    pub bounds: LightBounds,
    pub center: Vec3,
    /// The axis times the intensity, shorter for a wide cone: a sum of these is long only if all shine the same way.
    lean: Vec3,
    pub light: u32,
}

impl Item {
    /// A light with its bounds.
    pub fn new(light: u32, bounds: LightBounds) -> Item {
        let b = &bounds;
        let axis = b.axis * (b.intensity * 0.5 * (1.0 + b.cos_o));
        // For two-sided lights the sign is arbitrary: take it from the largest component.
        let turn = b.two_sided && {
            let largest = b.axis.abs().max_position();
            b.axis[largest] < 0.0
        };
        Item {
            bounds,
            center: (b.min + b.max) * 0.5,
            lean: if turn { -axis } else { axis },
            light,
        }
    }
}

/// One interval of a split candidate.
#[derive(Clone, Copy)]
struct Bucket {
    min: Vec3,
    max: Vec3,
    axis: Vec3,
    intensity: f32,
}

impl Bucket {
    const EMPTY: Bucket = Bucket {
        min: Vec3::INFINITY,
        max: Vec3::NEG_INFINITY,
        axis: Vec3::ZERO,
        intensity: 0.0,
    };

    fn add(&mut self, item: &Item) {
        self.min = self.min.min(item.bounds.min);
        self.max = self.max.max(item.bounds.max);
        self.axis += item.lean;
        self.intensity += item.bounds.intensity;
    }

    fn merge(&mut self, other: &Bucket) {
        self.min = self.min.min(other.min);
        self.max = self.max.max(other.max);
        self.axis += other.axis;
        self.intensity += other.intensity;
    }

    /// Intensity times surface of the box times spread of directions (1 for parallel, 4 for all): the chance that
    /// this group is asked for, up to a factor. A cheap stand-in for the surface area orientation heuristic.
    fn cost(&self, thickness: f32) -> f32 {
        if self.intensity <= 0.0 {
            return 0.0;
        }
        let d = (self.max - self.min).max(Vec3::splat(thickness));
        let area = d.x * d.y + d.y * d.z + d.z * d.x;
        let spread = 4.0 - 3.0 * (self.axis.length() / self.intensity).min(1.0);
        self.intensity * area * spread
    }
}

/// Orders the list so that the first part becomes the first child; returns its length, in 1..len.
pub(crate) fn split(list: &mut [Item], depth: u32) -> usize {
    let half = list.len() / 2;
    if list.len() == 2 {
        return half;
    }
    let (lo, hi) = list.iter().fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), i| {
        (lo.min(i.center), hi.max(i.center))
    });
    let extent = hi - lo;
    let longest = extent.max_element();
    if longest.is_nan() || longest <= 0.0 {
        return half; // all centres coincide
    }
    if depth >= HALVE_FROM_DEPTH {
        let axis = (0..3).find(|&k| extent[k] == longest).unwrap_or(0);
        list.select_nth_unstable_by(half, |a, b| {
            a.center[axis].total_cmp(&b.center[axis]).then(a.light.cmp(&b.light))
        });
        return half;
    }
    // Boxes flat to within a bucket still cost something, or flat groups would all be free.
    let thickness = longest / BUCKETS as f32;
    let mut buckets = [[Bucket::EMPTY; BUCKETS]; 3];
    let wide = [0, 1, 2].map(|k| extent[k] > 0.0);
    for item in list.iter() {
        for k in (0..3).filter(|&k| wide[k]) {
            buckets[k][bucket_of(item, k, lo[k], extent[k])].add(item);
        }
    }
    let mut best: Option<(f32, usize, usize)> = None;
    for k in (0..3).filter(|&k| wide[k]) {
        let buckets = &buckets[k];
        let mut below = [0.0f32; BUCKETS];
        let mut sum = Bucket::EMPTY;
        for (b, cost) in buckets.iter().zip(&mut below) {
            sum.merge(b);
            *cost = sum.cost(thickness);
        }
        let mut sum = Bucket::EMPTY;
        for edge in (1..BUCKETS).rev() {
            sum.merge(&buckets[edge]);
            // Cutting long axes is preferred, against thin slices.
            let cost = (below[edge - 1] + sum.cost(thickness)) * (longest / extent[k]);
            if below[edge - 1] > 0.0 && sum.intensity > 0.0 && best.is_none_or(|(c, ..)| cost < c) {
                best = Some((cost, k, edge));
            }
        }
    }
    let Some((_, k, edge)) = best else {
        return half;
    };
    let mut first = 0;
    for i in 0..list.len() {
        if bucket_of(&list[i], k, lo[k], extent[k]) < edge {
            list.swap(i, first);
            first += 1;
        }
    }
    if first == 0 || first == list.len() { half } else { first }
}

fn bucket_of(item: &Item, k: usize, lo: f32, extent: f32) -> usize {
    (((item.center[k] - lo) / extent * BUCKETS as f32) as usize).min(BUCKETS - 1)
}
