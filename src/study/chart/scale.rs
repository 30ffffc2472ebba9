//! Logarithmic axes: from values to places, and which values get a label.

use super::font;
use crate::math::words::{percent, significant};

/// Factor between the ends of an axis, at least; so that it has two labels.
const LEAST_SPAN: f64 = 8.0;
/// Room between the outermost values and the ends, as a share of the axis.
const MARGIN: f64 = 0.07;
/// Least and greatest value that an axis is drawn for.
const LIMITS: [f64; 2] = [1e-12, 1e12];

/// What an axis measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// Seconds, labelled in ms, s, min, h.
    Seconds,
    /// A share, labelled in percent.
    Share,
}

/// The values at the ends of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Domain {
    pub low: f64,
    pub high: f64,
}

impl Domain {
    /// Ends that hold all of the values that can stand on a logarithmic axis, with some room; [0.1, 10] for none.
    pub fn around(values: impl Iterator<Item = f64>) -> Self {
        let (low, high) = values
            .filter(|v| (LIMITS[0]..=LIMITS[1]).contains(v))
            .fold((f64::INFINITY, 0.0f64), |(low, high), v| (low.min(v), high.max(v)));
        if low > high {
            return Self { low: 0.1, high: 10.0 };
        }
        let (middle, half) = ((low * high).sqrt(), (high / low).sqrt());
        let half = half.powf(1.0 + 2.0 * MARGIN).max(LEAST_SPAN.sqrt());
        Self {
            low: middle / half,
            high: middle * half,
        }
    }

    pub fn holds(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }
}

/// A domain laid along pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    pub domain: Domain,
    /// Place of the low and the high end.
    pub ends: [f64; 2],
}

/// A labelled value.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    pub value: f64,
    pub label: String,
}

impl Scale {
    /// Place of a value above 0, in or outside the domain.
    pub fn at(&self, value: f64) -> f64 {
        let share = (value / self.domain.low).log10() / (self.domain.high / self.domain.low).log10();
        self.ends[0] + share * (self.ends[1] - self.ends[0])
    }

    /// The densest of the sensible sets of labels that stand apart by `gap` and stick out past the ends by at most
    /// half of it. Labels are set across (x axis) or, with `stacked`, one above the other (y axis).
    pub fn ticks(&self, measure: Measure, size: f64, gap: f64, stacked: bool) -> Vec<Tick> {
        let fits = |ticks: &[Tick]| {
            let room = |tick: &Tick| match stacked {
                true => size,
                false => font::width(&tick.label, size, false),
            };
            ticks.windows(2).all(|pair| {
                let distance = (self.at(pair[1].value) - self.at(pair[0].value)).abs();
                distance >= 0.5 * (room(&pair[0]) + room(&pair[1])) + gap
            })
        };
        let inside = |tick: &Tick| {
            let half = if stacked {
                0.0
            } else {
                0.5 * font::width(&tick.label, size, false) - 0.5 * gap
            };
            let [low, high] = [self.ends[0].min(self.ends[1]), self.ends[0].max(self.ends[1])];
            let at = self.at(tick.value);
            at - half >= low && at + half <= high
        };
        const MANTISSAS: [&[f64]; 5] = [
            &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0],
            &[1.0, 1.5, 2.0, 3.0, 5.0, 7.0],
            &[1.0, 2.0, 5.0],
            &[1.0, 3.0],
            &[1.0],
        ];
        let sets = MANTISSAS.iter().map(|set| (*set, 1));
        let sparse = (2..=24).map(|step| (MANTISSAS[4], step));
        for (mantissas, step) in sets.chain(sparse) {
            let ticks: Vec<Tick> = self.all(measure, mantissas, step).into_iter().filter(inside).collect();
            // The densest sets are for axes so short that the next would leave them bare.
            let crowded = mantissas.len() > 3 && ticks.len() > 6;
            if fits(&ticks) && !crowded && !ticks.is_empty() {
                return ticks;
            }
        }
        // Long labels on a short axis: those of the densest set that find room, from the left.
        let mut few: Vec<Tick> = Vec::new();
        for tick in self.all(measure, MANTISSAS[0], 1).into_iter().filter(inside) {
            few.push(tick);
            if !fits(&few) {
                few.pop();
            }
        }
        few
    }

    /// All values of the form mantissa × 10ⁿ in the unit that a reader would use, n a multiple of `step`.
    fn all(&self, measure: Measure, mantissas: &[f64], step: i32) -> Vec<Tick> {
        let [low, high] = [self.domain.low, self.domain.high].map(|v| v.log10().floor() as i32);
        let mut ticks = Vec::new();
        // An hour is 3.6 times the next lower power of ten.
        for power in (low - 4..=high + 1).filter(|p| p.rem_euclid(step) == 0) {
            for mantissa in mantissas {
                // Parsed, for 10⁻³ as a product of binary fractions is off by a bit.
                let value = format!("{mantissa}e{power}").parse().unwrap_or(f64::NAN);
                ticks.extend(match measure {
                    Measure::Share => vec![Tick {
                        value,
                        label: percent(value),
                    }],
                    Measure::Seconds => seconds(value),
                });
            }
        }
        ticks.retain(|tick| self.domain.holds(tick.value));
        ticks.sort_by(|a, b| a.value.total_cmp(&b.value));
        ticks.dedup_by(|a, b| a.value == b.value);
        ticks
    }
}

/// A round number as seconds, minutes and hours, where it is round in them: 50 s are not, for a minute follows.
fn seconds(value: f64) -> Vec<Tick> {
    let tick = |scale: f64, unit: &str| Tick {
        value: value * scale,
        label: format!("{} {unit}", significant(value, 3)),
    };
    let mut ticks = Vec::new();
    if value < 36.0 {
        let (scale, unit) = match value {
            v if v >= 1.0 => (1.0, "s"),
            v if v >= 1e-3 => (1e3, "ms"),
            _ => (1e6, "µs"),
        };
        ticks.push(Tick {
            value,
            label: format!("{} {unit}", significant(value * scale, 3)),
        });
    }
    if (1.0..36.0).contains(&value) {
        ticks.push(tick(60.0, "min"));
    }
    if value >= 1.0 {
        ticks.push(tick(3600.0, "h"));
    }
    ticks
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scale(low: f64, high: f64, length: f64) -> Scale {
        Scale {
            domain: Domain { low, high },
            ends: [0.0, length],
        }
    }

    fn labels(low: f64, high: f64, length: f64, measure: Measure) -> Vec<String> {
        let ticks = scale(low, high, length).ticks(measure, 13.5, 10.0, false);
        ticks.into_iter().map(|tick| tick.label).collect()
    }

    #[test]
    fn a_scale_grows_with_its_values_and_meets_its_ends() {
        let scale = scale(0.5, 50.0, 300.0);
        assert_eq!([0.5, 5.0, 50.0].map(|v| scale.at(v).round()), [0.0, 150.0, 300.0]);
        let places: Vec<f64> = (1..200).map(|i| scale.at(0.3 * f64::from(i))).collect();
        assert!(places.windows(2).all(|w| w[0] < w[1]));
    }

    #[test]
    fn labels_are_round_in_the_unit_of_their_size() {
        assert_eq!(
            labels(0.08, 400.0, 500.0, Measure::Seconds),
            ["300 ms", "1 s", "3 s", "10 s", "30 s", "1 min", "3 min"]
        );
        assert_eq!(
            labels(0.0008, 0.3, 200.0, Measure::Share),
            ["0.3 %", "1 %", "3 %", "10 %"]
        );
        assert_eq!(
            labels(50.0, 90_000.0, 250.0, Measure::Seconds),
            ["10 min", "1 h", "10 h"]
        );
        assert_eq!(
            labels(1.1, 4.5, 300.0, Measure::Seconds),
            ["1.5 s", "2 s", "3 s", "4 s"]
        );
    }

    /// Widths, spans and lengths over many orders: labels grow, stand apart, and at least two are there.
    #[test]
    fn labels_never_touch() {
        for measure in [Measure::Seconds, Measure::Share] {
            for power in -9..9 {
                for span in [8.0, 20.0, 1e2, 1e4, 1e9] {
                    for length in [140.0, 200.0, 600.0] {
                        let low = 1.7 * 10f64.powi(power);
                        let scale = scale(low, low * span, length);
                        let ticks = scale.ticks(measure, 13.5, 10.0, false);
                        let ends: Vec<[f64; 2]> = ticks
                            .iter()
                            .map(|t| (scale.at(t.value), 0.5 * font::width(&t.label, 13.5, false)))
                            .map(|(at, half)| [at - half, at + half])
                            .collect();
                        assert!(ends.windows(2).all(|w| w[0][1] + 9.9 < w[1][0]), "{ticks:?}");
                        assert!(ends.iter().all(|e| e[0] > -5.1 && e[1] < length + 5.1));
                        assert!(!ticks.is_empty(), "{measure:?}: {low} × {span} on {length}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_domain_is_never_empty() {
        let none = Domain::around([f64::NAN, 0.0, -1.0, f64::INFINITY].into_iter());
        assert_eq!(none, Domain { low: 0.1, high: 10.0 });
        let one = Domain::around([2.0, 2.0].into_iter());
        assert!(one.low < 1.0 && one.high > 4.0 && (one.high / one.low - LEAST_SPAN).abs() < 1e-9);
        let wide = Domain::around([1e-12, 1e12, 1e300].into_iter());
        assert!(wide.low < 1e-12 && wide.high > 1e12 && wide.high.is_finite());
    }
}
