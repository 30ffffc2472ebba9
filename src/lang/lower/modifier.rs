//! What follows a shape: looks, transforms, visibility.

use crate::lang::desc::{Layer, Look, ObjectDesc, ShapeDesc};
use crate::lang::eval::{Interp, Parsed, T, Tok};
use crate::lang::syntax::Word;
use glam::DAffine3;
use std::rc::Rc;

/// Layers of one texture.
const MAX_LAYERS: usize = 200;

impl Interp<'_> {
    /// Reads one modifier; false if the token begins none.
    pub fn modifier(&mut self, object: &mut ObjectDesc, tok: Tok) -> Parsed<bool> {
        let w = match tok.t {
            T::Word(w) => w,
            // `sphere { 0, 1 Gold }`: POV-Ray wants the word, we take a declared look as well.
            T::Name(_) => return self.named_look(object),
            _ => return Ok(false),
        };
        if let Some(t) = self.transform_word(w)? {
            object.transform = t * object.transform;
            self.check_transform(&object.transform, tok)?;
            return Ok(true);
        }
        match w {
            Word::Texture => {
                let new = self.texture()?;
                if object.look.layers.as_ref().map_or(0, |l| l.len()) + new.len() > MAX_LAYERS {
                    let message = format!("texture has more than {MAX_LAYERS} layers");
                    return Err(self.error("P0605", tok.span, message));
                }
                add_layers(&mut object.look, &new);
            }
            Word::Pigment => {
                let base = self.top_layer(&object.look).pigment.clone();
                let pigment = self.pigment_over(base)?;
                self.edit_layer(&mut object.look, tok, |l| l.pigment = pigment);
            }
            Word::Finish => {
                let base = self.top_layer(&object.look).finish.clone();
                let finish = self.finish_over(base)?;
                self.edit_layer(&mut object.look, tok, |l| l.finish = finish);
            }
            Word::Normal => {
                let normal = Some(self.normal()?);
                self.edit_layer(&mut object.look, tok, |l| l.normal = normal);
            }
            Word::Material => {
                let look = self.material()?;
                apply_look(&mut object.look, look);
            }
            Word::Interior => {
                let base = object.look.interior.clone().unwrap_or_default();
                object.look.interior = Some(self.interior_over(base)?);
            }
            Word::NoShadow => {
                self.bump();
                object.visibility.shadow = false;
            }
            Word::NoImage => {
                self.bump();
                object.visibility.camera = false;
            }
            Word::NoReflection => {
                self.bump();
                object.visibility.indirect = false;
            }
            Word::Inverse => {
                self.bump();
                invert(object);
            }
            Word::UvMapping => {
                self.bump();
                use_uv(&mut object.look);
            }
            Word::Hollow => {
                self.bump();
                object.look.hollow = self.flag()?;
                if object.look.hollow {
                    hollow_parts(object);
                }
            }
            Word::Open | Word::Sturm | Word::Hierarchy | Word::DoubleIlluminate => {
                self.bump();
                self.flag()?;
            }
            Word::CutawayTextures | Word::SplitUnion | Word::NoRadiosity => {
                self.bump();
                self.flag()?;
            }
            Word::BoundedBy | Word::Photons | Word::Radiosity => {
                self.bump();
                self.skip_block()?;
            }
            Word::ClippedBy => {
                self.warn_once("P0409", tok.span, "`clipped_by` is not supported yet and is left out");
                self.bump();
                self.skip_block()?;
            }
            Word::InteriorTexture => {
                self.warn_once(
                    "P0409",
                    tok.span,
                    "`interior_texture` is not supported yet and is left out",
                );
                self.bump();
                self.skip_block()?;
            }
            _ => return Ok(false),
        }
        Ok(true)
    }

    /// A transform that can be undone; overflow and underflow along the way are errors.
    pub fn check_transform(&mut self, t: &DAffine3, tok: Tok) -> Parsed<()> {
        if crate::lang::transform::is_invertible(t) {
            return Ok(());
        }
        Err(self.error(
            "P0310",
            tok.span,
            "transforms leave the range of numbers: the object vanishes or is infinite",
        ))
    }

    fn named_look(&mut self, object: &mut ObjectDesc) -> Parsed<bool> {
        use crate::lang::desc::Desc;
        use crate::lang::eval::Value;
        let tok = self.peek();
        let T::Name(name) = tok.t else { return Ok(false) };
        let Some(Value::Desc(desc)) = self.scopes.get(name).cloned() else {
            return Ok(false);
        };
        self.note_read(name);
        match desc {
            Desc::Texture(layers) => add_layers(&mut object.look, &layers),
            Desc::Material(look) => apply_look(&mut object.look, look),
            Desc::Interior(i) => object.look.interior = Some(i),
            Desc::Pigment(p) => self.edit_layer(&mut object.look, tok, |l| l.pigment = p),
            Desc::Normal(n) => self.edit_layer(&mut object.look, tok, |l| l.normal = Some(n)),
            Desc::Finish(f) => self.edit_layer(&mut object.look, tok, |l| l.finish = f),
            Desc::Transform(t) => object.transform = t * object.transform,
            _ => return Ok(false),
        }
        self.bump();
        Ok(true)
    }

    fn top_layer(&mut self, look: &Look) -> Rc<Layer> {
        let top = look.layers.as_ref().and_then(|l| l.last().cloned());
        top.unwrap_or_else(|| self.default_layer())
    }

    /// Changes the top layer, which starts as the default texture.
    fn edit_layer(&mut self, look: &mut Look, tok: Tok, edit: impl FnOnce(&mut Layer)) {
        let mut layer = (*self.top_layer(look)).clone();
        layer.span = Some(tok.span);
        edit(&mut layer);
        let mut layers = look.layers.as_ref().map(|l| l.to_vec()).unwrap_or_default();
        layers.pop();
        layers.push(Rc::new(layer));
        look.layers = Some(layers.into());
        look.surface = None;
    }
}

/// A texture given to something that has one lies on top of it.
fn add_layers(look: &mut Look, new: &[Rc<Layer>]) {
    let mut layers = look.layers.as_ref().map(|l| l.to_vec()).unwrap_or_default();
    layers.extend(new.iter().cloned());
    look.layers = Some(layers.into());
    look.surface = None;
}

/// `uv_mapping` of an object holds for the pigments it has.
fn use_uv(look: &mut Look) {
    let Some(layers) = &look.layers else { return };
    let mapped = layers.iter().map(|l| {
        let mut layer = (**l).clone();
        Rc::make_mut(&mut layer.pigment).uv = true;
        if let Some(normal) = &mut layer.normal {
            Rc::make_mut(normal).uv = true;
        }
        Rc::new(layer)
    });
    look.layers = Some(mapped.collect());
}

/// A hollow union's parts are hollow.
fn hollow_parts(object: &mut ObjectDesc) {
    let ShapeDesc::Union(parts) = &object.shape else { return };
    let shows_media = |part: &ObjectDesc| part.look.interior.as_ref().is_some_and(|i| !i.media.is_empty());
    if !parts.iter().any(|part| shows_media(part) && !part.look.hollow) {
        return; // shared as it is
    }
    let hollow = parts.iter().map(|part| {
        let mut part = (**part).clone();
        part.look.hollow = true;
        Rc::new(part)
    });
    object.shape = ShapeDesc::Union(hollow.collect());
}

/// A material replaces what it says something about.
pub(super) fn apply_look(look: &mut Look, new: Look) {
    if !new.is_bare() {
        look.layers = new.layers;
        look.surface = new.surface;
    }
    if new.interior.is_some() {
        look.interior = new.interior;
    }
}

/// Only a plane looks different from its other side: glass and emission know where the inside is.
fn invert(object: &mut ObjectDesc) {
    use crate::scene::Shape;
    if let ShapeDesc::Primitive(shape) = &object.shape
        && let Shape::Plane { normal, distance } = **shape
    {
        object.shape = ShapeDesc::Primitive(Rc::new(Shape::Plane {
            normal: -normal,
            distance: -distance,
        }));
    }
}
