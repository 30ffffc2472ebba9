//! Frames of an animation: which there are, the clock of each, and how their files are named.

use super::args::AnimationArgs;
use crate::lang::Frame;
use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Frames per second of models where nobody says any.
pub const DEFAULT_FPS: f64 = 24.0;

/// Digits of a frame's number in a file's name, unless the name or the number has more.
const DIGITS: usize = 4;

/// Frames that one command renders at most.
const MOST_FRAMES: u32 = 1_000_000;

/// `a..b`: the frames from a to b, both included; `a` alone is one frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameRange {
    /// The first one.
    pub first: u32,
    /// The last one, not before the first.
    pub last: u32,
}

impl FrameRange {
    /// All their numbers.
    pub fn numbers(self) -> std::ops::RangeInclusive<u32> {
        self.first..=self.last
    }

    /// How many there are.
    pub fn count(self) -> u32 {
        self.last - self.first + 1
    }
}

impl FromStr for FrameRange {
    type Err = String;

    fn from_str(text: &str) -> Result<FrameRange, String> {
        let wrong = || format!("`{text}` is no range of frames; write A..B with A ≤ B, both included, or one number");
        let number = |text: &str| text.trim().parse::<u32>().ok().filter(|n| *n <= i32::MAX as u32);
        let (first, last) = match text.split_once("..") {
            Some((first, last)) => (number(first), number(last)),
            None => (number(text), number(text)),
        };
        let (Some(first), Some(last)) = (first, last) else {
            return Err(wrong());
        };
        if first > last {
            return Err(wrong());
        }
        if last - first >= MOST_FRAMES {
            return Err(format!(
                "`{text}` are more frames than the {MOST_FRAMES} that are supported"
            ));
        }
        Ok(FrameRange { first, last })
    }
}

impl fmt::Display for FrameRange {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self.first == self.last {
            true => write!(f, "{}", self.first),
            false => write!(f, "{}..{}", self.first, self.last),
        }
    }
}

/// `c0..c1`: the clock of the first and of the last frame, any two finite numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClockRange {
    /// Of the first frame.
    pub first: f64,
    /// Of the last frame.
    pub last: f64,
}

impl FromStr for ClockRange {
    type Err = String;

    fn from_str(text: &str) -> Result<ClockRange, String> {
        let number = |text: &str| text.trim().parse::<f64>().ok().filter(|c| c.is_finite());
        let ends = text.split_once("..").and_then(|(a, b)| Some((number(a)?, number(b)?)));
        match ends {
            Some((first, last)) => Ok(ClockRange { first, last }),
            None => Err(format!(
                "`{text}` is no range of clocks; write C0..C1, for example 0..2.5"
            )),
        }
    }
}

impl fmt::Display for ClockRange {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}..{}", self.first, self.last)
    }
}

/// The frames to render and the clock of each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Animation {
    /// All frames of the animation.
    pub all: FrameRange,
    /// Those to be rendered.
    pub chosen: FrameRange,
    pace: Pace,
    /// Clock units that the shutter of each frame is open, if the flags say it.
    pub shutter: Option<f64>,
}

/// Where in an animation a scene is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moment {
    /// The frame.
    pub frame: Frame,
    /// Clock units that its shutter is open, if the flags say it.
    pub shutter: Option<f64>,
}

/// How the clock of a frame follows from its number.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Pace {
    /// It counts seconds of so many frames.
    Seconds(f64),
    /// It goes in even steps from the first frame's; the last one, if it has one of its own, is met exactly.
    Even { first: f64, delta: f64, last: Option<f64> },
}

impl Pace {
    fn delta(self) -> f64 {
        match self {
            Pace::Seconds(fps) => 1.0 / fps,
            Pace::Even { delta, .. } => delta,
        }
    }

    fn clock(self, number: u32, all: FrameRange) -> f64 {
        match self {
            Pace::Seconds(fps) => f64::from(number) / fps,
            Pace::Even { last: Some(last), .. } if number == all.last => last,
            Pace::Even { first, delta, .. } => first + delta * f64::from(number.saturating_sub(all.first)),
        }
    }
}

impl Animation {
    /// What the flags say; `None` for a still. `is_model`: the scene is a bare model, whose clock counts seconds.
    pub fn of(args: &AnimationArgs, is_model: bool) -> Result<Option<Animation>, String> {
        let Some(all) = args.frames.or(args.frame) else {
            return match args.first_flag() {
                Some(flag) => Err(format!("{flag} needs the frames of an animation: add --frames A..B")),
                None => Ok(None),
            };
        };
        let chosen = args.frame.unwrap_or(all);
        if chosen.first < all.first || chosen.last > all.last {
            return Err(format!("--frame {chosen} is not among --frames {all}"));
        }
        let by_seconds = args
            .fps
            .or((is_model && args.clock_range.is_none()).then_some(DEFAULT_FPS));
        let pace = match by_seconds {
            Some(fps) => Pace::Seconds(fps),
            None if args.frames.is_none() => {
                let message = "--frame needs to know the animation that it is of: add --frames A..B, or --fps N";
                return Err(message.to_owned());
            }
            None => {
                let clock = args.clock_range.unwrap_or(ClockRange { first: 0.0, last: 1.0 });
                let steps = all.count() - u32::from(!args.cyclic);
                Pace::Even {
                    first: clock.first,
                    delta: match steps {
                        0 => 0.0,
                        steps => (clock.last - clock.first) / f64::from(steps),
                    },
                    last: (!args.cyclic && steps > 0).then_some(clock.last),
                }
            }
        };
        let shutter = args.shutter_angle.map(|degrees| degrees / 360.0 * pace.delta().abs());
        Ok(Some(Animation {
            all,
            chosen,
            pace,
            shutter,
        }))
    }

    /// How a frame is read.
    pub fn moment(&self, number: u32) -> Moment {
        Moment {
            frame: self.frame(number),
            shutter: self.shutter,
        }
    }

    /// Where in the animation a frame is.
    pub fn frame(&self, number: u32) -> Frame {
        let clock = |number| self.pace.clock(number, self.all);
        Frame {
            number,
            clock: clock(number),
            frames: [self.all.first, self.all.last],
            clocks: [clock(self.all.first), clock(self.all.last)],
            delta: self.pace.delta(),
        }
    }

    /// The file of a frame: the last `####` of the name becomes its number, with as many digits at least; a name without
    /// them ends in the number.
    pub fn numbered(&self, path: &Path, number: u32) -> PathBuf {
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        if let Some(end) = name.rfind('#') {
            let begin = name[..end]
                .rfind(|c| c != '#')
                .map_or(0, |i| i + name[i..].chars().next().map_or(1, char::len_utf8));
            let width = end + 1 - begin;
            return path.with_file_name(format!("{}{number:0width$}{}", &name[..begin], &name[end + 1..]));
        }
        let digits = self.all.last.to_string().len().max(DIGITS);
        let (stem, extension) = match name.rfind('.').filter(|i| *i > 0) {
            Some(dot) => name.split_at(dot),
            None => (name.as_str(), ""),
        };
        path.with_file_name(format!("{stem}{number:0digits$}{extension}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frames(text: &str) -> FrameRange {
        text.parse().unwrap_or_else(|e| panic!("{e}"))
    }

    fn args(range: &str) -> AnimationArgs {
        AnimationArgs {
            frames: Some(frames(range)),
            ..AnimationArgs::default()
        }
    }

    fn of(args: &AnimationArgs, is_model: bool) -> Animation {
        match Animation::of(args, is_model) {
            Ok(Some(animation)) => animation,
            other => panic!("{other:?}"),
        }
    }

    fn clocks(animation: &Animation) -> Vec<f64> {
        animation.chosen.numbers().map(|n| animation.frame(n).clock).collect()
    }

    #[test]
    fn ranges_are_read_and_written_alike() {
        for (text, ends) in [("1..120", Some((1, 120))), ("7", Some((7, 7))), ("0..0", Some((0, 0)))] {
            let found = text.parse::<FrameRange>().ok();
            assert_eq!(found.map(|r| (r.first, r.last)), ends, "{text}");
        }
        assert_eq!(
            (frames("3..9").to_string(), frames("3..3").to_string()),
            ("3..9".into(), "3".into())
        );
        for text in ["9..3", "-1..3", "a", "1..", "..2", "1.5", "0..2000000", "9999999999"] {
            assert!(text.parse::<FrameRange>().is_err(), "{text}");
        }
        for text in ["1", "a..b", "0..inf", "NaN..1"] {
            assert!(text.parse::<ClockRange>().is_err(), "{text}");
        }
    }

    /// POV-Ray's mapping: the clock runs from 0 in the first frame to 1 in the last; cyclic, one step short of it.
    #[test]
    fn the_clock_of_a_text_scene_runs_from_0_to_1() {
        assert_eq!(clocks(&of(&args("1..5"), false)), [0.0, 0.25, 0.5, 0.75, 1.0]);
        let cyclic = AnimationArgs {
            cyclic: true,
            ..args("1..4")
        };
        assert_eq!(clocks(&of(&cyclic, false)), [0.0, 0.25, 0.5, 0.75]);
        let ranged = AnimationArgs {
            clock_range: Some(ClockRange { first: 2.0, last: -1.0 }),
            frame: Some(frames("11..12")),
            ..args("10..13")
        };
        let animation = of(&ranged, false);
        assert_eq!(clocks(&animation), [1.0, 0.0]);
        let frame = animation.frame(11);
        assert_eq!((frame.frames, frame.clocks, frame.delta), ([10, 13], [2.0, -1.0], -1.0));
        assert_eq!(clocks(&of(&args("6..6"), false)), [0.0]);
    }

    #[test]
    fn the_clock_of_a_model_counts_seconds() {
        assert_eq!(clocks(&of(&args("0..2"), true)), [0.0, 1.0 / 24.0, 2.0 / 24.0]);
        let alone = AnimationArgs {
            frame: Some(frames("30")),
            fps: Some(60.0),
            shutter_angle: Some(180.0),
            ..AnimationArgs::default()
        };
        let animation = of(&alone, false);
        assert_eq!((clocks(&animation), animation.shutter), (vec![0.5], Some(0.5 / 60.0)));
    }

    #[test]
    fn flags_that_do_not_fit_are_told() {
        let frame = Some(frames("3"));
        for (args, told) in [
            (
                AnimationArgs {
                    frame: Some(frames("9")),
                    ..args("1..5")
                },
                "not among --frames 1..5",
            ),
            (
                AnimationArgs {
                    frame,
                    ..AnimationArgs::default()
                },
                "add --frames A..B, or --fps N",
            ),
            (
                AnimationArgs {
                    cyclic: true,
                    ..AnimationArgs::default()
                },
                "--cyclic needs",
            ),
            (
                AnimationArgs {
                    fps: Some(24.0),
                    ..AnimationArgs::default()
                },
                "--fps needs",
            ),
        ] {
            let found = Animation::of(&args, false);
            assert!(found.as_ref().is_err_and(|e| e.contains(told)), "{args:?}: {found:?}");
        }
        assert_eq!(Animation::of(&AnimationArgs::default(), true), Ok(None));
    }

    #[test]
    fn files_are_named_by_their_frames() {
        let animation = of(&args("1..12"), false);
        for (name, expected) in [
            ("out/x.png", "out/x0007.png"),
            ("x##.exr", "x07.exr"),
            ("#.png", "7.png"),
            ("a#b##c.png", "a#b07c.png"),
            ("ü######.png", "ü000007.png"),
            ("x.ptspart", "x0007.ptspart"),
            ("v1.2/x", "v1.2/x0007"),
        ] {
            assert_eq!(animation.numbered(Path::new(name), 7), Path::new(expected), "{name}");
        }
        let long = of(&args("1..123456"), false);
        assert_eq!(long.numbered(Path::new("x.png"), 7), Path::new("x000007.png"));
    }
}
