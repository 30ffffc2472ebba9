//! The sums of one net of one pixel over a range of its points, in a form that does not depend on how it arose.
//!
//! A range [j0, j1) is kept as the points of an unfinished first leaf, one by one (their sum could not be
//! continued to the left), then the maximal subtrees of the leaves that lie wholly inside, then the sum of an
//! unfinished last leaf. Two ranges that meet can therefore be joined to exactly what one run over both gives.

use std::ops::Range;

/// Points in a leaf of the tree.
pub const LEAF: u32 = 16;

/// Points that net `net` of `nets` has among the first `samples` samples.
pub fn net_points(samples: u32, net: u32, nets: u32) -> u32 {
    samples / nets + u32::from(net < samples % nets)
}

/// The points of a net among a range of samples.
pub fn net_range(samples: &Range<u32>, net: u32, nets: u32) -> Range<u32> {
    net_points(samples.start, net, nets)..net_points(samples.end, net, nets)
}

/// What a range of points is kept as: vectors in the order of their points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Single points of an unfinished first leaf.
    pub head: u32,
    /// Maximal subtrees.
    pub nodes: u32,
    /// Whether there is the sum of an unfinished last leaf that has its beginning.
    pub tail: bool,
}

impl Layout {
    /// Of the points [j0, j1), j0 ≤ j1.
    pub fn of(points: &Range<u32>) -> Layout {
        let (j0, j1) = (points.start, points.end);
        let (mut leaf, last) = (j0.div_ceil(LEAF), j1 / LEAF);
        // u64: the leaf that holds the last point of all ends beyond u32.
        let head = u64::from(j1).min(u64::from(leaf) * u64::from(LEAF)) as u32 - j0;
        let mut nodes = 0;
        while leaf < last {
            leaf += 1 << leaf.trailing_zeros().min((last - leaf).ilog2());
            nodes += 1;
        }
        Layout {
            head,
            nodes,
            tail: !j1.is_multiple_of(LEAF) && last * LEAF >= j0,
        }
    }

    /// How many vectors these are.
    pub fn len(&self) -> usize {
        self.head as usize + self.nodes as usize + usize::from(self.tail)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// Adds points, subtrees and leaves to the end of a range.
#[derive(Clone, Debug)]
pub struct Accumulator {
    channels: usize,
    /// First leaf that lies wholly in the range; subtrees never reach further to the left.
    first_leaf: u32,
    /// Points before this one belong to the unfinished first leaf.
    head_end: u32,
    /// The single points and the maximal subtrees so far.
    stack: Vec<f64>,
    /// The leaf that is being filled.
    leaf: Vec<f64>,
}

impl Accumulator {
    /// For vectors of this many channels; [`Accumulator::load`] begins a range.
    pub fn new(channels: usize) -> Accumulator {
        Accumulator {
            channels,
            first_leaf: 0,
            head_end: 0,
            stack: Vec::with_capacity(32 * channels),
            leaf: vec![0.0; channels],
        }
    }

    /// Begins with a range that is known already; `sums` are its vectors by [`Layout`].
    pub fn load(&mut self, points: &Range<u32>, sums: &[f64]) {
        let layout = Layout::of(points);
        let split = (layout.head + layout.nodes) as usize * self.channels;
        self.first_leaf = points.start.div_ceil(LEAF);
        self.head_end = self.first_leaf.saturating_mul(LEAF);
        self.stack.clear();
        self.stack.extend_from_slice(&sums[..split]);
        self.leaf.fill(0.0);
        self.leaf[..sums.len() - split].copy_from_slice(&sums[split..]);
    }

    /// Adds point `j`, the next one of the range.
    #[inline]
    pub fn push(&mut self, j: u32, value: &[f64]) {
        if j < self.head_end {
            self.stack.extend_from_slice(value);
            return;
        }
        self.leaf.iter_mut().zip(value).for_each(|(l, v)| *l += v);
        if (j + 1).is_multiple_of(LEAF) {
            self.carry(0, (j + 1) / LEAF);
        }
    }

    /// Adds the range that begins where this one ends.
    pub fn join(&mut self, points: &Range<u32>, sums: &[f64]) {
        let layout = Layout::of(points);
        let mut vectors = sums.chunks_exact(self.channels);
        for (j, value) in (points.start..points.start + layout.head).zip(&mut vectors) {
            self.push(j, value);
        }
        let (mut leaf, last) = (points.start.div_ceil(LEAF), points.end / LEAF);
        for value in vectors.by_ref().take(layout.nodes as usize) {
            let level = leaf.trailing_zeros().min((last - leaf).ilog2());
            leaf += 1 << level;
            self.leaf.copy_from_slice(value);
            self.carry(level, leaf);
        }
        if let Some(value) = vectors.next() {
            self.leaf.copy_from_slice(value);
        }
    }

    /// Appends the vectors of the range, which ends at point `end`.
    pub fn finish(&mut self, begin: u32, end: u32) -> &[f64] {
        if Layout::of(&(begin..end)).tail {
            self.stack.extend_from_slice(&self.leaf);
        }
        &self.stack
    }

    /// Puts a finished subtree of 2^`level` leaves that ends before leaf `end` into the tree: equal subtrees are
    /// added. The leaf is cleared.
    fn carry(&mut self, mut level: u32, end: u32) {
        let c = self.channels;
        while level < end.trailing_zeros() && u64::from(end) >= u64::from(self.first_leaf) + (2 << level) {
            let older = self.stack.len() - c;
            self.leaf
                .iter_mut()
                .zip(&self.stack[older..])
                .for_each(|(l, o)| *l += o);
            self.stack.truncate(older);
            level += 1;
        }
        self.stack.extend_from_slice(&self.leaf);
        self.leaf.fill(0.0);
    }
}

/// Adds the vectors of a range to `out`, from the last to the first, a fixed order.
pub fn add_total(sums: &[f64], out: &mut [f64]) {
    for vector in sums.chunks_exact(out.len()).rev() {
        out.iter_mut().zip(vector).for_each(|(o, s)| *o += s);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::stats::Pcg;

    fn value(j: u32) -> [f64; 2] {
        let mut rng = Pcg::new(u64::from(j) + 7);
        let v = rng.next_f64() * 10f64.powi((rng.next_u32() % 12) as i32);
        [v, -v]
    }

    fn run(points: Range<u32>) -> Vec<f64> {
        let mut sums = Accumulator::new(2);
        sums.load(&(points.start..points.start), &[]);
        points.clone().for_each(|j| sums.push(j, &value(j)));
        sums.finish(points.start, points.end).to_vec()
    }

    fn bits(sums: &[f64]) -> Vec<u64> {
        sums.iter().map(|v| v.to_bits()).collect()
    }

    #[test]
    fn a_range_is_kept_as_its_layout_says() {
        for (points, head, nodes, tail) in [
            (0..0, 0, 0, false),
            (0..5, 0, 0, true),
            (0..16, 0, 1, false),
            (0..1003, 0, 5, true),
            (3..9, 6, 0, false),
            (3..16, 13, 0, false),
            (3..17, 13, 0, true),
            (5..5, 0, 0, false),
            (16..64, 0, 2, false),
            (u32::MAX - 3..u32::MAX, 3, 0, false),
        ] {
            assert_eq!(Layout::of(&points), Layout { head, nodes, tail }, "{points:?}");
        }
        for points in [0..1003, 7..1003, 100..101, 31..33, 160..480] {
            assert_eq!(run(points.clone()).len(), 2 * Layout::of(&points).len(), "{points:?}");
        }
    }

    #[test]
    fn ranges_that_meet_join_to_what_one_run_gives() {
        let mut rng = Pcg::new(1);
        let mut draw = |n: u32| rng.next_u32() % n;
        for _ in 0..2000 {
            let begin = draw(200);
            let middle = begin + draw(300);
            let end = middle + draw(300);
            let mut joined = Accumulator::new(2);
            joined.load(&(begin..middle), &run(begin..middle));
            joined.join(&(middle..end), &run(middle..end));
            let joined = joined.finish(begin, end);
            assert_eq!(bits(joined), bits(&run(begin..end)), "{begin}..{middle}..{end}");
        }
    }

    /// Oracle: integers below 2⁵³ are summed exactly in any order.
    #[test]
    fn the_total_has_every_point_once() {
        for points in [0..777u32, 5..777, 100..101, 13..16, 17..18] {
            let mut sums = Accumulator::new(1);
            sums.load(&(points.start..points.start), &[]);
            points.clone().for_each(|j| sums.push(j, &[f64::from(j)]));
            let mut total = [0.0];
            add_total(sums.finish(points.start, points.end), &mut total);
            assert_eq!(total[0], points.clone().map(f64::from).sum::<f64>(), "{points:?}");
        }
    }
}
