//! What a model means once it is loaded.

use super::{ObjOptions, load};
use crate::diag::{Anomaly, Diagnostics};
use crate::files::{Files, MemoryFiles};
use crate::scene::{
    Channel, ColorInput, Encoding, ImageTexture, Material, Mesh, OpacityMode, Principled, Scene, SurfaceModel, Texture,
    Wrap,
};
use glam::{DVec2, DVec3, Vec2, Vec3};
use std::path::{Path, PathBuf};

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

fn load_files(list: &[(&str, &[u8])]) -> (Scene, Diagnostics) {
    let mut files = MemoryFiles::default();
    for (name, data) in list {
        files.insert(*name, *data);
    }
    let mut diags = Diagnostics::default();
    let scene = load(Path::new("m/a.obj"), &files, &ObjOptions::default(), &mut diags);
    (scene.unwrap_or_else(|| panic!("not loaded: {diags:#?}")), diags)
}

fn load_text(obj: &str) -> (Scene, Diagnostics) {
    load_files(&[("m/a.obj", obj.as_bytes())])
}

fn quiet(obj: &str) -> Scene {
    let (scene, diags) = load_text(obj);
    assert!(diags.is_empty(), "{diags:#?}");
    scene
}

/// The material of the only slot of a square with this MTL text, and the scene.
fn material(mtl: &str) -> (Material, Scene, Diagnostics) {
    let obj = format!("mtllib a.mtl\n{SQUARE}vt 0 0\nusemtl m\nf 1/1 2/1 3/1 4/1\n");
    let mtl = format!("newmtl m\n{mtl}\n");
    let image: &[u8] = b"not decoded by the import";
    let list = [
        ("m/a.obj", obj.as_bytes()),
        ("m/a.mtl", mtl.as_bytes()),
        ("m/Textures/Wood.PNG", image),
        ("m/b_normal.png", image),
        ("m/bump.png", image),
    ];
    let (scene, diags) = load_files(&list);
    let id = scene.meshes[0].slot_material(0).expect("a material");
    (scene.materials[id.index()].clone(), scene, diags)
}

fn area_vector(mesh: &Mesh) -> DVec3 {
    let at = |i: u32| mesh.positions[i as usize].as_dvec3();
    mesh.triangles
        .iter()
        .map(|&[a, b, c]| (at(b) - at(a)).cross(at(c) - at(a)) * 0.5)
        .sum()
}

#[test]
fn negative_indices_count_back_and_texture_rows_count_from_the_top() {
    let scene = quiet(&format!("{SQUARE}vt 0 0\nvt 1 0.25\nvt 0 1\nf -4/-3 -3/-2 -1/-1\n"));
    let mesh = &scene.meshes[0];
    let corner = |p: Vec3| {
        mesh.positions
            .iter()
            .position(|q| *q + mesh.center.as_vec3() == p)
            .expect("a vertex")
    };
    assert_eq!(mesh.uvs[0][corner(Vec3::ZERO)], Vec2::new(0.0, 1.0));
    assert_eq!(mesh.uvs[0][corner(Vec3::X)], Vec2::new(1.0, 0.75));
    assert_eq!(mesh.uvs[0][corner(Vec3::Y)], Vec2::new(0.0, 0.0));
    assert!(scene.is_bare_model && scene.objects.len() == 1);
}

#[test]
fn a_concave_polygon_keeps_its_area_and_side() {
    let scene = quiet("v 0 0 0\nv 4 0 0\nv 4 4 0\nv 2 1 0\nv 0 4 0\nf 1 2 3 4 5\n");
    assert_eq!(area_vector(&scene.meshes[0]), DVec3::new(0.0, 0.0, 10.0));
}

#[test]
fn a_model_far_away_keeps_the_shape_it_has_at_home() {
    let shape = |x: f64| {
        let v = |a: f64, b: f64| format!("v {} {} -7\n", x + a, b);
        quiet(&format!("{}{}{}f 1 2 3\n", v(0.0, 0.0), v(0.001, 0.0), v(0.0, 0.001)))
    };
    let (home, away) = (shape(0.0), shape(16_777_216.0));
    // Written numbers are f64: at 2²⁴ they have steps of 2⁻²⁸.
    for (a, b) in home.meshes[0].positions.iter().zip(&away.meshes[0].positions) {
        assert!((*a - *b).abs().max_element() < 8e-9, "{a} became {b}");
    }
    assert!((away.meshes[0].center.x - 16_777_216.000_5).abs() < 1e-8);
}

#[test]
fn smoothing_groups_share_normals_inside_and_not_across() {
    // Two walls at a right angle that meet in the edge 2–5.
    let walls = "v 0 0 0\nv 1 0 0\nv 1 0 -1\nv 0 1 0\nv 1 1 0\nv 1 1 -1\n";
    let faces = |a: &str, b: &str| format!("{walls}s {a}\nf 1 2 5 4\ns {b}\nf 2 3 6 5\n");
    assert!(quiet(&faces("off", "0")).meshes[0].normals.is_empty());
    let smooth = quiet(&faces("1", "1"));
    let mesh = &smooth.meshes[0];
    assert_eq!(mesh.positions.len(), 6);
    let diagonal = Vec3::new(1.0, 0.0, 1.0).normalize();
    let on_edge = |m: &Mesh| -> Vec<Vec3> {
        let x = |i: usize| m.positions[i] + m.center.as_vec3();
        (0..m.positions.len())
            .filter(|&i| x(i).x == 1.0 && x(i).z == 0.0)
            .map(|i| m.normals[i])
            .collect()
    };
    for n in on_edge(mesh) {
        assert!((n - diagonal).length() < 1e-6, "{n}");
    }
    let apart = quiet(&faces("1", "2"));
    let normals = on_edge(&apart.meshes[0]);
    assert_eq!(normals.len(), 4, "the edge's vertices are split");
    assert!(
        normals
            .iter()
            .all(|n| (*n - Vec3::X).length() < 1e-6 || (*n - Vec3::Z).length() < 1e-6)
    );
}

#[test]
fn given_normals_are_kept_and_zero_ones_replaced() {
    let (scene, diags) = load_text(&format!("{SQUARE}vn 0 3 4\nvn 0 0 0\nf 1//1 2//1 3//2\n"));
    assert_eq!(diags.anomalies().of(Anomaly::ReplacedNormal), 1);
    let mesh = &scene.meshes[0];
    let normals: Vec<Vec3> = mesh.triangles[0].iter().map(|&i| mesh.normals[i as usize]).collect();
    assert_eq!(normals, [Vec3::new(0.0, 0.6, 0.8), Vec3::new(0.0, 0.6, 0.8), Vec3::Z]);
}

#[test]
fn objects_become_meshes_and_materials_become_slots() {
    let mtl = b"newmtl red\nKd 1 0 0\nnewmtl gr\xfcn\nKd 0 1 0\nnewmtl unused\nmap_Kd missing.png\n";
    let obj = [
        b"mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\no Stra\xdfe\nusemtl red\nf 1 2 3\nusemtl gr\xfcn\nf 1 3 4\n".as_slice(),
        b"usemtl red\nf 2 3 4\no empty\no other\ng part\nf 1 2 4\n",
    ];
    let (scene, diags) = load_files(&[("m/a.obj", &obj.concat()), ("m/a.mtl", mtl)]);
    assert!(
        diags.is_empty(),
        "an unused material's texture is nobody's business: {diags:#?}"
    );
    let names: Vec<&str> = scene.objects.iter().map(|o| o.name.as_str()).collect();
    assert_eq!(names, ["Straße", "other"]);
    assert_eq!(scene.meshes[0].face_materials, [0, 1, 0]);
    let name_of = |slot| {
        scene.materials[scene.meshes[0].slot_material(slot).expect("some").index()]
            .name
            .clone()
    };
    assert_eq!([name_of(0), name_of(1)], ["red", "grün"]);
    assert_eq!(scene.materials.len(), 2, "only used materials are converted");
    assert!(scene.meshes[1].face_materials.is_empty() && scene.meshes[1].materials.len() == 1);
}

#[test]
fn vertex_colours_are_display_values_and_shown_where_no_material_is() {
    let scene = quiet("v 0 0 0 1 0.5 0\nv 1 0 0 1 0.5 0\nv 1 1 0\nf 1 2 3\n");
    let mesh = &scene.meshes[0];
    assert!(
        (mesh.colors[0].y - 0.214_041).abs() < 1e-6,
        "sRGB 0.5 is {}",
        mesh.colors[0].y
    );
    assert_eq!(mesh.colors[2], glam::Vec4::ONE);
    let material = &scene.materials[mesh.slot_material(0).expect("some").index()];
    let SurfaceModel::Diffuse {
        color: ColorInput {
            texture: Some(texture), ..
        },
        ..
    } = material.surface
    else {
        panic!()
    };
    assert_eq!(scene.textures[texture.index()], Texture::VertexColor);
    let bytes = quiet("v 0 0 0 255 0 0\nv 1 0 0 255 0 0\nv 1 1 0 0 0 51\nf 1 2 3\n");
    assert_eq!(bytes.meshes[0].colors[0].x, 1.0);
}

#[test]
fn files_are_found_despite_letter_case_and_backslashes() {
    let (m, scene, diags) = material(r"map_Kd -s 2 3 -o 0.5 0 -clamp on textures\wood.png");
    assert!(diags.is_empty(), "{diags:#?}");
    let SurfaceModel::Diffuse {
        color: ColorInput {
            factor,
            texture: Some(texture),
        },
        ..
    } = m.surface
    else {
        panic!()
    };
    assert_eq!(factor, DVec3::ONE);
    let Texture::Image(ImageTexture {
        image,
        uv_transform,
        wrap_u,
        encoding,
        ..
    }) = scene.textures[texture.index()]
    else {
        panic!("no image")
    };
    assert_eq!((wrap_u, encoding), (Wrap::Clamp, Encoding::Srgb));
    assert_eq!(
        uv_transform.transform_point2(DVec2::new(1.0, 1.0)),
        DVec2::new(2.5, 1.0)
    );
    assert!(scene.images[image.index()].name.ends_with("Textures/Wood.PNG"));
}

#[test]
fn images_are_not_opened_by_the_import() {
    let mut files = MemoryFiles::default();
    files.insert("a.obj", format!("mtllib a.mtl\n{SQUARE}usemtl m\nf 1 2 3\n").as_bytes());
    files.insert("a.mtl", b"newmtl m\nmap_Kd a.png\nmap_d a.png\n".as_slice());
    files.insert("a.png", b"x".as_slice());
    let scene = load(
        Path::new("a.obj"),
        &files,
        &ObjOptions::default(),
        &mut Diagnostics::default(),
    )
    .expect("loads");
    assert_eq!(files.opened(), [PathBuf::from("a.obj"), PathBuf::from("a.mtl")]);
    assert_eq!(scene.images.len(), 1, "one file, one image");
    assert_eq!(scene.materials[0].opacity.alpha.texture.map(|t| t.1), Some(Channel::A));
}

#[test]
fn a_phong_highlight_becomes_a_coat_of_matching_roughness() {
    let SurfaceModel::Principled(p) = material("Kd 0.2 0.3 0.4\nKs 0.5 0.5 0.5\nNs 198\nillum 2").0.surface else {
        panic!()
    };
    let Principled {
        base_color,
        roughness,
        specular,
        specular_color,
        ..
    } = *p;
    assert_eq!(base_color.factor, DVec3::new(0.2, 0.3, 0.4));
    // α = sqrt(2 / 200) = 0.1; Ks 0.5 is the ordinary 4 %.
    assert!((roughness.factor.powi(2) - 0.1).abs() < 1e-12);
    assert_eq!((specular.factor, specular_color.factor), (1.0, DVec3::ONE));
    for diffuse in ["Ks 0 0 0\nillum 2", "Ks 1 1 1\nillum 1", "Ns 5"] {
        assert!(
            matches!(material(diffuse).0.surface, SurfaceModel::Diffuse { .. }),
            "{diffuse}"
        );
    }
}

#[test]
fn a_mask_is_in_the_alpha_that_varies_or_else_in_the_grey() {
    let png = |alpha: [u8; 2]| {
        let image = image::RgbaImage::from_fn(2, 1, |x, _| image::Rgba([255, 255, 255, alpha[x as usize]]));
        let mut out = std::io::Cursor::new(Vec::new());
        image.write_to(&mut out, image::ImageFormat::Png).expect("into memory");
        out.into_inner()
    };
    let obj = format!("mtllib a.mtl\n{SQUARE}vt 0 0\nusemtl m\nf 1/1 2/1 3/1 4/1\n");
    for (alpha, channel) in [([255, 0], Channel::A), ([255, 255], Channel::R)] {
        let (mask, mtl) = (png(alpha), b"newmtl m\nKd 1 1 1\nmap_d mask.png\n");
        let files = [
            ("m/a.obj", obj.as_bytes()),
            ("m/a.mtl", &mtl[..]),
            ("m/mask.png", &mask),
        ];
        let (scene, diags) = load_files(&files);
        assert!(diags.is_empty(), "{diags:#?}");
        let material = &scene.materials[scene.meshes[0].slot_material(0).expect("a material").index()];
        assert_eq!(material.opacity.alpha.texture.map(|t| t.1), Some(channel), "{alpha:?}");
    }
}

/// What Blender 5.0.1 wrote of principled surfaces whose values are known.
#[test]
fn blenders_dialect_gives_its_surface_back() {
    let read = |body: &str| {
        let mtl = format!("# Blender 5.0.1 MTL File: 'None'\n# www.blender.org\n\nnewmtl m\n{body}\n");
        let obj = format!("mtllib a.mtl\n{SQUARE}usemtl m\nf 1 2 3 4\n");
        let (scene, diags) = load_files(&[("m/a.obj", obj.as_bytes()), ("m/a.mtl", mtl.as_bytes())]);
        assert!(diags.is_empty(), "{diags:#?}");
        let m = scene.materials[scene.meshes[0].slot_material(0).expect("a material").index()].clone();
        let SurfaceModel::Principled(p) = m.surface else {
            panic!("{:?}", m.surface);
        };
        (*p, m.opacity)
    };
    let head = "Kd 0.8 0.8 0.8\nKe 0 0 0\n";
    let (p, opacity) = read(&format!("{head}Ns 250\nKa 1 1 1\nKs 0.5 0.5 0.5\nNi 1.5\nd 1\nillum 2"));
    assert_eq!(
        (p.roughness.factor, p.metallic.factor, p.specular.factor),
        (0.5, 0.0, 1.0)
    );
    assert_eq!(opacity.mode, OpacityMode::Opaque);
    let (p, _) = read(&format!("{head}Ns 640\nKa 1 1 1\nKs 0.5 0.5 0.5\nNi 1.5\nd 1\nillum 3"));
    assert!((p.roughness.factor - 0.2).abs() < 1e-12);
    assert_eq!(p.metallic.factor, 1.0);
    // Transparency is coverage here: nothing refracts.
    let (p, opacity) = read(&format!(
        "{head}Ns 250\nKa 1 1 1\nKs 0.5 0.5 0.5\nNi 1.5\nd 0.5\nillum 9"
    ));
    assert_eq!((p.metallic.factor, p.transmission.factor), (0.0, 0.0));
    assert_eq!((opacity.mode, opacity.alpha.factor), (OpacityMode::Blend, 0.5));
    let (p, _) = read(&format!("{head}Ns 250\nKa 1 1 1\nKs 0 0 0\nNi 1.5\nd 1\nillum 1"));
    assert_eq!(p.specular.factor, 0.0);
    // With its extended set on, Pr and Pm say it themselves.
    let (p, _) = read(&format!(
        "{head}Ks 0.25 0.25 0.25\nNi 1.4\nd 1\nillum 3\nPr 0.2\nPm 0.75\nPc 0.5\nPcr 0.03"
    ));
    assert_eq!(
        (p.roughness.factor, p.metallic.factor, p.specular.factor),
        (0.2, 0.75, 0.5)
    );
    assert_eq!(
        (p.ior, p.clearcoat.factor, p.clearcoat_roughness.factor),
        (1.4, 0.5, 0.03)
    );
}

#[test]
fn illumination_models_choose_glass_and_mirror() {
    let glass = material("Kd 0 0 0\nTf 0.9 1 1\nNi 1.33\nd 0.1\nillum 7").0;
    let SurfaceModel::Glass {
        color, ior, roughness, ..
    } = glass.surface
    else {
        panic!()
    };
    assert_eq!(
        (color.factor, ior, roughness.factor),
        (DVec3::new(0.9, 1.0, 1.0), 1.33, 0.0)
    );
    assert_eq!(glass.opacity.mode, OpacityMode::Opaque, "glass is all there");
    let mirror = material("Kd 0 0 0\nKs 0.9 0.9 0.9\nillum 3").0;
    assert!(matches!(mirror.surface, SurfaceModel::Specular { color } if color.factor == DVec3::splat(0.9)));
}

/// Whitted's model: Kd·diffuse + Ks·mirror, unless that is more than all.
#[test]
fn a_half_mirror_returns_what_its_two_parts_do() {
    let (m, scene, _) = material("Kd 0.3 0.3 0.3\nKs 0.5 0.5 0.5\nillum 3");
    let SurfaceModel::Mix { a, b, weight } = m.surface else {
        panic!()
    };
    let SurfaceModel::Diffuse { color: kd, .. } = scene.materials[a.index()].surface else {
        panic!()
    };
    let SurfaceModel::Specular { color: ks } = scene.materials[b.index()].surface else {
        panic!()
    };
    let w = weight.factor;
    assert!(((1.0 - w) * kd.factor.x - 0.3).abs() < 1e-12 && (w * ks.factor.x - 0.5).abs() < 1e-12);
    let (m, scene, _) = material("Kd 1 1 1\nKs 1 1 1\nillum 3");
    let SurfaceModel::Mix { a, weight, .. } = m.surface else {
        panic!()
    };
    let SurfaceModel::Diffuse { color: kd, .. } = scene.materials[a.index()].surface else {
        panic!()
    };
    assert_eq!((kd.factor, weight.factor), (DVec3::ONE, 0.5));
}

#[test]
fn metallic_roughness_emission_and_opacity_are_taken_over() {
    let m = material("Kd 1 0.5 0\nPr 0.25\nPm 1\nPc 0.5\nPcr 0.1\naniso 0.3\nanisor 0.25\nKe 2 3 4\nTr 0.75").0;
    let SurfaceModel::Principled(p) = m.surface else {
        panic!()
    };
    assert_eq!(
        (p.roughness.factor, p.metallic.factor, p.clearcoat.factor),
        (0.25, 1.0, 0.5)
    );
    assert_eq!(p.anisotropy_rotation, std::f64::consts::FRAC_PI_2);
    assert_eq!(m.emission.factor, DVec3::new(2.0, 3.0, 4.0));
    assert_eq!((m.opacity.mode, m.opacity.alpha.factor), (OpacityMode::Blend, 0.25));
    assert_eq!(material("d 0.5\nTr 0.9").0.opacity.alpha.factor, 0.5, "d wins");
}

#[test]
fn a_bump_map_is_a_normal_map_or_a_height_map() {
    let (m, scene, _) = material("bump -bm 0.5 b_normal.png");
    let normal = m.normal_map.expect("a normal map");
    assert_eq!(normal.scale, 0.5);
    let Texture::Image(ImageTexture { encoding, .. }) = scene.textures[normal.texture.index()] else {
        panic!()
    };
    assert_eq!(encoding, Encoding::Linear);
    let (m, scene, diags) = material("map_Bump -bm 3 -mm 0 0.5 bump.png");
    let bump = m.bump_map.expect("a height map");
    assert!(m.normal_map.is_none() && diags.is_empty(), "{diags:?}");
    assert_eq!(bump.scale, 1.5);
    assert!(matches!(
        scene.textures[bump.texture.index()],
        Texture::Image(ImageTexture {
            encoding: Encoding::Linear,
            ..
        })
    ));
}

#[test]
fn a_library_that_is_not_named_but_lies_beside_the_model_is_used() {
    let obj = format!("{SQUARE}usemtl m\nf 1 2 3\n");
    let (scene, diags) = load_files(&[("m/a.obj", obj.as_bytes()), ("m/a.mtl", b"newmtl m\nKd 1 0 0\n")]);
    assert_eq!(scene.materials.len(), 1);
    assert_eq!(diags.iter().map(|d| d.code).collect::<Vec<_>>(), ["O0215"]);
}

#[test]
fn what_would_be_missed_in_the_picture_is_told() {
    let codes = |mtl: &str| material(mtl).2.iter().map(|d| d.code).collect::<Vec<_>>();
    assert_eq!(codes("disp bump.png"), ["O0216"]);
    assert_eq!(codes("map_Kd -mm 0.1 2 bump.png"), ["O0217"]);
    assert!(codes("Ka 1 1 1\nmap_Ka bump.png\nillum 2").is_empty());
    let SurfaceModel::Principled(p) = material("map_Ks bump.png").0.surface else {
        panic!()
    };
    assert!(p.specular_color.texture.is_some());
}

/// Each object's table of vertices must not grow with the model: 3000 objects would take minutes.
#[test]
fn many_objects_of_few_faces_load_in_proportion() {
    let object = |i: usize| format!("o part{i}\nv {i} 0 0\nv {i} 1 0\nv {i} 0 1\ns 1\nf -3 -2 -1\n");
    let scene = quiet(&(0..3000).map(object).collect::<String>());
    assert_eq!(scene.meshes.len(), 3000);
    assert!(
        scene
            .meshes
            .iter()
            .all(|m| m.triangles.len() == 1 && m.positions.len() == 3)
    );
}

/// Each of these took quadratic time or more.
#[test]
fn small_files_that_ask_for_much_work_end_soon() {
    let begun = std::time::Instant::now();
    let mut files = MemoryFiles::default();
    let mut text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n".to_owned();
    text += &"\\\n".repeat(1_000_000);
    text += "\n";
    text += &"mtllib a.mtl\n".repeat(20_000);
    // A comb of many teeth.
    for i in 0..60_000 {
        text += &format!("v {} {} 0\n", i, if i % 2 == 0 { 0 } else { 5 + i % 7 });
    }
    text += "f 1 2 3\nf";
    (4..60_004).for_each(|i| text += &format!(" {i}"));
    files.insert("m.obj", text.into_bytes());
    let mut library = b"newmtl x\nKd 1 1 1\nmap_Bump b.png\n".to_vec();
    (0..2000).for_each(|i| library.extend(format!("newmtl x{i}\nmap_Bump b.png\n").into_bytes()));
    files.insert("a.mtl", library);
    files.insert("b.png", vec![0; 100_000]);
    let mut diags = Diagnostics::default();
    let scene = load("m.obj".as_ref(), &files, &ObjOptions::default(), &mut diags);
    assert!(scene.is_some(), "{diags:?}");
    let opened = |name: &str| files.opened().iter().filter(|p| p.as_os_str() == name).count();
    assert_eq!([opened("a.mtl"), opened("m.obj")], [1, 1]);
    assert!(opened("b.png") <= 1);
    assert!(begun.elapsed().as_secs() < 30, "{:?}", begun.elapsed());
}
