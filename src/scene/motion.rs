//! Motion while the shutter is open, as the description holds it: keys at equal steps of time.

use super::{Camera, Light, LightKind, Mesh, Object, Scene};
use glam::{DAffine3, DVec3};
use std::sync::Arc;

/// Keys that are more than this are not looked at: the motion is followed finely enough.
pub const MOST_KEYS: usize = 65;

/// Where a camera stands and looks at one moment; as the fields of [`Camera`] of the same names.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraKey {
    /// Where it stands.
    pub location: DVec3,
    /// Towards the centre of the picture.
    pub direction: DVec3,
    /// Width of the image plane.
    pub right: DVec3,
    /// Height of the image plane.
    pub up: DVec3,
    /// Radius of the lens.
    pub lens_radius: f64,
    /// Distance of the plane in focus.
    pub focus_distance: f64,
}

impl Camera {
    /// Where it stands and looks when the shutter opens.
    pub fn key(&self) -> CameraKey {
        CameraKey {
            location: self.location,
            direction: self.direction,
            right: self.right,
            up: self.up,
            lens_radius: self.lens_radius,
            focus_distance: self.focus_distance,
        }
    }

    /// Whether it really moves: its keys are not all the same.
    pub fn moves(&self) -> bool {
        differ(&self.motion)
    }

    /// The camera moved by an affine map, its motion with it. A map that stretches changes what it sees as it changes the
    /// world.
    pub fn transformed(mut self, t: &DAffine3) -> Camera {
        let key = self.key().transformed(t);
        (self.location, self.direction, self.right, self.up) = (key.location, key.direction, key.right, key.up);
        (self.lens_radius, self.focus_distance) = (key.lens_radius, key.focus_distance);
        self.motion.iter_mut().for_each(|key| *key = key.transformed(t));
        self
    }
}

impl CameraKey {
    /// The same place moved by an affine map. The lens grows with the length of a cube of the same volume.
    fn transformed(&self, t: &DAffine3) -> CameraKey {
        let size = t.matrix3.determinant().abs().cbrt();
        CameraKey {
            location: t.transform_point3(self.location),
            direction: t.transform_vector3(self.direction),
            right: t.transform_vector3(self.right),
            up: t.transform_vector3(self.up),
            lens_radius: self.lens_radius * size,
            focus_distance: self.focus_distance * size,
        }
    }
}

impl Object {
    /// Whether it really moves by itself: its keys are not all the same.
    pub fn moves(&self) -> bool {
        differ(&self.motion)
    }
}

impl Light {
    /// Whether it really moves: its keys are not all the same.
    pub fn moves(&self) -> bool {
        differ(&self.motion)
    }
}

impl Scene {
    /// Whether anything really moves while the shutter is open.
    pub fn moves(&self) -> bool {
        let mut groups = self.groups.iter().flat_map(|g| &g.objects);
        self.objects.iter().any(Object::moves)
            || groups.any(Object::moves)
            || self.cameras.iter().any(Camera::moves)
            || self.lights.iter().any(Light::moves)
            || self.meshes.iter().any(Mesh::bends)
    }

    /// Lets everything stand where it is when the shutter opens.
    pub fn hold_still(&mut self) {
        let groups = self.groups.iter_mut().flat_map(|g| &mut g.objects);
        for object in self.objects.iter_mut().chain(groups) {
            object.motion.clear();
        }
        self.cameras.iter_mut().for_each(|c| c.motion.clear());
        self.lights.iter_mut().for_each(|l| l.motion.clear());
        if self.meshes.iter().any(|m| !m.later.is_empty()) {
            let meshes = Arc::make_mut(&mut self.meshes);
            meshes.iter_mut().for_each(|m| m.later.clear());
        }
    }
}

/// Whether neighbours among keys differ.
fn differ<T: PartialEq>(keys: &[T]) -> bool {
    keys.windows(2).any(|pair| pair[0] != pair[1])
}

/// Keys of an object that stands in a group, both moving: where the object is from where it would be if nothing moved,
/// in its own space. `outer` are the group's keys, `inner` the object's, `transform` places the object in the group.
/// Where one has more keys than the other, that is followed between its keys.
pub fn nested(outer: &[DAffine3], transform: &DAffine3, inner: &[DAffine3]) -> Vec<DAffine3> {
    if outer.is_empty() {
        return inner.to_vec();
    }
    let back = transform.inverse();
    let keys = outer.len().max(inner.len());
    let at = |k: usize| {
        let carried = match resampled(outer, k, keys) {
            // A translation stays one: no rounding of the inverse comes in.
            Some(m) if m.matrix3 == glam::DMat3::IDENTITY => {
                DAffine3::from_translation(back.transform_vector3(m.translation))
            }
            Some(m) => back * m * *transform,
            None => DAffine3::IDENTITY,
        };
        match resampled(inner, k, keys) {
            Some(own) => carried * own,
            None => carried,
        }
    };
    (0..keys).map(at).collect()
}

/// Key `k` of `keys`, read from a motion that may have another number of them; `None` without any.
fn resampled(motion: &[DAffine3], k: usize, keys: usize) -> Option<DAffine3> {
    match motion {
        [] => None,
        [only] => Some(*only),
        _ if motion.len() == keys => motion.get(k).copied(),
        _ => {
            let at = k as f64 / (keys - 1) as f64 * (motion.len() - 1) as f64;
            let i = (at as usize).min(motion.len() - 2);
            let w = at - i as f64;
            let (a, b) = (&motion[i], &motion[i + 1]);
            Some(DAffine3 {
                matrix3: a.matrix3 * (1.0 - w) + b.matrix3 * w,
                translation: a.translation * (1.0 - w) + b.translation * w,
            })
        }
    }
}

/// Whether more keys would follow the motion better by anything that can be seen: halfway between every other key the
/// straight way is off by more than what twice as many keys would leave of a turn by a few degrees. Between keys twice as
/// near the straight way is off by a quarter of that.
pub fn wants_more_keys(keys: &[DAffine3]) -> bool {
    /// Of lengths, and of the way that is moved.
    const OFF: f64 = 1.0 / 256.0;
    let Some(first) = keys.first() else { return false };
    let length = |m: &DAffine3| m.matrix3.to_cols_array().iter().map(|x| x * x).sum::<f64>().sqrt();
    let way = keys
        .iter()
        .map(|k| k.translation.distance(first.translation))
        .fold(0.0, f64::max);
    let size = keys.iter().map(length).fold(0.0, f64::max);
    keys.windows(3).step_by(2).any(|three| {
        let [a, b, c] = three else { return false };
        let off = (a.matrix3 + c.matrix3) * 0.5 - b.matrix3;
        let turned = length(&DAffine3 {
            matrix3: off,
            translation: DVec3::ZERO,
        });
        let bent = ((a.translation + c.translation) * 0.5 - b.translation).length();
        turned > 4.0 * OFF * size || bent > 4.0 * OFF * way
    })
}

/// The place of a lamp and what it spans, as a map, so that all that moves is followed alike; `None` for parallel light
/// its direction.
pub fn lamp_frame(kind: &LightKind) -> DAffine3 {
    let (position, x, y, z) = match *kind {
        LightKind::Point { position, .. } => (position, DVec3::X, DVec3::Y, DVec3::Z),
        LightKind::Spot { position, axis, .. } => (position, axis, DVec3::ZERO, DVec3::ZERO),
        LightKind::Directional { direction } => (DVec3::ZERO, direction, DVec3::ZERO, DVec3::ZERO),
        LightKind::Area {
            position,
            axis1,
            axis2,
            spot,
            ..
        } => (position, axis1, axis2, spot.map_or(DVec3::ZERO, |(axis, _)| axis)),
    };
    DAffine3::from_mat3_translation(glam::DMat3::from_cols(x, y, z), position)
}

/// The same for a camera.
pub fn camera_frame(key: &CameraKey) -> DAffine3 {
    DAffine3::from_mat3_translation(glam::DMat3::from_cols(key.direction, key.right, key.up), key.location)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn turn(angle: f64) -> DAffine3 {
        DAffine3::from_rotation_y(angle)
    }

    #[test]
    fn nested_motions_are_where_both_take_a_point() {
        let place = DAffine3::from_scale_rotation_translation(
            DVec3::new(2.0, 3.0, -1.0),
            glam::DQuat::from_rotation_z(0.7),
            DVec3::new(5.0, 1.0, -2.0),
        );
        let outer: Vec<_> = (0..5).map(|k| turn(0.1 * f64::from(k))).collect();
        let inner: Vec<_> = (0..5)
            .map(|k| DAffine3::from_translation(DVec3::X * f64::from(k)))
            .collect();
        let both = nested(&outer, &place, &inner);
        let p = DVec3::new(0.2, -0.4, 0.9);
        for k in 0..5 {
            let want = (outer[k] * place * inner[k]).transform_point3(p);
            let found = (place * both[k]).transform_point3(p);
            assert!((want - found).length() < 1e-14, "{k}: {found}, not {want}");
        }
        assert_eq!(nested(&[], &place, &inner), inner);
        let coarse = nested(&inner[..2], &place, &outer);
        assert_eq!(coarse.len(), 5);
        assert!((coarse[2].translation - place.inverse().transform_vector3(DVec3::X * 0.5)).length() < 1e-14);
    }

    #[test]
    fn straight_ways_need_two_keys_and_turns_need_more() {
        let straight: Vec<_> = (0..9)
            .map(|k| DAffine3::from_translation(DVec3::X * f64::from(k)))
            .collect();
        assert!(!wants_more_keys(&straight));
        let by = |degrees: f64, keys: i32| -> Vec<DAffine3> {
            (0..keys)
                .map(|k| turn((degrees / f64::from(keys - 1) * f64::from(k)).to_radians()))
                .collect()
        };
        assert!(wants_more_keys(&by(360.0, 9)) && wants_more_keys(&by(360.0, 17)));
        assert!(!wants_more_keys(&by(360.0, 65)) && !wants_more_keys(&by(45.0, 9)));
        // What circles without turning.
        let orbit = |keys: i32| -> Vec<DAffine3> {
            let at =
                |k: i32| turn(std::f64::consts::TAU / f64::from(keys - 1) * f64::from(k)).transform_point3(DVec3::X);
            (0..keys).map(|k| DAffine3::from_translation(at(k))).collect()
        };
        assert!(wants_more_keys(&orbit(9)) && !wants_more_keys(&orbit(65)));
    }
}
