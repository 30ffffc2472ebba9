//! What `make_models` needs: surfaces as grids of points, an OBJ writer, and (in the submodules) shapes, textures,
//! skies and a GLB writer. Models are right-handed, y up, as both formats want it.

pub mod features;
pub mod glb;
pub mod gltf;
pub mod grids;
pub mod lathe;
pub mod shapes;
pub mod skies;
pub mod textures;

use glam::{DVec2, DVec3};
use std::fmt::Write;
use std::path::Path;

/// Vertices with normals and texture coordinates (v grows downwards, as in glTF), and quads, counter-clockwise
/// seen from outside.
#[derive(Default)]
pub struct Surface {
    pub positions: Vec<DVec3>,
    pub normals: Vec<DVec3>,
    pub uvs: Vec<DVec2>,
    pub quads: Vec<[u32; 4]>,
}

impl Surface {
    /// A grid of (columns + 1) × (rows + 1) points of `f(u, v)`, u and v in [0, 1]. Normals are computed from
    /// differences, as ∂f/∂u × ∂f/∂v; `f` must be smooth and defined slightly outside.
    pub fn grid(columns: u32, rows: u32, f: &dyn Fn(f64, f64) -> DVec3) -> Surface {
        let mut s = Surface::default();
        let h = 1e-5;
        for j in 0..=rows {
            for i in 0..=columns {
                let (u, v) = (f64::from(i) / f64::from(columns), f64::from(j) / f64::from(rows));
                let du = f(u + h, v) - f(u - h, v);
                let dv = f(u, v + h) - f(u, v - h);
                s.positions.push(f(u, v));
                s.normals.push((du * 1e6).cross(dv * 1e6).normalize_or(DVec3::Y));
                s.uvs.push(DVec2::new(u, 1.0 - v));
            }
        }
        for j in 0..rows {
            for i in 0..columns {
                let a = j * (columns + 1) + i;
                s.quads.push([a, a + 1, a + columns + 2, a + columns + 1]);
            }
        }
        s
    }

    /// Adds another surface.
    pub fn append(&mut self, other: Surface) {
        let offset = self.positions.len() as u32;
        self.positions.extend(other.positions);
        self.normals.extend(other.normals);
        self.uvs.extend(other.uvs);
        self.quads.extend(other.quads.iter().map(|q| q.map(|i| i + offset)));
    }
}

/// Writes `name.obj` and `name.mtl`; v of the texture coordinates grows upwards in OBJ.
pub fn write_obj(
    folder: &Path,
    name: &str,
    material: &str,
    properties: &str,
    surface: &Surface,
) -> std::io::Result<()> {
    let mut text = format!("# made by examples/make_models.rs\nmtllib {name}.mtl\no {name}\nusemtl {material}\n");
    let mut line = |args: std::fmt::Arguments| {
        let _ = text.write_fmt(args); // a String takes everything
        text.push('\n');
    };
    for p in &surface.positions {
        line(format_args!("v {:.4} {:.4} {:.4}", p.x, p.y, p.z));
    }
    for n in &surface.normals {
        line(format_args!("vn {:.3} {:.3} {:.3}", n.x, n.y, n.z));
    }
    for q in &surface.quads {
        let [a, b, c, d] = q.map(|i| i + 1);
        line(format_args!("f {a}//{a} {b}//{b} {c}//{c} {d}//{d}"));
    }
    std::fs::write(folder.join(format!("{name}.obj")), text)?;
    std::fs::write(
        folder.join(format!("{name}.mtl")),
        format!("# made by examples/make_models.rs\nnewmtl {material}\n{properties}\n"),
    )
}
