//! Lamps and far-away light to the IR.

use super::emit::Emitted;
use crate::lang::desc::{LightDesc, ObjectDesc, ShapeDesc, SkyDesc};
use crate::lang::eval::Interp;
use crate::lang::transform::rotation_deg;
use crate::scene::{
    Environment, EnvironmentKind, Falloff, Image, ImageSource, Light, LightKind, Place, Scene, SpotProfile,
};
use glam::{DAffine3, DVec3};
use std::rc::Rc;

/// Lamps of one scene, those of unions counted as often as they are placed.
pub(super) const MAX_LIGHTS: usize = 1_000_000;

impl Interp<'_> {
    /// The lamps of a group that is placed again.
    pub(super) fn emit_lamps(
        &mut self,
        children: &[Rc<ObjectDesc>],
        to_world: DAffine3,
        out: &mut Scene,
        done: &mut Emitted,
    ) {
        let key = children.as_ptr().cast::<()>();
        if matches!(done.groups.get(&key), Some((_, false))) {
            return;
        }
        for child in children {
            if self.is_halted() {
                return;
            }
            let t = to_world * child.transform;
            match &child.shape {
                ShapeDesc::Light(light) => self.emit_light(light, t, out),
                ShapeDesc::Union(inner) => self.emit_lamps(inner, t, out, done),
                ShapeDesc::Model(model) => {
                    let mirror = DAffine3::from_scale(DVec3::new(1.0, 1.0, -1.0));
                    self.emit_model(model, t * mirror, out, done);
                }
                _ => {}
            }
        }
    }

    /// A lamp, placed.
    pub(super) fn emit_light(&mut self, l: &LightDesc, to_world: DAffine3, out: &mut Scene) {
        if out.lights.len() >= MAX_LIGHTS {
            self.fatal("P0602", l.span, format!("more than {MAX_LIGHTS} lamps"));
            return;
        }
        let color = self.linear(l.color);
        if color.min_element() < 0.0 {
            self.moved(l.span, "a lamp of negative brightness is left out where it is negative");
        }
        let color = color.max(DVec3::ZERO);
        let falloff = match (l.fade_distance, l.fade_power) {
            (d, p) if d > 0.0 && p > 0.0 => Falloff::Fade { distance: d, power: p },
            _ => Falloff::None,
        };
        let axis = (l.point_at - l.position).try_normalize();
        let spot = l.spot.map(|[radius, falloff, tightness]| SpotProfile::Pov {
            radius: radius.to_radians(),
            falloff: falloff.to_radians(),
            tightness,
        });
        if (l.parallel || spot.is_some()) && axis.is_none() {
            self.error(
                "P0315",
                l.span,
                "lamp points at its own place: `point_at` must differ from it",
            );
            return;
        }
        let axis = axis.unwrap_or(DVec3::Z);
        let position = l.position;
        let kind = if l.parallel {
            LightKind::Directional { direction: axis }
        } else if let Some([axis1, axis2]) = l.area.filter(|[a, b]| a.cross(*b) != DVec3::ZERO) {
            LightKind::Area {
                position,
                axis1,
                axis2,
                circular: l.circular,
                spot: spot.map(|s| (axis, s)),
                falloff,
            }
        } else if let Some(profile) = spot {
            LightKind::Spot {
                position,
                axis,
                profile,
                falloff,
            }
        } else {
            LightKind::Point { position, falloff }
        };
        let light = Light {
            name: String::new(),
            color,
            kind,
            casts_shadows: !l.shadowless,
            motion: Vec::new(),
            place: Place::Text(l.span),
        };
        out.lights.push(light.transformed(to_world));
    }

    /// Background, sky or environment, whichever says most.
    pub(super) fn emit_environment(&mut self, out: &mut Scene) {
        let Some((sky, span)) = self
            .scene
            .environment
            .take()
            .or(self.scene.sky_sphere.take())
            .or(self.scene.background.take())
        else {
            return;
        };
        let kind = match sky {
            SkyDesc::Color(color, pattern) => {
                if let Some((word, at)) = pattern {
                    self.warn_pattern(word, at);
                }
                match self.linear(color).max(DVec3::ZERO) {
                    DVec3::ZERO => {
                        self.note_idle("environment", "it is black", span);
                        EnvironmentKind::Black
                    }
                    c => EnvironmentKind::Constant(c),
                }
            }
            SkyDesc::Image { path, strength, rotate } => EnvironmentKind::Image {
                image: out.add_image(Image {
                    name: path.display().to_string(),
                    source: ImageSource::File(path),
                    fallback: None,
                    place: Place::Text(span),
                }),
                strength,
                rotation: rotation_deg(rotate),
            },
        };
        out.environment = Environment {
            kind,
            place: Place::Text(span),
            ..Environment::default()
        };
    }
}
