//! `image_map { png "file" … }`.

use crate::lang::desc::ImageDesc;
use crate::lang::eval::{Interp, Parsed, T};
use crate::lang::syntax::Word;
use glam::DAffine3;
use std::path::Path;
use std::rc::Rc;

impl Interp<'_> {
    /// An image map, beginning with its word. `None` if it names no file (a function's image, for instance).
    pub fn image_map(&mut self) -> Parsed<Option<Rc<ImageDesc>>> {
        self.bump();
        let mut image = None;
        if self.peek().t != T::Mark(b'{') {
            self.image_items(&mut image, false)?; // `image_map png "file"`, the old form
            return Ok(image.map(Rc::new));
        }
        self.block(|s| {
            s.image_items(&mut image, false)?;
            let depth = s.depth();
            // What is left (gamma, an image function's numbers) does not change what is shown.
            while !(s.peek().t == T::Mark(b'}') && s.depth() == depth) && s.peek().t != T::End {
                s.bump();
            }
            Ok(image.map(Rc::new))
        })
    }

    /// A bump map, beginning with its word: the image of heights, and `bump_size` if it is written here.
    pub fn bump_map(&mut self, size: &mut f64) -> Parsed<Option<Rc<ImageDesc>>> {
        self.bump();
        self.block(|s| {
            let depth = s.depth();
            let mut image = None;
            loop {
                s.image_items(&mut image, false)?;
                match s.peek().t {
                    T::End => return Ok(image.map(Rc::new)),
                    T::Mark(b'}') if s.depth() == depth => return Ok(image.map(Rc::new)),
                    T::Word(Word::BumpSize) => {
                        s.bump();
                        *size = s.finite("bump_size")?;
                    }
                    _ => {
                        s.bump();
                    }
                }
            }
        })
    }

    /// The file and what is known to change it; stops at the first word that is not. `smooth`: texels are interpolated
    /// where nothing is said.
    pub(super) fn image_items(&mut self, image: &mut Option<ImageDesc>, smooth: bool) -> Parsed<()> {
        loop {
            let tok = self.peek();
            match tok.t {
                _ if image.is_none() && self.starts_text() => {
                    let name = self.text("the image's file")?.to_string();
                    let path = self.locate(&name, tok.span, &["", ".png", ".jpg"])?;
                    self.name_file("image", path.as_deref().unwrap_or(Path::new(&name)), tok.span);
                    *image = Some(ImageDesc {
                        name,
                        path,
                        once: false,
                        smooth,
                        channel: None,
                        transform: DAffine3::IDENTITY,
                        span: tok.span,
                    });
                }
                T::Word(
                    Word::Gif
                    | Word::Tga
                    | Word::Png
                    | Word::Jpeg
                    | Word::Tiff
                    | Word::Ppm
                    | Word::Pgm
                    | Word::Pot
                    | Word::Sys,
                ) => {
                    self.bump();
                }
                // Types that POV-Ray has no word for, or that are newer than our table.
                T::Name(n) if image.is_none() && self.scopes.get(n).is_none() && self.raw_is_text(1) => {
                    self.bump();
                }
                T::Word(Word::Once) => {
                    self.bump();
                    if let Some(i) = image {
                        i.once = true;
                    }
                }
                T::Word(Word::Interpolate) => {
                    self.bump();
                    let method = self.finite("interpolation")?;
                    if let Some(i) = image {
                        i.smooth = method > 0.0;
                    }
                }
                T::Word(Word::MapType | Word::UseIndex | Word::UseColor | Word::UseAlpha) => {
                    self.bump();
                    self.skip_arguments()?;
                }
                T::Word(Word::Filter | Word::Transmit) => {
                    self.bump();
                    self.eat_word(Word::All);
                    self.skip_arguments()?;
                }
                T::Mark(b',') => {
                    self.bump();
                }
                _ => return Ok(()),
            }
        }
    }
}
