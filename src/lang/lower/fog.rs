//! `fog { … }`.

use super::transform::TRANSFORM_TEXTS;
use crate::diag::Diagnostic;
use crate::lang::desc::{Desc, FogDesc};
use crate::lang::eval::{Interp, Parsed, Stop, T, Value};
use crate::lang::syntax::Word;
use crate::scene::{Fog, GroundFog, Place, Scene};
use glam::DVec3;
use std::rc::Rc;

/// Words of a fog, for suggestions.
const FOG_TEXTS: &[&str] = &[
    "fog_type",
    "distance",
    "color",
    "rgb",
    "fog_offset",
    "fog_alt",
    "up",
    "turbulence",
    "turb_depth",
    "octaves",
    "omega",
    "lambda",
];

impl Interp<'_> {
    /// A fog, beginning with its word.
    pub fn fog(&mut self) -> Parsed<Rc<FogDesc>> {
        let span = self.bump().span;
        self.block(|s| {
            let mut fog = FogDesc::new(span);
            loop {
                let tok = s.peek_item();
                match tok.t {
                    T::Mark(b'}') | T::End => return Ok(Rc::new(fog)),
                    T::Mark(b',') => {
                        s.bump();
                    }
                    _ if s.starts_color() => fog.color = s.color()?,
                    T::Name(n) if matches!(s.scopes.get(n), Some(Value::Desc(_) | Value::Poison)) => {
                        match s.take_value()? {
                            Value::Desc(Desc::Fog(named)) => {
                                fog = FogDesc {
                                    span,
                                    ..(*named).clone()
                                }
                            }
                            Value::Poison => return Err(Stop),
                            other => {
                                let message = format!("expected a fog, found {}", other.kind());
                                return Err(s.error("P0303", tok.span, message));
                            }
                        }
                    }
                    T::Word(w) => s.fog_word(w, &mut fog)?,
                    // The form of old scenes: a number alone is the distance.
                    _ if s.starts_expr() => fog.distance = Some(s.within("distance of fog", 0.0, f64::MAX)?),
                    _ => return Err(s.unexpected("`fog`", FOG_TEXTS, tok)),
                }
            }
        })
    }

    fn fog_word(&mut self, w: Word, fog: &mut FogDesc) -> Parsed<()> {
        let tok = self.peek();
        if let Some(t) = self.transform_word(w)? {
            let up = t.transform_vector3(fog.up);
            if !(up.length() > 0.0 && up.is_finite()) {
                return Err(self.error("P0310", tok.span, "transform leaves the fog without a direction of up"));
            }
            fog.up = up;
            return Ok(());
        }
        self.bump();
        let at = self.peek().span;
        match w {
            Word::FogType => match self.finite("fog_type")? {
                1.0 => fog.is_ground = false,
                2.0 => fog.is_ground = true,
                other => {
                    let d = Diagnostic::error("P0311", format!("fog_type must be 1 or 2, found {other}")).at(at, "");
                    return Err(self.report(d.hint("1 is everywhere, 2 lies on the ground")));
                }
            },
            Word::Distance => fog.distance = Some(self.within("distance of fog", 0.0, f64::MAX)?),
            Word::FogOffset => fog.offset = self.finite("fog_offset")?,
            Word::FogAlt => fog.alt = self.finite("fog_alt")?,
            Word::Up => {
                fog.up = self.vec3("up")?;
                if fog.up == DVec3::ZERO {
                    return Err(self.error("P0311", at, "up must not be the zero vector"));
                }
            }
            Word::Turbulence => {
                fog.turbulence = Some(tok.span);
                self.expr()?;
            }
            Word::TurbDepth | Word::Octaves | Word::Omega | Word::Lambda => self.skip_arguments()?,
            _ => return Err(self.unexpected("`fog`", &[FOG_TEXTS, TRANSFORM_TEXTS].concat(), tok)),
        }
        Ok(())
    }

    /// Fogs that there are; one of distance 0 is switched off.
    pub(super) fn emit_fogs(&mut self, out: &mut Scene) {
        for fog in std::mem::take(&mut self.scene.fogs) {
            let Some(distance) = fog.distance else {
                let d =
                    Diagnostic::warning("P0414", "fog without `distance` is not there, as in POV-Ray").at(fog.span, "");
                self.report(d.hint("give the way on which 37 % of what lies behind is left"));
                continue;
            };
            if distance == 0.0 {
                self.note_idle("fog", "its distance is 0, which switches it off", fog.span);
                continue;
            }
            if fog.is_ground && fog.alt == 0.0 {
                let d = Diagnostic::error("P0311", "fog on the ground needs a `fog_alt` other than 0").at(fog.span, "");
                self.report(d.hint("it is the height above `fog_offset` at which half of the fog is left"));
                continue;
            }
            let [r, g, b, filter, transmit] = fog.color;
            if DVec3::new(r, g, b).min_element() < 0.0 {
                self.error("P0311", fog.span, "colour of fog must not be negative");
                continue;
            }
            if let Some(at) = fog.turbulence {
                let message = "`turbulence` of fog is not supported yet and is left out";
                self.warn_once("P0409", at, message);
            }
            if filter != 0.0 || transmit != 0.0 {
                let message = "`filter` and `transmit` of a fog's colour are not supported yet and are left out";
                self.warn_once("P0409", fog.span, message);
            }
            // A negative height turns POV-Ray's fog upside down.
            let up = fog.up.normalize_or(DVec3::Y) * fog.alt.signum();
            out.fogs.push(Fog {
                color: self.linear(DVec3::new(r, g, b)),
                distance,
                ground: fog.is_ground.then(|| GroundFog {
                    up,
                    offset: fog.offset * fog.alt.signum(),
                    falloff: fog.alt.abs(),
                }),
                place: Place::Text(fog.span),
            });
        }
    }
}
