//! Text scenes with a shutter: what they say of places follows, what they say of anything else is told.

use crate::diag::{Diagnostics, Severity, SourceMap};
use crate::files::{Files, MemoryFiles};
use crate::load::{LoadOptions, load};
use crate::scene::{LightKind, Object, Scene, Shape};
use glam::{DAffine3, DVec3};
use std::path::Path;

fn read(text: &str, options: LoadOptions) -> (Scene, Vec<String>) {
    let mut files = MemoryFiles::default();
    files.insert("a.pts", text.as_bytes());
    let (mut sources, mut diags) = (SourceMap::default(), Diagnostics::default());
    let scene = load(Path::new("a.pts"), &files, &options, &mut sources, &mut diags);
    let told = |d: &crate::diag::Diagnostic| match d.primary_span() {
        Some(span) => format!("{} {}", sources.place(span), d.message),
        None => d.message.clone(),
    };
    assert_eq!(files.opened().len(), 1, "the text is read once");
    let told: Vec<String> = diags
        .iter()
        .filter(|d| d.severity != Severity::Error)
        .map(told)
        .collect();
    (
        scene.unwrap_or_else(|| panic!("{:?}", diags.iter().collect::<Vec<_>>())),
        told,
    )
}

/// From clock 2 to clock 3.
fn open(text: &str) -> (Scene, Vec<String>) {
    let options = LoadOptions {
        clock: Some(2.0),
        shutter: Some(1.0),
        ..LoadOptions::default()
    };
    read(text, options)
}

/// Without a word of complaint.
fn quiet(text: &str) -> Scene {
    let (scene, told) = open(text);
    assert!(told.is_empty(), "{told:?}");
    scene
}

/// Where a point of the shape is at key k.
fn at(object: &Object, k: usize, p: DVec3) -> DVec3 {
    let moved = object.motion.get(k).copied().unwrap_or(DAffine3::IDENTITY);
    (object.transform * moved).transform_point3(p)
}

fn near(a: DVec3, b: DVec3) {
    assert!((a - b).length() < 1e-12 * (1.0 + b.length()), "{a} is not {b}");
}

#[test]
fn what_is_written_with_the_clock_moves() {
    let text = "sphere { <clock, 0, 0>, 1 }\n\
                box { -1, 1 translate clock * y }\n\
                cylinder { 0, <0, 1 + clock, 0>, .5 }\n\
                sphere { 0, 1 rotate 9 * clock * z translate x }\n\
                plane { y, -clock }\n\
                triangle { <0, 0, 0>, <1, 0, 0>, <0, clock, 0> }\n\
                torus { 2, .5 scale clock }\n\
                sphere { 5, 1 }";
    let scene = quiet(text);
    let keys: Vec<usize> = scene.objects.iter().map(|o| o.motion.len()).collect();
    assert_eq!(keys, [9, 9, 9, 9, 9, 9, 9, 0]);
    let o = |i: usize| &scene.objects[i];
    for k in 0..9 {
        let clock = 2.0 + k as f64 / 8.0;
        near(at(o(0), k, DVec3::X * 3.0), DVec3::X * (clock + 1.0));
        near(at(o(1), k, DVec3::ONE), DVec3::new(1.0, 1.0 + clock, 1.0));
        near(at(o(2), k, DVec3::Y * 3.0), DVec3::Y * (1.0 + clock));
        near(at(o(2), k, DVec3::X * 0.5), DVec3::X * 0.5);
        let turn = (9.0 * clock).to_radians();
        near(at(o(3), k, DVec3::X), DVec3::new(1.0 + turn.cos(), turn.sin(), 0.0));
        near(at(o(4), k, -DVec3::Y * 2.0), -DVec3::Y * clock);
        near(at(o(5), k, DVec3::Y * 2.0), DVec3::Y * clock);
        near(at(o(6), k, DVec3::X), DVec3::X * clock);
    }
    assert!(!o(7).moves() && o(0).moves());
}

#[test]
fn unions_move_whole_and_in_their_parts() {
    let text = "union { sphere { <0, clock, 0>, 1 } sphere { 3, 1 } rotate 5 * clock * y }\n\
                #declare U = union { box { 0, 1 translate clock * z } box { 2, 3 } };\n\
                object { U } object { U translate clock * x }";
    let scene = quiet(text);
    assert_eq!(
        scene.objects.iter().map(|o| o.motion.len()).collect::<Vec<_>>(),
        [9, 0, 9]
    );
    let inside: Vec<Vec<usize>> = scene
        .groups
        .iter()
        .map(|g| g.objects.iter().map(|o| o.motion.len()).collect())
        .collect();
    assert_eq!(inside, [[9, 0], [9, 0]], "each group once");
    let inner = &scene.groups[0].objects[0];
    near(at(inner, 8, DVec3::new(0.0, 2.0, 0.0)), DVec3::Y * 3.0);
}

#[test]
fn cameras_and_lamps_move() {
    let text = "camera { location <clock, 0, -5> look_at 0 }\n\
                light_source { <clock, 5, 0>, 1 }\n\
                light_source { 0, 1 spotlight point_at y translate clock * z }\n\
                light_source { 9, 1 }\n\
                sphere { 0, 1 }";
    let scene = quiet(text);
    let camera = scene.camera().expect("a camera");
    assert_eq!(camera.motion.len(), 9);
    assert_eq!(camera.motion[0], camera.key());
    assert_eq!(camera.motion[8].location, DVec3::new(3.0, 0.0, -5.0));
    let axis = camera.motion[8].direction.normalize();
    near(axis, -DVec3::new(3.0, 0.0, -5.0).normalize());
    let place = |l: usize, k: usize| match scene.lights[l].motion.get(k) {
        Some(LightKind::Point { position, .. } | LightKind::Spot { position, .. }) => Some(*position),
        _ => None,
    };
    assert_eq!(place(0, 8), Some(DVec3::new(3.0, 5.0, 0.0)));
    assert_eq!(place(1, 4), Some(DVec3::Z * 2.5));
    assert_eq!(place(2, 0), None);
}

/// As finely as it takes: nine keys do for 45°, a whole turn takes all of them.
#[test]
fn fast_turns_are_read_more_finely() {
    let keys = |degrees: u32| {
        let scene = quiet(&format!("box {{ -1, 1 rotate {degrees} * clock * y }}"));
        scene.objects[0].motion.len()
    };
    assert_eq!([keys(5), keys(45), keys(360)], [9, 9, 65]);
}

/// Each is told once, at its place, and stands or looks as it does when the shutter opens; the rest still moves.
#[test]
fn what_changes_otherwise_is_told() {
    let base = "sphere { <clock, 0, 0>, 1 }\n";
    let cases = [
        (
            "sphere { 9, 1 pigment { rgb <clock, 0, 0> } }",
            "a sphere changes its look",
        ),
        ("torus { 2, clock / 5 }", "a torus changes its form"),
        ("#if (clock > 2.5) box { 0, 1 } #end", "a box appears"),
        ("#if (clock < 2.5) box { 0, 1 } #end", "a box is there only for a while"),
        (
            "#for (I, 1, floor(2 * clock)) box { I, I + 1 } #end",
            "a box is there only for a while",
        ),
        (
            "mesh { triangle { 0, x, <0, clock, 0> } triangle { 0, x, z } }",
            "a mesh changes its vertices",
        ),
        ("light_source { 5, rgb clock }", "a lamp changes its light"),
        ("background { rgb clock }", "the environment changes"),
        ("#if (clock = 2.5) #error \"no\" #end", "cannot be read at clock 2.5"),
    ];
    for (line, message) in cases {
        let (scene, told) = open(&format!("{base}{line}"));
        let about = told.iter().filter(|t| t.contains(message)).count();
        assert!(about >= 1, "{line}: {told:?}");
        assert!(told.len() <= 4, "{line}: {told:?}");
        let has_place = told.iter().any(|t| t.starts_with("a.pts:2") && t.contains(message));
        let is_whole_scene = message.contains("environment");
        assert!(has_place || is_whole_scene, "{line}: {told:?}");
        let moves = scene.objects[0].moves();
        assert_eq!(moves, !message.contains("cannot be read"), "{line}: {told:?}");
    }
}

#[test]
fn a_mesh_that_is_moved_as_a_whole_moves() {
    let text = "mesh { triangle { <clock, 0, 0>, <1 + clock, 0, 0>, <clock, 1, 0> } }\n\
                mesh { triangle { 0, x, y } rotate clock * z }";
    let scene = quiet(text);
    let Shape::Mesh(id) = scene.objects[0].shape else {
        panic!("no mesh")
    };
    let corner = scene.meshes[id.index()].center + scene.meshes[id.index()].positions[0].as_dvec3();
    near(at(&scene.objects[0], 8, corner), DVec3::X * 3.0);
    assert_eq!(scene.objects[1].motion.len(), 9);
}

#[test]
fn the_scene_or_the_command_opens_the_shutter() {
    let text = "render { shutter .5 } sphere { <clock, 0, 0>, 1 }";
    let (scene, _) = read(text, LoadOptions::default());
    assert_eq!(scene.objects[0].motion.last().map(|m| m.translation.x), Some(0.5));
    let closed = LoadOptions {
        shutter: Some(0.0),
        ..LoadOptions::default()
    };
    assert!(read(text, closed).0.objects[0].motion.is_empty());
    assert!(
        read("sphere { <clock, 0, 0>, 1 }", LoadOptions::default()).0.objects[0]
            .motion
            .is_empty()
    );
    let (_, told) = read("render { shutter 1 } sphere { 0, 1 }", LoadOptions::default());
    assert!(told.len() == 1 && told[0].contains("nothing moves"), "{told:?}");
}

/// The end of the shutter is no other scene: what depends on whether the clock runs stays.
#[test]
fn the_clock_is_on_for_all_moments_or_for_none() {
    let text = "#if (clock_on) box { 0, 1 } #end sphere { <clock, 0, 0>, 1 }";
    let from = |clock| LoadOptions {
        clock: Some(clock),
        shutter: Some(1.0),
        ..LoadOptions::default()
    };
    for (clock, objects) in [(0.0, 1), (1.0, 2)] {
        let (scene, told) = read(text, from(clock));
        assert!(scene.objects.len() == objects && told.is_empty(), "{told:?}");
    }
}

/// Random numbers, macros and loops are the same each time, so that only the clock tells moments apart.
#[test]
fn made_scenes_follow() {
    let text = "#declare S = seed(4);\n\
                #macro Ball(P) sphere { P + clock * <rand(S), rand(S), 0>, .1 } #end\n\
                #for (I, 1, 50) Ball(<I, 0, 0>) #end";
    let scene = quiet(text);
    assert_eq!(scene.objects.len(), 50);
    assert!(scene.objects.iter().all(Object::moves));
}
