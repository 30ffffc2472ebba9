//! Materials as text, for the dump of a scene: what is as by default is left out.

use super::dump::{num, vec};
use super::*;
use glam::DVec3;
use std::fmt::Write;

fn color(c: &ColorInput) -> String {
    let texture = c.texture.map_or(String::new(), |t| format!("*texture {}", t.0));
    format!("{}{texture}", vec(c.factor))
}

fn scalar(s: &ScalarInput) -> String {
    let texture = s
        .texture
        .map_or(String::new(), |(t, c)| format!("*texture {}.{c:?}", t.0));
    let offset = match s.offset {
        0.0 => String::new(),
        offset => format!("{}+", num(offset)),
    };
    format!("{offset}{}{texture}", num(s.factor))
}

/// What a medium does, each with a space before it; nothing for a clear one.
pub(super) fn medium_text(m: &Medium) -> String {
    let mut text = String::new();
    let parts = [
        ("absorption", m.absorption),
        ("scattering", m.scattering),
        ("medium emission", m.emission),
    ];
    for (name, v) in parts.into_iter().filter(|(_, v)| *v != DVec3::ZERO) {
        let _ = write!(text, " {name} {}", vec(v));
    }
    if m.phase != Phase::default() {
        let _ = write!(text, " phase {:?}", m.phase);
    }
    text
}

pub(super) fn material_text(m: &Material) -> String {
    let mut text = surface_text(&m.surface);
    if m.emission.factor != DVec3::ZERO {
        let _ = write!(text, " emission {}", color(&m.emission));
    }
    if m.emission_sides != EmissionSides::ByShape {
        let _ = write!(text, " sides {:?}", m.emission_sides);
    }
    if m.unlit {
        text.push_str(" unlit");
    }
    if m.opacity.mode != OpacityMode::Opaque {
        let _ = write!(text, " opacity {:?} {}", m.opacity.mode, scalar(&m.opacity.alpha));
    }
    if let Some(n) = m.normal_map {
        let _ = write!(text, " normal_map {} {}", n.texture.0, num(n.scale));
    }
    if let Some(b) = m.bump_map {
        let _ = write!(text, " bump_map {} {}", b.texture.0, num(b.scale));
    }
    text += &medium_text(&m.interior);
    if !m.name.is_empty() {
        let _ = write!(text, " name {:?}", m.name);
    }
    text
}

fn surface_text(s: &SurfaceModel) -> String {
    match s {
        SurfaceModel::Diffuse { color: c, sigma } => format!("diffuse {} sigma {}", color(c), scalar(sigma)),
        SurfaceModel::Specular { color: c } => format!("specular {}", color(c)),
        SurfaceModel::Glass {
            color: c,
            ior,
            roughness,
            abbe,
        } => {
            let abbe = abbe.map_or(String::new(), |v| format!(" abbe {}", num(v)));
            format!(
                "glass {} ior {} roughness {}{abbe}",
                color(c),
                num(*ior),
                scalar(roughness)
            )
        }
        SurfaceModel::Glossy {
            color: c,
            roughness,
            ior,
            metal,
        } => {
            let metal = if *metal { " metal" } else { "" };
            format!(
                "glossy {} roughness {} ior {}{metal}",
                color(c),
                scalar(roughness),
                num(*ior)
            )
        }
        SurfaceModel::Translucent { color: c, transmit } => {
            format!("translucent {} transmit {}", color(c), scalar(transmit))
        }
        SurfaceModel::Principled(p) => principled_text(p),
        SurfaceModel::Finish(f) => finish_text(f),
        SurfaceModel::Mix { a, b, weight } => format!("mix {} {} {}", a.0, b.0, scalar(weight)),
        SurfaceModel::Black => "black".to_owned(),
    }
}

fn principled_text(p: &Principled) -> String {
    let d = Principled::default();
    let mut text = format!("principled {}", color(&p.base_color));
    let scalars = [
        ("metallic", p.metallic, d.metallic),
        ("roughness", p.roughness, d.roughness),
        ("specular", p.specular, d.specular),
        ("transmission", p.transmission, d.transmission),
        ("clearcoat", p.clearcoat, d.clearcoat),
        ("clearcoat_roughness", p.clearcoat_roughness, d.clearcoat_roughness),
        ("sheen_roughness", p.sheen_roughness, d.sheen_roughness),
        ("anisotropy", p.anisotropy, d.anisotropy),
        ("diffuse_transmission", p.diffuse_transmission, d.diffuse_transmission),
        ("iridescence", p.iridescence, d.iridescence),
        (
            "iridescence_thickness",
            p.iridescence_thickness,
            d.iridescence_thickness,
        ),
    ];
    for (name, v, default) in scalars {
        if v != default {
            let _ = write!(text, " {name} {}", scalar(&v));
        }
    }
    let numbers = [
        ("ior", p.ior, d.ior),
        ("anisotropy_rotation", p.anisotropy_rotation, d.anisotropy_rotation),
        ("dispersion", p.dispersion, d.dispersion),
        ("iridescence_ior", p.iridescence_ior, d.iridescence_ior),
    ];
    for (name, v, default) in numbers {
        if v != default {
            let _ = write!(text, " {name} {}", num(v));
        }
    }
    let colors = [
        ("specular_color", p.specular_color, d.specular_color),
        ("sheen_color", p.sheen_color, d.sheen_color),
        (
            "diffuse_transmission_color",
            p.diffuse_transmission_color,
            d.diffuse_transmission_color,
        ),
    ];
    for (name, v, default) in colors {
        if v != default {
            let _ = write!(text, " {name} {}", color(&v));
        }
    }
    if p.thick {
        text.push_str(" thick");
    }
    if let Some(n) = p.clearcoat_normal {
        let _ = write!(text, " clearcoat_normal {} {}", n.texture.0, num(n.scale));
    }
    if let Some(t) = p.anisotropy_direction {
        let _ = write!(text, " anisotropy_direction {}", t.0);
    }
    text
}

fn finish_text(f: &Finish) -> String {
    let d = Finish::default();
    let mut text = format!("finish {}", color(&f.color));
    let numbers = [
        ("filter", f.filter, d.filter),
        ("transmit", f.transmit, d.transmit),
        ("diffuse", f.diffuse, d.diffuse),
        ("diffuse_back", f.diffuse_back, d.diffuse_back),
        ("brilliance", f.brilliance, d.brilliance),
        ("phong", f.phong, d.phong),
        ("phong_size", f.phong_size, d.phong_size),
        ("specular", f.specular, d.specular),
        ("roughness", f.roughness, d.roughness),
        ("metallic", f.metallic, d.metallic),
    ];
    for (name, v, default) in numbers {
        if v != default {
            let _ = write!(text, " {name} {}", num(v));
        }
    }
    if let Some(r) = f.reflection {
        let _ = write!(
            text,
            " reflection {} {} falloff {}",
            vec(r.min),
            vec(r.max),
            num(r.falloff)
        );
        if r.fresnel {
            text.push_str(" fresnel");
        }
        if r.metallic != 0.0 {
            let _ = write!(text, " metallic {}", num(r.metallic));
        }
    }
    if f.conserve_energy {
        text.push_str(" conserve_energy");
    }
    if f.dispersion != 0.0 {
        let _ = write!(text, " dispersion {}", num(f.dispersion));
    }
    if let Some(ior) = f.ior {
        let _ = write!(text, " ior {}", num(ior));
    }
    text
}
