//! What nothing drawn refers to, at last: it is not opened, not decoded, not built. Nothing is taken out of the tables,
//! so that ids stay what they are.

use super::{Pass, Pruned, Reached, Removal, Saved};
use crate::scene::{GroupId, Image, ImageId, ImageSource, MaterialId, MeshId, Place, SurfaceModel};
use std::collections::BTreeSet;
use std::path::Path;

/// Tells what the picture does without.
pub fn pass(pruned: &mut Pruned<'_>) {
    let reached = pruned.reached();
    let mut found = materials(pruned, &reached);
    found.extend(images(pruned, &reached));
    found.extend(meshes(pruned, &reached));
    found.extend(groups(pruned, &reached));
    found.extend(left_out(pruned));
    pruned.what.extend(found);
}

fn materials(pruned: &Pruned<'_>, reached: &Reached) -> Vec<Removal> {
    let materials = &pruned.scene.materials;
    // A part of a mix that has no share is told with the mix.
    let parts = pruned.written.materials.iter().flat_map(|m| match m.surface {
        SurfaceModel::Mix { a, b, .. } => [Some(a), Some(b)],
        _ => [None; 2],
    });
    let parts: BTreeSet<MaterialId> = parts.flatten().collect();
    let idle = (0..).map(MaterialId).zip(materials);
    let idle = idle.filter(|(id, _)| !reached.materials.contains(id) && !parts.contains(id));
    let tell = |(_, m): (_, &crate::scene::Material)| {
        let why = "nothing drawn has it";
        Removal::new(Pass::Unreachable, "material", &m.name, why, &m.place, Saved::default())
    };
    idle.map(tell).collect()
}

fn images(pruned: &Pruned<'_>, reached: &Reached) -> Vec<Removal> {
    let idle = (0..).map(ImageId).zip(&pruned.scene.images);
    let idle = idle.filter(|(id, _)| !reached.images.contains(id));
    let tell = |(id, image): (ImageId, &Image)| {
        let dropped = pruned.dropped.get(&id).cloned();
        let (pass, reason) = dropped.unwrap_or((Pass::Unreachable, "nothing drawn shows it".to_owned()));
        let (why, saved) = match pruned.images.decoded_bytes(id) {
            // It had to be opened to know.
            Some(bytes) => (reason, Saved::of_bytes(bytes)),
            None => spared(pruned, image, reason),
        };
        Removal::new(pass, "image", &image.name, why, &image.place, saved)
    };
    idle.map(tell).collect()
}

/// What is saved by not even opening an image.
fn spared(pruned: &Pruned<'_>, image: &Image, reason: String) -> (String, Saved) {
    match &image.source {
        ImageSource::File(path) => file_left(pruned, path, &reason),
        ImageSource::Bytes(b) => (format!("{reason}: not decoded"), Saved::of_bytes(b.len() as u64)),
        ImageSource::Pixels { data, .. } => (reason, Saved::of_bytes(size_of_val(&data[..]) as u64)),
    }
}

/// What is saved by leaving a file alone; one that is missing is no mistake where nobody needs it.
fn file_left(pruned: &Pruned<'_>, path: &Path, reason: &str) -> (String, Saved) {
    let size = pruned.files.size(path);
    let how = if size.is_some() {
        "not opened"
    } else {
        "not opened, and not there"
    };
    let saved = Saved {
        files: vec![path.to_owned()],
        ..Saved::of_bytes(size.unwrap_or(0))
    };
    (format!("{reason}: {how}"), saved)
}

fn meshes(pruned: &Pruned<'_>, reached: &Reached) -> Vec<Removal> {
    let idle = (0..).map(MeshId).zip(&*pruned.scene.meshes);
    let idle = idle.filter(|(id, _)| !reached.meshes.contains(id));
    let tell = |(_, mesh): (_, &crate::scene::Mesh)| {
        let saved = Saved::of_bytes(((mesh.positions.len() + mesh.normals.len() + mesh.triangles.len()) * 12) as u64);
        Removal::new(
            Pass::Unreachable,
            "mesh",
            &mesh.name,
            "nothing places it",
            &Place::None,
            saved,
        )
    };
    idle.map(tell).collect()
}

fn groups(pruned: &Pruned<'_>, reached: &Reached) -> Vec<Removal> {
    let idle = (0..).map(GroupId).zip(&pruned.scene.groups);
    let idle = idle.filter(|(id, _)| !reached.groups.contains(id));
    let tell = |(_, group): (_, &crate::scene::Group)| {
        let saved = Saved {
            objects: group.objects.len() as u64,
            ..Saved::default()
        };
        let first = group.objects.first()?;
        Some(Removal::new(
            Pass::Unreachable,
            "group",
            "",
            "nothing places it",
            &first.place,
            saved,
        ))
    };
    idle.filter_map(tell).collect()
}

/// What the front ends have not even read.
fn left_out(pruned: &Pruned<'_>) -> Vec<Removal> {
    let tell = |left: &crate::scene::LeftOut| {
        let (why, saved) = match &left.file {
            Some(path) => file_left(pruned, path, &left.why),
            None => (left.why.clone(), Saved::of_bytes(left.bytes)),
        };
        Removal::new(Pass::Unreachable, left.kind, &left.name, why, &left.place, saved)
    };
    pruned.scene.left_out.iter().map(tell).collect()
}
