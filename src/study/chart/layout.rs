//! The page: title, panels, caption.

use super::super::experiment::{Goal, Study};
use super::super::fit::Law;
use super::super::points::{pareto, points};
use super::font;
use super::panel::{Chart, Panel, Role};
use super::scale::{Domain, Measure, Scale};
use super::shapes::{Anchor, Page, Room, Shape, Text};
use crate::math::words::{duration, percent, rough_percent, significant};

/// Width of the page. Printed 16 cm wide, a CSS pixel is 2/3 point.
pub const WIDTH: f64 = 680.0;
/// Size of words: 9 points in print.
pub const SIZE: f64 = 13.6;

const TITLE_SIZE: f64 = 19.0;
const EDGE: f64 = 14.0;
/// Room below a plot for its labels.
const BELOW: f64 = 1.75 * SIZE;
const LINE: f64 = 1.35 * SIZE;
/// Variants that share one panel, the base line not counted; more get a panel for each axis.
const SHARED: usize = 5;
/// Panels in a row, at most.
const COLUMNS: usize = 3;
const COLUMN_GAP: f64 = 16.0;
/// Heights of plots: the only one, the overview, one of an axis.
const HEIGHTS: [f64; 3] = [400.0, 275.0, 112.0];
/// What a plot of an axis is higher for each column that it need not leave to others.
const ROOMY: f64 = 80.0;
/// Space between the labels of an error axis.
pub const TICK_GAP: f64 = 0.6 * SIZE;
/// Farther than this from all that was measured, the goal is told in the caption instead of shown.
const GOAL_REACH: f64 = 12.0;

/// Draws the page.
pub fn page(study: &Study) -> Page {
    let points = points(study);
    let front = pareto(&points);
    let laws: Vec<Option<Law>> = (0..study.variants.len()).map(|v| Law::of(study, v)).collect();
    let times = Domain::around(reached(points.iter().map(|p| p.seconds), study.time_goal()));
    let floors = laws.iter().flatten().filter_map(|law| law.floor);
    let errors = points.iter().flat_map(|p| [p.error, p.spread.end]).chain(floors);
    let chart = Chart {
        study,
        points: &points,
        front: &front,
        laws: &laws,
        seconds: times,
        error: Domain::around(reached(errors, study.error_goal())),
    };
    let mut page = Sheet {
        y: EDGE,
        left: label_room(chart.error),
        shapes: Vec::new(),
    };
    let title = format!("Error against time: {}", file_name(&study.scene));
    page.words(&title, TITLE_SIZE, true);
    page.words(&subtitle(study), SIZE, false);
    page.y += 0.5 * SIZE;
    let others: Vec<usize> = (1..study.variants.len()).collect();
    if others.len() <= SHARED {
        page.panel(&chart, Role::Whole, &others, HEIGHTS[0]);
    } else {
        page.panel(&chart, Role::Overview, &others, HEIGHTS[1]);
        page.axes(&chart, &axes(study));
    }
    page.y += 0.6 * SIZE;
    for sentence in caption(&chart) {
        page.words(&sentence, SIZE, false);
    }
    Page {
        size: [WIDTH, (page.y + EDGE).ceil()],
        title,
        description: description(&chart),
        shapes: page.shapes,
    }
}

/// The scene without its folders.
fn file_name(scene: &str) -> &str {
    let name = std::path::Path::new(scene).file_name().and_then(|name| name.to_str());
    name.unwrap_or(scene)
}

/// Where plots begin: right of the axis's name and its widest label.
fn label_room(domain: Domain) -> f64 {
    let ticks = HEIGHTS.iter().flat_map(|height| {
        let ends = [*height, 0.0];
        Scale { domain, ends }.ticks(Measure::Share, SIZE, TICK_GAP, true)
    });
    let widest = ticks.map(|t| font::width(&t.label, SIZE, false)).fold(0.0, f64::max);
    EDGE + 1.2 * SIZE + widest + 10.0
}

/// The values and the goal, unless it is far from all of them.
fn reached(values: impl Iterator<Item = f64>, goal: Option<f64>) -> impl Iterator<Item = f64> {
    let values: Vec<f64> = values.filter(|v| v.is_finite() && *v > 0.0).collect();
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(0.0, f64::max);
    let near = goal.filter(|g| values.is_empty() || (low / GOAL_REACH..=high * GOAL_REACH).contains(g));
    values.into_iter().chain(near)
}

/// The variants of each axis besides the base line, in the order in which the axes come.
fn axes(study: &Study) -> Vec<(String, Vec<usize>)> {
    let mut axes: Vec<(String, Vec<usize>)> = Vec::new();
    for (index, variant) in study.variants.iter().enumerate().skip(1) {
        match axes.iter_mut().find(|(axis, _)| *axis == variant.axis) {
            Some((_, variants)) => variants.push(index),
            None => axes.push((variant.axis.clone(), vec![index])),
        }
    }
    axes
}

fn subtitle(study: &Study) -> String {
    let threads = match study.threads {
        1 => "1 thread".to_owned(),
        n => format!("{n} threads"),
    };
    let [width, height] = study.size;
    format!(
        "{width} × {height} pixels · {threads} · {} · pts {}",
        study.processor, study.version
    )
}

/// What E is, what the marks show, and how good the reference is.
fn caption(chart: &Chart) -> Vec<String> {
    let study = chart.study;
    let spp = study
        .reference
        .spp
        .map_or(String::new(), |n| format!(", {n} samples per pixel"));
    let own = match study.reference.error {
        Some(e) => format!("its own error is {}, and its noise is subtracted from E", percent(e)),
        None => "its own error is unknown, and nothing is subtracted from E".to_owned(),
    };
    let mut sentences = vec![format!(
        "E is the root of the mean squared error over pixels and channels, relative to the brightness of each pixel. \
         Reference: {}{spp}; {own}.",
        study.reference.source
    )];
    let mut marks = Vec::new();
    let (few, most) = chart
        .points
        .iter()
        .fold((usize::MAX, 0), |(few, most), p| (few.min(p.rows), most.max(p.rows)));
    match most {
        0 => marks.push("Nothing was measured.".to_owned()),
        1 => marks.push("Each point is one picture.".to_owned()),
        _ => {
            let seeds = if few == most {
                most.to_string()
            } else {
                format!("{few} to {most}")
            };
            marks.push(format!(
                "A point is the median time and the root mean square of E over {seeds} seeds; bars reach from the \
                 least to the greatest E of them."
            ));
        }
    }
    if (0..study.variants.len()).any(|v| study.is_biased(v)) {
        let floors = match chart.laws.iter().flatten().any(|law| law.floor.is_some()) {
            true => "; the level that they tend to (floor) is dotted where it stands out from the noise",
            false => "",
        };
        marks.push(format!(
            "Hollow markers: variants that change the expected picture, so that more time does not bring E to 0{floors}."
        ));
    }
    if chart.points.iter().any(|p| p.error == 0.0) {
        marks.push("Arrows at the lower edge: E too small for this reference to tell from 0.".to_owned());
    }
    match study.goal {
        Goal::Error(e) if e > 0.0 && !chart.error.holds(e) => {
            marks.push(format!("The goal of {} lies outside.", percent(e)))
        }
        Goal::Seconds(s) if s > 0.0 && !chart.seconds.holds(s) => {
            marks.push(format!("The goal of {} lies outside.", duration(s)));
        }
        _ => {}
    }
    sentences.push(marks.join(" "));
    sentences
}

/// The chart in words.
fn description(chart: &Chart) -> String {
    let study = chart.study;
    let mut sentences = vec![format!(
        "Logarithmic chart of the error E over wall-clock seconds, {} variants.",
        study.variants.len()
    )];
    for variant in 0..study.variants.len() {
        let mut own = chart.points.iter().filter(|p| p.variant == variant);
        let Some(first) = own.next() else { continue };
        let last = own.next_back().unwrap_or(first);
        let floor = chart.laws[variant].as_ref().and_then(|law| law.floor);
        let floor = floor.map_or(String::new(), |f| format!(", floor {}", rough_percent(f)));
        sentences.push(format!(
            "{}: from {} after {} to {} after {}{floor}.",
            study.label(variant),
            percent(first.error),
            duration(first.seconds),
            percent(last.error),
            duration(last.seconds)
        ));
    }
    if let Some(law) = chart.laws.first().and_then(Option::as_ref) {
        let exponent = significant(law.exponent, 2);
        sentences.push(format!(
            "Of the base line E falls as samples to the power of −{exponent}."
        ));
    }
    sentences.join(" ")
}

/// A page being filled from top to bottom.
struct Sheet {
    y: f64,
    /// Where plots begin.
    left: f64,
    shapes: Vec<Shape>,
}

impl Sheet {
    /// Wrapped words across the page.
    fn words(&mut self, words: &str, size: f64, bold: bool) {
        // Readers without the typeface may set words a little wider.
        let limit = 0.94 * (WIDTH - 2.0 * EDGE);
        // A number and its unit stay on one line.
        let words = words.replace(" %", "\u{a0}%");
        for line in font::wrap(&words, size, bold, limit) {
            self.y += 1.35 * size;
            let line = font::cut(&line, size, bold, WIDTH - 2.0 * EDGE);
            let text = Text::new(line, [EDGE, self.y - 0.3 * size], size);
            self.shapes.push(Shape::Words(Text { bold, ..text }));
        }
    }

    /// A panel across the page.
    fn panel(&mut self, chart: &Chart, role: Role, variants: &[usize], height: f64) {
        let mut panel = Panel {
            role,
            title: String::new(),
            variants,
            room: Room::new([self.left, self.y], [WIDTH - EDGE, self.y + height]),
            legend: 0.0,
            labelled: [true; 2],
        };
        panel.legend = panel.legend_height(chart);
        panel.room.max[1] += panel.legend;
        self.shapes.extend(panel.draw(chart));
        self.name_axes(panel.room.min[1] + panel.legend, panel.room.max[1]);
    }

    fn name_axes(&mut self, top: f64, bottom: f64) {
        let middle = 0.5 * (self.left + WIDTH - EDGE);
        let y = bottom + BELOW + 0.85 * SIZE;
        let across = Text::new("wall-clock time of one run", [middle, y], SIZE);
        let up = Text::new("error E", [EDGE + 0.8 * SIZE, 0.5 * (top + bottom)], SIZE);
        self.shapes.push(Shape::Words(across.anchored(Anchor::Middle)));
        self.shapes.push(Shape::Words(Text {
            upward: true,
            ..up.anchored(Anchor::Middle)
        }));
        self.y = bottom + BELOW + LINE;
    }

    /// A panel for each axis, in rows.
    fn axes(&mut self, chart: &Chart, axes: &[(String, Vec<usize>)]) {
        let columns = axes.len().clamp(1, COLUMNS);
        let width = (WIDTH - EDGE - self.left - COLUMN_GAP * (columns - 1) as f64) / columns as f64;
        let height = HEIGHTS[2] + ROOMY * (COLUMNS - columns) as f64;
        let mut top = self.y + 0.6 * SIZE;
        for (row, group) in axes.chunks(columns).enumerate() {
            let mut panels: Vec<Panel> = group
                .iter()
                .enumerate()
                .map(|(column, (axis, variants))| {
                    let left = self.left + column as f64 * (width + COLUMN_GAP);
                    Panel {
                        role: Role::Axis,
                        title: axis.clone(),
                        variants,
                        room: Room::new([left, top], [left + width, top]),
                        legend: 0.0,
                        // Below the last panel of each column.
                        labelled: [column == 0, (row + 1) * columns + column >= axes.len()],
                    }
                })
                .collect();
            let legend = panels.iter().map(|p| p.legend_height(chart)).fold(0.0, f64::max);
            let bottom = top + legend + 0.3 * SIZE + height;
            let below = panels.iter().any(|panel| panel.labelled[1]);
            for panel in &mut panels {
                panel.legend = legend;
                panel.room.max[1] = bottom;
                self.shapes.extend(panel.draw(chart));
            }
            self.name_row(bottom - 0.5 * height);
            top = bottom + if below { BELOW } else { 0.0 } + 0.5 * SIZE;
        }
        self.y = top;
    }

    fn name_row(&mut self, middle: f64) {
        let at = [EDGE + 0.8 * SIZE, middle];
        self.shapes.push(Shape::Words(Text {
            upward: true,
            ..Text::new("error E", at, SIZE).anchored(Anchor::Middle)
        }));
    }
}
