//! What something drawn refers to.

use crate::scene::{
    EnvironmentKind, GroupId, ImageId, Material, MaterialId, MeshId, Object, Scene, Shape, SurfaceModel, Texture,
    TextureId, Visibility,
};
use std::collections::BTreeSet;

/// Where an object stands in the scene's tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ObjectId {
    /// The group it is a member of; `None` for those of the scene itself.
    pub group: Option<GroupId>,
    /// Its position there.
    pub index: usize,
}

/// What objects of a group inherit.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Inherited {
    own: Option<MaterialId>,
    forced: Option<MaterialId>,
    /// Seen by the camera, by shadow rays, by rays that left a surface.
    seen: [bool; 3],
}

impl Inherited {
    fn within(self, object: &Object) -> Inherited {
        let Visibility {
            camera,
            shadow,
            indirect,
        } = object.visibility;
        let [a, b, c] = self.seen;
        Inherited {
            own: object.material.or(self.own),
            forced: self.forced.or(object.material.filter(|_| object.override_material)),
            seen: [a && camera, b && shadow, c && indirect],
        }
    }
}

/// One way in which an object is drawn.
pub struct Drawing<'a> {
    /// Which object.
    pub id: ObjectId,
    /// The object, never a group.
    pub object: &'a Object,
    /// Its material, or one of those of its mesh; `None` is the engine's white.
    pub material: Option<MaterialId>,
    /// Whether any ray sees it.
    pub is_seen: bool,
}

/// Calls `visit` for every object with every material that it has somewhere. Materials are inherited as `compile` does;
/// members of a group are visited once for each way in which groups that place it are drawn, not once for each place.
pub fn drawn<'a>(scene: &'a Scene, visit: &mut dyn FnMut(Drawing<'a>)) {
    let mut done: BTreeSet<(GroupId, Inherited)> = BTreeSet::new();
    let outside = Inherited {
        own: None,
        forced: None,
        seen: [true; 3],
    };
    let mut queue: Vec<(Option<GroupId>, &[Object], Inherited)> = vec![(None, &scene.objects, outside)];
    while let Some((group, objects, outer)) = queue.pop() {
        for (index, object) in objects.iter().enumerate() {
            let inherited = outer.within(object);
            let pick = |m: Option<MaterialId>| inherited.forced.or(m).or(inherited.own).or(scene.default_material);
            let mut see = |material| {
                visit(Drawing {
                    id: ObjectId { group, index },
                    object,
                    material,
                    is_seen: inherited.seen != [false; 3],
                })
            };
            match &object.shape {
                Shape::Group(id) => {
                    if let Some(members) = scene.groups.get(id.index())
                        && done.insert((*id, inherited))
                    {
                        queue.push((Some(*id), &members.objects, inherited));
                    }
                }
                Shape::Mesh(id) => {
                    let slots = scene.meshes.get(id.index()).map_or(&[][..], |m| &m.materials);
                    match slots {
                        [] => see(pick(None)),
                        slots => slots.iter().for_each(|slot| see(pick(*slot))),
                    }
                }
                _ => see(pick(None)),
            }
        }
    }
}

/// What objects refer to themselves: where every search begins. Finding it takes a walk over all objects.
#[derive(Clone, Debug, Default)]
pub struct Roots {
    materials: BTreeSet<MaterialId>,
    /// Materials on meshes with vertex colours.
    colored: BTreeSet<MaterialId>,
    meshes: BTreeSet<MeshId>,
    groups: BTreeSet<GroupId>,
}

impl Roots {
    /// Looks at all objects.
    pub fn of(scene: &Scene) -> Roots {
        let mut roots = Roots::default();
        // Of millions of objects most are like the one before.
        let mut last = None;
        drawn(scene, &mut |drawing| {
            let mesh = match drawing.object.shape {
                Shape::Mesh(id) => Some(id),
                _ => None,
            };
            let seen = (drawing.material, mesh, drawing.id.group);
            if last == Some(seen) {
                return;
            }
            last = Some(seen);
            roots.materials.extend(drawing.material);
            roots.groups.extend(drawing.id.group);
            roots.meshes.extend(mesh);
            let has_colors = |id: MeshId| scene.meshes.get(id.index()).is_some_and(|m| !m.colors.is_empty());
            if mesh.is_some_and(has_colors) {
                roots.colored.extend(drawing.material);
            }
        });
        roots
    }

    /// The materials that vertex colours may reach, parts of mixtures included.
    pub fn colored(&self, scene: &Scene) -> BTreeSet<MaterialId> {
        let mut colored = self.colored.clone();
        with_parts(scene, &mut colored);
        colored
    }
}

/// What something drawn refers to.
#[derive(Clone, Debug, Default)]
pub struct Reached {
    /// Materials, parts of mixtures included.
    pub materials: BTreeSet<MaterialId>,
    /// Meshes.
    pub meshes: BTreeSet<MeshId>,
    /// Groups that have a place.
    pub groups: BTreeSet<GroupId>,
    /// Images of the materials and of the environment.
    pub images: BTreeSet<ImageId>,
    /// Images of the materials alone.
    pub textured: BTreeSet<ImageId>,
}

impl Reached {
    /// Follows all references from what is drawn.
    pub fn from(scene: &Scene) -> Reached {
        Reached::by(&Roots::of(scene), scene)
    }

    /// As [`Reached::from`], where the objects have been looked at already.
    pub fn by(roots: &Roots, scene: &Scene) -> Reached {
        let mut reached = Reached {
            materials: roots.materials.clone(),
            meshes: roots.meshes.clone(),
            groups: roots.groups.clone(),
            ..Reached::default()
        };
        with_parts(scene, &mut reached.materials);
        for material in reached
            .materials
            .iter()
            .filter_map(|id| scene.materials.get(id.index()))
        {
            reached.textured.extend(images_behind(scene, material));
        }
        reached.images.clone_from(&reached.textured);
        if let EnvironmentKind::Image { image, .. } = &scene.environment.kind {
            reached.images.insert(*image);
        }
        reached
    }
}

/// Adds the parts of mixtures.
pub fn with_parts(scene: &Scene, materials: &mut BTreeSet<MaterialId>) {
    let mut queue: Vec<MaterialId> = materials.iter().copied().collect();
    while let Some(id) = queue.pop() {
        if let Some(SurfaceModel::Mix { a, b, .. }) = scene.materials.get(id.index()).map(|m| &m.surface) {
            queue.extend([*a, *b].into_iter().filter(|part| materials.insert(*part)));
        }
    }
}

/// The images that a material itself refers to; products may be nested.
pub fn images_behind(scene: &Scene, material: &Material) -> BTreeSet<ImageId> {
    let mut queue: Vec<TextureId> = Vec::new();
    material.each_texture(&mut |t| queue.push(t));
    let (mut images, mut seen) = (BTreeSet::new(), BTreeSet::new());
    while let Some(id) = queue.pop() {
        match scene.textures.get(id.index()) {
            Some(Texture::Image(image)) => {
                images.insert(image.image);
            }
            Some(Texture::Product(a, b)) if seen.insert(id) => queue.extend([*a, *b]),
            _ => {}
        }
    }
    images
}
