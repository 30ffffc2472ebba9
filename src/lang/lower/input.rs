//! What varies over the language's own materials: colours and numbers that come from images, and normal maps.
//!
//! `0.8 * image_map { "rough.png" channel g }`: a factor, a source, a channel. An image that stands here by itself goes by
//! the surface's own coordinates and is interpolated; inside of a `pigment { … }` POV-Ray's rules hold.

use super::transform::TRANSFORM_TEXTS;
use crate::diag::Diagnostic;
use crate::lang::desc::{Desc, ImageDesc, NormalMapDesc, NumberDesc, Pigment};
use crate::lang::eval::{ImageFactor, Interp, Parsed, T, Value};
use crate::lang::syntax::Word;
use crate::scene::Channel;
use glam::DVec3;
use std::rc::Rc;

const IMAGE_TEXTS: &[&str] = &["png", "jpeg", "once", "interpolate", "channel"];
const CHANNEL: &str = "a channel: r, g, b or a";

/// What messages call a range.
fn range(min: f64, max: f64) -> String {
    match (min, max) {
        (_, f64::MAX) if min == f64::MIN_POSITIVE => "positive".to_owned(),
        (_, f64::MAX) => format!("at least {min}"),
        _ => format!("between {min} and {max}"),
    }
}

fn rgb([r, g, b, ..]: [f64; 5]) -> DVec3 {
    DVec3::new(r, g, b)
}

impl Interp<'_> {
    /// A number in a range; outside is an error, not a clamp.
    pub fn within(&mut self, what: &str, min: f64, max: f64) -> Parsed<f64> {
        let at = self.peek().span;
        let v = self.finite(what)?;
        if !(min..=max).contains(&v) {
            let message = format!("{what} must be {}, found {v}", range(min, max));
            return Err(self.error("P0311", at, message));
        }
        Ok(v)
    }

    /// A colour, `pigment { … }`, or an image, with a factor before or behind it.
    pub fn color_source(&mut self) -> Parsed<Rc<Pigment>> {
        self.refuse_bare_text()?;
        let mut tint = DVec3::ONE;
        if !self.begins_source() {
            let (color, met) = self.before_image(|s| s.color())?;
            match met {
                ImageFactor::Met(None) => tint = rgb(color),
                ImageFactor::Met(Some((_, at))) => {
                    let d = Diagnostic::error("P0303", "nothing can be added to the colours of an image").at(at, "");
                    return Err(self.report(d));
                }
                _ => return Ok(Rc::new(Pigment::plain(color))),
            }
        }
        let mut pigment = self.source()?;
        while self.eat(b'*') {
            tint *= match self.starts_color() {
                true => rgb(self.color()?),
                false => rgb(self.unary()?.five()),
            };
        }
        if tint != DVec3::ONE {
            Rc::make_mut(&mut pigment).tint *= tint;
        }
        Ok(pigment)
    }

    /// A number, or `offset + factor * image` in any order, where the image may be a pigment. `channel` is taken where
    /// none is named. All values that this can give must be in the range.
    pub fn number_source(&mut self, what: &str, (min, max): (f64, f64), channel: Channel) -> Parsed<NumberDesc> {
        self.refuse_bare_text()?;
        let at = self.peek().span;
        let mut number = NumberDesc::from(1.0);
        if !self.begins_source() {
            let (value, met) = self.before_image(|s| s.finite(what))?;
            number.factor = value;
            if let ImageFactor::Met(added) = met {
                number.offset = added.map_or(0.0, |a| a.0);
            } else if (min..=max).contains(&value) {
                return Ok(number);
            } else {
                let message = format!("{what} must be {}, found {value}", range(min, max));
                return Err(self.error("P0311", at, message));
            }
        }
        let pigment = self.source()?;
        let named = pigment.image.as_ref().and_then(|i| i.channel);
        let mut channel = named.unwrap_or(channel);
        loop {
            match self.peek().t {
                T::Mark(b'*') => {
                    self.bump();
                    number.factor *= self.unary()?.v[0];
                }
                T::Mark(sign @ (b'+' | b'-')) => {
                    self.bump();
                    let added = self.unary()?.v[0];
                    number.offset += if sign == b'-' { -added } else { added };
                }
                T::Word(Word::Channel) => channel = self.channel()?,
                _ => break,
            }
        }
        let (a, b) = (number.offset, number.offset + number.factor);
        let (least, most) = (a.min(b), a.max(b));
        if !(least >= min && most <= max) {
            let message = format!("{what} must be {}, found {least} to {most}", range(min, max));
            return Err(self.error("P0311", at, message));
        }
        number.source = Some((pigment, channel));
        Ok(number)
    }

    /// A string where an image may stand: which kind of thing it is has to be said.
    fn refuse_bare_text(&mut self) -> Parsed<()> {
        let tok = self.peek();
        if tok.t != T::Text {
            return Ok(());
        }
        let name = self.text("the image's file")?;
        let d = Diagnostic::error("P0201", "expected a value, found a string").at(tok.span, "");
        Err(self.report(d.hint(format!("an image is `image_map {{ \"{name}\" }}`"))))
    }

    /// Whether an image or a pigment comes next.
    pub fn begins_source(&mut self) -> bool {
        match self.peek().t {
            T::Word(Word::ImageMap | Word::Pigment) => true,
            T::Name(n) => matches!(self.scopes.get(n), Some(Value::Desc(Desc::Pigment(_)))),
            _ => false,
        }
    }

    /// Reads a value that may turn out to be the factor of an image, in front of which it then stops.
    fn before_image<V>(&mut self, read: impl FnOnce(&mut Self) -> Parsed<V>) -> Parsed<(V, ImageFactor)> {
        let outer = std::mem::replace(&mut self.image_factor, ImageFactor::May);
        let value = read(self);
        let met = std::mem::replace(&mut self.image_factor, outer);
        Ok((value?, met))
    }

    /// An image or a pigment.
    fn source(&mut self) -> Parsed<Rc<Pigment>> {
        let tok = self.peek();
        match tok.t {
            T::Word(Word::ImageMap) => Ok(Rc::new(Pigment::on_surface(self.surface_image()?))),
            T::Name(name) => match self.scopes.get(name).cloned() {
                Some(Value::Desc(Desc::Pigment(p))) => {
                    self.note_read(name);
                    self.bump();
                    Ok(p)
                }
                _ => Err(self.expected_not("an image or a pigment", tok)),
            },
            _ => self.pigment(),
        }
    }

    /// `image_map { "file" … }` on the surface's own coordinates, beginning with its word.
    pub fn surface_image(&mut self) -> Parsed<Rc<ImageDesc>> {
        let word = self.peek();
        if word.t != T::Word(Word::ImageMap) {
            return Err(self.expected_not("`image_map { … }`", word));
        }
        self.bump();
        if self.peek().t != T::Mark(b'{') {
            let mut image = None;
            self.image_items(&mut image, true)?;
            return self.needed(image, word.span);
        }
        self.block(|s| {
            let mut image = None;
            while s.image_item(&mut image, true)? {}
            s.needed(image, word.span)
        })
    }

    fn needed(&mut self, image: Option<ImageDesc>, at: crate::diag::Span) -> Parsed<Rc<ImageDesc>> {
        match image {
            Some(image) => Ok(Rc::new(image)),
            None => Err(self.error("P0201", at, "the image names no file")),
        }
    }

    /// One thing that is said of an image; false at the end of its block. `moves`: transforms are the image's.
    fn image_item(&mut self, image: &mut Option<ImageDesc>, moves: bool) -> Parsed<bool> {
        self.image_items(image, true)?;
        let tok = self.peek_item();
        match tok.t {
            T::Mark(b'}') | T::End => return Ok(false),
            T::Word(Word::Channel) => {
                let channel = self.channel()?;
                image.iter_mut().for_each(|i| i.channel = Some(channel));
            }
            T::Name(_) if self.eat_word_text("gamma") => self.skip_arguments()?, // the use of an image says what it holds
            T::Word(w) if moves => match self.transform_word(w)? {
                Some(t) => image.iter_mut().for_each(|i| i.transform = t * i.transform),
                None => return Err(self.unexpected("`image_map`", &[IMAGE_TEXTS, TRANSFORM_TEXTS].concat(), tok)),
            },
            _ => return Err(self.unexpected("`image_map`", &[IMAGE_TEXTS, TRANSFORM_TEXTS].concat(), tok)),
        }
        Ok(true)
    }

    /// `channel r`, beginning with the word.
    fn channel(&mut self) -> Parsed<Channel> {
        self.bump();
        for (texts, channel) in [
            (["r", "red"], Channel::R),
            (["g", "green"], Channel::G),
            (["b", "blue"], Channel::B),
            (["a", "alpha"], Channel::A),
        ] {
            if texts.iter().any(|text| self.eat_word_text(text)) {
                return Ok(channel);
            }
        }
        let tok = self.peek();
        let d = Diagnostic::error("P0201", format!("expected {CHANNEL}, found {}", self.describe(tok)));
        Err(self.report(d.at(tok.span, "")))
    }

    /// `normal_map { "file" scale s }` or `clearcoat_normal { … }`, behind its word.
    pub fn tangent_normals(&mut self, place: &str) -> Parsed<NormalMapDesc> {
        let word = self.here();
        self.block(|s| {
            let (mut image, mut scale) = (None, 1.0);
            loop {
                let tok = s.peek_item();
                match tok.t {
                    T::Word(Word::ImageMap) => image = Some(s.surface_image()?),
                    T::Word(Word::Scale) => {
                        s.bump();
                        scale = s.finite("scale of the normal map")?;
                    }
                    T::Mark(b'}') | T::End => break,
                    _ => {
                        let before = s.steps();
                        let mut own = image.as_deref().cloned();
                        s.image_items(&mut own, true)?;
                        if s.steps() == before {
                            let texts = ["png", "image_map", "scale", "once", "interpolate"];
                            return Err(s.unexpected(&format!("`{place}`"), &texts, tok));
                        }
                        image = own.map(Rc::new);
                    }
                }
            }
            match image {
                Some(image) => Ok(NormalMapDesc { image, scale }),
                None => Err(s.error("P0201", word, format!("`{place}` names no file"))),
            }
        })
    }
}
