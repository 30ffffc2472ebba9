//! A scene as text: stable, one thing a line, numbers in their shortest exact form. For tests and `inspect`.

use super::*;
use glam::{DAffine3, DVec3};
use std::fmt::Write;

impl Scene {
    /// The whole scene as text. Places and what is as by default are left out; two scenes with the same text are equal.
    pub fn dump(&self) -> String {
        let mut out = String::new();
        let line = &mut out;
        if self.handedness == Handedness::Right {
            push(line, 0, "right-handed");
        }
        if self.display_is_linear {
            push(line, 0, "display linear");
        }
        if self.is_bare_model {
            push(line, 0, "bare model");
        }
        if let Some(m) = self.default_material {
            push(line, 0, &format!("default material {}", m.0));
        }
        dump_defaults(line, &self.defaults);
        for (i, c) in self.cameras.iter().enumerate() {
            dump_camera(line, c, self.active_camera == Some(i));
        }
        dump_environment(line, &self.environment);
        for l in &self.lights {
            dump_light(line, l);
        }
        for o in &self.objects {
            dump_object(line, 0, o);
        }
        for (i, g) in self.groups.iter().enumerate() {
            push(line, 0, &format!("group {i}"));
            for o in &g.objects {
                dump_object(line, 1, o);
            }
        }
        for (i, m) in self.meshes.iter().enumerate() {
            dump_mesh(line, i, m);
        }
        for (i, m) in self.materials.iter().enumerate() {
            push(line, 0, &format!("material {i} {}", material_text(m)));
        }
        for (i, t) in self.textures.iter().enumerate() {
            push(line, 0, &format!("texture {i} {t:?}"));
        }
        for (i, image) in self.images.iter().enumerate() {
            push(line, 0, &format!("image {i} {:?}", image.source));
        }
        out
    }
}

fn push(out: &mut String, depth: usize, text: &str) {
    out.push_str(&"  ".repeat(depth));
    out.push_str(text);
    out.push('\n');
}

/// Adds 0 so that −0 prints as 0.
fn num(v: f64) -> String {
    format!("{}", v + 0.0)
}

fn vec(v: DVec3) -> String {
    format!("<{}, {}, {}>", num(v.x), num(v.y), num(v.z))
}

fn dump_defaults(out: &mut String, d: &RenderDefaults) {
    let mut text = String::from("render");
    if let Some([w, h]) = d.resolution {
        let _ = write!(text, " resolution {w}x{h}");
    }
    let numbers = [("error", d.error), ("confidence", d.confidence), ("time", d.time)];
    let counts = [
        ("spp", d.spp.map(u64::from)),
        ("max_depth", d.max_depth.map(u64::from)),
        ("seed", d.seed),
    ];
    for (name, v) in counts {
        if let Some(v) = v {
            let _ = write!(text, " {name} {v}");
        }
    }
    for (name, v) in numbers {
        if let Some(v) = v {
            let _ = write!(text, " {name} {}", num(v));
        }
    }
    if let Some(f) = d.filter {
        let _ = write!(text, " filter {f:?}");
    }
    if text != "render" {
        push(out, 0, &text);
    }
}

fn dump_camera(out: &mut String, c: &Camera, active: bool) {
    let active = if active { "" } else { " (inactive)" };
    push(out, 0, &format!("camera {:?}{active}", c.projection));
    for (name, v) in [
        ("location", c.location),
        ("direction", c.direction),
        ("right", c.right),
        ("up", c.up),
    ] {
        push(out, 1, &format!("{name} {}", vec(v)));
    }
    if c.aspect == Aspect::FromImage {
        push(out, 1, "aspect from image");
    }
    if c.lens_radius != 0.0 {
        push(
            out,
            1,
            &format!("lens {} focus {}", num(c.lens_radius), num(c.focus_distance)),
        );
    }
}

fn dump_environment(out: &mut String, e: &Environment) {
    let mut text = match &e.kind {
        EnvironmentKind::Black => String::new(),
        EnvironmentKind::Constant(c) => format!("environment {}", vec(*c)),
        EnvironmentKind::Image {
            image,
            strength,
            rotation,
        } => {
            let columns = [rotation.x_axis, rotation.y_axis, rotation.z_axis].map(vec).join(" ");
            format!(
                "environment image {} strength {} rotation {columns}",
                image.0,
                num(*strength)
            )
        }
    };
    if !text.is_empty() && !e.illuminates {
        text.push_str(" unlit");
    }
    if let Some(b) = e.backdrop {
        let _ = write!(text, " backdrop {}", vec(b));
    }
    if !text.is_empty() {
        push(out, 0, text.trim());
    }
}

fn dump_light(out: &mut String, l: &Light) {
    let falloff = |f: &Falloff| match f {
        Falloff::None => String::new(),
        Falloff::Fade { distance, power } => format!(" fade {} {}", num(*distance), num(*power)),
        Falloff::InverseSquare { range } => format!(
            " inverse square{}",
            range.map_or(String::new(), |r| format!(" range {}", num(r)))
        ),
    };
    let profile = |p: &SpotProfile| match p {
        SpotProfile::Pov {
            radius,
            falloff,
            tightness,
        } => format!(" pov {} {} {}", num(*radius), num(*falloff), num(*tightness)),
        SpotProfile::Punctual { inner, outer } => format!(" punctual {} {}", num(*inner), num(*outer)),
    };
    let kind = match &l.kind {
        LightKind::Point { position, falloff: f } => format!("point {}{}", vec(*position), falloff(f)),
        LightKind::Spot {
            position,
            axis,
            profile: p,
            falloff: f,
        } => format!(
            "spot {} axis {}{}{}",
            vec(*position),
            vec(*axis),
            profile(p),
            falloff(f)
        ),
        LightKind::Directional { direction } => format!("directional {}", vec(*direction)),
        LightKind::Area {
            position,
            axis1,
            axis2,
            circular,
            spot,
            falloff: f,
        } => {
            let round = if *circular { " circular" } else { "" };
            let spot = spot
                .as_ref()
                .map_or(String::new(), |(a, p)| format!(" axis {}{}", vec(*a), profile(p)));
            format!(
                "area {} {} {}{round}{spot}{}",
                vec(*position),
                vec(*axis1),
                vec(*axis2),
                falloff(f)
            )
        }
    };
    let shadows = if l.casts_shadows { "" } else { " shadowless" };
    push(out, 0, &format!("light {kind} color {}{shadows}", vec(l.color)));
}

fn dump_object(out: &mut String, depth: usize, o: &Object) {
    let mut text = shape_text(&o.shape);
    if let Some(m) = o.material {
        let over = if o.override_material { " override" } else { "" };
        let _ = write!(text, " material {}{over}", m.0);
    }
    if o.transform != DAffine3::IDENTITY {
        let t = &o.transform;
        let columns = [t.matrix3.x_axis, t.matrix3.y_axis, t.matrix3.z_axis]
            .map(vec)
            .join(" ");
        if t.matrix3 == glam::DMat3::IDENTITY {
            let _ = write!(text, " at {}", vec(t.translation));
        } else {
            let _ = write!(text, " axes {columns} at {}", vec(t.translation));
        }
    }
    let v = o.visibility;
    for (name, on) in [("camera", v.camera), ("shadow", v.shadow), ("indirect", v.indirect)] {
        if !on {
            let _ = write!(text, " no-{name}");
        }
    }
    if !o.name.is_empty() {
        let _ = write!(text, " name {:?}", o.name);
    }
    push(out, depth, &text);
}

fn shape_text(shape: &Shape) -> String {
    match shape {
        Shape::Sphere { center, radius } => format!("sphere {} {}", vec(*center), num(*radius)),
        Shape::Plane { normal, distance } => format!("plane {} {}", vec(*normal), num(*distance)),
        Shape::Box { min, max } => format!("box {} {}", vec(*min), vec(*max)),
        Shape::Cone {
            base,
            base_radius,
            cap,
            cap_radius,
            open,
        } => {
            let open = if *open { " open" } else { "" };
            let (r0, r1) = (num(*base_radius), num(*cap_radius));
            format!("cone {} {r0} {} {r1}{open}", vec(*base), vec(*cap))
        }
        Shape::Disc {
            center,
            normal,
            radius,
            hole_radius,
        } => format!(
            "disc {} {} {} {}",
            vec(*center),
            vec(*normal),
            num(*radius),
            num(*hole_radius)
        ),
        Shape::Torus { major, minor } => format!("torus {} {}", num(*major), num(*minor)),
        Shape::Triangle { vertices, normals } => {
            let corners = vertices.map(vec).join(" ");
            let normals = normals.map_or(String::new(), |n| format!(" normals {}", n.map(vec).join(" ")));
            format!("triangle {corners}{normals}")
        }
        Shape::Mesh(id) => format!("mesh {}", id.0),
        Shape::Group(id) => format!("group {}", id.0),
    }
}

fn dump_mesh(out: &mut String, i: usize, m: &Mesh) {
    let slots: Vec<String> = m
        .materials
        .iter()
        .map(|s| s.map_or("-".into(), |id| id.0.to_string()))
        .collect();
    let mut text = format!("mesh {i} center {}", vec(m.center));
    if !slots.is_empty() {
        let _ = write!(text, " slots {}", slots.join(" "));
    }
    if m.flip_winding {
        text.push_str(" flipped");
    }
    push(out, 0, &text);
    let f3 = |v: &glam::Vec3| format!("<{}, {}, {}>", v.x + 0.0, v.y + 0.0, v.z + 0.0);
    for (k, p) in m.positions.iter().enumerate() {
        let mut text = format!("vertex {}", f3(p));
        if let Some(n) = m.normals.get(k) {
            let _ = write!(text, " normal {}", f3(n));
        }
        for uv in &m.uvs {
            if let Some(uv) = uv.get(k) {
                let _ = write!(text, " uv <{}, {}>", uv.x + 0.0, uv.y + 0.0);
            }
        }
        push(out, 1, &text);
    }
    for (k, t) in m.triangles.iter().enumerate() {
        let slot = m.slot(k);
        let slot = if slot == 0 {
            String::new()
        } else {
            format!(" slot {slot}")
        };
        push(out, 1, &format!("face {} {} {}{slot}", t[0], t[1], t[2]));
    }
}

fn color(c: &ColorInput) -> String {
    let texture = c.texture.map_or(String::new(), |t| format!("*texture {}", t.0));
    format!("{}{texture}", vec(c.factor))
}

fn scalar(s: &ScalarInput) -> String {
    let texture = s
        .texture
        .map_or(String::new(), |(t, c)| format!("*texture {}.{c:?}", t.0));
    format!("{}{texture}", num(s.factor))
}

fn material_text(m: &Material) -> String {
    let mut text = surface_text(&m.surface);
    if m.emission.factor != DVec3::ZERO {
        let _ = write!(text, " emission {}", color(&m.emission));
    }
    if m.emission_sides != EmissionSides::ByShape {
        let _ = write!(text, " sides {:?}", m.emission_sides);
    }
    if m.opacity.mode != OpacityMode::Opaque {
        let _ = write!(text, " opacity {:?} {}", m.opacity.mode, scalar(&m.opacity.alpha));
    }
    if let Some(n) = m.normal_map {
        let _ = write!(text, " normal_map {} {}", n.texture.0, num(n.scale));
    }
    if m.interior.absorption != DVec3::ZERO {
        let _ = write!(text, " absorption {}", vec(m.interior.absorption));
    }
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
    if let Some(ior) = f.ior {
        let _ = write!(text, " ior {}", num(ior));
    }
    text
}
