//! One hard case: what is computed, by whom, and how far off it may be.

/// A case.
pub struct Case {
    /// Its number in the catalogue of docs/numerics.md; `L` for a slip of the lecture's slides.
    pub item: &'static str,
    /// What is computed.
    pub what: String,
    /// By the usual formula in f32.
    pub naive: f64,
    /// By pts.
    pub pts: f64,
    /// What it is.
    pub exact: f64,
    /// How far off pts may be.
    pub tolerance: f64,
    /// Why that far.
    pub because: &'static str,
}

impl Case {
    /// Whether a value is the exact one within the tolerance.
    pub fn holds(&self, value: f64) -> bool {
        (value - self.exact).abs() <= self.tolerance // false for NaN
    }

    /// The case in columns: item, what, naive, pts, exact, tolerance, verdict.
    pub fn columns(&self) -> [String; 7] {
        let verdict = if self.holds(self.pts) { "pass" } else { "**FAIL**" };
        [
            self.item.to_owned(),
            self.what.clone(),
            number(self.naive),
            number(self.pts),
            number(self.exact),
            format!("{} ({})", number(self.tolerance), self.because),
            verdict.to_owned(),
        ]
    }
}

/// Five digits, or fewer where they are zeros.
pub fn number(x: f64) -> String {
    let magnitude = x.abs();
    if !x.is_finite() || x == 0.0 {
        format!("{x}")
    } else if (1e-3..1e6).contains(&magnitude) {
        let decimals = (4 - magnitude.log10().floor() as i32).clamp(0, 8) as usize;
        let text = format!("{x:.decimals$}");
        if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        } else {
            text
        }
    } else {
        let text = format!("{x:.3e}");
        match text.split_once('e') {
            Some((digits, power)) if digits.contains('.') => {
                format!("{}e{power}", digits.trim_end_matches('0').trim_end_matches('.'))
            }
            _ => text,
        }
    }
}

/// The largest of some numbers; NaN if one of them is.
pub fn worst(values: impl IntoIterator<Item = f64>) -> f64 {
    values
        .into_iter()
        .fold(0.0, |a, b| if a.is_nan() || b.is_nan() { f64::NAN } else { a.max(b) })
}

/// The share of `true`.
pub fn share(found: impl IntoIterator<Item = bool>) -> f64 {
    let (n, hits) = found
        .into_iter()
        .fold((0u64, 0u64), |(n, k), x| (n + 1, k + u64::from(x)));
    hits as f64 / n as f64
}
