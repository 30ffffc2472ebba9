//! `light_source { … }`.

use super::transform::TRANSFORM_TEXTS;
use crate::diag::Span;
use crate::lang::desc::{LightDesc, ObjectDesc, ShapeDesc};
use crate::lang::eval::{Interp, Parsed, T};
use crate::lang::syntax::Word;
use glam::DVec3;
use std::rc::Rc;

const LIGHT_TEXTS: &[&str] = &[
    "color",
    "rgb",
    "spotlight",
    "cylinder",
    "parallel",
    "point_at",
    "radius",
    "falloff",
    "tightness",
    "area_light",
    "adaptive",
    "jitter",
    "circular",
    "orient",
    "fade_distance",
    "fade_power",
    "looks_like",
    "shadowless",
    "media_interaction",
    "media_attenuation",
    "projected_through",
];

impl Interp<'_> {
    /// A lamp behind its opening brace.
    pub fn light_source(&mut self, span: Span) -> Parsed<ObjectDesc> {
        if let T::Name(_) = self.peek().t
            && !self.starts_expr()
        {
            let mut object = (*self.named_object()?).clone();
            let ShapeDesc::Light(light) = &object.shape else {
                return Err(self.error("P0303", span, "expected a light source, found another object"));
            };
            let mut light = (**light).clone();
            self.light_items(&mut light, &mut object)?;
            object.shape = ShapeDesc::Light(Rc::new(light));
            return Ok(object);
        }
        let mut light = LightDesc {
            position: self.vec3("place of the lamp")?,
            color: DVec3::ONE,
            point_at: DVec3::Z,
            parallel: false,
            spot: None,
            area: None,
            circular: false,
            fade_distance: 0.0,
            fade_power: 0.0,
            shadowless: false,
            looks_like: None,
            span,
        };
        let mut object = ObjectDesc::new(ShapeDesc::Unsupported("light_source"), span);
        self.comma();
        self.light_items(&mut light, &mut object)?;
        object.shape = ShapeDesc::Light(Rc::new(light));
        Ok(object)
    }

    fn light_items(&mut self, light: &mut LightDesc, object: &mut ObjectDesc) -> Parsed<()> {
        loop {
            let tok = self.peek_item();
            match tok.t {
                T::Mark(b'}') | T::End => return Ok(()),
                T::Mark(b',' | b';') => {
                    self.bump();
                }
                _ if self.starts_color() || matches!(tok.t, T::Mark(b'<')) => {
                    let [r, g, b, ..] = self.color()?;
                    light.color = DVec3::new(r, g, b);
                }
                T::Word(w) => {
                    if let Some(t) = self.transform_word(w)? {
                        object.transform = t * object.transform;
                        self.check_transform(&object.transform, tok)?;
                    } else if !self.light_item(light, w)? {
                        let texts = [LIGHT_TEXTS, TRANSFORM_TEXTS].concat();
                        return Err(self.unexpected("`light_source`", &texts, tok));
                    }
                }
                // `light_source { <…> 1 }`: an intensity without a colour word.
                _ if self.starts_expr() => {
                    let [r, g, b, ..] = self.color()?;
                    light.color = DVec3::new(r, g, b);
                }
                _ => return Err(self.unexpected("`light_source`", LIGHT_TEXTS, tok)),
            }
        }
    }

    /// One word of a lamp, which comes next; false if it is none.
    fn light_item(&mut self, light: &mut LightDesc, w: Word) -> Parsed<bool> {
        let span = self.peek().span;
        if !LIGHT_TEXTS.contains(&w.text()) && w != Word::AreaIllumination && !matches!(w, Word::Photons | Word::Hollow)
        {
            return Ok(false);
        }
        self.bump();
        let cone = light.spot.unwrap_or([30.0, 45.0, 0.0]);
        match w {
            Word::Spotlight => light.spot = Some(cone),
            Word::Cylinder => {
                self.warn_once("P0410", span, "a cylinder of light is drawn as a spotlight");
                light.spot = Some(cone);
            }
            Word::Parallel => light.parallel = true,
            Word::PointAt => light.point_at = self.vec3("point_at")?,
            Word::Radius => light.spot = Some([self.finite("radius")?, cone[1], cone[2]]),
            Word::Falloff => light.spot = Some([cone[0], self.finite("falloff")?, cone[2]]),
            Word::Tightness => light.spot = Some([cone[0], cone[1], self.finite("tightness")?]),
            Word::AreaLight => {
                let a = self.vec3("first edge of the area light")?;
                self.comma();
                let b = self.vec3("second edge of the area light")?;
                self.comma();
                self.finite("number of lamps")?;
                self.comma();
                self.finite("number of lamps")?;
                light.area = Some([a, b]);
            }
            Word::Adaptive => {
                self.finite("adaptive")?;
            }
            Word::Circular => light.circular = true,
            Word::Jitter | Word::Orient => {}
            Word::FadeDistance => light.fade_distance = self.finite("fade_distance")?,
            Word::FadePower => light.fade_power = self.finite("fade_power")?,
            Word::Shadowless => light.shadowless = true,
            Word::LooksLike => {
                light.looks_like = Some(self.block(|s| match s.peek().t {
                    T::Name(_) => {
                        let named = s.named_object()?;
                        s.finished((*named).clone(), "looks_like").map(Rc::new)
                    }
                    _ => {
                        let inner = s.object()?;
                        s.finished((*inner).clone(), "looks_like").map(Rc::new)
                    }
                })?);
            }
            Word::ProjectedThrough => {
                self.warn_once(
                    "P0409",
                    span,
                    "`projected_through` is not supported yet and is left out",
                );
                self.skip_block()?;
            }
            Word::Photons => self.skip_block()?,
            _ => {
                self.flag()?;
            }
        }
        Ok(true)
    }
}
