//! The cases one can see, by the lecture's formulas and by pts, as a contact sheet.

use crate::tracer::{Form, Look, World};
use glam::Vec3;
use pts::compile::compile;
use pts::diag::{Diagnostics, SourceMap};
use pts::files::MemoryFiles;
use pts::load::{LoadOptions, load};
use pts::math::color::srgb_from_linear;
use pts::math::stats::Pcg;
use pts::render::driver::render;
use pts::render::report::{Picture, Silent};
use pts::render::settings::{Filter, Settings};
use std::path::Path;

/// Width and height of a picture, and its samples per pixel.
const SIZE: u32 = 160;
const SPP: u32 = 64;
/// For a world of so many triangles that each ray takes long, tried one by one.
const FEW_SPP: u32 = 16;
const GAP: u32 = 4;

/// One thing to see, described twice.
struct Pair {
    world: World,
    location: Vec3,
    look_at: Vec3,
    /// Horizontal field of view in degrees.
    angle: f32,
    /// Samples per pixel.
    spp: u32,
    /// The scene for pts, without its camera.
    scene: String,
}

/// Renders a scene in the language, by the box filter.
fn picture(scene: &str, [width, height]: [u32; 2], spp: u32) -> Picture {
    let mut files = MemoryFiles::default();
    files.insert("case.pts", scene.as_bytes());
    let (mut sources, mut diags) = (SourceMap::default(), Diagnostics::default());
    let options = LoadOptions {
        width: Some(width),
        height: Some(height),
        ..LoadOptions::default()
    };
    let described = load(Path::new("case.pts"), &files, &options, &mut sources, &mut diags);
    let compiled = described.and_then(|s| compile(&s, &files, width, height, &mut diags));
    let settings = Settings {
        filter: Filter::Box,
        nets: 16,
        ..Settings::new(width, height, spp)
    };
    match compiled {
        Some(compiled) => render(&compiled, &settings, &Silent).0,
        None => panic!("the scene is refused: {diags:?}"),
    }
}

/// Mean of a picture's green and its standard error.
pub fn mean(scene: &str, size: [u32; 2], spp: u32) -> (f64, f64) {
    let picture = picture(scene, size, spp);
    let n = picture.rgb.len() as f64;
    let variance: f64 = picture.stderr.iter().map(|e| f64::from(e[1]).powi(2)).sum();
    (
        picture.rgb.iter().map(|p| f64::from(p[1])).sum::<f64>() / n,
        variance.sqrt() / n,
    )
}

/// Draws all pairs, the lecture's above, and writes them as one PNG. Returns what each shows.
pub fn sheet(path: &Path) -> Result<Vec<&'static str>, image::ImageError> {
    let pairs = [
        ("acne: a floor that is a ball of R = 1e5", acne()),
        (
            "leaks: inside a closed ball of 24 576 slivers, all light outside",
            leaks(),
        ),
        ("a lamp that vanishes: R/d = 5e-5", vanished_lamp()),
        ("a bright rim: balls of ior 1 that should not be seen", rim()),
        ("a pane of glass, 1e-5 thick, before balls in a row", pane()),
    ];
    let (columns, step) = (pairs.len() as u32, SIZE + GAP);
    let mut sheet = image::RgbImage::from_pixel(columns * step - GAP, 2 * step - GAP, image::Rgb([255; 3]));
    for (column, (_, pair)) in pairs.iter().enumerate() {
        let camera = format!(
            "#version 3.8; camera {{ location {} look_at {} right x up y angle {} }}\n",
            vector(pair.location),
            vector(pair.look_at),
            pair.angle
        );
        let ours = picture(&(camera + &pair.scene), [SIZE, SIZE], pair.spp);
        for y in 0..SIZE {
            for x in 0..SIZE {
                let ours = ours.rgb[(y * SIZE + x) as usize][1];
                for (row, value) in [pair.lecture(x, y), ours].into_iter().enumerate() {
                    let v = (255.0 * srgb_from_linear(f64::from(value).clamp(0.0, 1.0))).round() as u8;
                    sheet.put_pixel(column as u32 * step + x, row as u32 * step + y, image::Rgb([v; 3]));
                }
            }
        }
    }
    sheet.save(path)?;
    Ok(pairs.map(|(what, _)| what).to_vec())
}

impl Pair {
    /// A pixel by the lecture's formulas.
    fn lecture(&self, x: u32, y: u32) -> f32 {
        let forward = (self.look_at - self.location).normalize();
        let right = Vec3::Y.cross(forward).normalize();
        let up = forward.cross(right);
        let half = (0.5 * self.angle).to_radians().tan();
        let mut rng = Pcg::new(u64::from(y * SIZE + x));
        let at = |k: u32, u: f32| ((k as f32 + u) / SIZE as f32 * 2.0 - 1.0) * half;
        let sum: f32 = (0..self.spp)
            .map(|_| {
                let (u, v) = (at(x, rng.next_f32()), -at(y, rng.next_f32()));
                let d = (forward + right * u + up * v).normalize();
                self.world.radiance(self.location, d, &mut rng)
            })
            .map(|l| if l.is_finite() { l } else { 0.0 })
            .sum();
        sum / self.spp as f32
    }
}

fn vector(v: Vec3) -> String {
    format!("<{}, {}, {}>", v.x, v.y, v.z)
}

const STILL_LIFE: &str = "sphere { <-0.7, 0.6, 0>, 0.6 material { diffuse { color rgb 0.7 } } }
sphere { <0.8, 0.4, -0.6>, 0.4 material { diffuse { color rgb 0.4 } } }\n";

fn still_life() -> [(Form, Look); 2] {
    [
        (Form::Ball(Vec3::new(-0.7, 0.6, 0.0), 0.6), Look::Diffuse(0.7)),
        (Form::Ball(Vec3::new(0.8, 0.4, -0.6), 0.4), Look::Diffuse(0.4)),
    ]
}

fn acne() -> Pair {
    let floor = (Form::Ball(Vec3::Y * -1e5, 1e5), Look::Diffuse(0.6));
    Pair {
        world: World {
            things: [floor].into_iter().chain(still_life()).collect(),
            sky: 0.9,
            lamp: None,
            det_eps: 0.0,
        },
        location: Vec3::new(0.0, 1.6, -5.0),
        look_at: Vec3::new(0.0, 0.5, 0.0),
        angle: 32.0,
        spp: SPP,
        scene: format!(
            "{STILL_LIFE} sphere {{ -1e5*y, 1e5 material {{ diffuse {{ color rgb 0.6 }} }} }} environment {{ color rgb 0.9 }}"
        ),
    }
}

fn vanished_lamp() -> Pair {
    let (center, radius, radiance) = (Vec3::new(-8.0, 18.0, -6.0), 1e-3, 2e8);
    let lamp = (Form::Ball(center, radius), Look::Glow(radiance));
    let floor = (Form::Ball(Vec3::Y * -100.0, 100.0), Look::Diffuse(0.6));
    let things = [lamp, floor].into_iter().chain(still_life()).collect();
    Pair {
        world: World { things, sky: 0.03, lamp: Some(0), det_eps: 0.0 },
        scene: format!(
            "{STILL_LIFE} sphere {{ -100*y, 100 material {{ diffuse {{ color rgb 0.6 }} }} }} environment {{ color rgb 0.03 }}
            sphere {{ {}, {radius} material {{ diffuse {{ color rgb 0 }} emission rgb {radiance} }} }}",
            vector(center)
        ),
        ..acne()
    }
}

fn rim() -> Pair {
    let balls = [(Vec3::new(-0.7, 0.6, 0.0), 0.6f32), (Vec3::new(0.8, 0.4, -0.6), 0.4)];
    let glass = balls.map(|(c, r)| (Form::Ball(c, r), Look::Glass(1.0)));
    let floor = (Form::Ball(Vec3::Y * -100.0, 100.0), Look::Diffuse(0.3));
    let mut scene = format!("{FLOOR} environment {{ color rgb 0.9 }}\n");
    for (c, r) in balls {
        scene += &format!(
            "sphere {{ {}, {r} material {{ glass {{ color rgb 1 ior 1 }} }} }}\n",
            vector(c)
        );
    }
    Pair {
        world: World {
            things: [floor].into_iter().chain(glass).collect(),
            sky: 0.9,
            lamp: None,
            det_eps: 0.0,
        },
        scene,
        ..acne()
    }
}

const FLOOR: &str = "sphere { -100*y, 100 material { diffuse { color rgb 0.3 } } }";

/// A pane at 60° before the left half of a row of balls.
fn pane() -> Pair {
    const THICKNESS: f32 = 1e-5;
    let along = Vec3::new(0.5, 0.0, 0.866_025_4); // the pane's direction on the floor
    let across = Vec3::new(-along.z, 0.0, along.x) * THICKNESS;
    let (near, far) = (Vec3::new(-0.9, 0.0, -2.4), Vec3::new(-0.9, 0.0, -2.4) + along * 2.0);
    let up = Vec3::Y * 3.0;
    let quad = |a: Vec3, b: Vec3| [[a, b, b + up], [a, b + up, a + up]];
    let faces = [quad(far, near), quad(near + across, far + across)].concat();
    let mut things: Vec<(Form, Look)> = faces.iter().map(|f| (Form::Triangle(*f), Look::Glass(1.5))).collect();
    things.push((Form::Ball(Vec3::Y * -100.0, 100.0), Look::Diffuse(0.3)));
    let mut scene = format!("{FLOOR} environment {{ color rgb 0.9 }}\nmesh {{\n");
    for [a, b, c] in faces {
        scene += &format!("triangle {{ {}, {}, {} }}\n", vector(a), vector(b), vector(c));
    }
    scene += "material { glass { color rgb 1 ior 1.5 } } }\n";
    for i in -6..=6 {
        let (center, albedo) = (Vec3::new(0.5 * i as f32, 0.5, 1.0), if i % 2 == 0 { 0.8 } else { 0.1 });
        things.push((Form::Ball(center, 0.25), Look::Diffuse(albedo)));
        scene += &format!(
            "sphere {{ {}, 0.25 material {{ diffuse {{ color rgb {albedo} }} }} }}\n",
            vector(center)
        );
    }
    Pair {
        world: World {
            things,
            sky: 0.9,
            lamp: None,
            det_eps: 0.0,
        },
        scene,
        ..acne()
    }
}

/// A dark closed ball of long thin triangles around the camera, which looks at its pole; all light is outside.
fn leaks() -> Pair {
    const MERIDIANS: u32 = 4096;
    const RINGS: u32 = 4;
    let point = |ring: u32, m: u32| {
        let theta = std::f64::consts::PI * f64::from(ring) / f64::from(RINGS);
        let phi = std::f64::consts::TAU * f64::from(m % MERIDIANS) / f64::from(MERIDIANS);
        let sin = if ring.is_multiple_of(RINGS) { 0.0 } else { theta.sin() };
        glam::DVec3::new(sin * phi.cos(), theta.cos(), sin * phi.sin()).as_vec3()
    };
    let mut faces = Vec::new();
    for ring in 0..RINGS {
        for m in 0..MERIDIANS {
            let [a, b, c, d] = [
                point(ring, m),
                point(ring, m + 1),
                point(ring + 1, m + 1),
                point(ring + 1, m),
            ];
            faces.extend((ring > 0).then_some([a, b, c]));
            faces.extend((ring + 1 < RINGS).then_some([a, c, d]));
        }
    }
    let mut scene = String::from("environment { color rgb 1e6 }\nmesh {\n");
    for [a, b, c] in &faces {
        scene += &format!("triangle {{ {}, {}, {} }}\n", vector(*a), vector(*b), vector(*c));
    }
    scene += "material { diffuse { color rgb 0 } emission rgb 0.2 } }\n";
    Pair {
        world: World {
            things: faces
                .into_iter()
                .map(|f| (Form::Triangle(f), Look::Glow(0.2)))
                .collect(),
            sky: 1e6,
            lamp: None,
            det_eps: 0.0,
        },
        location: Vec3::new(0.05, -0.1, 0.02),
        look_at: Vec3::new(0.0, 1.0, 0.3),
        angle: 70.0,
        spp: FEW_SPP,
        scene,
    }
}
