//! Flags for rendering an animation.

use crate::cli::animation::{ClockRange, FrameRange};
use crate::cli::values;
use clap::Args;

const ANIMATION: &str = "Animation (one picture a frame: -o x.png writes x0001.png, -o x##.png writes x01.png)";

/// Which frames are rendered, and at which clock.
#[derive(Args, Clone, Debug, Default)]
pub struct AnimationArgs {
    /// Render the frames from A to B, both included. The clock of a text scene runs from 0 in frame A to 1 in frame B, that
    /// of a bare glTF counts seconds (see --fps). After Ctrl-C the finished frames are kept.
    #[arg(long, value_name = "A..B", conflicts_with = "clock", help_heading = ANIMATION)]
    pub frames: Option<FrameRange>,
    /// Of the animation, render only this frame, or these: --frames 1..120 --frame 17..20.
    #[arg(long, value_name = "N|A..B", conflicts_with = "clock", help_heading = ANIMATION)]
    pub frame: Option<FrameRange>,
    /// The clock counts seconds: that of frame N is N/FPS [default of a bare glTF: 24].
    #[arg(long, value_name = "FPS", value_parser = values::above_zero, conflicts_with = "clock_range", help_heading = ANIMATION)]
    pub fps: Option<f64>,
    /// The clock of the first and of the last frame [default of text scenes: 0..1].
    #[arg(long, value_name = "C0..C1", allow_hyphen_values = true, help_heading = ANIMATION)]
    pub clock_range: Option<ClockRange>,
    /// The frame behind the last one would be the first again: the clock stops one step short of its end.
    #[arg(long, conflicts_with = "fps", help_heading = ANIMATION)]
    pub cyclic: bool,
    /// How long the shutter of each frame is open: 360 degrees are the time from one frame to the next.
    #[arg(long, value_name = "DEGREES", value_parser = values::factor, conflicts_with = "shutter", help_heading = ANIMATION)]
    pub shutter_angle: Option<f64>,
    /// Leave frames alone whose files are all there already.
    #[arg(long, help_heading = ANIMATION)]
    pub skip_existing: bool,
}

impl AnimationArgs {
    /// The first flag that has no meaning without frames.
    pub fn first_flag(&self) -> Option<&'static str> {
        let given = [
            (self.fps.is_some(), "--fps"),
            (self.clock_range.is_some(), "--clock-range"),
            (self.cyclic, "--cyclic"),
            (self.shutter_angle.is_some(), "--shutter-angle"),
            (self.skip_existing, "--skip-existing"),
        ];
        given.iter().find(|(is_given, _)| *is_given).map(|(_, flag)| *flag)
    }

    /// The words that say the same of one frame.
    pub fn words(&self, frame: u32) -> Vec<String> {
        let mut words = Vec::new();
        let mut flag = |name: &str, value: Option<String>| {
            if let Some(value) = value {
                words.extend([name.to_owned(), value]);
            }
        };
        flag("--frames", self.frames.map(|r| r.to_string()));
        flag("--frame", Some(frame.to_string()));
        flag("--fps", self.fps.map(|f| f.to_string()));
        flag("--clock-range", self.clock_range.map(|r| r.to_string()));
        flag("--shutter-angle", self.shutter_angle.map(|a| a.to_string()));
        if self.cyclic {
            words.push("--cyclic".to_owned());
        }
        words
    }
}
