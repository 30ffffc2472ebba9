//! Extension objects read member by member. An extension that is malformed costs a warning and its default, not the
//! model.

use super::Report;
use super::document::extension;
use crate::diag::Anomaly;
use glam::DVec3;
use serde_json::Value;
use std::ops::RangeInclusive;

/// The members of an extension object (or of none, when everything has its default).
pub(super) struct Fields<'v> {
    value: Option<&'v Value>,
    at: String,
}

/// Every number that is not negative.
pub(super) const NOT_NEGATIVE: RangeInclusive<f64> = 0.0..=f64::MAX;
/// Shares.
pub(super) const UNIT: RangeInclusive<f64> = 0.0..=1.0;
/// Every finite number.
pub(super) const FINITE: RangeInclusive<f64> = f64::MIN..=f64::MAX;

impl<'v> Fields<'v> {
    /// The extension `name` of an element that stands at `at`, if it has it.
    pub fn of(element: &'v Value, name: &str, at: &str) -> Option<Fields<'v>> {
        extension(element, name).map(|value| Fields {
            value: Some(value),
            at: format!("{at}.extensions.{name}"),
        })
    }

    /// The same, or an object without members if the element does not have it.
    pub fn of_or_empty(element: &'v Value, name: &str, at: &str) -> Fields<'v> {
        Fields::of(element, name, at).unwrap_or(Fields {
            value: None,
            at: String::new(),
        })
    }

    /// Any object as fields.
    pub fn new(value: &'v Value, at: impl Into<String>) -> Fields<'v> {
        Fields {
            value: Some(value),
            at: at.into(),
        }
    }

    /// A member's JSON.
    pub fn member(&self, key: &str) -> Option<&'v Value> {
        self.value?.get(key)
    }

    /// Where the object stands, for messages.
    pub fn at(&self) -> &str {
        &self.at
    }

    /// Where a member stands, for messages.
    pub fn place(&self, key: &str) -> String {
        format!("{}.{key}", self.at)
    }

    /// A number in `range`, or the default. One outside is moved to the range's end with a warning.
    pub fn number(&self, key: &str, default: f64, range: RangeInclusive<f64>, report: &mut Report) -> f64 {
        let Some(value) = self.member(key) else {
            return default;
        };
        match value.as_f64() {
            Some(number) => limit(number, range, &self.place(key), report),
            None => {
                let message = format!("is {value}, expected a number; {default} is used");
                report.warning("G0206", &self.place(key), message);
                default
            }
        }
    }

    /// N numbers in `range`, or the default.
    pub fn numbers<const N: usize>(
        &self,
        key: &str,
        default: [f64; N],
        range: RangeInclusive<f64>,
        report: &mut Report,
    ) -> [f64; N] {
        let Some(value) = self.member(key) else {
            return default;
        };
        let items: Option<Vec<f64>> = value.as_array().and_then(|a| a.iter().map(Value::as_f64).collect());
        match items.and_then(|items| <[f64; N]>::try_from(items).ok()) {
            Some(items) => items.map(|n| limit(n, range.clone(), &self.place(key), report)),
            None => {
                let message = format!("is not an array of {N} numbers; the default is used");
                report.warning("G0206", &self.place(key), message);
                default
            }
        }
    }

    /// Three numbers as a linear colour.
    pub fn color(&self, key: &str, default: f64, range: RangeInclusive<f64>, report: &mut Report) -> DVec3 {
        DVec3::from_array(self.numbers(key, [default; 3], range, report))
    }
}

/// N numbers of an element as they are written; the schema's types would round them to f32.
pub(super) fn exact<const N: usize>(element: &Value, key: &str) -> Option<[f64; N]> {
    let items = element.get(key)?.as_array()?;
    let items: Option<Vec<f64>> = items.iter().map(Value::as_f64).collect();
    items?.try_into().ok()
}

/// The number, moved into the range with a warning if it lies outside (NaN becomes the lower end).
pub(super) fn limit(number: f64, range: RangeInclusive<f64>, at: &str, report: &mut Report) -> f64 {
    if range.contains(&number) {
        return number;
    }
    let used = if number > *range.end() {
        *range.end()
    } else {
        *range.start()
    };
    let message = format!("is {number}, outside what it can mean; {used} is used");
    report.mended("G0207", at, message, Anomaly::MovedValue, 1);
    used
}
