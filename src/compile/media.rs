//! What fills solids and the space between them becomes the engine's media and fogs.

use crate::diag::{Diagnostic, Diagnostics};
use crate::render::medium as engine;
use crate::render::medium::fog as engine_fog;
use crate::render::medium::phase;
use crate::scene::{Fog, Medium, Phase, Scene};
use glam::DVec3;

/// The table of media; equal ones share a place, and the first is the clear one.
pub struct Media {
    /// The engine's media.
    pub table: Vec<engine::Medium>,
}

impl Media {
    /// Nothing but the clear medium.
    pub fn new() -> Media {
        Media {
            table: vec![engine::Medium::CLEAR],
        }
    }

    /// The engine's index of what fills a solid.
    pub fn add(&mut self, medium: &Medium) -> u32 {
        let compiled = compiled(medium);
        let place = self.table.iter().position(|known| *known == compiled);
        place.unwrap_or_else(|| {
            self.table.push(compiled);
            self.table.len() - 1
        }) as u32
    }

    /// The engine's index of the atmosphere. Error: it shines without taking anything, so that endless rays are infinite.
    pub fn add_atmosphere(&mut self, scene: &Scene, diags: &mut Diagnostics) -> u32 {
        let m = &scene.atmosphere;
        let extinction = m.absorption + m.scattering;
        let endless = m.emission.cmpgt(DVec3::ZERO) & extinction.cmple(DVec3::ZERO);
        if endless.any() {
            let message = "the atmosphere emits light and takes none: along a ray without end that adds up to infinity";
            let hint = "give the top-level `media` some absorption or scattering, or put it inside an object";
            diags.push(super::at_place(
                Diagnostic::error("C0401", message).hint(hint),
                &scene.atmosphere_place,
            ));
            return engine::CLEAR;
        }
        self.add(m)
    }
}

fn compiled(medium: &Medium) -> engine::Medium {
    let scattering = medium.scattering.as_vec3();
    engine::Medium {
        extinction: (medium.absorption + medium.scattering).as_vec3(),
        scattering,
        emission: medium.emission.as_vec3(),
        phase: match medium.phase {
            // Without scattering it is never asked for, and media that differ in nothing else are one.
            _ if scattering == glam::Vec3::ZERO => phase::Phase::ISOTROPIC,
            Phase::HenyeyGreenstein(g) => phase::Phase::HenyeyGreenstein(g),
            Phase::Rayleigh => phase::Phase::Rayleigh,
            Phase::Hazy => phase::Phase::Mie(8),
            Phase::Murky => phase::Phase::Mie(32),
        },
    }
}

/// The fogs, seen from the camera at `origin`.
pub fn fogs(scene: &Scene, origin: DVec3) -> Vec<engine_fog::Fog> {
    let fog = |fog: &Fog| engine_fog::Fog {
        color: fog.color.as_vec3(),
        distance: fog.distance,
        ground: fog.ground.map(|g| engine_fog::Ground {
            up: g.up,
            offset: g.offset - origin.dot(g.up),
            falloff: g.falloff,
        }),
    };
    scene.fogs.iter().map(fog).collect()
}
