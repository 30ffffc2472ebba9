//! Makes the models of the gallery and of the golden pictures: `cargo run --example make_models [folder]` (default `.`, the
//! repository's root).
//! Everything is computed, nothing downloaded; the files are committed so that the gallery renders as it is.

mod support;

use support::{features, glb::Glb, grids, lathe, shapes, skies, textures, write_obj};

fn main() -> std::io::Result<()> {
    let root = std::env::args().nth(1).unwrap_or_else(|| ".".into());
    let root = std::path::Path::new(&root);
    let folder = &root.join("scenes/models");
    std::fs::create_dir_all(folder)?;
    grids::write(&root.join("scenes/extensions"))?;
    features::write(&root.join("tests/golden/features"))?;

    let gold = "Kd 0.95 0.68 0.32\nKs 0.95 0.68 0.32\nNs 250\nPm 1\nPr 0.25\nillum 2";
    write_obj(folder, "knot", "gold", gold, &shapes::knot(2, 3, 180, 14))?;
    let glaze = "Kd 0.10 0.32 0.42\nKs 0.04 0.04 0.04\nNs 400\nPr 0.18\nillum 2";
    write_obj(folder, "vase", "glaze", glaze, &lathe::fluted_vase(26, 60))?;

    skies::write(&folder.join("studio.exr"), skies::studio)?;
    skies::write(&folder.join("dusk.exr"), skies::dusk)?;

    let mut glb = Glb::new();
    let wood = glb.image("wood", &textures::crate_color(256));
    let bumps = glb.image("planks", &textures::crate_normals(256));
    let wear = glb.image("wear", &textures::roughness(128));
    let planks = glb.textured("painted planks", wood, bumps, wear);
    let iron = glb.metal("iron", [0.16, 0.15, 0.14], 0.45);
    let brass = glb.metal("brass", [0.88, 0.62, 0.28], 0.22);
    let glow = glb.glowing("flame", [1.0, 0.55, 0.20], 14.0);

    let cube = glb.mesh("crate", planks, &shapes::cuboid([1.0, 1.0, 1.0]));
    let base = glb.mesh("base", iron, &lathe::turned(lathe::BASE, 48));
    let roof = glb.mesh("roof", iron, &lathe::turned(lathe::ROOF, 48));
    let post = glb.mesh("post", brass, &lathe::turned(lathe::POST, 12));
    let flame = glb.mesh("flame", glow, &lathe::turned(lathe::FLAME, 32));
    let ring = glb.mesh("ring", brass, &shapes::ring(0.16, 0.025, 40, 12));

    let mut lantern = vec![
        glb.node("base", Some(base), [0.0; 3], 0.0, 1.0, &[]),
        glb.node("roof", Some(roof), [0.0, 0.78, 0.0], 0.0, 1.0, &[]),
        glb.node("flame", Some(flame), [0.0, 0.16, 0.0], 0.0, 1.0, &[]),
        glb.node("ring", Some(ring), [0.0, 1.22, 0.0], 35.0, 1.0, &[]),
    ];
    for corner in 0..4 {
        let (s, c) = (f64::from(corner) * 90.0 + 45.0).to_radians().sin_cos();
        lantern.push(glb.node("post", Some(post), [0.27 * c, 0.1, 0.27 * s], 0.0, 1.0, &[]));
    }
    let lantern = glb.node("lantern", None, [0.0, 1.0, 0.0], 20.0, 0.8, &lantern);
    let big = glb.node("big crate", Some(cube), [0.0, 0.5, 0.0], 0.0, 1.0, &[]);
    let small = glb.node("small crate", Some(cube), [1.05, 0.3, 0.35], -28.0, 0.6, &[]);
    let root = glb.node("still life", None, [0.0; 3], 0.0, 1.0, &[big, small, lantern]);
    glb.write(&folder.join("lantern.glb"), root)
}
