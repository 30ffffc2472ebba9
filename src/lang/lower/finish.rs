//! `finish { … }`.

use crate::lang::desc::{Desc, FinishDesc};
use crate::lang::eval::{Interp, Parsed, Stop, T, Value};
use crate::lang::syntax::Word;
use crate::scene::FinishReflection;
use glam::DVec3;
use std::rc::Rc;

const FINISH_TEXTS: &[&str] = &[
    "ambient",
    "diffuse",
    "emission",
    "brilliance",
    "phong",
    "phong_size",
    "specular",
    "roughness",
    "metallic",
    "reflection",
    "conserve_energy",
    "crand",
    "irid",
    "subsurface",
    "albedo",
];

impl Interp<'_> {
    /// A finish, beginning with its word, from the default.
    pub fn finish(&mut self) -> Parsed<Rc<FinishDesc>> {
        let base = self.default_layer().finish.clone();
        self.finish_over(base)
    }

    /// A finish, beginning with its word, that changes another one.
    pub fn finish_over(&mut self, base: Rc<FinishDesc>) -> Parsed<Rc<FinishDesc>> {
        self.bump();
        self.block(|s| {
            let mut f = (*base).clone();
            loop {
                let tok = s.peek_item();
                let w = match tok.t {
                    T::Mark(b'}') | T::End => return Ok(Rc::new(f)),
                    T::Mark(b',') => {
                        s.bump();
                        continue;
                    }
                    T::Name(n) if s.scopes.get(n).is_some() => {
                        match s.take_value()? {
                            Value::Desc(Desc::Finish(named)) => f = (*named).clone(),
                            Value::Poison => return Err(Stop),
                            other => {
                                let message = format!("expected a finish, found {}", other.kind());
                                return Err(s.error("P0303", tok.span, message));
                            }
                        }
                        continue;
                    }
                    T::Word(w) => w,
                    _ => return Err(s.unexpected("`finish`", FINISH_TEXTS, tok)),
                };
                s.bump();
                match w {
                    Word::Ambient => f.ambient = s.finish_color()?,
                    Word::Emission => f.emission = s.finish_color()?,
                    Word::Diffuse => {
                        s.albedo();
                        f.diffuse = [s.finite("diffuse")?, 0.0];
                        if s.eat(b',') || matches!(s.peek().t, T::Number(_)) {
                            f.diffuse[1] = s.finite("diffuse")?;
                        }
                    }
                    Word::Brilliance => f.brilliance = s.finite("brilliance")?,
                    Word::Phong => {
                        s.albedo();
                        f.phong = s.finite("phong")?;
                    }
                    Word::PhongSize => f.phong_size = s.finite("phong_size")?,
                    Word::Specular => {
                        s.albedo();
                        f.specular = s.finite("specular")?;
                    }
                    Word::Roughness => {
                        let at = s.peek().span;
                        f.roughness = s.finite("roughness")?;
                        if f.roughness <= 0.0 {
                            s.moved(at, "roughness of a highlight must be positive, taken as 0.0001");
                            f.roughness = 1e-4;
                        }
                    }
                    Word::Metallic => f.metallic = s.optional_number(1.0)?,
                    Word::Reflection => f.reflection = s.reflection()?,
                    Word::ReflectionExponent => {
                        s.finite("reflection_exponent")?;
                    }
                    Word::ConserveEnergy => f.conserve_energy = s.flag()?,
                    Word::Crand | Word::Ior | Word::Refraction | Word::Fresnel => {
                        s.skip_arguments()?;
                    }
                    Word::Irid | Word::Subsurface => {
                        s.warn_once(
                            "P0409",
                            tok.span,
                            format!("`{}` is not supported yet and is left out", w.text()),
                        );
                        s.skip_arguments()?;
                    }
                    Word::UseAlpha => {
                        s.flag()?;
                    }
                    _ => return Err(s.unexpected("`finish`", FINISH_TEXTS, tok)),
                }
            }
        })
    }

    /// `albedo` before an amount: our lobes are normalised anyway.
    fn albedo(&mut self) {
        self.eat_word(Word::Albedo);
    }

    /// An amount per channel: a colour, or a number for all.
    fn finish_color(&mut self) -> Parsed<DVec3> {
        let [r, g, b, ..] = self.color()?;
        Ok(DVec3::new(r, g, b))
    }

    fn optional_number(&mut self, default: f64) -> Parsed<f64> {
        if matches!(self.peek().t, T::Number(_) | T::Mark(b'(' | b'-')) || self.starts_expr() {
            return self.finite("amount");
        }
        Ok(default)
    }

    /// `reflection 0.3` or `reflection { a, b falloff f fresnel metallic }`.
    fn reflection(&mut self) -> Parsed<Option<FinishReflection>> {
        let mut r = FinishReflection {
            min: DVec3::ZERO,
            max: DVec3::ZERO,
            falloff: 1.0,
            fresnel: false,
            metallic: 0.0,
        };
        if self.peek().t != T::Mark(b'{') {
            r.min = self.finish_color()?;
            r.max = r.min;
            return Ok((r.max != DVec3::ZERO).then_some(r));
        }
        self.block(|s| {
            if s.starts_expr() {
                r.min = s.finish_color()?;
                r.max = r.min;
                s.comma();
                if s.starts_expr() {
                    r.max = s.finish_color()?;
                } else {
                    // One value is the reflectance at every angle.
                }
            }
            loop {
                let tok = s.peek_item();
                match tok.t {
                    T::Mark(b'}') | T::End => return Ok(()),
                    T::Word(Word::Falloff) => {
                        s.bump();
                        r.falloff = s.finite("falloff")?;
                    }
                    T::Word(Word::Fresnel) => {
                        s.bump();
                        r.fresnel = s.flag()?;
                    }
                    T::Word(Word::Metallic) => {
                        s.bump();
                        r.metallic = s.optional_number(1.0)?;
                    }
                    T::Word(Word::Exponent) => {
                        s.bump();
                        s.finite("exponent")?;
                    }
                    T::Mark(b',') => {
                        s.bump();
                    }
                    _ => {
                        return Err(s.unexpected("`reflection`", &["falloff", "fresnel", "metallic", "exponent"], tok));
                    }
                }
            }
        })?;
        Ok((r.max != DVec3::ZERO || r.min != DVec3::ZERO).then_some(r))
    }
}
