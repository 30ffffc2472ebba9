//! Morph targets and skins in a pose, and in later ones while the shutter is open.

use super::Loader;
use super::accessor::Wanted;
use super::mesh::VEC3;
use super::part::Part;
use crate::diag::Diagnostic;
use glam::{DAffine3, DMat3, DMat4, DVec3, Vec3, Vec4};
use gltf::json;
use json::mesh::{Primitive, Semantic};
use json::validation::Checked;

/// How a node bends its mesh.
#[derive(Default)]
pub(super) struct Pose {
    /// Weights of the morph targets, instead of the mesh's.
    pub weights: Option<Vec<f32>>,
    /// For each joint the map from the mesh's bind pose to the world.
    pub joints: Option<Vec<DAffine3>>,
    /// How it does at equal steps of the time that the shutter is open, the opening left out; none if the mesh keeps its
    /// form.
    pub later: Vec<Pose>,
}

/// Positions and normals of a part.
pub(super) type Form = (Vec<DVec3>, Vec<Vec3>);

/// Weights and joints are fractions, whatever their component type says.
const FRACTIONS: Wanted = Wanted {
    components: &[4],
    normalize: true,
};

impl Loader<'_> {
    /// Adds the weighted morph targets to the part, whose vertex i is vertex `order[i]` of the file.
    pub(super) fn morph(
        &mut self,
        part: &mut Part,
        primitive: &Primitive,
        weights: &[f32],
        order: &[u32],
        vertices: usize,
        at: &str,
    ) -> Option<()> {
        let targets = primitive.targets.as_deref().unwrap_or(&[]);
        for (t, (target, &weight)) in targets.iter().zip(weights).enumerate() {
            if weight == 0.0 {
                continue;
            }
            let at = format!("{at}.targets[{t}]");
            if let Some(accessor) = target.positions {
                let deltas = self.floats(accessor.value(), VEC3, &format!("{at}.POSITION"))?;
                self.same_count(deltas.count(), vertices, &format!("{at}.POSITION"))?;
                for (p, &i) in part.positions.iter_mut().zip(order) {
                    *p += DVec3::from(Vec3::from(deltas.get(i as usize, 0.0))) * f64::from(weight);
                }
            }
            for (accessor, name) in [(target.normals, "NORMAL"), (target.tangents, "TANGENT")] {
                let Some(accessor) = accessor else {
                    continue;
                };
                let at = format!("{at}.{name}");
                let deltas = self.floats(accessor.value(), VEC3, &at)?;
                self.same_count(deltas.count(), vertices, &at)?;
                let delta = |i: u32| Vec3::from(deltas.get(i as usize, 0.0)) * weight;
                if name == "NORMAL" {
                    part.normals.iter_mut().zip(order).for_each(|(n, &i)| *n += delta(i));
                } else {
                    part.tangents
                        .iter_mut()
                        .zip(order)
                        .for_each(|(t, &i)| *t += delta(i).extend(0.0));
                }
            }
        }
        Some(())
    }

    /// Gives the part its form in the later poses. `rest` are its positions and normals without any pose, `weights` those
    /// of the morph targets where a pose has none.
    pub(super) fn bend(
        &mut self,
        part: &mut Part,
        (rest, at): (Form, &str),
        primitive: &Primitive,
        weights: &[f32],
        pose: &Pose,
        (order, vertices): (&[u32], usize),
    ) -> Option<()> {
        let mut forms = Vec::with_capacity(pose.later.len());
        for later in &pose.later {
            let mut bent = Part {
                positions: rest.0.clone(),
                normals: rest.1.clone(),
                ..Part::default()
            };
            let weights = later.weights.as_deref().unwrap_or(weights);
            self.morph(&mut bent, primitive, weights, order, vertices, at)?;
            if let Some(joints) = &later.joints {
                self.skin(&mut bent, primitive, joints, order, vertices, at)?;
            }
            if bent.flip_winding != part.flip_winding || !bent.positions.iter().all(|p| p.is_finite()) {
                self.tell_still(at);
                return Some(());
            }
            bent.normals.iter_mut().for_each(|n| *n = n.normalize_or_zero());
            forms.push((bent.positions, bent.normals));
        }
        part.later = forms;
        Some(())
    }

    /// Moves the part by its joints, from the bind pose into the world.
    pub(super) fn skin(
        &mut self,
        part: &mut Part,
        primitive: &Primitive,
        joints: &[DAffine3],
        order: &[u32],
        vertices: usize,
        at: &str,
    ) -> Option<()> {
        let mut blended = vec![(DAffine3::ZERO, 0.0f64); order.len()];
        for set in 0.. {
            let find = |semantic| primitive.attributes.get(&Checked::Valid(semantic)).map(|a| a.value());
            let (Some(j), Some(w)) = (find(Semantic::Joints(set)), find(Semantic::Weights(set))) else {
                break;
            };
            let joints_at = format!("{at}.attributes.JOINTS_{set}");
            let weights_at = format!("{at}.attributes.WEIGHTS_{set}");
            let indices = self.integers(j, &[4], &joints_at)?;
            let weights = self.floats(w, FRACTIONS, &weights_at)?;
            self.same_count(indices.len() / 4, vertices, &joints_at)?;
            self.same_count(weights.count(), vertices, &weights_at)?;
            for ((sum, total), &v) in blended.iter_mut().zip(order) {
                let at = v as usize * 4;
                let four = indices.get(at..at + 4).unwrap_or(&[]);
                for (&joint, weight) in four.iter().zip(weights.get::<4>(v as usize, 0.0)) {
                    // Exporters leave odd joints beside weights of 0.
                    if weight == 0.0 || !weight.is_finite() {
                        continue;
                    }
                    let Some(matrix) = joints.get(joint as usize) else {
                        let d = Diagnostic::error(
                            "G0607",
                            format!("vertex {v} names joint {joint}, but the skin has {}", joints.len()),
                        );
                        self.report.push(&joints_at, d);
                        return None;
                    };
                    let weight = f64::from(weight);
                    sum.matrix3 += matrix.matrix3 * weight;
                    sum.translation += matrix.translation * weight;
                    *total += weight;
                }
            }
        }
        let mut orientation = 0.0;
        for (i, (sum, total)) in blended.iter().enumerate() {
            // A vertex that no joint holds goes with the first, as most viewers do.
            let first = joints.first().copied().unwrap_or_default();
            let pose = match total.recip() {
                f if f.is_finite() => DAffine3 {
                    matrix3: sum.matrix3 * f,
                    translation: sum.translation * f,
                },
                _ => first,
            };
            orientation += pose.matrix3.determinant();
            part.positions[i] = pose.transform_point3(part.positions[i]);
            if let Some(n) = part.normals.get_mut(i) {
                *n = (cofactor(pose.matrix3) * n.as_dvec3()).as_vec3();
            }
            if let Some(t) = part.tangents.get_mut(i) {
                *t = (pose.matrix3 * t.truncate().as_dvec3()).as_vec3().extend(t.w);
            }
        }
        if orientation < 0.0 {
            part.flip_winding = true;
            part.normals.iter_mut().for_each(|n| *n = -*n);
            part.tangents.iter_mut().for_each(|t| t.w = -t.w);
        }
        Some(())
    }

    /// The joints of skin `index`: `world[node]` times the inverse bind matrix. `None` if the skin is broken or
    /// cannot be posed.
    pub(super) fn joints(&mut self, index: usize, world: &[Option<DAffine3>], at: &str) -> Option<Vec<DAffine3>> {
        let skin: json::Skin = self.doc.get(index, at, &mut self.report)?;
        let at = format!("skins[{index}]");
        let inverse = match skin.inverse_bind_matrices {
            None => None,
            Some(accessor) => {
                const MAT4: Wanted = Wanted {
                    components: &[16],
                    normalize: false,
                };
                let place = format!("{at}.inverseBindMatrices");
                let matrices = self.floats(accessor.value(), MAT4, &place)?;
                if matrices.count() < skin.joints.len() {
                    let message = format!("{} matrices for {} joints", matrices.count(), skin.joints.len());
                    self.report.error("G0608", &place, message);
                    return None;
                }
                Some(matrices)
            }
        };
        let mut joints = Vec::with_capacity(skin.joints.len());
        for (i, node) in skin.joints.iter().enumerate() {
            let place = format!("{at}.joints[{i}]");
            self.doc.raw("nodes", node.value(), &place, &mut self.report)?;
            let Some(Some(global)) = world.get(node.value()) else {
                let message = "the joint is not in the scene; the mesh is drawn as it was bound";
                self.report.warning("G0609", &place, message);
                return None;
            };
            let bind = inverse.as_ref().map_or(DAffine3::IDENTITY, |m| {
                affine_from_columns(m.get::<16>(i, 0.0).map(f64::from))
            });
            joints.push(*global * bind);
        }
        Some(joints)
    }
}

/// The affine part of a column-major 4×4 matrix.
pub(super) fn affine_from_columns(columns: [f64; 16]) -> DAffine3 {
    DAffine3::from_mat4(DMat4::from_cols_array(&columns))
}

/// det(m)·m⁻ᵗ: how normals turn. Defined for singular matrices too.
fn cofactor(m: DMat3) -> DMat3 {
    let (x, y, z) = (m.x_axis, m.y_axis, m.z_axis);
    DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y))
}

/// The unit tangents with their signs, or `None` if one cannot be normalised.
pub(super) fn unit_tangents(tangents: &[Vec4]) -> Option<Vec<Vec4>> {
    let unit = |t: &Vec4| {
        let axis = t.truncate().try_normalize()?;
        Some(axis.extend(if t.w < 0.0 { -1.0 } else { 1.0 }))
    };
    tangents.iter().map(unit).collect()
}
