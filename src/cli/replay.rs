//! The command line that makes the same picture again, bit by bit.

use super::args::{LoadArgs, RenderArgs, ViewArgs};
use super::metadata::filter_word;
use crate::math::words::shell_word;
use crate::render::settings::{Region, Settings, StopRules};
use crate::render::technique::Technique;
use clap::ValueEnum;

/// The words after `pts render`: what was given and what was decided, with the samples that were taken instead
/// of the stop rules (after an interruption: those that are complete all over the picture). Things that do not change the picture (threads, terminal) are left out.
pub fn command(args: &RenderArgs, settings: &Settings, spp: u32, with_outputs: bool) -> String {
    words(args, settings, Some(spp), with_outputs)
}

/// The words that make all of the picture that a part belongs to, without outputs and the number of samples.
pub fn picture_command(args: &RenderArgs, settings: &Settings) -> String {
    words(args, settings, None, false)
}

fn words(args: &RenderArgs, settings: &Settings, spp: Option<u32>, with_outputs: bool) -> String {
    let mut words = vec![
        "pts".to_owned(),
        "render".to_owned(),
        args.scene().display().to_string(),
    ];
    let mut flag = |name: &str, value: Option<String>| {
        if let Some(value) = value {
            words.extend([name.to_owned(), value]);
        }
    };
    if with_outputs {
        for output in &args.output.output {
            flag("-o", Some(output.display().to_string()));
        }
        flag("--format", args.output.format.map(|f| f.extension().to_owned()));
    }
    flag("-r", Some(format!("{}x{}", settings.width, settings.height)));
    let names_seed = args.sampling.seed.is_some() || settings.seed != 0;
    flag("--seed", names_seed.then(|| settings.seed.to_string()));
    flag("--nets", args.sampling.nets.map(|n| n.to_string()));
    flag(
        "--filter",
        args.sampling.filter.map(|_| filter_word(settings.filter).to_owned()),
    );
    words.extend(scene_words(&args.view, &args.load));
    if let Some(moment) = &args.load.moment {
        words.extend(args.animation.words(moment.frame.number));
    }
    let mut flag = |name: &str, value: Option<String>| {
        if let Some(value) = value {
            words.extend([name.to_owned(), value]);
        }
    };
    let layers: Vec<String> = args.output.aov.iter().filter_map(|a| value_name(*a)).collect();
    flag("--aov", (!layers.is_empty()).then(|| layers.join(",")));
    flag("--view", args.output.view.and_then(value_name));
    flag("--tonemap", args.output.tonemap.and_then(value_name));
    flag("--exposure", args.output.exposure.map(|e| e.to_string()));
    if args.output.no_dither {
        words.push("--no-dither".to_owned());
    }
    // What stands on the command line; a limit of bounces in the scene speaks for itself.
    let technique = Technique {
        max_depth: u32::MAX,
        ..args.sampling.technique()
    };
    words.extend(technique.flags());
    if let Some(list) = args.sampling.without_list() {
        words.extend(["--without".to_owned(), list]);
    }
    if args.prune.no_prune {
        words.push("--no-prune".to_owned());
    }
    if let Some(list) = args.prune.forced_list() {
        words.extend(["--force-effects".to_owned(), list]);
    }
    if let Some(depth) = args.sampling.max_depth {
        words.extend(["--max-depth".to_owned(), depth.to_string()]);
    }
    if let Some(spp) = spp {
        words.extend(part_words(args, settings, spp.max(1)));
        let confidence = settings.stop.confidence;
        if confidence != StopRules::samples(1).confidence {
            words.extend(["--confidence".to_owned(), confidence.to_string()]);
        }
    }
    let quoted: Vec<String> = words.iter().map(|w| shell_word(w)).collect();
    quoted.join(" ")
}

/// The words that say how a scene is read and seen, not quoted.
pub fn scene_words(view: &ViewArgs, load: &LoadArgs) -> Vec<String> {
    let mut words = Vec::new();
    let mut flag = |name: &str, value: Option<String>| {
        if let Some(value) = value {
            words.extend([name.to_owned(), value]);
        }
    };
    flag("--camera", view.camera.as_ref().map(|c| c.to_string()));
    flag("--env-color", view.env_color.map(|[r, g, b]| format!("{r},{g},{b}")));
    flag("--env-map", view.env_map.as_ref().map(|p| p.display().to_string()));
    flag("--env-rotate", view.env_rotate.map(|d| d.to_string()));
    flag("--env-strength", view.env_strength.map(|s| s.to_string()));
    flag("--light-scale", view.light_scale.map(|f| f.to_string()));
    for dir in &load.include {
        flag("-I", Some(dir.display().to_string()));
    }
    for (name, value) in &load.define {
        flag("-D", Some(format!("{name}={value}")));
    }
    flag("--clock", load.clock.map(|t| t.to_string()));
    flag("--shutter", load.shutter.map(|s| s.to_string()));
    flag("--gltf-scene", load.gltf_scene.clone());
    flag("--variant", load.variant.clone());
    flag("--animation", load.animation.clone());
    flag("--glass", load.glass.map(|g| g.word().to_owned()));
    words.extend(load.allow_outside.then(|| "--allow-outside".to_owned()));
    words
}

/// Which samples of which pixels.
fn part_words(args: &RenderArgs, settings: &Settings, spp: u32) -> Vec<String> {
    let (parts, first) = (&args.parts, settings.first);
    let samples = match parts.samples {
        Some(_) => ["--samples".to_owned(), format!("{first}..{}", first + spp)],
        None => ["--spp".to_owned(), spp.to_string()],
    };
    let tile = parts.tile.map(|t| ["--tile".to_owned(), t.to_string()]);
    let region = parts.region.map(|r| ["--region".to_owned(), region_word(&r)]);
    std::iter::once(samples).chain(tile).chain(region).flatten().collect()
}

/// `x0,y0,x1,y1`.
pub fn region_word(r: &Region) -> String {
    format!("{},{},{},{}", r.x0, r.y0, r.x1, r.y1)
}

/// The word of a flag's value on the command line.
fn value_name(value: impl ValueEnum) -> Option<String> {
    value.to_possible_value().map(|v| v.get_name().to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::args::{Cli, Command};
    use clap::Parser;

    fn args(words: &[&str]) -> RenderArgs {
        match Cli::parse_from(["pts", "render"].iter().chain(words)).command {
            Some(Command::Render(args)) => *args,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_replay_names_what_was_decided_instead_of_the_stop_rules() {
        let args = args(&["my scene.pts", "--error", "2%", "--time", "1h", "-j", "2", "-q"]);
        let settings = Settings::new(32, 16, 1024);
        let text = command(&args, &settings, 96, true);
        assert_eq!(text, "pts render 'my scene.pts' -r 32x16 --spp 96");
    }

    #[test]
    fn replaying_a_replay_gives_the_same_words() {
        let first = args(&[
            "a.pts",
            "-o",
            "x.exr",
            "--camera",
            "location=1,2,3 angle=40",
            "--env-color",
            "1,0.5,0",
            "--direct",
            "light",
            "--sampler",
            "independent",
            "--clamp",
            "0.1",
            "--no-caustics",
            "--max-depth",
            "7",
            "--no-prune",
            "--nets",
            "8",
            "--filter",
            "box",
            "-D",
            "r=2",
            "--aov",
            "depth,normal",
            "--tonemap",
            "agx",
            "--exposure",
            "-1.5",
            "--no-dither",
            "--clock",
            "-2",
            "--shutter",
            "0.5",
            "--env-rotate",
            "-30",
            "--env-strength",
            "2.5",
            "-I",
            "inc",
        ]);
        let mut settings = Settings::new(8, 8, 4);
        settings.seed = 7;
        settings.filter = crate::render::settings::Filter::Box;
        let text = command(&first, &settings, 4, true);
        let technique = "--sampler independent --direct light --clamp 0.1 --no-caustics --no-prune --max-depth 7";
        assert!(text.contains(technique), "{text}");
        // No word of this command holds a blank but the camera's.
        let camera = "'location=1,2,3 angle=40'";
        let shielded = text.replace(camera, "CAMERA");
        let words: Vec<&str> = shielded.split(' ').skip(2).collect();
        let words: Vec<&str> = words
            .into_iter()
            .map(|w| if w == "CAMERA" { camera.trim_matches('\'') } else { w })
            .collect();
        assert_eq!(command(&args(&words), &settings, 4, true), text);
    }
}
