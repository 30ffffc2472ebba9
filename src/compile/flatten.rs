//! Groups become leaves: every shape with its own transform, material and visibility.

use crate::diag::{Anomaly, Diagnostic, Diagnostics};
use crate::scene::motion::nested;
use crate::scene::{MaterialId, Object, Scene, Shape, Visibility};
use glam::DAffine3;

/// Groups may be nested this deep; a group that contains itself is found out by it.
const DEEPEST: usize = 256;

/// A shape that is not a group, in world space.
#[derive(Clone, Debug)]
pub struct Leaf<'a> {
    /// The object as written.
    pub object: &'a Object,
    /// From the shape's space to world space.
    pub transform: DAffine3,
    /// How it moves in the shape's space, the motions of all groups around it included; see [`Object::motion`]. Empty for
    /// what stands still.
    pub motion: Vec<DAffine3>,
    /// Material for what has none of its own.
    pub material: Option<MaterialId>,
    /// Material that replaces every other.
    pub override_material: Option<MaterialId>,
    /// Seen by which rays.
    pub visibility: Visibility,
}

impl Leaf<'_> {
    /// From the shape's space to where it stands; differs from `transform` only if all keys of its motion say the same.
    pub fn still_transform(&self) -> DAffine3 {
        match self.motion.split_first() {
            Some((first, rest)) if rest.iter().all(|key| key == first) && first.is_finite() => self.transform * *first,
            _ => self.transform,
        }
    }
}

/// All leaves of a scene in the order they were written, each instance of a group apart. Objects with a
/// transform that is not finite or not invertible cannot be drawn; they are left out with a warning.
pub fn leaves<'a>(scene: &'a Scene, diags: &mut Diagnostics) -> Vec<Leaf<'a>> {
    let mut out = Vec::new();
    // A stack of iterators would borrow awkwardly; a stack of leaves to do, reversed, keeps the order.
    let mut to_do: Vec<(Leaf<'a>, usize)> = scene.objects.iter().rev().map(|o| (root(o), 0)).collect();
    while let Some((leaf, depth)) = to_do.pop() {
        let Shape::Group(id) = leaf.object.shape else {
            if drawable(&leaf.transform) {
                out.push(leaf);
            } else {
                diags.push(super::at_place(
                    Diagnostic::warning(
                        "C0101",
                        "an object's transform is singular or not finite: it is left out",
                    )
                    .counting(Anomaly::DroppedShape, 1)
                    .hint("a scale factor may be zero; give every axis a size"),
                    &leaf.object.place,
                ));
            }
            continue;
        };
        if depth >= DEEPEST {
            diags.push(super::at_place(
                Diagnostic::error("C0102", format!("groups are nested more than {DEEPEST} deep")),
                &leaf.object.place,
            ));
            return out;
        }
        let Some(group) = scene.groups.get(id.index()) else {
            continue;
        };
        to_do.extend(group.objects.iter().rev().map(|o| (inside(&leaf, o), depth + 1)));
    }
    out
}

fn root(object: &Object) -> Leaf<'_> {
    Leaf {
        object,
        transform: object.transform,
        motion: object.motion.clone(),
        material: object.material,
        override_material: object.material.filter(|_| object.override_material),
        visibility: object.visibility,
    }
}

fn inside<'a>(outer: &Leaf<'_>, object: &'a Object) -> Leaf<'a> {
    let (a, b) = (outer.visibility, object.visibility);
    Leaf {
        object,
        transform: outer.transform * object.transform,
        motion: nested(&outer.motion, &object.transform, &object.motion),
        material: object.material.or(outer.material),
        override_material: outer
            .override_material
            .or(object.material.filter(|_| object.override_material)),
        visibility: Visibility {
            camera: a.camera && b.camera,
            shadow: a.shadow && b.shadow,
            indirect: a.indirect && b.indirect,
        },
    }
}

/// Whether a shape under this transform has an inside to hit: all numbers finite, the linear part invertible.
fn drawable(t: &DAffine3) -> bool {
    let m = t.matrix3;
    let largest = [m.x_axis, m.y_axis, m.z_axis]
        .iter()
        .map(|c| c.abs().max_element())
        .fold(0.0, f64::max);
    // Scaled by the largest entry, so that tiny and huge scenes are judged alike.
    let det = (m * (1.0 / largest)).determinant();
    t.is_finite() && det.is_finite() && det != 0.0 && m.inverse().is_finite()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn sphere() -> Object {
        let shape = Shape::Sphere {
            center: DVec3::ZERO,
            radius: 1.0,
        };
        Object::new(shape)
    }

    #[test]
    fn nested_groups_multiply_transforms_and_pass_materials_down() {
        let mut scene = Scene::default();
        let [outer, inner] = [0.1, 0.2].map(|g| scene.add_material(crate::scene::Material::diffuse(DVec3::splat(g))));
        let group = scene.add_group(vec![sphere(), sphere().with_material(inner)]);
        let place = |x: f64| DAffine3::from_translation(DVec3::X * x);
        let placed = Object::new(Shape::Group(group))
            .with_material(outer)
            .transformed(place(1.0));
        let second = scene.add_group(vec![placed]);
        scene
            .objects
            .push(Object::new(Shape::Group(second)).transformed(place(10.0)));
        let found = leaves(&scene, &mut Diagnostics::default());
        assert_eq!(found.len(), 2);
        assert_eq!((found[0].material, found[1].material), (Some(outer), Some(inner)));
        assert_eq!(found[1].transform.translation.x, 11.0);
    }

    #[test]
    fn a_group_that_contains_itself_is_an_error() {
        let mut scene = Scene::default();
        let id = scene.add_group(Vec::new());
        scene.groups[id.index()].objects.push(Object::new(Shape::Group(id)));
        scene.objects.push(Object::new(Shape::Group(id)));
        let mut diags = Diagnostics::default();
        leaves(&scene, &mut diags);
        assert!(diags.has_errors());
    }

    #[test]
    fn maps_without_numbers_or_beyond_them_are_left_out_with_a_warning() {
        let mut stretched = DAffine3::IDENTITY;
        stretched.matrix3.y_axis.x = f64::NAN;
        let far = DAffine3::from_translation(DVec3::new(f64::INFINITY, 0.0, 0.0));
        let vast = DAffine3::from_scale(DVec3::splat(f64::MAX)) * DAffine3::from_scale(DVec3::splat(2.0));
        for map in [stretched, far, vast, DAffine3::from_scale(DVec3::new(0.0, 0.0, 1.0))] {
            let mut scene = Scene::default();
            scene.objects.push(sphere().transformed(map));
            let mut diags = Diagnostics::default();
            assert!(leaves(&scene, &mut diags).is_empty(), "{map:?}");
            assert_eq!(diags.anomalies().of(Anomaly::DroppedShape), 1);
        }
        // Mirrored and stretched by 10¹² is neither.
        let mirrored = DAffine3::from_scale(DVec3::new(-1.0, 1e12, 1.0));
        let mut scene = Scene::default();
        scene.objects.push(sphere().transformed(mirrored));
        let mut diags = Diagnostics::default();
        assert_eq!(leaves(&scene, &mut diags).len(), 1);
        assert_eq!(diags.anomalies().of(Anomaly::DroppedShape), 0);
    }

    #[test]
    fn a_flattened_object_is_left_out_with_a_warning_and_tiny_ones_are_not() {
        let mut scene = Scene::default();
        scene
            .objects
            .push(sphere().transformed(DAffine3::from_scale(DVec3::new(1.0, 0.0, 1.0))));
        scene
            .objects
            .push(sphere().transformed(DAffine3::from_scale(DVec3::splat(1e-90))));
        let mut diags = Diagnostics::default();
        assert_eq!(leaves(&scene, &mut diags).len(), 1);
        assert_eq!(diags.count(crate::diag::Severity::Warning), 1);
    }
}
