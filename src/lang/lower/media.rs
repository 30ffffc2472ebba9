//! `media { … }` and `density { … }`.

use crate::diag::Diagnostic;
use crate::lang::desc::{Desc, MediaDesc, Pigment};
use crate::lang::eval::{Interp, Parsed, Stop, T, Value};
use crate::lang::syntax::Word;
use crate::scene::{Medium, Phase};
use glam::DVec3;
use std::rc::Rc;

/// Words of a medium, for suggestions.
const MEDIA_TEXTS: &[&str] = &[
    "absorption",
    "emission",
    "scattering",
    "density",
    "method",
    "intervals",
    "samples",
    "confidence",
    "variance",
    "ratio",
    "jitter",
    "aa_level",
    "aa_threshold",
];

impl Interp<'_> {
    /// A medium, beginning with its word.
    pub fn media(&mut self) -> Parsed<Rc<MediaDesc>> {
        let span = self.bump().span;
        self.block(|s| {
            let mut m = MediaDesc::new(span);
            loop {
                let tok = s.peek_item();
                let w = match tok.t {
                    T::Mark(b'}') | T::End => return Ok(Rc::new(m)),
                    T::Mark(b',') => {
                        s.bump();
                        continue;
                    }
                    T::Name(n) if s.scopes.get(n).is_some() => {
                        match s.take_value()? {
                            Value::Desc(Desc::Media(named)) => {
                                m = MediaDesc {
                                    span,
                                    ..(*named).clone()
                                }
                            }
                            Value::Poison => return Err(Stop),
                            other => {
                                let message = format!("expected a medium, found {}", other.kind());
                                return Err(s.error("P0303", tok.span, message));
                            }
                        }
                        continue;
                    }
                    T::Name(_) if s.eat_word_text("aa_level") || s.eat_word_text("aa_threshold") => {
                        m.effort = Some(tok.span);
                        s.skip_arguments()?;
                        continue;
                    }
                    T::Word(w) => w,
                    _ => return Err(s.unexpected("`media`", MEDIA_TEXTS, tok)),
                };
                match w {
                    Word::Density => {
                        let density = s.density()?;
                        let [r, g, b, ..] = density.color;
                        m.density *= DVec3::new(r, g, b);
                        m.pattern = m.pattern.or(density.pattern);
                    }
                    Word::Absorption => {
                        s.bump();
                        m.absorption = s.coefficient("absorption")?;
                    }
                    Word::Emission => {
                        s.bump();
                        m.emission = s.coefficient("emission")?;
                    }
                    Word::Scattering => {
                        s.bump();
                        s.block(|s| s.scattering(&mut m))?;
                    }
                    Word::Method
                    | Word::Intervals
                    | Word::Samples
                    | Word::Confidence
                    | Word::Variance
                    | Word::Ratio
                    | Word::Jitter => {
                        m.effort = Some(tok.span);
                        s.bump();
                        s.skip_arguments()?;
                    }
                    Word::Collect => {
                        s.bump();
                        s.flag()?;
                    }
                    // They would move patterns of density.
                    _ if s.transform_word(w)?.is_some() => {}
                    _ => return Err(s.unexpected("`media`", MEDIA_TEXTS, tok)),
                }
            }
        })
    }

    /// `type, colour [extinction e] [eccentricity g]`.
    fn scattering(&mut self, m: &mut MediaDesc) -> Parsed<()> {
        let at = self.peek().span;
        let kind = self.finite("type of scattering")?;
        self.comma();
        m.scattering = self.coefficient("scattering")?;
        (m.extinction, m.phase) = (1.0, Phase::default());
        let mut eccentricity = 0.0;
        loop {
            let tok = self.peek_item();
            match tok.t {
                T::Mark(b'}') | T::End => break,
                T::Mark(b',') => {
                    self.bump();
                }
                T::Word(Word::Extinction) => {
                    self.bump();
                    m.extinction = self.within("extinction", 0.0, f64::MAX)?;
                }
                T::Word(Word::Eccentricity) => {
                    self.bump();
                    eccentricity = self.eccentricity("eccentricity")?;
                }
                _ => return Err(self.unexpected("`scattering`", &["eccentricity", "extinction"], tok)),
            }
        }
        m.phase = match kind {
            1.0 => Phase::default(),
            2.0 => Phase::Hazy,
            3.0 => Phase::Murky,
            4.0 => Phase::Rayleigh,
            5.0 => Phase::HenyeyGreenstein(eccentricity),
            _ => {
                let d =
                    Diagnostic::error("P0311", format!("type of scattering must be 1 to 5, found {kind}")).at(at, "");
                let types = "1 isotropic, 2 Mie haze, 3 murky Mie, 4 Rayleigh, 5 Henyey–Greenstein";
                return Err(self.report(d.hint(types)));
            }
        };
        Ok(())
    }

    /// A density, beginning with its word: a colour that multiplies coefficients, of patterns the mean.
    pub fn density(&mut self) -> Parsed<Rc<Pigment>> {
        self.bump();
        let at = self.here();
        let white = Rc::new(Pigment::plain([1.0, 1.0, 1.0, 0.0, 0.0]));
        let density = self.block(|s| s.pigment_items(b'}', white))?;
        if density.color.iter().any(|c| *c < 0.0) {
            return Err(self.error("P0311", at, "density must not be negative"));
        }
        Ok(density)
    }

    /// A coefficient per channel and unit of way, ≥ 0. It is no colour that is seen, so gamma does not touch it.
    pub fn coefficient(&mut self, what: &str) -> Parsed<DVec3> {
        let at = self.peek().span;
        let [r, g, b, ..] = self.color()?;
        let v = DVec3::new(r, g, b);
        if v.min_element() < 0.0 {
            return Err(self.error("P0311", at, format!("{what} must not be negative")));
        }
        Ok(v)
    }

    /// Where Henyey and Greenstein's function sends light: −1 back, 1 on, both excluded.
    pub fn eccentricity(&mut self, what: &str) -> Parsed<f64> {
        let at = self.peek().span;
        let g = self.finite(what)?;
        if (g as f32).abs() >= 1.0 {
            // so near to 1 that the engine would count it as 1
            let message = format!("{what} must lie between -1 and 1, both excluded, found {g}");
            return Err(self.error("P0311", at, message));
        }
        Ok(g)
    }

    /// Several media in one place as one.
    pub(super) fn medium_of(&mut self, media: &[Rc<MediaDesc>]) -> Medium {
        let mut all = Medium::default();
        for m in media {
            if m.is_clear() {
                // Solids may share it.
                if self.told_first(&format!("clear medium at {:?}", m.span)) {
                    self.note_idle("medium", "it takes, scatters and emits no light", m.span);
                }
                continue;
            }
            if let Some((word, at)) = m.pattern {
                let message =
                    format!("`{word}` is not supported yet: the medium is as dense everywhere as in the mean");
                self.warn_once("P0412", at, message);
            }
            if let Some(at) = m.effort
                && self.told_first("how media are sampled")
            {
                let message = "how POV-Ray samples media has no meaning in path tracing, skipped";
                self.report(Diagnostic::note("P0411", message).at(at, ""));
            }
            let scattering = m.scattering * m.density;
            // POV-Ray takes `extinction` times what is scattered from the way ahead; the rest is absorbed.
            let mut absorption = m.absorption * m.density + scattering * (m.extinction - 1.0);
            if absorption.min_element() < 0.0 {
                let message = format!(
                    "`extinction {}` takes less from the way ahead than is scattered: read as if nothing were absorbed",
                    m.extinction
                );
                self.moved(m.span, message);
                absorption = absorption.max(DVec3::ZERO);
            }
            all = all.and(&Medium {
                absorption,
                scattering,
                emission: self.linear(m.emission) * m.density,
                phase: m.phase,
            });
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use crate::diag::{Diagnostics, SourceMap};
    use crate::files::MemoryFiles;
    use crate::lang::{LoadOptions, ModelRequest, load_bytes};
    use std::path::Path;

    /// What a scene leaves out, by kind.
    fn left_out(text: &str) -> Vec<&'static str> {
        let (mut sources, mut diags) = (SourceMap::default(), Diagnostics::default());
        let none = |_: &ModelRequest, _: &mut Diagnostics| None;
        let (files, options) = (MemoryFiles::default(), LoadOptions::new(&none));
        let path = Path::new("a.pts");
        let scene = load_bytes(path, text.as_bytes(), &files, &options, &mut sources, &mut diags);
        scene.unwrap_or_default().left_out.iter().map(|l| l.kind).collect()
    }

    #[test]
    fn what_comes_to_nothing_is_told_once() {
        let ball = |inside: &str| format!("sphere {{ 0, 1 hollow pigment {{ rgbt 1 }} interior {{ {inside} }} }}");
        assert_eq!(left_out(&ball("media { scattering { 1, 0 } }")), ["medium"]);
        assert_eq!(left_out(&ball("media { absorption 1 density { rgb 0 } }")), ["medium"]);
        assert_eq!(left_out(&ball("ior 1.5 dispersion 1")), ["dispersion"]);
        assert!(left_out(&ball("ior 1.5 dispersion 1.1 media { absorption 1 }")).is_empty());
        let shared = "#declare I = interior { media { emission 0 } };\n\
            sphere { 0, 1 hollow pigment { rgbt 1 } interior { I } }\n\
            sphere { x, 1 hollow pigment { rgbt <1, 0, 0, 1> } interior { I } }";
        assert_eq!(left_out(shared), ["medium"]);
        assert_eq!(left_out("media { absorption 0 } media { absorption 1 }"), ["medium"]);
    }
}
