//! What the pictures of a study are measured against.

use super::{Failure, Request};
use crate::render::settings::Settings;
use crate::study::CompareError;
use crate::study::experiment::{Reference, Row};
use crate::study::workshop::{Order, Watch, Workshop};
use crate::study::yardstick::Yardstick;

/// Nets of the reference at least: its noise must be known.
const REFERENCE_NETS: u32 = 4;

/// The reference's seed beyond the base line's; rows use the next ones after that, far fewer than these.
const REFERENCE_SEED: u64 = 1_000_000;

/// The reference that is given, or a new one.
pub fn find(
    request: &Request,
    workshop: &mut Workshop,
    watch: &dyn Watch,
    seconds: f64,
    notes: &mut Vec<String>,
) -> Result<(Yardstick, Reference), Failure> {
    let settings = workshop.base().clone();
    if let Some((name, image)) = &request.reference {
        let size = [settings.width, settings.height];
        if [image.width, image.height] != size {
            let a = [image.width, image.height];
            return Err(CompareError::Size { a, b: size }.into());
        }
        let (is_developed, samples) = (image.is_developed, image.samples.as_ref());
        let mean = samples.map(|s| s.iter().map(|n| u64::from(*n)).sum::<u64>() / s.len().max(1) as u64);
        let yardstick = Yardstick::new(image.clone())?;
        if is_developed {
            notes.push(format!(
                "the reference {name} is cut at white and rounded, which counts as error of every row"
            ));
        }
        if yardstick.error().is_none() {
            notes.push(format!(
                "the reference {name} has no standard errors: its own noise is not subtracted and counts as error of \
                 every row"
            ));
        }
        let error = yardstick.error();
        let told = Reference {
            source: name.clone(),
            spp: mean,
            error,
            seconds: None,
        };
        return Ok((yardstick, told));
    }
    let honest = Settings {
        nets: settings.nets.max(REFERENCE_NETS),
        ..settings.clone()
    };
    let order = Order {
        technique: request.settings.technique,
        threads: None,
        seed: request.settings.seed.wrapping_add(REFERENCE_SEED),
        spp: u32::MAX,
        seconds: Some(seconds),
        stage: "reference",
        what: "rendering the reference",
    };
    let shot = if honest.nets == settings.nets {
        workshop.shoot(&order)?
    } else {
        super::workshop(request, &honest, watch).shoot(&order)?
    };
    let spp = shot.report.spp;
    let yardstick = Yardstick::new(shot.image)?;
    if yardstick.error().is_none() {
        notes.push(format!(
            "the reference has only {spp} samples per pixel: too few to know its noise (give more time)"
        ));
    }
    let told = Reference {
        source: format!("rendered as written, seed {}", order.seed),
        spp: Some(u64::from(spp)),
        error: yardstick.error(),
        seconds: Some(shot.seconds),
    };
    Ok((yardstick, told))
}

/// Says where the reference is too noisy for the best pictures.
pub fn note(reference: &Reference, rows: &[Row]) -> Option<String> {
    let most = rows.iter().filter(|r| r.variant == 0).map(|r| r.spp).max()?;
    let best: Vec<f64> = rows
        .iter()
        .filter(|r| r.variant == 0 && r.spp == most)
        .map(|r| r.e2)
        .collect();
    let e2 = best.iter().sum::<f64>() / best.len() as f64;
    let own = reference.error.filter(|own| own * own > e2)?;
    Some(format!(
        "the reference's own error ({:.2} %) is larger than that of the best pictures: theirs are known poorly (a larger \
         --budget, or a better --reference, helps)",
        100.0 * own
    ))
}
