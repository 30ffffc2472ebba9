//! What a panel shows: front, guide, goal, lines, spreads, floors, markers, and the words beside them.

use super::super::experiment::Point;
use super::super::points::best_error;
use super::labels::{Labels, around};
use super::layout::SIZE;
use super::panel::{Chart, Panel, Role};
use super::scale::Scale;
use super::shapes::{Anchor, At, Room, Shape, Stroke, Text};
use super::style::{self, Style};
use crate::math::words::{duration, percent, rough_percent};

/// Width of the Pareto front's line.
pub const FRONT_WIDTH: f64 = 8.0;
/// Pieces of the Pareto front's line.
const FRONT_STEPS: usize = 200;
/// A point of the Pareto front wears a ring.
const RING: f64 = 3.2;

/// The guide's line.
pub fn guide_stroke() -> Stroke {
    Stroke::dashed(style::GUIDE, 1.3, &[1.5, 3.5])
}

/// A point on the front.
pub fn ring(at: At, biased: bool) -> Shape {
    let fill = Some(if biased { [255; 3] } else { style::BLACK });
    Shape::Disc(at, RING, fill, Some(Stroke::solid(style::BLACK, 1.4)))
}

/// A point that is not named.
pub fn dot(at: At) -> Shape {
    Shape::Disc(at, 2.4, Some([255; 3]), Some(Stroke::solid(style::BEHIND, 1.1)))
}

/// A panel being drawn.
pub struct Ink<'a> {
    pub chart: &'a Chart<'a>,
    pub panel: &'a Panel<'a>,
    pub plot: Room,
    pub x: Scale,
    pub y: Scale,
    pub labels: Labels,
    pub shapes: Vec<Shape>,
    /// Drawn last, so that no line crosses them.
    pub words: Vec<Text>,
}

impl Ink<'_> {
    fn place(&self, point: &Point) -> Option<At> {
        let shown = point.seconds > 0.0 && point.error > 0.0;
        shown.then(|| [self.x.at(point.seconds), self.y.at(point.error)])
    }

    /// The front: the least error that so many seconds are measured to buy.
    pub fn front(&mut self) {
        let times = || self.chart.front.iter().map(|&i| self.chart.points[i].seconds);
        let (Some(first), Some(last)) = (times().next(), times().next_back()) else {
            return;
        };
        let between = (0..=FRONT_STEPS).map(|i| first * (last / first).powf(i as f64 / FRONT_STEPS as f64));
        let mut times: Vec<f64> = times().chain(between).filter(|t| (first..=last).contains(t)).collect();
        times.sort_by(f64::total_cmp);
        let best = |t: f64| [self.x.at(t), self.y.at(best_error(self.chart.points, t))];
        let line: Vec<At> = times.into_iter().map(best).collect();
        let line = Shape::Line(line, Stroke::solid(style::FRONT, FRONT_WIDTH));
        self.shapes.push(Shape::Group("Pareto front".to_owned(), vec![line]));
    }

    /// E ∝ 1/√t through the base line's longest run.
    pub fn guide(&mut self) {
        let base = self.chart.points.iter().filter(|p| p.variant == 0 && p.error > 0.0);
        let Some(last) = base.max_by(|a, b| a.seconds.total_cmp(&b.seconds)) else {
            return;
        };
        let error = |seconds: f64| last.error * (last.seconds / seconds).sqrt();
        let seconds = |error: f64| last.seconds * (last.error / error).powi(2);
        let (time, share) = (self.chart.seconds, self.chart.error);
        let [from, to] = [time.low.max(seconds(share.high)), time.high.min(seconds(share.low))];
        if from < to {
            let ends = [from, to].map(|t| [self.x.at(t), self.y.at(error(t))]);
            self.shapes.push(Shape::Line(ends.to_vec(), guide_stroke()));
            self.labels.cross(&ends);
        }
    }

    pub fn goal(&mut self) {
        let ([left, top], [right, bottom]) = (self.plot.min, self.plot.max);
        let stroke = Stroke::dashed(style::GOAL, 1.5, &[7.0, 2.0, 1.5, 2.0]);
        let (ends, words, places) = match (self.chart.study.error_goal(), self.chart.study.time_goal()) {
            (Some(goal), _) if self.chart.error.holds(goal) => {
                let at = self.y.at(goal);
                let [above, below] = [at - 0.4 * SIZE, at + 1.0 * SIZE];
                let places = vec![
                    ([left + 5.0, below], Anchor::Start),
                    ([left + 5.0, above], Anchor::Start),
                    ([right - 5.0, above], Anchor::End),
                    ([right - 5.0, below], Anchor::End),
                ];
                ([[left, at], [right, at]], format!("goal {}", percent(goal)), places)
            }
            (_, Some(goal)) if self.chart.seconds.holds(goal) => {
                let at = self.x.at(goal);
                let places = [bottom - 6.0, top + SIZE, bottom - 6.0 - 1.4 * SIZE, top + 2.4 * SIZE]
                    .into_iter()
                    .flat_map(|y| [([at + 5.0, y], Anchor::Start), ([at - 5.0, y], Anchor::End)])
                    .collect();
                ([[at, top], [at, bottom]], format!("goal {}", duration(goal)), places)
            }
            _ => return,
        };
        self.shapes.push(Shape::Line(ends.to_vec(), stroke));
        self.labels.cross(&ends);
        if self.panel.role == Role::Axis {
            return; // the overview names it
        }
        let text = Text::new(words, [0.0; 2], SIZE).colored(style::GOAL);
        if let Some(text) = self.labels.place(&text, &places) {
            self.words.push(text);
        }
    }

    pub fn dots(&mut self) {
        let others: Vec<At> = self
            .chart
            .points
            .iter()
            .filter(|p| p.variant != 0)
            .filter_map(|p| self.place(p))
            .collect();
        for at in others {
            self.shapes.push(dot(at));
            self.labels.take(Room::around(at, 2.4));
        }
    }

    /// Lines, spreads and markers of variants; first all lines, then all markers.
    pub fn lines(&mut self, variants: &[usize]) {
        let mut markers = Vec::new();
        for &variant in variants {
            let style = self.panel.style(self.chart, variant);
            let points: Vec<&Point> = self.chart.points.iter().filter(|p| p.variant == variant).collect();
            let mut threads: Vec<usize> = points.iter().map(|p| p.threads).collect();
            threads.sort_unstable();
            threads.dedup();
            let mut parts = Vec::new();
            for threads in threads {
                let run: Vec<&Point> = points.iter().copied().filter(|p| p.threads == threads).collect();
                let line: Vec<At> = run.iter().filter_map(|p| self.place(p)).collect();
                self.labels.cross(&line);
                parts.push(Shape::Line(line, style.line.clone()));
            }
            parts.extend(self.floor(variant, &points, &style));
            self.shapes.push(Shape::Group(self.chart.study.label(variant), parts));
            for point in points {
                markers.push((point, style.clone()));
            }
        }
        for (point, style) in markers {
            self.marker(point, &style);
        }
    }

    fn marker(&mut self, point: &Point, style: &Style) {
        let study = self.chart.study;
        let words = format!(
            "{}, {} spp: {}, error {}",
            study.label(point.variant),
            point.spp,
            duration(point.seconds),
            percent(point.error)
        );
        let mut parts = Vec::new();
        let x = self.x.at(point.seconds);
        match self.place(point) {
            Some(at) => {
                parts.extend(self.spread(point, x, style));
                parts.push(style.marker(at));
                self.labels.take(Room::around(at, style.radius() + 1.0));
            }
            // Below all that can be measured: an arrow down at the edge.
            None if point.seconds > 0.0 => {
                let foot = self.plot.max[1] - 2.0;
                let tip = vec![[x - 4.0, foot - 7.0], [x, foot], [x + 4.0, foot - 7.0]];
                parts.push(Shape::Line(
                    vec![[x, foot - 16.0], [x, foot]],
                    Stroke::solid(style.line.color, 1.4),
                ));
                parts.push(Shape::Line(tip, Stroke::solid(style.line.color, 1.4)));
                self.labels.take(Room::new([x - 5.0, foot - 17.0], [x + 5.0, foot]));
            }
            None => return,
        }
        self.shapes.push(Shape::Group(words, parts));
    }

    /// A bar from the least to the greatest E of the seeds.
    fn spread(&mut self, point: &Point, x: f64, style: &Style) -> Vec<Shape> {
        let low = point.spread.start.max(self.chart.error.low);
        let high = point.spread.end.min(self.chart.error.high);
        if point.rows < 2 || low.is_nan() || high.is_nan() || low >= high {
            return Vec::new();
        }
        let [low, high] = [low, high].map(|e| self.y.at(e));
        self.labels.take(Room::new([x - 3.5, high], [x + 3.5, low]));
        let stroke = || Stroke::solid(style.line.color, 1.3);
        let cap = |y: f64| Shape::segment([x - 3.5, y], [x + 3.5, y], stroke());
        let mut parts = vec![Shape::segment([x, low], [x, high], stroke()), cap(high)];
        if point.spread.start >= self.chart.error.low {
            parts.push(cap(low));
        }
        parts
    }

    /// The level a biased variant tends to, from its first point to the right edge.
    fn floor(&mut self, variant: usize, points: &[&Point], style: &Style) -> Vec<Shape> {
        let floor = self
            .chart
            .laws
            .get(variant)
            .and_then(Option::as_ref)
            .and_then(|law| law.floor);
        let Some(floor) = floor.filter(|f| self.chart.error.holds(*f)) else {
            return Vec::new();
        };
        let start = points
            .iter()
            .map(|p| self.x.at(p.seconds))
            .fold(self.plot.max[0], f64::min);
        let ends = [[start, self.y.at(floor)], [self.plot.max[0], self.y.at(floor)]];
        self.labels.cross(&ends);
        let text = Text::new(format!("floor {}", rough_percent(floor)), [0.0; 2], SIZE);
        let [right, at] = ends[1];
        let places = [
            ([right - 4.0, at + 0.98 * SIZE], Anchor::End),
            ([right - 4.0, at - 0.35 * SIZE], Anchor::End),
        ];
        if let Some(text) = self.labels.place(&text, &places) {
            self.words.push(text);
        }
        vec![Shape::Line(
            ends.to_vec(),
            Stroke::dashed(style.line.color, 1.1, &[1.5, 2.5]),
        )]
    }

    /// Samples per pixel beside the points of the base line: the ends first.
    pub fn samples(&mut self) {
        if self.panel.role == Role::Axis {
            return;
        }
        let mut base: Vec<(At, u32)> = self
            .chart
            .points
            .iter()
            .filter(|p| p.variant == 0)
            .filter_map(|p| Some((self.place(p)?, p.spp)))
            .collect();
        let first = base.len().min(1);
        base.rotate_right(first);
        for (at, spp) in base {
            let text = Text::new(format!("{spp} spp"), [0.0; 2], SIZE);
            if let Some(text) = self.labels.place(&text, &around(at, 4.0, SIZE)) {
                self.words.push(text);
            }
        }
    }

    /// Names beside the last points, where they fit.
    pub fn names(&mut self) {
        for &variant in self.panel.variants {
            let style = self.panel.style(self.chart, variant);
            let mut places: Vec<At> = self
                .chart
                .points
                .iter()
                .filter(|p| p.variant == variant)
                .filter_map(|p| self.place(p))
                .collect();
            places.reverse();
            let text = Text::new(self.chart.study.label(variant), [0.0; 2], SIZE);
            let candidates: Vec<_> = places.iter().flat_map(|at| around(*at, style.radius(), SIZE)).collect();
            if let Some(text) = self.labels.place(&text, &candidates) {
                self.words.push(text);
            }
        }
    }

    /// The front's points that are not the base line's.
    fn on_front(&self) -> Vec<(At, usize)> {
        let points = self.chart.front.iter().map(|&i| &self.chart.points[i]);
        let others = points.filter(|p| p.variant != 0);
        others.filter_map(|p| Some((self.place(p)?, p.variant))).collect()
    }

    pub fn front_rings(&mut self) {
        for (at, variant) in self.on_front() {
            let biased = self.chart.study.is_biased(variant);
            self.shapes.push(ring(at, biased));
            self.labels.take(Room::around(at, RING + 1.0));
        }
    }

    /// The names of the front's variants, where they fit: beside a point, or farther off with a line to it.
    pub fn front_names(&mut self) {
        let mut named = Vec::new();
        for (at, variant) in self.on_front() {
            if named.contains(&variant) {
                continue;
            }
            let text = Text::new(self.chart.study.label(variant), [0.0; 2], SIZE);
            let near = around(at, RING, SIZE);
            let far = [14.0, 24.0, 36.0, 50.0, 66.0, 84.0].into_iter().flat_map(|d| {
                let [x, y] = at;
                let below = y + d + 0.78 * SIZE;
                [
                    ([x - 0.4 * d, below], Anchor::End),
                    ([x - 0.4 * d, below], Anchor::Middle),
                ]
            });
            let places: Vec<_> = near.iter().copied().chain(far).collect();
            let Some(text) = self.labels.place(&text, &places) else {
                continue;
            };
            if !near.contains(&(text.at, text.anchor)) {
                let [x, y] = text.at;
                let tip = [x + if text.anchor == Anchor::End { -4.0 } else { 0.0 }, y - 0.8 * SIZE];
                let leader = [tip, at];
                self.labels.cross(&leader);
                self.shapes
                    .push(Shape::Line(leader.to_vec(), Stroke::solid(style::GUIDE, 0.8)));
            }
            self.words.push(text);
            named.push(variant);
        }
    }
}
