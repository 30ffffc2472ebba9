//! One panel: axes, lines, points, and the words beside them.

use super::super::experiment::{Point, Study};
use super::super::fit::Law;
use super::super::words::{duration, percent};
use super::labels::{Labels, around};
use super::scale::{Domain, Measure, Scale};
use super::shapes::{Anchor, At, Room, Shape, Stroke, Text};
use super::style::{self, Style};
use super::{font, layout::SIZE};

/// What all panels of a chart share.
pub struct Chart<'a> {
    pub study: &'a Study,
    pub points: &'a [Point],
    /// Indices into `points`.
    pub front: &'a [usize],
    /// One for each variant.
    pub laws: &'a [Option<Law>],
    pub seconds: Domain,
    pub error: Domain,
}

/// What a panel is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The only one.
    Whole,
    /// All variants as dots, the Pareto front named.
    Overview,
    /// One axis, with the base line behind.
    Axis,
}

/// A panel to draw.
pub struct Panel<'a> {
    pub role: Role,
    pub title: String,
    /// The variants it shows besides the base line.
    pub variants: &'a [usize],
    /// The room of title, legend and plot, without the axes' labels.
    pub room: Room,
    /// Height of the legend.
    pub legend: f64,
    /// Whether labels stand left of it and below it.
    pub labelled: [bool; 2],
}

/// Height of a line of the legend.
const LINE: f64 = 1.32 * SIZE;
/// Height of a panel's title.
const TITLE: f64 = 1.35 * SIZE;
/// Width of a piece of line in a legend.
const SAMPLE: f64 = 34.0;
/// A point of the Pareto front wears a ring.
const RING: f64 = 3.2;

/// A legend's entry: its shapes are drawn into the room of a sample.
struct Entry {
    words: String,
    draw: Box<dyn Fn(Room) -> Vec<Shape>>,
}

impl Panel<'_> {
    fn style(&self, chart: &Chart, variant: usize) -> Style {
        match self.variants.iter().position(|v| *v == variant) {
            Some(index) => Style::variant(index, chart.study.is_biased(variant)),
            None => Style::base(self.role == Role::Axis),
        }
    }

    fn entries(&self, chart: &Chart) -> Vec<Entry> {
        let line = |words: &str, stroke: Stroke| Entry {
            words: words.to_owned(),
            draw: Box::new(move |room: Room| {
                let middle = 0.5 * (room.min[1] + room.max[1]);
                vec![Shape::segment(
                    [room.min[0], middle],
                    [room.max[0], middle],
                    stroke.clone(),
                )]
            }),
        };
        let named = |variant: usize, words: String| {
            let style = self.style(chart, variant);
            Entry {
                words,
                draw: Box::new(move |room| style.sample(room)),
            }
        };
        let variants = self.variants.iter().filter_map(|v| {
            let name = match self.role {
                Role::Axis => chart.study.variants.get(*v)?.name.clone(),
                _ => chart.study.label(*v),
            };
            Some(named(*v, name))
        });
        let guide = || line("error ∝ 1/√time", guide_stroke());
        let front = || line("Pareto front", Stroke::solid(style::FRONT, 7.0));
        let base = || named(0, chart.study.label(0));
        match self.role {
            Role::Whole => std::iter::once(base())
                .chain(variants)
                .chain([front(), guide()])
                .collect(),
            Role::Overview => {
                let dots = Entry {
                    words: "other variants".to_owned(),
                    draw: Box::new(|room| {
                        vec![dot([
                            0.5 * (room.min[0] + room.max[0]),
                            0.5 * (room.min[1] + room.max[1]),
                        ])]
                    }),
                };
                vec![base(), dots, front(), guide()]
            }
            Role::Axis => variants.collect(),
        }
    }

    /// The legend's height for a panel of this width.
    pub fn legend_height(&self, chart: &Chart) -> f64 {
        let (_, rows) = flow(&self.entries(chart), self.room.width());
        rows as f64 * LINE
    }

    fn plot(&self) -> Room {
        let title = if self.title.is_empty() { 0.0 } else { TITLE };
        Room::new(
            [self.room.min[0], self.room.min[1] + title + self.legend + 0.3 * SIZE],
            self.room.max,
        )
    }

    /// Everything, from back to front.
    pub fn draw(&self, chart: &Chart) -> Vec<Shape> {
        let plot = self.plot();
        let x = Scale {
            domain: chart.seconds,
            ends: [plot.min[0], plot.max[0]],
        };
        let y = Scale {
            domain: chart.error,
            ends: [plot.max[1], plot.min[1]],
        };
        let mut ink = Ink {
            chart,
            panel: self,
            plot,
            x,
            y,
            labels: Labels::new(plot),
            shapes: Vec::new(),
            words: Vec::new(),
        };
        ink.heading();
        ink.frame();
        if self.role != Role::Axis {
            ink.front();
        }
        ink.guide();
        ink.goal();
        if self.role == Role::Overview {
            ink.dots();
        }
        let shown: Vec<usize> = std::iter::once(0).chain(self.variants.iter().copied()).collect();
        if self.role == Role::Overview {
            ink.lines(&[0]);
            ink.front_names();
        } else {
            ink.lines(&shown);
        }
        ink.samples();
        if self.role == Role::Whole {
            ink.names();
        }
        let mut shapes = ink.shapes;
        shapes.extend(ink.words.into_iter().map(Shape::Words));
        shapes
    }
}

/// Where each entry goes, and how many lines that takes.
fn flow(entries: &[Entry], width: f64) -> (Vec<At>, usize) {
    let (mut x, mut row) = (0.0, 0usize);
    let mut places = Vec::new();
    for entry in entries {
        let wide = SAMPLE + 6.0 + font::width(&entry.words, SIZE, false) + 16.0;
        if x > 0.0 && x + wide - 16.0 > width {
            (x, row) = (0.0, row + 1);
        }
        places.push([x, row as f64 * LINE]);
        x += wide;
    }
    let rows = if entries.is_empty() { 0 } else { row + 1 };
    (places, rows)
}

fn guide_stroke() -> Stroke {
    Stroke::dashed(style::GUIDE, 1.3, &[1.5, 3.5])
}

fn dot(at: At) -> Shape {
    Shape::Disc(at, 2.4, Some([255; 3]), Some(Stroke::solid(style::BEHIND, 1.1)))
}

/// A panel being drawn.
struct Ink<'a> {
    chart: &'a Chart<'a>,
    panel: &'a Panel<'a>,
    plot: Room,
    x: Scale,
    y: Scale,
    labels: Labels,
    shapes: Vec<Shape>,
    words: Vec<Text>,
}

impl Ink<'_> {
    fn heading(&mut self) {
        let [x, top] = self.panel.room.min;
        let mut below = top;
        if !self.panel.title.is_empty() {
            let title = font::cut(&self.panel.title, SIZE, true, self.panel.room.width());
            self.words.push(Text::new(title, [x, top + SIZE], SIZE).bold());
            below += TITLE;
        }
        let entries = self.panel.entries(self.chart);
        let (places, _) = flow(&entries, self.panel.room.width());
        for (entry, [dx, dy]) in entries.iter().zip(places) {
            let (left, upper) = (x + dx, below + dy);
            self.shapes
                .extend((entry.draw)(Room::new([left, upper], [left + SAMPLE, upper + LINE])));
            let start = left + SAMPLE + 6.0;
            let name = font::cut(&entry.words, SIZE, false, self.panel.room.max[0] - start);
            self.words.push(Text::new(name, [start, upper + 0.98 * SIZE], SIZE));
        }
    }

    fn frame(&mut self) {
        let ([left, top], [right, bottom]) = (self.plot.min, self.plot.max);
        let grid = || Stroke::solid(style::GRID, 1.0);
        for tick in self.x.ticks(Measure::Seconds, SIZE, 12.0, false) {
            let at = self.x.at(tick.value);
            self.shapes.push(Shape::segment([at, top], [at, bottom], grid()));
            if self.panel.labelled[1] {
                let place = [at, bottom + 1.25 * SIZE];
                self.words
                    .push(Text::new(tick.label, place, SIZE).anchored(Anchor::Middle));
            }
        }
        for tick in self.y.ticks(Measure::Share, SIZE, 0.6 * SIZE, true) {
            let at = self.y.at(tick.value);
            self.shapes.push(Shape::segment([left, at], [right, at], grid()));
            if self.panel.labelled[0] {
                let place = [left - 6.0, at + 0.35 * SIZE];
                self.words
                    .push(Text::new(tick.label, place, SIZE).anchored(Anchor::End));
            }
        }
        let edge = Some(Stroke::solid(style::GUIDE, 1.0));
        self.shapes.push(Shape::rectangle(self.plot, None, edge));
    }

    fn place(&self, point: &Point) -> Option<At> {
        let shown = point.seconds > 0.0 && point.error > 0.0;
        shown.then(|| [self.x.at(point.seconds), self.y.at(point.error)])
    }

    /// The front as steps: the least error that so many seconds buy.
    fn front(&mut self) {
        let corners: Vec<At> = self
            .chart
            .front
            .iter()
            .filter_map(|&i| self.place(&self.chart.points[i]))
            .collect();
        let mut steps = Vec::new();
        for (i, corner) in corners.iter().enumerate() {
            if let Some(before) = i.checked_sub(1).and_then(|b| corners.get(b)) {
                steps.push([corner[0], before[1]]);
            }
            steps.push(*corner);
        }
        if let (Some(first), Some(last)) = (corners.first(), corners.last()) {
            steps.insert(0, [first[0], self.plot.min[1]]);
            steps.push([self.plot.max[0], last[1]]);
            self.shapes.push(Shape::Group(
                "Pareto front".to_owned(),
                vec![Shape::Line(steps, Stroke::solid(style::FRONT, 7.0))],
            ));
        }
    }

    /// E ∝ 1/√t through the base line's longest run.
    fn guide(&mut self) {
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

    fn goal(&mut self) {
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

    fn dots(&mut self) {
        let others: Vec<At> = self
            .chart
            .points
            .iter()
            .filter(|p| p.variant != 0)
            .filter_map(|p| self.place(p))
            .collect();
        self.shapes.extend(others.into_iter().map(dot));
    }

    /// Lines, spreads and markers of variants; first all lines, then all markers.
    fn lines(&mut self, variants: &[usize]) {
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
    fn spread(&self, point: &Point, x: f64, style: &Style) -> Vec<Shape> {
        let low = point.spread.start.max(self.chart.error.low);
        let high = point.spread.end.min(self.chart.error.high);
        if point.rows < 2 || low.is_nan() || high.is_nan() || low >= high {
            return Vec::new();
        }
        let [low, high] = [low, high].map(|e| self.y.at(e));
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
        let text = Text::new(format!("floor {}", percent(floor)), [0.0; 2], SIZE);
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
    fn samples(&mut self) {
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
    fn names(&mut self) {
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

    /// Rings around the front's points, and the names of their variants where they fit.
    fn front_names(&mut self) {
        let points: Vec<&Point> = self.chart.front.iter().map(|&i| &self.chart.points[i]).collect();
        for point in &points {
            if let (Some(at), true) = (self.place(point), point.variant != 0) {
                let biased = self.chart.study.is_biased(point.variant);
                let fill = Some(if biased { [255; 3] } else { style::BLACK });
                let edge = Some(Stroke::solid(style::BLACK, 1.4));
                self.shapes.push(Shape::Disc(at, RING, fill, edge));
                self.labels.take(Room::around(at, RING + 1.0));
            }
        }
        let mut named = Vec::new();
        for point in points {
            let Some(at) = self.place(point).filter(|_| point.variant != 0) else {
                continue;
            };
            if named.contains(&point.variant) {
                continue;
            }
            let text = Text::new(self.chart.study.label(point.variant), [0.0; 2], SIZE);
            if let Some(text) = self.labels.place(&text, &around(at, RING, SIZE)) {
                self.words.push(text);
                named.push(point.variant);
            }
        }
    }
}
