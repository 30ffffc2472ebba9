//! Meshes that change their form while the shutter is open: skins and morph targets.

use super::motion::step;
use glam::Vec3;

/// A form of a mesh at one moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Form {
    /// Vertices, relative to the mesh's centre.
    pub positions: Vec<Vec3>,
    /// Shading normals, or empty for flat faces.
    pub normals: Vec<Vec3>,
}

/// Forms at equal steps of the time that the shutter is open, the first at its opening. Vertices go on straight lines in
/// between, so that triangles that share a vertex share it at all times.
#[derive(Clone, Debug, PartialEq)]
pub struct Bend {
    forms: Box<[Form]>,
}

impl Bend {
    /// A mesh that goes through these forms. `None` if that is no motion or not one mesh: fewer than two forms, all the
    /// same, not as many vertices in each, or some that are not finite.
    pub fn new(forms: Vec<Form>) -> Option<Bend> {
        let first = forms.first()?;
        let fits = |f: &Form| {
            f.positions.len() == first.positions.len()
                && f.normals.len() == first.normals.len()
                && f.positions.iter().all(|p| p.is_finite())
        };
        let bends = forms.windows(2).any(|pair| pair[0] != pair[1]);
        (bends && forms.iter().all(fits)).then(|| Bend { forms: forms.into() })
    }

    /// The forms, two or more.
    pub fn forms(&self) -> &[Form] {
        &self.forms
    }

    /// The corners of a triangle at a time in [0, 1]; `None` if it has one that does not exist.
    pub fn corners_at(&self, triangle: [u32; 3], time: f32) -> Option<[Vec3; 3]> {
        let (a, b, w) = self.around(time);
        between(&a.positions, &b.positions, w, triangle)
    }

    /// The shading normals at the corners of a triangle at a time in [0, 1], not normalised; `None` without any.
    pub fn normals_at(&self, triangle: [u32; 3], time: f32) -> Option<[Vec3; 3]> {
        let (a, b, w) = self.around(time);
        between(&a.normals, &b.normals, w, triangle)
    }

    /// Memory that it takes.
    pub fn bytes(&self) -> usize {
        let of = |f: &Form| size_of_val(&f.positions[..]) + size_of_val(&f.normals[..]);
        self.forms.iter().map(of).sum()
    }

    /// The forms before and after a time, and how much of the way between them has passed.
    fn around(&self, time: f32) -> (&Form, &Form, f32) {
        let (i, w) = step(self.forms.len(), time);
        (&self.forms[i], &self.forms[i + 1], w as f32)
    }
}

fn between(a: &[Vec3], b: &[Vec3], w: f32, triangle: [u32; 3]) -> Option<[Vec3; 3]> {
    let at = |i: u32| {
        let (a, b) = (a.get(i as usize)?, b.get(i as usize)?);
        Some(*a + (*b - *a) * w)
    };
    Some([at(triangle[0])?, at(triangle[1])?, at(triangle[2])?])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn form(x: f32) -> Form {
        Form {
            positions: vec![Vec3::X * x, Vec3::Y, Vec3::Z * x],
            normals: vec![Vec3::Z; 3],
        }
    }

    #[test]
    fn forms_are_met_and_vertices_go_straight() {
        let bend = Bend::new(vec![form(0.0), form(2.0), form(3.0)]).expect("it bends");
        for (time, x) in [(0.0, 0.0), (0.25, 1.0), (0.5, 2.0), (0.75, 2.5), (1.0, 3.0), (9.0, 3.0)] {
            let found = bend.corners_at([0, 1, 2], time).expect("a triangle");
            assert_eq!(found, [Vec3::X * x, Vec3::Y, Vec3::Z * x], "{time}");
            assert_eq!(bend.normals_at([0, 1, 2], time), Some([Vec3::Z; 3]));
        }
        assert_eq!(bend.corners_at([0, 1, 3], 0.5), None);
    }

    #[test]
    fn what_is_no_motion_of_one_mesh_is_refused() {
        let mut other = form(1.0);
        other.positions.push(Vec3::ZERO);
        let infinite = Form {
            positions: vec![Vec3::INFINITY; 3],
            ..form(0.0)
        };
        for forms in [
            vec![],
            vec![form(1.0)],
            vec![form(1.0); 5],
            vec![form(1.0), other],
            vec![form(1.0), infinite],
        ] {
            assert_eq!(Bend::new(forms), None);
        }
    }
}
