//! What fills solids: `KHR_materials_volume`, and the draft `KHR_materials_volume_scatter` beside it.

use super::extension::{Fields, NOT_NEGATIVE, UNIT};
use super::{Glass, Loader};
use crate::diag::{Anomaly, Diagnostic};
use crate::scene::{Medium, Phase, Principled};
use glam::DVec3;
use serde_json::Value;

impl Loader<'_> {
    /// `KHR_materials_volume`: σ = −ln(colour)/distance is taken from the way ahead, distances being in the world. It is
    /// absorption, unless a part of it is scattered.
    pub(super) fn volume(&mut self, raw: &Value, surface: &mut Principled, at: &str) -> Medium {
        let transmits = surface.transmission.factor > 0.0;
        let Some(volume) = Fields::of(raw, "KHR_materials_volume", at) else {
            surface.thick = transmits && self.options.glass == Glass::Solid;
            if transmits && self.options.glass == Glass::AsWritten && self.is_from_blender() {
                let d = Diagnostic::note(
                    "G0707",
                    "glass without KHR_materials_volume is drawn as a thin sheet, without refraction",
                );
                self.report.push(
                    at,
                    d.hint("for solid glass render with --glass solid, or give the exporter a thickness above 0"),
                );
            }
            return Medium::default();
        };
        let report = &mut self.report;
        let thickness = volume.number("thicknessFactor", 0.0, NOT_NEGATIVE, report);
        surface.thick = match self.options.glass {
            Glass::AsWritten => thickness > 0.0,
            Glass::Solid => thickness > 0.0 || transmits,
            Glass::Thin => false,
        };
        let distance = volume.number("attenuationDistance", f64::INFINITY, 0.0..=f64::INFINITY, report);
        let color = volume.color("attenuationColor", 1.0, UNIT, report);
        if !surface.thick || distance.is_infinite() {
            return Medium::default();
        }
        if distance <= 0.0 {
            let place = volume.place("attenuationDistance");
            let message = "is 0, expected more; nothing is absorbed";
            report.mended("G0207", &place, message, Anomaly::MovedValue, 1);
            return Medium::default();
        }
        // Black would absorb without end; the least positive number is as black, and finite.
        let extinction = color.map(|c| -c.max(f64::MIN_POSITIVE).ln() / distance);
        match Fields::of(raw, "KHR_materials_volume_scatter", at) {
            Some(scatter) => self.scatter(&scatter, extinction, surface, at),
            None => Medium::absorbing(extinction),
        }
    }

    /// `KHR_materials_volume_scatter`: which share of the extinction is scattered, and where to.
    fn scatter(&mut self, e: &Fields, extinction: DVec3, surface: &mut Principled, at: &str) -> Medium {
        let albedo = e
            .color("multiscatterColor", 0.0, UNIT, &mut self.report)
            .map(single_albedo);
        let most = f64::from(1.0_f32.next_down()); // the engine counts in f32
        let eccentricity = e.number("scatterAnisotropy", 0.0, -most..=most, &mut self.report);
        let scattering = extinction * albedo;
        // A dense inside makes it matter little how light enters (section "Scattering & (Diffuse-)Transmission"), but it
        // has to enter.
        let enters_diffusely = surface.diffuse_transmission.factor > 0.0 && surface.transmission.factor == 0.0;
        if enters_diffusely && scattering != DVec3::ZERO {
            surface.transmission = surface.diffuse_transmission;
            surface.diffuse_transmission = 0.0.into();
            if surface.transmission.factor == 1.0 && surface.transmission.texture.is_none() {
                surface.base_color = surface.diffuse_transmission_color;
            }
            let d = Diagnostic::note(
                "G0709",
                "diffuse transmission into a scattering volume is drawn as transmission",
            );
            self.report.push(at, d);
        }
        Medium {
            absorption: extinction - scattering,
            scattering,
            phase: Phase::HenyeyGreenstein(eccentricity),
            ..Medium::default()
        }
    }

    /// Whether Blender's exporter wrote the file, whose glass rarely has a volume.
    fn is_from_blender(&self) -> bool {
        let generator = self.doc.top("asset").and_then(|a| a.get("generator"));
        generator.and_then(Value::as_str).is_some_and(|g| g.contains("Blender"))
    }
}

/// Share of the extinction that is scattered, so that a thick solid looks as if it had this albedo; both in [0, 1].
/// Source: the extension's section "Multi-Scatter Albedo", after Kulla and Conty 2017.
fn single_albedo(multiple: f64) -> f64 {
    let root = (9.59217 + 41.6808 * multiple + 17.7126 * multiple * multiple).sqrt();
    let s = 4.09712 + 4.20863 * multiple - root;
    // At the ends the five digits of the fit leave the interval by 1e-10.
    (1.0 - s * s).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Oracle: the albedo of a half-space that scatters evenly, (1 − s)(1 − 0.139·s)/(1 + 1.17·s) with s² = 1 − ρ_ss
    /// (van de Hulst, Multiple Light Scattering, 1980). Its three digits make its inverse as good as 10⁻³.
    #[test]
    fn a_deep_solid_has_the_albedo_that_was_asked_for() {
        for i in 0..=100 {
            let wanted = f64::from(i) / 100.0;
            let s = (1.0 - single_albedo(wanted)).sqrt();
            let albedo = (1.0 - s) * (1.0 - 0.139 * s) / (1.0 + 1.17 * s);
            assert!((albedo - wanted).abs() < 1e-3, "{wanted}: {albedo}");
        }
    }
}
