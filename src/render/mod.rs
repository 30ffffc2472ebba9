//! The engine: from compiled data to pixels. It knows no names, no source places and no files.
//!
//! All positions are f32 relative to [`scene::CompiledScene::origin`] (the camera), which keeps digits where they matter;
//! transforms and analytic shapes stay f64. `compile` fills the data, `driver` runs passes over tiles,
//! `kernel` traces one path, `film` sums.

pub mod ray;
pub mod report;
pub mod settings;
pub mod surface;

/// stub
pub mod scene {
    /// stub
    pub struct CompiledScene {}
}
/// stub
pub mod driver {
    use super::report::*;
    use super::scene::CompiledScene;
    use super::settings::Settings;
    /// stub
    pub fn render(_: &CompiledScene, settings: &Settings, observer: &dyn Observer) -> (Picture, Report) {
        let n = (settings.width * settings.height) as usize;
        let begin = std::time::Instant::now();
        let mut stop = StopReason::Samples;
        let mut spp = 0;
        while spp < settings.stop.spp {
            spp += 1;
            std::thread::sleep(std::time::Duration::from_micros(if settings.stop.spp > 5000 {
                2000
            } else {
                1
            }));
            let elapsed = settings.started.elapsed().as_secs_f64();
            observer.progress(&Progress {
                spp,
                samples: u64::from(spp) * n as u64,
                samples_at_most: u64::from(settings.stop.spp) * n as u64,
                fraction: f64::from(spp) / f64::from(settings.stop.spp),
                elapsed,
                remaining: Some(1.0),
                error: (spp >= 64).then_some(ErrorEstimate { error: 0.1, bound: 0.2 }),
            });
            if observer.should_stop() {
                stop = StopReason::Interrupted;
                break;
            }
            if settings.stop.seconds.is_some_and(|s| elapsed > s) {
                stop = StopReason::Time;
                break;
            }
        }
        let picture = Picture {
            width: settings.width,
            height: settings.height,
            rgb: vec![[0.5; 3]; n],
            stderr: vec![[0.1; 3]; n],
            samples: vec![spp; n],
            ..Picture::default()
        };
        let report = Report {
            stop,
            spp,
            samples: u64::from(spp) * n as u64,
            rays: 0,
            seconds: begin.elapsed().as_secs_f64(),
            error: (spp >= 64).then_some(ErrorEstimate { error: 0.1, bound: 0.2 }),
            anomalies: Anomalies::default(),
        };
        (picture, report)
    }
}
