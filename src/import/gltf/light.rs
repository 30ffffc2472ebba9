//! Lamps of `KHR_lights_punctual`. Candela, lux and nit are taken 1:1 as radiometric units.

use super::Loader;
use super::extension::{Fields, NOT_NEGATIVE};
use crate::diag::Anomaly;
use crate::scene::{Falloff, Light, LightKind, SpotProfile};
use glam::{DAffine3, DVec3};
use serde_json::Value;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

const NAME: &str = "KHR_lights_punctual";

impl Loader<'_> {
    /// Adds lamp `index` at a node's place; it shines along the node's −z. The node's scale does not matter.
    pub(super) fn load_light(&mut self, index: usize, world: DAffine3, node: String, at: &str) {
        let lights = self.doc.extension(NAME).and_then(|e| e.get("lights"));
        let Some(raw) = lights.and_then(|l| l.get(index)) else {
            let count = lights.and_then(Value::as_array).map_or(0, Vec::len);
            self.report
                .error("G0202", at, format!("is {index}, but the file has {count} lights"));
            return;
        };
        let at = format!("extensions.{NAME}.lights[{index}]");
        let fields = Fields::new(raw, at.clone());
        let report = &mut self.report;
        let intensity = fields.number("intensity", 1.0, NOT_NEGATIVE, report);
        let mut color = fields.color("color", 1.0, NOT_NEGATIVE, report) * intensity;
        let range = fields.number("range", f64::INFINITY, NOT_NEGATIVE, report);
        let falloff = Falloff::InverseSquare {
            range: (range > 0.0 && range.is_finite()).then_some(range),
        };
        let (position, axis) = place(&world);
        let kind = match fields.member("type").and_then(Value::as_str) {
            Some("point") => LightKind::Point { position, falloff },
            Some("directional") => {
                color /= PI; // lux is E = π·color
                LightKind::Directional { direction: axis }
            }
            Some("spot") => {
                let empty = Value::Null;
                let spot = Fields::new(fields.member("spot").unwrap_or(&empty), format!("{at}.spot"));
                let outer = spot.number("outerConeAngle", FRAC_PI_4, 0.0..=FRAC_PI_2, report);
                let inner = spot.number("innerConeAngle", 0.0, 0.0..=FRAC_PI_2, report);
                if inner >= outer {
                    let message =
                        format!("the inner cone angle {inner} is not below the outer {outer}; it is moved below");
                    report.mended("G0801", &format!("{at}.spot"), message, Anomaly::MovedValue, 1);
                }
                LightKind::Spot {
                    position,
                    axis,
                    profile: SpotProfile::Punctual {
                        inner: inner.min(outer.next_down()).max(0.0),
                        outer: outer.max(f64::MIN_POSITIVE),
                    },
                    falloff,
                }
            }
            other => {
                let found = other.map_or("missing".to_owned(), |o| format!("\"{o}\""));
                let message =
                    format!("is {found}, expected \"point\", \"spot\" or \"directional\"; the lamp is left out");
                report.warning("G0802", &format!("{at}.type"), message);
                return;
            }
        };
        if color == DVec3::ZERO {
            return;
        }
        let own = raw.get("name").and_then(Value::as_str).filter(|n| !n.is_empty());
        self.scene.lights.push(Light {
            name: own.map_or(node, str::to_owned),
            color,
            kind,
            casts_shadows: true,
            motion: Vec::new(),
            place: self.report.origin(&at),
        });
    }
}

/// Where a lamp at a node's place is, and where it shines to: a unit vector.
fn place(world: &DAffine3) -> (DVec3, DVec3) {
    (world.translation, (-world.matrix3.z_axis).normalize_or(DVec3::NEG_Z))
}

/// A lamp as it is where its node is at another time.
pub(super) fn at_place(lamp: &LightKind, world: &DAffine3) -> LightKind {
    let (there, towards) = place(world);
    let mut lamp = lamp.clone();
    match &mut lamp {
        LightKind::Point { position, .. } => *position = there,
        LightKind::Spot { position, axis, .. } => (*position, *axis) = (there, towards),
        LightKind::Directional { direction } => *direction = towards,
        LightKind::Area { .. } => {} // no file describes one
    }
    lamp
}
