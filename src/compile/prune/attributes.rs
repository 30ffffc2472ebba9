//! Coordinates, tangents and colours of vertices that no material reads: `compile` does not take them over.

use super::reach::{drawn, with_parts};
use super::{Pass, Pruned, Saved};
use crate::math::words::grouped;
use crate::scene::{Material, Mesh, MeshId, Place, Scene, Shape, SurfaceModel};
use std::collections::{BTreeMap, BTreeSet};

/// Tells in one line what is left behind.
pub fn pass(pruned: &mut Pruned<'_>) {
    let idle: Vec<u64> = unread(&pruned.scene).collect();
    let bytes: u64 = idle.iter().sum();
    if bytes > 0 {
        let meshes = match idle.len() {
            1 => "a mesh".to_owned(),
            n => format!("{} meshes", grouped(n as u64)),
        };
        let name = format!("of {meshes}");
        let saved = Saved::of_bytes(bytes);
        pruned.tell(
            Pass::Attributes,
            "vertex data",
            &name,
            "no material reads them",
            &Place::None,
            saved,
        );
    }
}

/// Bytes of each mesh that no material on it reads, 0 left out.
fn unread(scene: &Scene) -> impl Iterator<Item = u64> + '_ {
    let mut read: BTreeMap<MeshId, bool> = BTreeMap::new();
    drawn(scene, &mut |drawing| {
        if let Shape::Mesh(id) = drawing.object.shape {
            let known = read.entry(id).or_insert(false);
            if !*known && let Some(material) = drawing.material {
                let mut all = BTreeSet::from([material]);
                with_parts(scene, &mut all);
                *known = all.iter().filter_map(|m| scene.materials.get(m.index())).any(reads);
            }
        }
    });
    let idle = read.into_iter().filter_map(|(id, read)| (!read).then_some(id));
    idle.filter_map(|id| scene.meshes.get(id.index()))
        .map(bytes)
        .filter(|b| *b > 0)
}

fn bytes(mesh: &Mesh) -> u64 {
    let uvs: usize = mesh.uvs.iter().map(|set| size_of_val(&set[..])).sum();
    (uvs + size_of_val(&mesh.tangents[..]) + size_of_val(&mesh.colors[..])) as u64
}

/// Whether evaluating a material asks for more than the point and its normals.
fn reads(material: &Material) -> bool {
    let mut found = false;
    material.each_texture(&mut |_| found = true);
    found || matches!(&material.surface, SurfaceModel::Principled(p) if p.anisotropy.most() != 0.0)
}
