//! A scene as text: stable, one thing a line, numbers in their shortest exact form. For tests and `inspect`.

use super::dump_material::{material_text, medium_text};
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
        if !self.atmosphere.is_clear() {
            push(line, 0, &format!("atmosphere{}", medium_text(&self.atmosphere)));
        }
        for f in &self.fogs {
            let ground = f.ground.map_or(String::new(), |g| {
                format!(" up {} offset {} falloff {}", vec(g.up), num(g.offset), num(g.falloff))
            });
            push(
                line,
                0,
                &format!("fog {} distance {}{ground}", vec(f.color), num(f.distance)),
            );
        }
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
pub(super) fn num(v: f64) -> String {
    format!("{}", v + 0.0)
}

pub(super) fn vec(v: DVec3) -> String {
    format!("<{}, {}, {}>", num(v.x), num(v.y), num(v.z))
}

fn dump_defaults(out: &mut String, d: &RenderDefaults) {
    let mut text = String::from("render");
    if let Some([w, h]) = d.resolution {
        let _ = write!(text, " resolution {w}x{h}");
    }
    let numbers = [
        ("error", d.error),
        ("confidence", d.confidence),
        ("time", d.time),
        ("shutter", d.shutter),
    ];
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
    for key in &c.motion {
        let vectors = [key.location, key.direction, key.right, key.up].map(vec).join(" ");
        let (lens, focus) = (num(key.lens_radius), num(key.focus_distance));
        push(out, 1, &format!("key {vectors} lens {lens} focus {focus}"));
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
    let kind_text = |kind: &LightKind| match kind {
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
    let kind = kind_text(&l.kind);
    push(out, 0, &format!("light {kind} color {}{shadows}", vec(l.color)));
    for key in &l.motion {
        push(out, 1, &format!("key {}", kind_text(key)));
    }
}

fn dump_object(out: &mut String, depth: usize, o: &Object) {
    let mut text = shape_text(&o.shape);
    if let Some(m) = o.material {
        let over = if o.override_material { " override" } else { "" };
        let _ = write!(text, " material {}{over}", m.0);
    }
    if o.transform != DAffine3::IDENTITY {
        text.push_str(&map_text(&o.transform));
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
    for key in &o.motion {
        push(out, depth + 1, &format!("key{}", map_text(key)));
    }
}

fn map_text(t: &DAffine3) -> String {
    let columns = [t.matrix3.x_axis, t.matrix3.y_axis, t.matrix3.z_axis]
        .map(vec)
        .join(" ");
    if t.matrix3 == glam::DMat3::IDENTITY {
        format!(" at {}", vec(t.translation))
    } else {
        format!(" axes {columns} at {}", vec(t.translation))
    }
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
    for (i, form) in m.later.iter().enumerate() {
        push(out, 1, &format!("form {}", i + 1));
        for (k, p) in form.positions.iter().enumerate() {
            let normal = form
                .normals
                .get(k)
                .map_or(String::new(), |n| format!(" normal {}", f3(n)));
            push(out, 2, &format!("vertex {}{normal}", f3(p)));
        }
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
