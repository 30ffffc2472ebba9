//! One layer of an image as a picture of its own, in false colours where it holds numbers.

use super::Layers;
use crate::math::color::linear_from_srgb;
use crate::pictures::colormap::magma;

/// Which layer is shown, and how.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewKind {
    /// The relative standard error, logarithmic from [`LEAST_ERROR`] (dark) to 1 (bright).
    Error,
    /// The time of a sample, logarithmic between the twentieth parts of pixels that are quickest (dark) and slowest
    /// (bright).
    Time,
    /// n/2 + 1/2 as sRGB numbers: red grows with x, green with y, blue with z; middle grey where nothing is hit.
    Normal,
    /// The albedo as a colour.
    Albedo,
    /// The depth, linear between the hundredth parts of pixels that are nearest (bright) and farthest (dark).
    Depth,
}

/// The relative error that is shown darkest.
pub const LEAST_ERROR: f64 = 1e-3;

/// Times below this, in nanoseconds, are shown as this: no clock tells them apart, and 0 has no logarithm.
const LEAST_TIME: f64 = 1.0;

/// Share of pixels at either end of a scale that are beyond it. One far pixel must not darken all others; of times
/// there are more such, since the machine takes a thread off its pixel now and then.
const BEYOND_DEPTH: f64 = 0.01;
const BEYOND_TIME: f64 = 0.05;

/// A picture of a layer.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// What it shows.
    pub kind: ViewKind,
    /// Linear colours: to be written without tone curve, exposure and dither.
    pub layers: Layers,
    /// The least and the largest number that the colours tell apart, in the layer's unit; `None` for colours that are
    /// no scale, or if there is no number at all.
    pub range: Option<[f64; 2]>,
    /// Pixels without a number, which are grey.
    pub unknown: u64,
}

/// Shows a layer; `None` if the image does not have it.
pub fn view(kind: ViewKind, of: &Layers) -> Option<View> {
    let picture = |rgb: Vec<[f32; 3]>| Layers::from_rgb(of.width, of.height, rgb);
    let colors = |rgb: Vec<[f32; 3]>| View {
        kind,
        layers: picture(rgb),
        range: None,
        unknown: 0,
    };
    let scale = |numbers: &[f32], range: Option<[f64; 2]>, place: &dyn Fn(f64, [f64; 2]) -> f64| {
        let known = range.filter(|_| numbers.iter().any(|v| v.is_finite()));
        let color = |v: &f32| match known {
            Some(range) if v.is_finite() => magma(place(f64::from(*v), range)),
            _ => magma(f64::NAN),
        };
        View {
            kind,
            layers: picture(numbers.iter().map(color).collect()),
            range: known,
            unknown: numbers.iter().filter(|v| !v.is_finite()).count() as u64,
        }
    };
    Some(match kind {
        ViewKind::Error => scale(of.relerr.as_deref()?, Some([LEAST_ERROR, 1.0]), &logarithmic),
        ViewKind::Time => {
            let least = LEAST_TIME as f32;
            let shown = |t: &f32| if *t < least { least } else { *t }; // NaN stays NaN
            let times: Vec<f32> = of.time.as_deref()?.iter().map(shown).collect();
            scale(&times, most_of(&times, BEYOND_TIME), &logarithmic)
        }
        ViewKind::Depth => {
            let depths = of.depth.as_deref()?;
            scale(depths, most_of(depths, BEYOND_DEPTH), &|z, range| {
                1.0 - linear(z, range)
            })
        }
        ViewKind::Normal => {
            let code = |n: f32| linear_from_srgb(f64::from(n) * 0.5 + 0.5) as f32;
            colors(of.normal.as_deref()?.iter().map(|n| n.map(code)).collect())
        }
        ViewKind::Albedo => colors(of.albedo.clone()?),
    })
}

/// The place of a number on a scale, 0 to 1; in the middle of a scale without extent.
fn linear(v: f64, [low, high]: [f64; 2]) -> f64 {
    if high > low { (v - low) / (high - low) } else { 0.5 }
}

fn logarithmic(v: f64, [low, high]: [f64; 2]) -> f64 {
    linear(v.ln(), [low.ln(), high.ln()])
}

/// The numbers between which all but the share `beyond` at either end lie; `None` without finite numbers.
fn most_of(numbers: &[f32], beyond: f64) -> Option<[f64; 2]> {
    let mut known: Vec<f32> = numbers.iter().copied().filter(|v| v.is_finite()).collect();
    known.sort_unstable_by(f32::total_cmp);
    let last = known.len().checked_sub(1)?;
    let beyond = (last as f64 * beyond) as usize;
    Some([known[beyond], known[last - beyond]].map(f64::from))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::{AlphaUse, Develop, develop};
    use crate::pictures::colormap::UNKNOWN;

    /// The bytes of a view as it is written.
    fn bytes(view: &View) -> Vec<u8> {
        let how = Develop {
            dither: false,
            ..Develop::default()
        };
        develop(&view.layers, &how, AlphaUse::OnBlack).bytes
    }

    const DARK: [u8; 3] = [0, 0, 4];
    const MIDDLE: [u8; 3] = [183, 55, 121];
    const BRIGHT: [u8; 3] = [252, 253, 191];

    #[test]
    fn errors_are_shown_on_a_fixed_scale() {
        let middle = (LEAST_ERROR as f32).sqrt();
        let layers = Layers {
            relerr: Some(vec![1e-3, middle, 1.0, 50.0, 0.0, f32::NAN]),
            ..Layers::from_rgb(6, 1, vec![[0.0; 3]; 6])
        };
        let view = view(ViewKind::Error, &layers).unwrap();
        assert_eq!((view.range, view.unknown), (Some([1e-3, 1.0]), 1));
        assert_eq!(bytes(&view), [DARK, MIDDLE, BRIGHT, BRIGHT, DARK, UNKNOWN].concat());
    }

    #[test]
    fn one_slow_pixel_does_not_darken_the_others() {
        let mut times: Vec<f32> = (0..300).map(|i| 100.0 * 10f32.powi(i % 3)).collect();
        times[7] = 1e12;
        times[8] = f32::NAN;
        times[9] = 0.0;
        let layers = Layers {
            time: Some(times),
            ..Layers::from_rgb(300, 1, vec![[0.0; 3]; 300])
        };
        let view = view(ViewKind::Time, &layers).unwrap();
        assert_eq!((view.range, view.unknown), (Some([100.0, 1e4]), 1));
        let shown: Vec<[u8; 3]> = bytes(&view).chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect();
        assert_eq!(shown[..3], [DARK, MIDDLE, BRIGHT]);
        assert_eq!(shown[7..10], [BRIGHT, UNKNOWN, DARK]);
    }

    #[test]
    fn near_is_bright_and_what_is_not_hit_is_grey() {
        let layers = Layers {
            depth: Some(vec![2.0, 3.0, 4.0, f32::INFINITY]),
            ..Layers::from_rgb(4, 1, vec![[0.0; 3]; 4])
        };
        let seen = view(ViewKind::Depth, &layers).unwrap();
        assert_eq!((seen.range, seen.unknown), (Some([2.0, 4.0]), 1));
        assert_eq!(bytes(&seen), [BRIGHT, MIDDLE, DARK, UNKNOWN].concat());
        let nothing = Layers {
            depth: Some(vec![f32::INFINITY]),
            ..Layers::from_rgb(1, 1, vec![[0.0; 3]])
        };
        assert_eq!(view(ViewKind::Depth, &nothing).unwrap().range, None);
        assert_eq!(view(ViewKind::Depth, &Layers::from_rgb(1, 1, vec![[0.0; 3]])), None);
    }

    #[test]
    fn normals_and_albedo_are_colours() {
        let layers = Layers {
            normal: Some(vec![[1.0, 0.0, -1.0]]),
            albedo: Some(vec![[0.215_86, 1.0, 0.0]]),
            ..Layers::from_rgb(1, 1, vec![[0.0; 3]])
        };
        assert_eq!(bytes(&view(ViewKind::Normal, &layers).unwrap()), [255, 128, 0]);
        assert_eq!(bytes(&view(ViewKind::Albedo, &layers).unwrap()), [128, 255, 0]);
    }
}
