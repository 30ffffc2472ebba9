//! One panel: title, legend and axes around a plot.

use super::super::experiment::{Point, Study};
use super::super::fit::Law;
use super::labels::Labels;
use super::marks::{FRONT_WIDTH, Ink, dot, guide_stroke, ring};
use super::scale::{Domain, Measure, Scale};
use super::shapes::{Anchor, At, Room, Shape, Stroke, Text};
use super::style::{self, Style};
use super::{font, layout::SIZE, layout::TICK_GAP};

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

/// An entry with a piece of line.
fn line(words: &str, stroke: Stroke) -> Entry {
    Entry {
        words: words.to_owned(),
        draw: Box::new(move |room: Room| {
            let ([left, _], [right, _], [_, y]) = (room.min, room.max, room.middle());
            vec![Shape::segment([left, y], [right, y], stroke.clone())]
        }),
    }
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
/// Space between the entries of a legend.
const APART: f64 = 16.0;
/// Width of a piece of line in a legend.
const SAMPLE: f64 = 31.0;
/// A legend's entry: its shapes are drawn into the room of a sample.
struct Entry {
    words: String,
    draw: Box<dyn Fn(Room) -> Vec<Shape>>,
}

impl Panel<'_> {
    /// How a variant looks here.
    pub fn style(&self, chart: &Chart, variant: usize) -> Style {
        match self.variants.iter().position(|v| *v == variant) {
            Some(index) => Style::variant(index, chart.study.is_biased(variant)),
            None => Style::base(self.role == Role::Axis),
        }
    }

    fn entries(&self, chart: &Chart) -> Vec<Entry> {
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
        let guide = || line("1/√time", guide_stroke());
        let front = || line("Pareto front", Stroke::solid(style::FRONT, FRONT_WIDTH));
        let base = || named(0, chart.study.label(0));
        match self.role {
            Role::Whole => {
                let front = (!self.variants.is_empty()).then(front);
                let lines = std::iter::once(base()).chain(variants);
                lines.chain(front).chain([guide()]).collect()
            }
            Role::Overview => {
                let dots = Entry {
                    words: "other variants".to_owned(),
                    draw: Box::new(|room| vec![dot(room.middle())]),
                };
                let marked = Entry {
                    draw: Box::new(move |room| [(front().draw)(room), vec![ring(room.middle(), true)]].concat()),
                    ..front()
                };
                vec![base(), dots, marked, guide()]
            }
            Role::Axis => variants.collect(),
        }
    }

    /// Height of title and legend.
    pub fn legend_height(&self, chart: &Chart) -> f64 {
        let (_, rows) = flow(&self.entries(chart), self.title_width(), self.room.width());
        rows as f64 * LINE
    }

    /// Room that the title takes of the legend's first line.
    fn title_width(&self) -> f64 {
        match self.title.is_empty() {
            true => 0.0,
            false => font::width(&self.title, SIZE, true) + 0.75 * APART,
        }
    }

    fn plot(&self) -> Room {
        let top = self.room.min[1] + self.legend + 0.3 * SIZE;
        Room::new([self.room.min[0], top], self.room.max)
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
        if self.role != Role::Axis && !self.variants.is_empty() {
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
            ink.front_rings();
        } else {
            ink.lines(&shown);
        }
        ink.samples();
        match self.role {
            Role::Whole => ink.names(),
            Role::Overview => ink.front_names(),
            Role::Axis => {}
        }
        let mut shapes = ink.shapes;
        shapes.extend(ink.words.into_iter().map(Shape::Words));
        shapes
    }
}

/// Where each entry goes, the first line being taken up to `start`, and how many lines that takes.
fn flow(entries: &[Entry], start: f64, width: f64) -> (Vec<At>, usize) {
    let (mut x, mut row) = (start, 0usize);
    let mut places = Vec::new();
    for entry in entries {
        let wide = SAMPLE + 6.0 + font::width(&entry.words, SIZE, false);
        if x > 0.0 && x + wide > width {
            (x, row) = (0.0, row + 1);
        }
        places.push([x, row as f64 * LINE]);
        x += wide + APART;
    }
    (places, row + 1)
}

impl Ink<'_> {
    fn heading(&mut self) {
        let [x, top] = self.panel.room.min;
        let wide = self.panel.room.width();
        if !self.panel.title.is_empty() {
            let title = font::cut(&self.panel.title, SIZE, true, wide);
            self.words.push(Text::new(title, [x, top + 0.98 * SIZE], SIZE).bold());
        }
        let entries = self.panel.entries(self.chart);
        let (places, _) = flow(&entries, self.panel.title_width(), wide);
        for (entry, [dx, dy]) in entries.iter().zip(places) {
            let (left, upper) = (x + dx, top + dy);
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
        for tick in self.y.ticks(Measure::Share, SIZE, TICK_GAP, true) {
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
}
