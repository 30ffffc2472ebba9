//! A scene at one moment and at another: what has moved from the one to the other.
//!
//! Things are the same if they were written at the same place, the first with the first and so on. What differs in more
//! than its place keeps the look it has when the shutter opens, and is told.

use super::form;
use crate::scene::{
    CameraKey, GroupId, Light, LightKind, Material, MaterialId, Mesh, MeshForm, MeshId, Object, Place, Scene, Shape,
    SurfaceModel,
};
use glam::{DAffine3, Vec3};
use std::collections::{BTreeMap, HashMap};

/// Meshes of more vertices keep their form.
const MOST_VERTICES: usize = 1 << 20;

/// Mixtures nested deeper than this contain themselves; `compile` refuses them.
const DEEPEST: u32 = 64;

/// Where an object is at one moment.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// Where it is when the shutter opens.
    Same,
    /// Moved, in its own space: `transform · this` places it.
    At(Box<DAffine3>),
    /// Nobody knows: it stands still.
    Lost,
}

/// Where all things of a scene are at one moment. Objects come first, then those of each group.
pub struct Pose {
    /// By object.
    pub objects: Vec<Step>,
    /// By lamp; `None` for one that is not found again.
    pub lights: Vec<Option<LightKind>>,
    /// The camera in use; `None` if it is not found again.
    pub camera: Option<CameraKey>,
    /// Meshes of models that have another form.
    pub forms: BTreeMap<MeshId, MeshForm>,
}

/// Something that differs in more than its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// What it is and does: `a sphere changes its material`.
    pub what: String,
    /// What is shown instead: `it looks as when the shutter opens`.
    pub instead: &'static str,
    /// Where it was written.
    pub place: Place,
}

const LOOKS: &str = "it looks as it does when the shutter opens";
const STANDS: &str = "it stands where it is when the shutter opens";
const HIDDEN: &str = "what is not there when the shutter opens is not shown";

/// Follows a scene to another moment.
pub struct Follower<'a> {
    first: &'a Scene,
    other: &'a Scene,
    /// Which group of the other scene a group is.
    groups: HashMap<GroupId, Option<GroupId>>,
    /// By group, where its objects begin among all.
    starts: Vec<usize>,
    pose: Pose,
    changes: Vec<Change>,
}

/// Where everything is at the moment of `other`, a scene made by the same text as `first`, and what else changes.
pub fn pose(first: &Scene, other: &Scene) -> (Pose, Vec<Change>) {
    let mut starts = Vec::with_capacity(first.groups.len());
    let mut count = first.objects.len();
    for group in &first.groups {
        starts.push(count);
        count += group.objects.len();
    }
    let mut follower = Follower {
        first,
        other,
        groups: HashMap::new(),
        starts,
        pose: Pose {
            objects: vec![Step::Same; count],
            lights: Vec::new(),
            camera: None,
            forms: BTreeMap::new(),
        },
        changes: Vec::new(),
    };
    follower.objects(&first.objects, &other.objects, 0);
    follower.lights();
    follower.camera();
    if first.environment != other.environment {
        follower.tell("the environment changes", LOOKS, &first.environment.place);
    }
    if !follower.is_same_look(first.default_material, other.default_material) {
        follower.tell("the default texture changes", LOOKS, &Place::None);
    }
    (follower.pose, follower.changes)
}

impl Follower<'_> {
    fn tell(&mut self, what: impl Into<String>, instead: &'static str, place: &Place) {
        self.changes.push(Change {
            what: what.into(),
            instead,
            place: place.clone(),
        });
    }

    /// Follows a list of objects, the first of which has the number `start`.
    fn objects(&mut self, first: &[Object], other: &[Object], start: usize) {
        let found = partners(first, other, |o| &o.place);
        for (i, object) in first.iter().enumerate() {
            let step = match found.of[i].and_then(|k| other.get(k)) {
                Some(partner) => self.object(object, partner),
                None => {
                    self.tell(
                        format!("{} is there only for a while", name(&object.shape)),
                        STANDS,
                        &object.place,
                    );
                    Step::Lost
                }
            };
            self.pose.objects[start + i] = step;
        }
        for object in found.new.iter().filter_map(|k| other.get(*k)) {
            self.tell(format!("{} appears", name(&object.shape)), HIDDEN, &object.place);
        }
    }

    fn is_same_look(&self, a: Option<MaterialId>, b: Option<MaterialId>) -> bool {
        match (a, b) {
            (Some(a), Some(b)) => looks_alike((self.first, a), (self.other, b), 0),
            (a, b) => a.is_none() && b.is_none(),
        }
    }

    fn object(&mut self, object: &Object, partner: &Object) -> Step {
        if !self.is_same_look(object.material, partner.material) || object.visibility != partner.visibility {
            self.tell(
                format!("{} changes its look", name(&object.shape)),
                LOOKS,
                &object.place,
            );
        }
        let Some(map) = self.shape(object, partner) else {
            return Step::Lost;
        };
        if map == DAffine3::IDENTITY && object.transform == partner.transform {
            return Step::Same;
        }
        let (a, b) = (&object.transform, &partner.transform);
        let moved = if a.matrix3 == b.matrix3 {
            // Only shifted: exact, whatever the inverse is rounded to.
            DAffine3::from_translation(a.matrix3.inverse() * (b.translation - a.translation))
        } else {
            a.inverse() * *b
        };
        let step = moved * map;
        if !step.is_finite() {
            self.tell(
                format!("{} has no size for a moment", name(&object.shape)),
                STANDS,
                &object.place,
            );
            return Step::Lost;
        }
        Step::At(Box::new(step))
    }

    /// The map from the shape to its partner, in the shape's own space.
    fn shape(&mut self, object: &Object, partner: &Object) -> Option<DAffine3> {
        match (&object.shape, &partner.shape) {
            (Shape::Group(a), Shape::Group(b)) => {
                if self.group(*a, *b) {
                    return Some(DAffine3::IDENTITY);
                }
            }
            (Shape::Mesh(a), Shape::Mesh(b)) => {
                let id = *a;
                let (a, b) = (self.first.meshes.get(a.index())?, self.other.meshes.get(b.index())?);
                // A model is placed by its nodes; vertices are there only where it plays.
                if matches!(object.place, Place::Model(_)) {
                    if !self.pose.forms.contains_key(&id) && !b.positions.is_empty() {
                        self.form(id, a, b, &object.place);
                    }
                    return Some(DAffine3::IDENTITY);
                }
                let is_same_form = a.positions == b.positions && a.triangles == b.triangles;
                let is_same_paint = (&a.normals, &a.uvs, &a.colors, &a.face_materials)
                    == (&b.normals, &b.uvs, &b.colors, &b.face_materials)
                    && a.materials.len() == b.materials.len()
                    && a.materials
                        .iter()
                        .zip(&b.materials)
                        .all(|(a, b)| self.is_same_look(*a, *b));
                if is_same_form && !is_same_paint {
                    self.tell("a mesh changes its look", LOOKS, &object.place);
                }
                if is_same_form {
                    return Some(DAffine3::from_translation(b.center - a.center));
                }
                self.tell("a mesh changes its vertices", STANDS, &object.place);
                return None;
            }
            (a, b) => {
                if let Some(map) = form::map(a, b) {
                    return Some(map);
                }
            }
        }
        self.tell(
            format!("{} changes its form", name(&object.shape)),
            STANDS,
            &object.place,
        );
        None
    }

    /// Keeps the form that a mesh of a model has.
    fn form(&mut self, id: MeshId, a: &Mesh, b: &Mesh, place: &Place) {
        let shift = (b.center - a.center).as_vec3();
        let positions: Vec<Vec3> = b.positions.iter().map(|p| *p + shift).collect();
        if positions == a.positions && b.normals == a.normals {
            return;
        }
        let is_followed = a.positions.len() <= MOST_VERTICES
            && (a.positions.len(), a.normals.len(), &a.triangles) == (b.positions.len(), b.normals.len(), &b.triangles);
        if !is_followed {
            self.tell("a mesh of a model changes its form", LOOKS, place);
            return;
        }
        let normals = b.normals.clone();
        self.pose.forms.insert(id, MeshForm { positions, normals });
    }

    /// Follows what is in a group, once. Whether it is the group that its other places say it is.
    fn group(&mut self, a: GroupId, b: GroupId) -> bool {
        if let Some(known) = self.groups.get(&a) {
            return *known == Some(b);
        }
        self.groups.insert(a, Some(b));
        let (first, other) = (self.first, self.other);
        if let (Some(g), Some(h)) = (first.groups.get(a.index()), other.groups.get(b.index())) {
            self.objects(&g.objects, &h.objects, self.starts[a.index()]);
        }
        true
    }

    fn lights(&mut self) {
        let (first, other) = (self.first, self.other);
        let found = partners(&first.lights, &other.lights, |l| &l.place);
        for (i, light) in first.lights.iter().enumerate() {
            let partner = found.of[i].and_then(|k| other.lights.get(k));
            let key = partner.and_then(|p| self.light(light, p));
            if partner.is_none() {
                self.tell("a lamp is there only for a while", STANDS, &light.place);
            }
            self.pose.lights.push(key);
        }
        for light in found.new.iter().filter_map(|k| other.lights.get(*k)) {
            self.tell("a lamp appears", HIDDEN, &light.place);
        }
    }

    fn light(&mut self, light: &Light, partner: &Light) -> Option<LightKind> {
        if light.color != partner.color || light.casts_shadows != partner.casts_shadows {
            self.tell(
                "a lamp changes its light",
                "it shines as it does when the shutter opens",
                &light.place,
            );
        }
        let key = placed_like(&light.kind, &partner.kind);
        match &key {
            None => self.tell("a lamp changes its kind", STANDS, &light.place),
            Some(key) if *key != partner.kind => {
                self.tell(
                    "a lamp changes its beam",
                    "it shines as it does when the shutter opens",
                    &light.place,
                );
            }
            Some(_) => {}
        }
        key
    }

    fn camera(&mut self) {
        let Some(camera) = self.first.camera() else { return };
        let partner = self.other.camera();
        let alike = partner.filter(|p| p.projection == camera.projection && p.aspect == camera.aspect);
        if alike.is_none() {
            self.tell("the camera changes its kind", STANDS, &camera.place);
        }
        self.pose.camera = alike.map(|p| p.key());
    }
}

/// A lamp where another of its kind stands; `None` for lamps of different kinds.
fn placed_like(lamp: &LightKind, there: &LightKind) -> Option<LightKind> {
    let mut key = lamp.clone();
    match (&mut key, there) {
        (LightKind::Point { position, .. }, LightKind::Point { position: p, .. }) => *position = *p,
        (
            LightKind::Spot { position, axis, .. },
            LightKind::Spot {
                position: p, axis: a, ..
            },
        ) => {
            (*position, *axis) = (*p, *a);
        }
        (LightKind::Directional { direction }, LightKind::Directional { direction: d }) => *direction = *d,
        (
            LightKind::Area {
                position,
                axis1,
                axis2,
                spot,
                ..
            },
            LightKind::Area {
                position: p,
                axis1: a,
                axis2: b,
                spot: other,
                ..
            },
        ) => {
            (*position, *axis1, *axis2) = (*p, *a, *b);
            match (spot, other) {
                (Some((axis, _)), Some((a, _))) => *axis = *a,
                (None, None) => {}
                _ => return None,
            }
        }
        _ => return None,
    }
    Some(key)
}

/// Which thing of another list each one is, and which of the others are new.
struct Partners {
    of: Vec<Option<usize>>,
    new: Vec<usize>,
}

/// Pairs things that were written at the same place, in order. Where there are more or fewer of them at another moment,
/// nobody knows which is which: none has a partner.
fn partners<T>(first: &[T], other: &[T], place: impl Fn(&T) -> &Place) -> Partners {
    let is_same = first.len() == other.len() && first.iter().zip(other).all(|(a, b)| place(a) == place(b));
    if is_same {
        return Partners {
            of: (0..first.len()).map(Some).collect(),
            new: Vec::new(),
        };
    }
    let mut by_place: BTreeMap<String, (Vec<usize>, Vec<usize>)> = BTreeMap::new();
    for (i, thing) in first.iter().enumerate() {
        by_place.entry(format!("{:?}", place(thing))).or_default().0.push(i);
    }
    for (k, thing) in other.iter().enumerate() {
        by_place.entry(format!("{:?}", place(thing))).or_default().1.push(k);
    }
    let mut found = Partners {
        of: vec![None; first.len()],
        new: Vec::new(),
    };
    for (here, there) in by_place.into_values() {
        if here.len() == there.len() {
            here.into_iter().zip(there).for_each(|(i, k)| found.of[i] = Some(k));
        } else if here.is_empty() {
            found.new.extend(there);
        }
    }
    found
}

/// Whether two materials of two scenes look the same. The same text numbers its textures alike.
fn looks_alike((first, a): (&Scene, MaterialId), (other, b): (&Scene, MaterialId), depth: u32) -> bool {
    let (Some(m), Some(n)) = (first.materials.get(a.index()), other.materials.get(b.index())) else {
        return false;
    };
    if let (SurfaceModel::Mix { a, b, weight }, SurfaceModel::Mix { a: c, b: d, weight: v }) = (&m.surface, &n.surface)
    {
        let rest = |m: &Material| Material {
            surface: SurfaceModel::Black,
            ..m.clone()
        };
        return depth < DEEPEST
            && weight == v
            && rest(m) == rest(n)
            && looks_alike((first, *a), (other, *c), depth + 1)
            && looks_alike((first, *b), (other, *d), depth + 1);
    }
    let mut textures = Vec::new();
    m.each_texture(&mut |t| textures.push(t));
    m == n
        && textures
            .iter()
            .all(|t| first.textures.get(t.index()) == other.textures.get(t.index()))
}

/// What messages call a shape.
fn name(shape: &Shape) -> &'static str {
    match shape {
        Shape::Sphere { .. } => "a sphere",
        Shape::Plane { .. } => "a plane",
        Shape::Box { .. } => "a box",
        Shape::Cone { .. } => "a cone",
        Shape::Disc { .. } => "a disc",
        Shape::Torus { .. } => "a torus",
        Shape::Triangle { .. } => "a triangle",
        Shape::Mesh(_) => "a mesh",
        Shape::Group(_) => "a group",
    }
}
