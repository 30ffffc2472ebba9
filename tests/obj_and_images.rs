//! Malformed models and images: each is told with its place, none stops the program.

use pts::diag::{Diagnostics, Severity};
use pts::files::{DiskFiles, Files, MemoryFiles};
use pts::import::obj::{ObjOptions, load};
use pts::output::{Develop, Format, Layers, encode};
use pts::pictures::{Limits, decode, read_exr_channels};
use std::path::Path;

/// File, code, and the line it must point at (in the file itself or its library).
const OBJ: &[(&str, &str, &str)] = &[
    ("binary.obj", "O0002", "binary.obj:1"),
    ("comments_only.obj", "O0003", "comments_only.obj:1"),
    ("corner_of_four_parts.obj", "O0109", "corner_of_four_parts.obj:5"),
    ("corner_without_vertex.obj", "O0109", "corner_without_vertex.obj:6"),
    ("crossing_outline.obj", "O0121", "crossing_outline.obj:5"),
    ("curves_only.obj", "O0112", "curves_only.obj:7"),
    ("d_out_of_range.obj", "O0211", "d_out_of_range.mtl:1"),
    ("decimal_comma.obj", "O0101", "decimal_comma.obj:1"),
    ("empty.obj", "O0003", "empty.obj:1"),
    (
        "face_before_its_vertices.obj",
        "O0107",
        "face_before_its_vertices.obj:1",
    ),
    (
        "face_of_one_corner_thrice.obj",
        "O0106",
        "face_of_one_corner_thrice.obj:5",
    ),
    ("face_of_two_corners.obj", "O0106", "face_of_two_corners.obj:5"),
    ("face_without_area.obj", "O0120", "face_without_area.obj:1"),
    ("html.obj", "O0111", "html.obj:1"),
    ("index_is_a_fraction.obj", "O0109", "index_is_a_fraction.obj:5"),
    (
        "index_negative_past_the_start.obj",
        "O0107",
        "index_negative_past_the_start.obj:5",
    ),
    ("index_overflows.obj", "O0109", "index_overflows.obj:5"),
    ("index_past_the_end.obj", "O0107", "index_past_the_end.obj:5"),
    ("index_zero.obj", "O0107", "index_zero.obj:5"),
    ("kd_negative.obj", "O0205", "kd_negative.mtl:2"),
    ("kd_of_two_numbers.obj", "O0205", "kd_of_two_numbers.mtl:2"),
    ("kd_of_words.obj", "O0205", "kd_of_words.mtl:2"),
    ("kd_without_numbers.obj", "O0205", "kd_without_numbers.mtl:2"),
    (
        "library_without_materials.obj",
        "O0203",
        "library_without_materials.mtl:1",
    ),
    ("missing_library.obj", "O0201", "missing_library.obj:1"),
    ("ni_below_one.obj", "O0212", "ni_below_one.mtl:1"),
    ("no_faces.obj", "O0003", "no_faces.obj:1"),
    ("ns_is_a_word.obj", "O0206", "ns_is_a_word.mtl:2"),
    ("points_and_lines_only.obj", "O0112", "points_and_lines_only.obj:5"),
    ("property_before_newmtl.obj", "O0202", "property_before_newmtl.mtl:1"),
    ("smoothing_word.obj", "O0113", "smoothing_word.obj:5"),
    (
        "texture_index_past_the_end.obj",
        "O0108",
        "texture_index_past_the_end.obj:6",
    ),
    ("texture_missing.obj", "O0209", "texture_missing.mtl:2"),
    ("texture_option_unknown.obj", "O0207", "texture_option_unknown.mtl:2"),
    ("texture_without_name.obj", "O0208", "texture_without_name.mtl:2"),
    ("undefined_material.obj", "O0210", "undefined_material.obj:6"),
    ("unknown_statement.obj", "O0111", "unknown_statement.obj:5"),
    ("usemtl_without_name.obj", "O0114", "usemtl_without_name.obj:5"),
    ("vertex_cut_off.obj", "O0102", "vertex_cut_off.obj:3"),
    ("vertex_with_word.obj", "O0101", "vertex_with_word.obj:2"),
    ("vertices_not_finite.obj", "O0104", "vertices_not_finite.obj:1"),
    ("weight_zero.obj", "O0103", "weight_zero.obj:1"),
];

/// File and code.
const IMAGES: &[(&str, &str)] = &[
    ("bad_depth.png", "I0005"),
    ("bad_offset.bmp", "I0005"),
    ("bad_offsets.exr", "I0005"),
    ("empty.png", "I0001"),
    ("garbage_deflate.png", "I0005"),
    ("git_lfs_pointer.png", "I0002"),
    ("header_only.jpg", "I0005"),
    ("huge.bmp", "I0005"),
    ("huge.exr", "I0005"),
    ("huge.hdr", "I0004"),
    ("huge.ppm", "I0004"),
    ("huge_dimensions.png", "I0004"),
    ("no_colour.exr", "I0006"),
    ("no_pixels.exr", "I0005"),
    ("only_magic.exr", "I0005"),
    ("only_signature.png", "I0005"),
    ("random.jpg", "I0002"),
    ("text.png", "I0002"),
    ("texture.dds", "I0003"),
    ("too_many_texels.png", "I0004"),
    ("truncated.gif", "I0005"),
    ("truncated.hdr", "I0005"),
    ("truncated.png", "I0005"),
    ("truncated.tga", "I0005"),
    ("truncated.webp", "I0005"),
    ("words.ppm", "I0005"),
    ("wrong_crc.png", "I0005"),
    ("zero_width.png", "I0005"),
];

fn names(dir: &str, ending: Option<&str>) -> Vec<String> {
    let all = DiskFiles::default().list(Path::new(dir));
    all.into_iter()
        .filter(|n| ending.is_none_or(|e| n.ends_with(e)))
        .collect()
}

#[test]
fn every_bad_model_is_told_with_its_place() {
    assert_eq!(
        names("tests/bad/obj", Some(".obj")).len(),
        OBJ.len(),
        "the table lists every file"
    );
    for (name, code, line) in OBJ {
        let path = format!("tests/bad/obj/{name}");
        let mut diags = Diagnostics::default();
        let scene = load(
            Path::new(&path),
            &DiskFiles::default(),
            &ObjOptions::default(),
            &mut diags,
        );
        assert_eq!(
            scene.is_none(),
            diags.has_errors(),
            "{name}: a scene if and only if there is no error"
        );
        let told: Vec<String> = diags
            .iter()
            .map(|d| format!("{} {:?} {}", d.code, d.place, d.message))
            .collect();
        let found = diags
            .iter()
            .find(|d| d.code == *code)
            .unwrap_or_else(|| panic!("{name}: no {code} in {told:#?}"));
        assert_eq!(
            found.place.as_deref(),
            Some(format!("tests/bad/obj/{line}").as_str()),
            "{name}: {told:#?}"
        );
        assert!(
            diags.iter().all(|d| d.place.is_some() && !d.message.contains('\n')),
            "{name}: {told:#?}"
        );
        assert!(
            diags
                .iter()
                .all(|d| d.severity != Severity::Error || !d.hints.is_empty()),
            "{name}: {told:#?}"
        );
    }
}

#[test]
fn every_bad_image_is_told_with_its_place() {
    assert_eq!(
        names("tests/bad/images", None).len(),
        IMAGES.len(),
        "the table lists every file"
    );
    for (name, code) in IMAGES {
        let bytes = std::fs::read(format!("tests/bad/images/{name}")).expect("the file is there");
        let error = decode(&bytes, name, Limits::default()).expect_err(name);
        assert_eq!(
            (error.code, error.place.as_deref()),
            (*code, Some(*name)),
            "{}",
            error.message
        );
        assert!(
            !error.hints.is_empty() && !error.message.contains('\n'),
            "{name}: {}",
            error.message
        );
    }
}

/// Splitmix64: reproducible bytes.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % n as u64) as usize
    }
}

/// A file with up to eight bytes changed, and cut off every fourth time.
fn mutated(original: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = original.to_vec();
    for _ in 0..1 + random.below(8) {
        let at = random.below(bytes.len());
        bytes[at] = random.below(256) as u8;
    }
    if random.below(4) == 0 {
        bytes.truncate(random.below(bytes.len()) + 1);
    }
    bytes
}

/// One small picture in every format that can be written.
fn sample_images() -> Vec<(&'static str, Vec<u8>)> {
    let rgb: Vec<[f32; 3]> = (0..24 * 20)
        .map(|i| [0.1, 0.4, 0.7].map(|o| (i as f32 * 0.013 + o).fract()))
        .collect();
    let layers = Layers {
        samples: Some(vec![9; rgb.len()]),
        ..Layers::from_rgb(24, 20, rgb)
    };
    let names = [
        (Format::Png, "a.png"),
        (Format::Exr, "a.exr"),
        (Format::Hdr, "a.hdr"),
        (Format::Jpeg, "a.jpg"),
        (Format::Ppm, "a.ppm"),
    ];
    let meta = serde_json::json!({ "seed": 1 });
    let encoded = |f| encode(f, &layers, &Develop::default(), &meta).expect("encodes").bytes;
    names
        .into_iter()
        .map(|(format, name)| (name, encoded(format)))
        .collect()
}

#[test]
fn images_with_changed_bytes_decode_or_are_refused() {
    // A small limit keeps changed sizes from costing time; larger ones are refused by the same check.
    let limits = Limits {
        max_texels: 1 << 16,
        max_bytes: 1 << 22,
    };
    for (name, original) in sample_images() {
        let mut random = Random(7);
        let mut refused = 0;
        for _ in 0..400 {
            let bytes = mutated(&original, &mut random);
            match decode(&bytes, name, limits) {
                Ok(picture) => assert_eq!(
                    picture.texels.len() as u64,
                    u64::from(picture.width) * u64::from(picture.height)
                ),
                Err(error) => {
                    assert!(error.place.is_some() && !error.hints.is_empty());
                    refused += 1;
                }
            }
            if name == "a.exr" {
                let _ = read_exr_channels(&bytes, limits);
            }
        }
        assert!(refused > 0, "{name}: not one of 400 damaged files was noticed");
    }
}

#[test]
fn models_with_changed_bytes_load_or_are_refused() {
    let obj =
        b"mtllib a.mtl\no one\nv 0 0 0 1 0 0\nv 1 0 0\nv 1 1 0\nv 0.2 0.3 0\nvt 0 0\nvt 1 1\nvn 0 0 1\ns 1\nusemtl m\n\
        f 1/1/1 2/2 3//1 -1\ns off\no two\nusemtl n\nf 1 2 3\nf 4 3 2 1 # end\n";
    let mtl =
        b"newmtl m\nKd 0.5 0.5 0.5\nKs 1 1 1\nNs 50\nd 0.5\nmap_Kd -s 2 2 -o 0.1 a.png\nbump -bm 2 b_normal.png\n\
        newmtl n\nillum 4\nNi 1.4\nTf 1 1 0\nPr 0.4\n";
    let mut random = Random(11);
    let mut loaded = 0;
    for _ in 0..3000 {
        let mut files = MemoryFiles::default();
        files.insert("a.obj", mutated(obj, &mut random));
        files.insert("a.mtl", mutated(mtl, &mut random));
        files.insert("a.png", b"not decoded here".as_slice());
        files.insert("b_normal.png", b"nor here".as_slice());
        let mut diags = Diagnostics::default();
        let scene = load(Path::new("a.obj"), &files, &ObjOptions::default(), &mut diags);
        assert_eq!(scene.is_none(), diags.has_errors());
        assert!(diags.iter().all(|d| d.place.is_some()));
        for mesh in scene.iter().flat_map(|s| s.meshes.iter()) {
            let n = mesh.positions.len();
            assert!(mesh.triangles.iter().flatten().all(|&i| (i as usize) < n));
            assert!(mesh.normals.is_empty() || mesh.normals.len() == n);
            assert!(mesh.tangents.is_empty() || mesh.tangents.len() == n);
            assert!(mesh.uvs.iter().all(|uv| uv.len() == n));
            assert!(mesh.face_materials.iter().all(|&s| (s as usize) < mesh.materials.len()));
        }
        loaded += usize::from(scene.is_some());
    }
    assert!((100..2900).contains(&loaded), "{loaded} of 3000 were loaded");
}
