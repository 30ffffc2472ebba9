//! The report of `pts compare`, for people and for programs.

use super::args::CompareArgs;
use super::compare::Excess;
use crate::study::blocks::{FALSE_ALARM, NoiseTest};
use crate::study::{Image, Metrics};
use clap::ValueEnum;
use serde_json::{Value, json};
use std::fmt::Write;

/// The report as a table, ending in a line break.
pub fn to_text(args: &CompareArgs, a: &Image, m: &Metrics) -> String {
    let mut text = format!(
        "{} against {} ({}x{} pixels)\n",
        args.image.display(),
        args.reference.display(),
        a.width,
        a.height
    );
    let mut line = |name: &str, value: String, about: &str| {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{}", format!("{name:<14}{value:<13}{about}").trim_end());
    };
    line("E", percent(m.rel_rmse), "relative error");
    line("relMSE", number(m.rel_mse()), "E²");
    line("RMSE", number(m.rmse), "");
    let psnr = match m.psnr_db.is_finite() {
        true => format!("{:.2} dB", m.psnr_db),
        false => "∞".to_owned(),
    };
    line("PSNR", psnr, "of the developed 8-bit pictures");
    line(
        "FLIP",
        number(m.flip),
        "of the developed 8-bit pictures, mean, 67 pixels per degree",
    );
    let exposures = m.exposures.map_or("both are black".to_owned(), |e| {
        format!(
            "mean over {} exposures from {:+.1} to {:+.1} EV",
            e.count, e.start, e.stop
        )
    });
    line("HDR-FLIP", number(m.hdr_flip), &exposures);
    let [x, y] = m.largest.colors.map(color);
    let place = match m.largest.value > 0.0 {
        true => format!("at ({}, {}): {x} against {y}", m.largest.x, m.largest.y),
        false => String::new(),
    };
    line("largest", number(m.largest.value), &place);
    let [energy_a, energy_b] = m.energy.map(number);
    line(
        "energy",
        format!("× {}", number(m.energy_ratio())),
        &format!("mean luminance {energy_a} against {energy_b}"),
    );
    match &m.noise {
        Some(noise) => noise_lines(noise, &mut line),
        None => line(
            "noise",
            "unknown".to_owned(),
            "needs .exr images with known standard errors",
        ),
    }
    text
}

fn noise_lines(noise: &NoiseTest, line: &mut impl FnMut(&str, String, &str)) {
    let NoiseTest {
        side,
        blocks,
        differing,
        threshold,
        ..
    } = noise;
    let verdict = format!(
        "of blocks differ beyond noise: {differing} of {blocks}, {side}x{side} pixels, |z| > {threshold:.2}{}",
        match noise.has_noise {
            [true, true] => "",
            [true, false] => "; the reference is taken as exact",
            _ => "; the image is taken as exact",
        }
    );
    line("beyond noise", share(noise.share(), noise.differing), &verdict);
    let z = noise.worst.extreme().unwrap_or(0.0);
    line(
        "",
        String::new(),
        &format!("farthest: z = {z:+.2} at ({}, {})", noise.worst.x, noise.worst.y),
    );
    if noise.untested > 0 {
        line(
            "",
            String::new(),
            &format!("{} pixels of unknown noise are not tested", noise.untested),
        );
    }
    let [r, g, b] = noise.bias_z;
    line(
        "bias",
        format!("z = {:+.2}", noise.bias()),
        &format!("red {r:+.2}, green {g:+.2}, blue {b:+.2}"),
    );
}

/// What is said of a number beyond its threshold.
pub fn excess(e: &Excess) -> String {
    let shown = |v| if e.is_share { percent(v) } else { number(v) };
    format!(
        "{} is {}, more than the {} allowed",
        e.metric,
        shown(e.value),
        shown(e.limit)
    )
}

/// The report as one document. Numbers that are infinite (PSNR of equal pictures, E against black) are `null`.
pub fn to_json(args: &CompareArgs, a: &Image, m: &Metrics, beyond: &[Excess]) -> Value {
    let [mean_a, mean_b] = m.mean_rgb;
    json!({
        "version": 1,
        "image": args.image.display().to_string(),
        "reference": args.reference.display().to_string(),
        "width": a.width,
        "height": a.height,
        "pixels": m.pixels,
        "non_finite": {"image": m.non_finite[0], "reference": m.non_finite[1]},
        "e": m.rel_rmse,
        "relmse": m.rel_mse(),
        "rmse": m.rmse,
        "psnr_db": m.psnr_db,
        "flip": m.flip,
        "hdr_flip": m.hdr_flip,
        "exposures": m.exposures.map(|e| json!({"start": e.start, "stop": e.stop, "count": e.count})),
        "largest": {
            "value": m.largest.value, "x": m.largest.x, "y": m.largest.y,
            "image": m.largest.colors[0], "reference": m.largest.colors[1],
        },
        "energy": {
            "image": m.energy[0], "reference": m.energy[1], "ratio": m.energy_ratio(),
            "image_rgb": mean_a, "reference_rgb": mean_b,
        },
        "noise": m.noise.as_ref().map(noise_json),
        "within": beyond.is_empty(),
        "beyond": beyond.iter()
            .map(|e| json!({"metric": e.metric, "value": e.value, "limit": e.limit}))
            .collect::<Vec<_>>(),
    })
}

fn noise_json(noise: &NoiseTest) -> Value {
    json!({
        "block_size": noise.side,
        "blocks": noise.blocks,
        "differing": noise.differing,
        "share": noise.share(),
        "threshold_z": noise.threshold,
        "false_alarm": FALSE_ALARM,
        "farthest": {"z": noise.worst.extreme(), "x": noise.worst.x, "y": noise.worst.y},
        "bias_z": noise.bias_z,
        "untested_pixels": noise.untested,
        "exact": {"image": !noise.has_noise[0], "reference": !noise.has_noise[1]},
    })
}

/// What a heat map says about itself.
pub fn heatmap_metadata(args: &CompareArgs) -> Value {
    let name = |path: &std::path::Path| path.file_name().map(|n| n.to_string_lossy().into_owned());
    json!({
        "version": env!("CARGO_PKG_VERSION"),
        "heatmap": args.heatmap_kind.to_possible_value().map(|v| v.get_name().to_owned()),
        "image": name(&args.image),
        "reference": name(&args.reference),
    })
}

/// Four significant digits, without an exponent where that is short.
fn number(v: f64) -> String {
    if v == 0.0 || !v.is_finite() {
        return format!("{v}").replace("inf", "∞");
    }
    let digits = v.abs().log10().floor() as i32;
    match digits {
        -4..=5 => format!("{v:.*}", (3 - digits).max(0) as usize),
        _ => format!("{v:.3e}"),
    }
}

fn percent(v: f64) -> String {
    format!("{} %", number(100.0 * v))
}

/// A share of counted things: never 0.0 % where one was counted.
fn share(v: f64, count: u64) -> String {
    match (100.0 * v) as f32 {
        p if p < 0.05 && count > 0 => "< 0.1 %".to_owned(),
        p => format!("{p:.1} %"),
    }
}

fn color(c: [f32; 3]) -> String {
    c.map(|v| number(f64::from(v))).join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_four_digits() {
        for (v, text) in [
            (0.0, "0"),
            (0.031_415_9, "0.03142"),
            (12.345_67, "12.35"),
            (123_456.7, "123457"),
            (1.5e-7, "1.500e-7"),
            (f64::INFINITY, "∞"),
        ] {
            assert_eq!(number(v), text);
        }
        assert_eq!(percent(0.021_34), "2.134 %");
    }

    #[test]
    fn a_share_of_some_is_not_told_as_none() {
        assert_eq!(share(0.0, 0), "0.0 %");
        assert_eq!(share(1e-5, 1), "< 0.1 %");
        assert_eq!(share(0.013, 13), "1.3 %");
    }
}
