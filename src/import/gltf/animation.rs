//! Animations: where nodes are at a time, by the channels of the file.
//!
//! All animations of a file are played together, as far as they move different things: the first one whole, each further
//! one unless it moves what an earlier one moves already. Before its first key and after its last a channel holds still.

use super::accessor::{Numbers, Wanted};
use super::document::index_of;
use super::mesh::VEC3;
use super::variant::known;
use super::{Loader, Report};
use glam::{DAffine3, DQuat, DVec3, DVec4};
use serde_json::Value;
use std::collections::BTreeMap;
use std::rc::Rc;

/// What a channel moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Path {
    Translation,
    Rotation,
    Scale,
    Weights,
}

/// How values lie between keys.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Way {
    Step,
    Linear,
    Cubic,
}

/// Values at keys.
struct Curve {
    /// Seconds, growing; at least one.
    times: Rc<Numbers>,
    /// Values by key; of cubic curves in-tangent, value and out-tangent.
    values: Rc<Numbers>,
    /// Numbers of a value.
    width: usize,
    way: Way,
}

/// What all channels of a file say.
#[derive(Default)]
pub(super) struct Tracks {
    curves: BTreeMap<(usize, Path), Curve>,
}

/// Translation, rotation and scale of a node as it is written.
#[derive(Clone, Copy)]
pub(super) struct Rest {
    /// Where it is.
    pub translation: DVec3,
    /// How it is turned, unit.
    pub rotation: DQuat,
    /// How it is stretched.
    pub scale: DVec3,
}

impl Rest {
    /// Translation · rotation · scale.
    pub fn transform(&self) -> DAffine3 {
        DAffine3::from_scale_rotation_translation(self.scale, self.rotation, self.translation)
    }
}

impl Loader<'_> {
    /// The channels that are played. What is broken in them is told.
    pub(super) fn tracks(&mut self) -> Tracks {
        let mut tracks = Tracks::default();
        let count = self.doc.len("animations");
        let mut played = 0..count;
        if let Some(wanted) = self.options.animation.as_deref() {
            let names: Vec<String> = (0..count).map(|i| self.doc.name("animations", i)).collect();
            let Some(index) = names.iter().position(|n| n == wanted) else {
                let names: Vec<&str> = names.iter().map(String::as_str).collect();
                let d = crate::diag::Diagnostic::error("G0903", format!("there is no animation \"{wanted}\""));
                self.report.push("", d.hint(known("animations", &names)));
                return tracks;
            };
            played = index..index + 1;
        }
        for index in played {
            let at = format!("animations[{index}]");
            let Some(animation) = self.doc.raw("animations", index, &at, &mut self.report) else {
                continue;
            };
            let curves = self.animation(animation, &at);
            let is_taken = curves.keys().any(|key| tracks.curves.contains_key(key));
            if is_taken {
                let message = "moves what an earlier animation moves already; it is not played";
                self.report.push(&at, crate::diag::Diagnostic::note("G0901", message));
            } else {
                tracks.curves.extend(curves);
            }
        }
        tracks
    }

    fn animation(&mut self, animation: &Value, at: &str) -> BTreeMap<(usize, Path), Curve> {
        let mut curves = BTreeMap::new();
        let channels = animation.get("channels").and_then(Value::as_array);
        for (i, channel) in channels.into_iter().flatten().enumerate() {
            let at_channel = format!("{at}.channels[{i}]");
            let Some(target) = channel.get("target") else {
                self.report.error("G0902", &at_channel, "has no `target`");
                continue;
            };
            let path = match target.get("path").and_then(Value::as_str) {
                Some("translation") => Path::Translation,
                Some("rotation") => Path::Rotation,
                Some("scale") => Path::Scale,
                Some("weights") => Path::Weights,
                Some("pointer") => continue, // KHR_animation_pointer, which nothing here follows
                other => {
                    let found = other.map_or("missing".to_owned(), |o| format!("\"{o}\""));
                    let message = format!("is {found}, expected translation, rotation, scale or weights");
                    self.report
                        .error("G0902", &format!("{at_channel}.target.path"), message);
                    continue;
                }
            };
            if target.get("node").is_none() {
                continue; // left to extensions, by the specification
            }
            let at_target = format!("{at_channel}.target");
            let Some(node) = index_of(target, "node", &at_target, &mut self.report) else {
                continue;
            };
            let Some(raw) = self
                .doc
                .raw("nodes", node, &format!("{at_target}.node"), &mut self.report)
            else {
                continue;
            };
            if raw.get("matrix").is_some() && path != Path::Weights {
                let message = format!("node {node} has a matrix, which cannot be animated; it stands still");
                self.report.warning("G0903", &at_target, message);
                continue;
            }
            let Some(sampler) = needed(channel, "sampler", &at_channel, &mut self.report) else {
                continue;
            };
            let Some(raw) = animation.get("samplers").and_then(|s| s.get(sampler)) else {
                let message = format!("is {sampler}, but the animation has no such sampler");
                self.report.error("G0902", &format!("{at_channel}.sampler"), message);
                continue;
            };
            let Some(curve) = self.curve(raw, path, &format!("{at}.samplers[{sampler}]")) else {
                continue;
            };
            if curves.insert((node, path), curve).is_some() {
                let message = "two channels of one animation move the same; the last one counts";
                self.report.warning("G0903", &at_channel, message);
            }
        }
        curves
    }

    /// Reads the keys of a sampler.
    fn curve(&mut self, sampler: &Value, path: Path, at: &str) -> Option<Curve> {
        const SCALARS: Wanted = Wanted {
            components: &[1],
            normalize: false,
        };
        // Integers stand for fractions here, whatever the accessor says.
        const WEIGHTS: Wanted = Wanted {
            components: &[1],
            normalize: true,
        };
        const QUATERNIONS: Wanted = Wanted {
            components: &[4],
            normalize: true,
        };
        let way = match sampler.get("interpolation").map(|v| v.as_str()) {
            None | Some(Some("LINEAR")) => Way::Linear,
            Some(Some("STEP")) => Way::Step,
            Some(Some("CUBICSPLINE")) => Way::Cubic,
            Some(_) => {
                let message = "is none of LINEAR, STEP and CUBICSPLINE; it is taken as LINEAR";
                self.report.warning("G0903", &format!("{at}.interpolation"), message);
                Way::Linear
            }
        };
        let input = needed(sampler, "input", at, &mut self.report)?;
        let output = needed(sampler, "output", at, &mut self.report)?;
        let times = self.floats(input, SCALARS, &format!("{at}.input"))?;
        let wanted = match path {
            Path::Translation | Path::Scale => VEC3,
            Path::Rotation => QUATERNIONS,
            Path::Weights => WEIGHTS,
        };
        let values = self.floats(output, wanted, &format!("{at}.output"))?;
        budget(&mut self.animated, &times, &values, at, &mut self.report)?;
        let keys = times.values.len();
        let mut pairs = times.values.windows(2);
        let is_growing = pairs.all(|pair| pair[0] < pair[1]) && times.values.iter().all(|t| t.is_finite());
        if keys == 0 || !is_growing {
            let message = "the times of the keys are missing or do not grow; the channel is not played";
            self.report.warning("G0904", &format!("{at}.input"), message);
            return None;
        }
        let parts = if way == Way::Cubic { 3 } else { 1 };
        let per_key = parts * keys;
        let (width, count) = match path {
            Path::Translation | Path::Scale => (3, values.count()),
            Path::Rotation => (4, values.count()),
            Path::Weights => (values.count() / per_key, values.count()),
        };
        let expected = if path == Path::Weights {
            width * per_key
        } else {
            per_key
        };
        if count != expected || width == 0 {
            let message = format!("has {count} elements for {keys} keys, which does not fit");
            self.report.error("G0904", &format!("{at}.output"), message);
            return None;
        }
        if !values.values.iter().all(|v| v.is_finite()) {
            let message = "a value is not finite; the channel is not played";
            self.report.warning("G0904", &format!("{at}.output"), message);
            return None;
        }
        Some(Curve {
            times,
            values,
            width,
            way,
        })
    }
}

/// Keys and values that are looked at, over all channels of a file: one accessor may serve any number of them.
const MOST_NUMBERS: u64 = 1 << 28;

/// Counts what a channel looks at; `None`, with an error, beyond what is looked at for one file.
fn budget(spent: &mut u64, times: &Numbers, values: &Numbers, at: &str, report: &mut Report) -> Option<()> {
    *spent += (times.values.len() + values.values.len()) as u64;
    if *spent > MOST_NUMBERS {
        let message = format!("the animations of the file have more than {MOST_NUMBERS} numbers");
        report.error("G0904", at, message);
        return None;
    }
    Some(())
}

/// The index that an element must have under a key.
fn needed(element: &Value, key: &str, at: &str, report: &mut Report) -> Option<usize> {
    if element.get(key).is_none() {
        report.error("G0902", at, format!("has no `{key}`"));
    }
    index_of(element, key, at, report)
}

impl Tracks {
    /// Whether a node is moved by itself.
    pub fn moves(&self, node: usize) -> bool {
        [Path::Translation, Path::Rotation, Path::Scale]
            .iter()
            .any(|path| self.curves.contains_key(&(node, *path)))
    }

    /// The node's own transform at a time in seconds, where no channel says otherwise as it is written.
    pub fn transform(&self, node: usize, rest: &Rest, time: f64) -> DAffine3 {
        let vector = |path, written: DVec3| match self.curves.get(&(node, path)) {
            Some(curve) => DVec3::from_slice(&curve.at(time)),
            None => written,
        };
        let rotation = self
            .curves
            .get(&(node, Path::Rotation))
            .map(|curve| curve.rotation(time));
        Rest {
            translation: vector(Path::Translation, rest.translation),
            rotation: rotation.flatten().unwrap_or(rest.rotation),
            scale: vector(Path::Scale, rest.scale),
        }
        .transform()
    }

    /// Whether a channel weighs the morph targets of a node.
    pub fn has_weights(&self, node: usize) -> bool {
        self.curves.contains_key(&(node, Path::Weights))
    }

    /// The weights of a node's morph targets at a time, if a channel says them.
    pub fn weights(&self, node: usize, time: f64) -> Option<Vec<f32>> {
        let curve = self.curves.get(&(node, Path::Weights))?;
        Some(curve.at(time).iter().map(|w| *w as f32).collect())
    }
}

impl Curve {
    /// The key before a time, how far it is to the next as a share, and how many seconds apart they are.
    fn place(&self, time: f64) -> (usize, f64, f64) {
        let times = &self.times.values;
        let last = times.len() - 1;
        let next = times.partition_point(|t| f64::from(*t) <= time);
        if next == 0 || next > last {
            return (if next == 0 { 0 } else { last }, 0.0, 0.0);
        }
        let (a, b) = (f64::from(times[next - 1]), f64::from(times[next]));
        (next - 1, (time - a) / (b - a), b - a)
    }

    /// Number `i` of the value (`part` 1 of cubic curves, else 0), or a tangent, of a key.
    fn number(&self, key: usize, part: usize, i: usize) -> f64 {
        let parts = if self.way == Way::Cubic { 3 } else { 1 };
        let at = (key * parts + part) * self.width + i;
        f64::from(self.values.values.get(at).copied().unwrap_or(0.0))
    }

    /// The value at a time, all its numbers by themselves.
    fn at(&self, time: f64) -> Vec<f64> {
        let (key, s, apart) = self.place(time);
        let value = |i| match self.way {
            Way::Cubic => {
                if s == 0.0 {
                    return self.number(key, 1, i);
                }
                let (s2, s3) = (s * s, s * s * s);
                (2.0 * s3 - 3.0 * s2 + 1.0) * self.number(key, 1, i)
                    + apart * (s3 - 2.0 * s2 + s) * self.number(key, 2, i)
                    + (3.0 * s2 - 2.0 * s3) * self.number(key + 1, 1, i)
                    + apart * (s3 - s2) * self.number(key + 1, 0, i)
            }
            Way::Linear if s > 0.0 => self.number(key, 0, i) * (1.0 - s) + self.number(key + 1, 0, i) * s,
            Way::Linear | Way::Step => self.number(key, 0, i),
        };
        (0..self.width).map(value).collect()
    }

    /// The value at a time as a rotation, turned evenly the short way between keys; `None` where it is none.
    fn rotation(&self, time: f64) -> Option<DQuat> {
        let unit = |v: &[f64]| {
            let v = DVec4::from_slice(v);
            v.try_normalize().map(|v| DQuat::from_xyzw(v.x, v.y, v.z, v.w))
        };
        if self.way != Way::Linear {
            return unit(&self.at(time));
        }
        let (key, s, _) = self.place(time);
        let of = |key| unit(&std::array::from_fn::<f64, 4, _>(|i| self.number(key, 0, i)));
        let from = of(key)?;
        if s == 0.0 {
            return Some(from);
        }
        Some(from.slerp(of(key + 1)?, s))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(way: Way, width: usize, values: &[f32]) -> Curve {
        Curve {
            times: Rc::new(Numbers {
                components: 1,
                values: vec![1.0, 2.0, 4.0],
            }),
            values: Rc::new(Numbers {
                components: width,
                values: values.to_vec(),
            }),
            width,
            way,
        }
    }

    #[test]
    fn values_between_keys_follow_their_way_and_hold_outside() {
        let values = [0.0, 10.0, 20.0];
        let linear = curve(Way::Linear, 1, &values);
        let step = curve(Way::Step, 1, &values);
        for (time, even, held) in [
            (-5.0, 0.0, 0.0),
            (1.0, 0.0, 0.0),
            (1.5, 5.0, 0.0),
            (2.0, 10.0, 10.0),
            (3.0, 15.0, 10.0),
            (4.0, 20.0, 20.0),
            (99.0, 20.0, 20.0),
        ] {
            assert_eq!((linear.at(time)[0], step.at(time)[0]), (even, held), "{time}");
        }
    }

    /// A cubic through tangents of its own is reproduced: x³ − 2x over both spans, in global seconds.
    #[test]
    fn a_cubic_reproduces_a_cubic() {
        let (f, slope) = (|x: f64| x * x * x - 2.0 * x, |x: f64| 3.0 * x * x - 2.0);
        let values: Vec<f32> = [1.0, 2.0, 4.0]
            .iter()
            .flat_map(|&x| [slope(x) as f32, f(x) as f32, slope(x) as f32])
            .collect();
        let cubic = curve(Way::Cubic, 1, &values);
        for i in 0..=30 {
            let x = 1.0 + f64::from(i) / 10.0;
            assert!((cubic.at(x)[0] - f(x)).abs() < 1e-12, "{x}: {}", cubic.at(x)[0]);
        }
    }

    /// Evenly and the short way: from 0° by 350° is −10°, half way −5°.
    #[test]
    fn rotations_turn_evenly_the_short_way() {
        let q = |degrees: f64| DQuat::from_rotation_y(degrees.to_radians());
        let numbers: Vec<f32> = [q(0.0), q(350.0), q(20.0)]
            .iter()
            .flat_map(|q| q.as_quat().to_array())
            .collect();
        let turned = curve(Way::Linear, 4, &numbers);
        for (time, degrees) in [(0.0, 0.0), (1.25, -2.5), (1.5, -5.0), (3.0, 5.0), (9.0, 20.0)] {
            let found = turned.rotation(time).expect("a rotation");
            assert!(found.angle_between(q(degrees)) < 1e-6, "{time}: {found}");
        }
        assert!(curve(Way::Linear, 4, &[0.0; 12]).rotation(1.5).is_none());
    }
}
