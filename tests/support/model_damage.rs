//! Loads bytes as a model or picture, as a fuzzer or a test gives them: nothing may panic, hang or take memory without
//! end. Fuzz targets and tests share these bodies.

use pts::diag::Diagnostics;
use pts::files::MemoryFiles;
use pts::import::{gltf, obj};
use pts::pictures::{Limits, cost, decode};

/// Most bytes of a picture that is decoded here.
const PICTURE: u64 = 64 << 20;

/// Loads bytes as a glTF or GLB, beside which some files lie, and compiles what can be drawn.
pub fn check_gltf(bytes: &[u8]) {
    let mut files = MemoryFiles::default();
    files.insert("m/model.glb", bytes);
    files.insert("m/b.bin", vec![0x3F; 600]);
    files.insert("m/t.png", *b"no picture");
    let mut diags = Diagnostics::default();
    let options = gltf::GltfOptions {
        clock: bytes.first().is_some_and(|b| b % 2 == 0).then_some(0.25),
        ..gltf::GltfOptions::default()
    };
    let scene = gltf::load("m/model.glb".as_ref(), &files, &options, &mut diags);
    assert_eq!(
        scene.is_none(),
        diags.has_errors(),
        "no scene if and only if there are errors"
    );
    let Some(mut scene) = scene else { return };
    if scene.objects.len() < 100 && scene.meshes.iter().map(|m| m.triangles.len()).sum::<usize>() < 10_000 {
        pts::import::framing::frame(&mut scene, 4.0 / 3.0);
        pts::compile::compile(&scene, &files, 4, 3, &mut diags);
    }
}

/// Loads bytes as an OBJ; what follows a line `#mtl` is its material library.
pub fn check_obj(bytes: &[u8]) {
    let marker = b"#mtl\n";
    let split = bytes
        .windows(marker.len())
        .position(|w| w == marker)
        .unwrap_or(bytes.len());
    let (model, library) = bytes.split_at(split);
    let mut files = MemoryFiles::default();
    files.insert("m/model.obj", model);
    files.insert("m/model.mtl", library);
    let mut diags = Diagnostics::default();
    let scene = obj::load("m/model.obj".as_ref(), &files, &obj::ObjOptions::default(), &mut diags);
    assert_eq!(
        scene.is_none(),
        diags.has_errors(),
        "no scene if and only if there are errors"
    );
}

/// Decodes bytes as a picture, unless that would be a large one.
pub fn check_picture(bytes: &[u8]) {
    let limits = Limits {
        max_texels: 1 << 22,
        max_bytes: PICTURE,
    };
    if cost(bytes, "x.tga", limits).is_none_or(|c| c.peak <= PICTURE)
        && let Ok(picture) = decode(bytes, "x.tga", limits)
    {
        let texels = picture.width as usize * picture.height as usize;
        assert_eq!(picture.texels.len(), texels);
    }
}
