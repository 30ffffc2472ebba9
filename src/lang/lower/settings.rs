//! `global_settings { … }` and `render { … }`.

use crate::diag::{Diagnostic, Span};
use crate::lang::desc::Gamma;
use crate::lang::eval::{Interp, Parsed, Stop, T};
use crate::lang::syntax::Word;
use crate::scene::FilterKind;
use glam::DVec3;

const RENDER_TEXTS: &[&str] = &[
    "resolution",
    "spp",
    "error",
    "confidence",
    "time",
    "max_depth",
    "seed",
    "filter",
    "shutter",
];
const GLOBAL_TEXTS: &[&str] = &[
    "assumed_gamma",
    "ambient_light",
    "max_trace_level",
    "max_intersections",
    "adc_bailout",
    "radiosity",
    "photons",
    "charset",
    "irid_wavelength",
    "hf_gray_16",
    "noise_generator",
    "number_of_waves",
    "subsurface",
    "mm_per_unit",
];

impl Interp<'_> {
    /// `global_settings { … }`: gamma and ambient light count, the rest is effort or not ours.
    pub fn global_settings(&mut self) -> Parsed<()> {
        self.bump();
        self.block(|s| {
            loop {
                let tok = s.peek_item();
                match tok.t {
                    T::Mark(b'}') | T::End => return Ok(()),
                    T::Mark(b',') => {
                        s.bump();
                    }
                    T::Word(Word::AssumedGamma) => {
                        s.bump();
                        s.assumed_gamma()?;
                    }
                    T::Word(Word::AmbientLight) => {
                        s.bump();
                        let [r, g, b, ..] = s.color()?;
                        s.scene.ambient_light = Some(DVec3::new(r, g, b));
                    }
                    T::Word(Word::Charset) => {
                        s.bump();
                        s.bump();
                    }
                    T::Word(
                        Word::MaxTraceLevel
                        | Word::MaxIntersections
                        | Word::AdcBailout
                        | Word::IridWavelength
                        | Word::NoiseGenerator
                        | Word::NumberOfWaves
                        | Word::HfGray16,
                    ) => {
                        s.bump();
                        s.skip_arguments()?;
                    }
                    T::Word(w @ (Word::Radiosity | Word::Photons | Word::Subsurface)) => {
                        if w != Word::Radiosity {
                            let d = Diagnostic::note(
                                "P0411",
                                format!("`{}` has no meaning in path tracing, skipped", w.text()),
                            );
                            s.report(d.at(tok.span, ""));
                        }
                        s.bump();
                        s.skip_block()?;
                    }
                    T::Name(_) if s.eat_word_text("mm_per_unit") => s.skip_arguments()?,
                    _ => return Err(s.unexpected("`global_settings`", GLOBAL_TEXTS, tok)),
                }
            }
        })
    }

    fn assumed_gamma(&mut self) -> Parsed<()> {
        if self.eat_word(Word::Srgb) {
            self.scene.gamma = Some(Gamma::Srgb);
            return Ok(());
        }
        let at = self.peek().span;
        let gamma = self.finite("assumed_gamma")?;
        if gamma <= 0.0 {
            return Err(self.error("P0311", at, format!("assumed_gamma must be positive, found {gamma}")));
        }
        self.scene.gamma = Some(if gamma == 1.0 {
            Gamma::Linear
        } else {
            Gamma::Power(gamma)
        });
        Ok(())
    }

    /// How written colours relate to linear light: as `assumed_gamma` says, else linear.
    pub fn gamma(&self) -> Gamma {
        self.scene.gamma.unwrap_or(Gamma::Linear)
    }

    /// Whether the picture is shown as computed: an old scene that says nothing about gamma.
    pub fn display_is_linear(&self) -> bool {
        self.scene.gamma.is_none() && self.scene_version < 3.7
    }

    /// A linear value as the scene would write it.
    pub fn working_from_linear(&self, v: f64) -> f64 {
        match self.gamma() {
            Gamma::Linear => v,
            Gamma::Power(g) => v.abs().powf(1.0 / g).copysign(v),
            Gamma::Srgb => crate::math::color::srgb_from_linear(v),
        }
    }

    /// A written colour as linear light.
    pub fn linear(&self, c: DVec3) -> DVec3 {
        match self.gamma() {
            Gamma::Linear => c,
            Gamma::Power(g) => DVec3::from_array(c.to_array().map(|v| v.abs().powf(g).copysign(v))),
            Gamma::Srgb => crate::math::color::linear_from_srgb_rgb(c),
        }
    }

    /// `render { … }`.
    pub fn render_block(&mut self) -> Parsed<()> {
        self.bump();
        self.block(|s| {
            let depth = s.depth();
            let mut failed = false;
            loop {
                let tok = s.peek_item();
                match tok.t {
                    T::Mark(b'}') | T::End => break,
                    T::Mark(b',' | b';') => {
                        s.bump();
                        continue;
                    }
                    _ => {}
                }
                let before = s.steps();
                if s.render_item(tok.span).is_err() {
                    failed = true;
                    s.recover(
                        depth,
                        before,
                        &[Word::Resolution, Word::Spp, Word::Error, Word::Time, Word::Seed],
                    );
                }
            }
            if failed { Err(Stop) } else { Ok(()) }
        })
    }

    fn render_item(&mut self, span: Span) -> Parsed<()> {
        let tok = self.peek();
        let T::Word(w) = tok.t else {
            return Err(self.unexpected("`render`", RENDER_TEXTS, tok));
        };
        if !RENDER_TEXTS.contains(&w.text()) {
            return Err(self.unexpected("`render`", RENDER_TEXTS, tok));
        }
        self.bump();
        match w {
            Word::Resolution => {
                let at = self.peek().span;
                let v = self.expr()?;
                let size = |v: f64| (v.fract() == 0.0 && (1.0..=65_536.0).contains(&v)).then_some(v as u32);
                let (Some(width), Some(height), 2) = (size(v.v[0]), size(v.v[1]), v.len) else {
                    let message = "resolution must be two whole numbers from 1 to 65536, as in `<800, 600>`";
                    return Err(self.error("P0317", at, message));
                };
                if let (Some(used), None) = (self.size_used, self.options.width.or(self.options.height)) {
                    let d = Diagnostic::error("P0317", "resolution comes after the image's size was used").at(span, "");
                    let d = d.with_context(used, "used here").hint("put `render { … }` before it");
                    return Err(self.report(d));
                }
                self.scene.defaults.resolution = Some([width, height]);
            }
            Word::Spp => self.scene.defaults.spp = Some(self.count("spp", f64::from(u32::MAX))? as u32),
            Word::MaxDepth => {
                self.scene.defaults.max_depth = Some(self.count("max_depth", f64::from(u32::MAX))? as u32)
            }
            Word::Seed => {
                let at = self.peek().span;
                let v = self.finite("seed")?;
                if v.fract() != 0.0 || !(0.0..=9_007_199_254_740_992.0).contains(&v) {
                    return Err(self.error("P0317", at, format!("seed must be a whole number from 0, found {v}")));
                }
                self.scene.defaults.seed = Some(v as u64);
            }
            Word::Error => self.scene.defaults.error = Some(self.share("error")?),
            Word::Confidence => self.scene.defaults.confidence = Some(self.share("confidence")?),
            Word::Time => self.scene.defaults.time = Some(self.duration()?),
            Word::Shutter => {
                let at = self.peek().span;
                let v = self.finite("shutter")?;
                if v < 0.0 {
                    return Err(self.error("P0317", at, format!("shutter must be 0 or more, found {v}")));
                }
                self.scene.defaults.shutter = Some(v);
            }
            _ => self.scene.defaults.filter = Some(self.filter_kind()?),
        }
        Ok(())
    }

    fn count(&mut self, what: &str, most: f64) -> Parsed<f64> {
        let at = self.peek().span;
        let v = self.finite(what)?;
        if v.fract() != 0.0 || !(1.0..=most).contains(&v) {
            return Err(self.error("P0317", at, format!("{what} must be a whole number from 1, found {v}")));
        }
        Ok(v)
    }

    /// `2%` or `0.02`.
    fn share(&mut self, what: &str) -> Parsed<f64> {
        let at = self.peek().span;
        let mut v = self.finite(what)?;
        if self.eat(b'%') {
            v /= 100.0;
        }
        if !(v > 0.0 && v < 1.0) {
            let d = Diagnostic::error(
                "P0317",
                format!("{what} must lie between 0 and 100 %, found {} %", v * 100.0),
            );
            return Err(self.report(d.at(at, "").hint("write a percentage such as `2%`")));
        }
        Ok(v)
    }

    /// `"90s"`, `"1h30m"`, `"2.5m"` or seconds as a number.
    fn duration(&mut self) -> Parsed<f64> {
        let at = self.peek().span;
        let seconds = if self.starts_text() {
            let text = self.text("time")?;
            parse_duration(&text)
        } else {
            Some(self.finite("time")?)
        };
        match seconds.filter(|s| *s > 0.0 && s.is_finite()) {
            Some(s) => Ok(s),
            None => Err(self.error(
                "P0317",
                at,
                "time must be positive, as in `\"90s\"`, `\"2.5m\"` or `\"1h30m\"`",
            )),
        }
    }

    fn filter_kind(&mut self) -> Parsed<FilterKind> {
        let tok = self.peek();
        let kinds = [
            ("box", FilterKind::Box),
            ("gaussian", FilterKind::Gaussian),
            ("blackman_harris", FilterKind::BlackmanHarris),
        ];
        for (text, kind) in kinds {
            if self.eat_word_text(text) {
                return Ok(kind);
            }
        }
        if self.starts_text() {
            let text = self.text("filter")?.replace('-', "_");
            if let Some(k) = kinds.iter().find(|k| k.0 == text) {
                return Ok(k.1);
            }
        }
        Err(self.unexpected("`filter`", &["box", "gaussian", "blackman_harris"], tok))
    }
}

/// Seconds of `1h30m`, `90s`, `2.5m`, `90`; `None` if it is none of these.
fn parse_duration(text: &str) -> Option<f64> {
    let mut rest = text.trim();
    if let Ok(v) = rest.parse() {
        return Some(v);
    }
    let mut total = 0.0;
    while !rest.is_empty() {
        let digits = rest.find(|c: char| !(c.is_ascii_digit() || c == '.'))?;
        let (number, tail) = rest.split_at(digits);
        let end = tail
            .find(|c: char| c.is_ascii_digit() || c == '.')
            .unwrap_or(tail.len());
        let (unit, next) = tail.split_at(end);
        let factor = match unit.trim() {
            "ms" => 1e-3,
            "s" | "sec" => 1.0,
            "m" | "min" => 60.0,
            "h" => 3600.0,
            "d" => 86_400.0,
            _ => return None,
        };
        total += number.parse::<f64>().ok()? * factor;
        rest = next;
    }
    Some(total)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_are_read_in_common_forms() {
        assert_eq!(parse_duration("90s"), Some(90.0));
        assert_eq!(parse_duration("1h30m"), Some(5400.0));
        assert_eq!(parse_duration("2.5m"), Some(150.0));
        assert_eq!(parse_duration("12"), Some(12.0));
        assert_eq!(parse_duration("soon"), None);
        assert_eq!(parse_duration("5 apples"), None);
    }
}
