//! Rows gathered into points: what the chart shows and the tables sum up.

use super::experiment::{Goal, Kind, Point, Row, Study};
use std::collections::BTreeMap;

/// The rows that say something: of a known variant, with a finite E² and a finite time above 0.
pub(crate) fn usable(study: &Study) -> impl Iterator<Item = &Row> {
    let known = study.variants.len();
    let timed = |row: &Row| row.seconds.total().is_finite() && row.seconds.total() > 0.0;
    study
        .rows
        .iter()
        .filter(move |row| row.variant < known && row.spp > 0 && row.e2.is_finite() && timed(row))
}

/// The rows of one variant with the same number of samples and threads, as points: median seconds, root of the mean
/// of E² (0 where that mean is negative), least and largest E of the seeds. Ordered by variant, samples and threads.
/// Rows without a finite E² or a time above 0 are left out.
pub fn points(study: &Study) -> Vec<Point> {
    let mut groups: BTreeMap<(usize, u32, usize), Vec<&Row>> = BTreeMap::new();
    for row in usable(study) {
        groups.entry((row.variant, row.spp, row.threads)).or_default().push(row);
    }
    let point = |((variant, spp, threads), rows): ((usize, u32, usize), Vec<&Row>)| {
        let mean = rows.iter().map(|row| row.e2).sum::<f64>() / rows.len() as f64;
        let errors = || rows.iter().map(|row| row.error());
        Point {
            variant,
            spp,
            threads,
            rows: rows.len(),
            seconds: median(rows.iter().map(|row| row.seconds.total()).collect()),
            error: mean.max(0.0).sqrt(),
            spread: errors().fold(f64::INFINITY, f64::min)..errors().fold(0.0, f64::max),
        }
    };
    groups.into_iter().map(point).collect()
}

/// Indices of the points that no other point beats in both seconds and error, by seconds. A point whose error is 0,
/// that is, below what the reference can tell, takes no part.
pub fn pareto(points: &[Point]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..points.len()).filter(|&i| points[i].error > 0.0).collect();
    let key = |i: usize| (points[i].seconds, points[i].error);
    order.sort_by(|&a, &b| key(a).0.total_cmp(&key(b).0).then(key(a).1.total_cmp(&key(b).1)));
    let mut least = f64::INFINITY;
    order.retain(|&i| {
        let better = points[i].error < least;
        least = least.min(points[i].error);
        better
    });
    order
}

/// The middle value, the mean of the two middle ones for an even number; NaN for none.
pub(crate) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    let middle = values.len() / 2;
    match (values.get(middle), values.len() % 2) {
        (None, _) => f64::NAN,
        (Some(upper), 1) => *upper,
        (Some(upper), _) => 0.5 * (upper + values[middle - 1]),
    }
}

impl Study {
    /// A variant as a reader meets it: `axis: name`; for the base line its name alone.
    pub(crate) fn label(&self, variant: usize) -> String {
        match self.variants.get(variant) {
            Some(v) if variant == 0 => v.name.clone(),
            Some(v) => format!("{}: {}", v.axis, v.name),
            None => format!("variant {variant}"),
        }
    }

    /// Whether the variant changes the expected picture.
    pub(crate) fn is_biased(&self, variant: usize) -> bool {
        self.variants.get(variant).is_some_and(|v| v.kind == Kind::Bias)
    }

    /// The error asked for, if one was.
    pub(crate) fn error_goal(&self) -> Option<f64> {
        match self.goal {
            Goal::Error(e) if e.is_finite() && e > 0.0 => Some(e),
            _ => None,
        }
    }

    /// The seconds asked for, if any were.
    pub(crate) fn time_goal(&self) -> Option<f64> {
        match self.goal {
            Goal::Seconds(s) if s.is_finite() && s > 0.0 => Some(s),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::synthetic;
    use super::*;

    #[test]
    fn a_point_is_the_median_time_and_the_root_mean_square_error_of_its_seeds() {
        let mut study = synthetic::study(1);
        study.rows.truncate(4);
        for (row, (seconds, e2)) in study
            .rows
            .iter_mut()
            .zip([(1.0, 0.04), (9.0, 0.01), (2.0, -0.01), (4.0, 0.0)])
        {
            (row.spp, row.variant, row.e2) = (16, 0, e2);
            row.seconds = super::super::experiment::Phases {
                render: seconds,
                ..Default::default()
            };
        }
        let found = points(&study);
        assert_eq!(found.len(), 1);
        assert_eq!((found[0].rows, found[0].seconds), (4, 3.0));
        assert!((found[0].error - 0.1).abs() < 1e-12, "{}", found[0].error);
        assert_eq!(found[0].spread, 0.0..0.2);
    }

    #[test]
    fn rows_that_say_nothing_are_left_out() {
        let mut study = synthetic::study(1);
        let all = points(&study).len();
        study.rows[0].e2 = f64::NAN;
        study.rows[1].seconds.render = f64::INFINITY;
        study.rows[2].variant = 99;
        let left: usize = points(&study).iter().map(|p| p.rows).sum();
        assert_eq!(left, study.rows.len() - 3);
        assert_eq!(points(&study).len(), all);
    }

    #[test]
    fn the_front_holds_what_nothing_beats() {
        let at = |seconds: f64, error: f64| Point {
            variant: 0,
            spp: 1,
            threads: 1,
            rows: 1,
            seconds,
            error,
            spread: error..error,
        };
        let points = [
            at(4.0, 0.1),
            at(1.0, 0.5),
            at(2.0, 0.6),
            at(1.0, 0.4),
            at(3.0, 0.1),
            at(9.0, 0.0),
        ];
        assert_eq!(pareto(&points), [3, 4]);
        assert!(pareto(&[]).is_empty());
    }

    #[test]
    fn the_median_of_an_even_number_lies_between() {
        assert_eq!(median(vec![3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(vec![4.0, 1.0, 2.0, 3.0]), 2.5);
        assert!(median(vec![]).is_nan());
    }
}
