//! The simple shapes: their numbers, checked.

use crate::diag::Span;
use crate::lang::desc::ShapeDesc;
use crate::lang::eval::{Interp, Parsed, T};
use crate::lang::syntax::Word;
use crate::scene::Shape;
use glam::DVec3;
use std::rc::Rc;

impl Interp<'_> {
    /// The shape of a word, behind its opening brace.
    pub fn shape(&mut self, w: Word, span: Span) -> Parsed<ShapeDesc> {
        let shape = match w {
            Word::Sphere => self.sphere(span)?,
            Word::Plane => self.plane()?,
            Word::Box => self.box_shape(span)?,
            Word::Cylinder => self.cylinder(span)?,
            Word::Cone => self.cone(span)?,
            Word::Disc => self.disc()?,
            Word::Torus => self.torus()?,
            Word::Triangle | Word::SmoothTriangle => self.triangle(w, span)?,
            Word::Mesh => return self.mesh(span),
            Word::Mesh2 => return self.mesh2(span),
            _ => return self.unsupported_shape(w),
        };
        Ok(ShapeDesc::Primitive(Rc::new(shape)))
    }

    fn sphere(&mut self, span: Span) -> Parsed<Shape> {
        let center = self.vec3("centre of the sphere")?;
        self.comma();
        let radius = self.finite("radius of the sphere")?.abs();
        if radius == 0.0 {
            return Err(self.error("P0311", span, "sphere radius is 0, expected a positive number"));
        }
        Ok(Shape::Sphere { center, radius })
    }

    fn plane(&mut self) -> Parsed<Shape> {
        let normal = self.unit("normal of the plane")?;
        self.comma();
        let distance = self.finite("distance of the plane")?;
        Ok(Shape::Plane { normal, distance })
    }

    /// A direction, made a unit vector.
    pub fn unit(&mut self, what: &str) -> Parsed<DVec3> {
        let at = self.peek().span;
        let v = self.vec3(what)?;
        // Scaled first: squares of very small or large components leave the range of doubles.
        match (v / v.abs().max_element()).try_normalize() {
            Some(unit) => Ok(unit),
            None => Err(self.error("P0311", at, format!("{what} has no length"))),
        }
    }

    fn box_shape(&mut self, span: Span) -> Parsed<Shape> {
        let a = self.vec3("corner of the box")?;
        self.comma();
        let b = self.vec3("corner of the box")?;
        let (min, max) = (a.min(b), a.max(b));
        let flat = (0..3).filter(|&i| min[i] == max[i]).count();
        if flat > 1 {
            return Err(self.error(
                "P0311",
                span,
                "box has no surface: its corners differ in fewer than two axes",
            ));
        }
        Ok(Shape::Box { min, max })
    }

    fn cylinder(&mut self, span: Span) -> Parsed<Shape> {
        let base = self.vec3("end of the cylinder")?;
        self.comma();
        let cap = self.vec3("end of the cylinder")?;
        self.comma();
        let radius = self.finite("radius of the cylinder")?.abs();
        self.tapered("cylinder", span, [base, cap], [radius, radius])
    }

    fn cone(&mut self, span: Span) -> Parsed<Shape> {
        let base = self.vec3("base of the cone")?;
        self.comma();
        let base_radius = self.finite("base radius of the cone")?.abs();
        self.comma();
        let cap = self.vec3("cap of the cone")?;
        self.comma();
        let cap_radius = self.finite("cap radius of the cone")?.abs();
        self.tapered("cone", span, [base, cap], [base_radius, cap_radius])
    }

    fn tapered(&mut self, what: &str, span: Span, ends: [DVec3; 2], radii: [f64; 2]) -> Parsed<Shape> {
        self.comma();
        let open = self.eat_word(Word::Open);
        let [base, cap] = ends;
        let [base_radius, cap_radius] = radii;
        if base == cap {
            return Err(self.error(
                "P0311",
                span,
                format!("{what} has no length: both ends are the same point"),
            ));
        }
        if base_radius == 0.0 && cap_radius == 0.0 {
            return Err(self.error("P0311", span, format!("{what} has no radius")));
        }
        Ok(Shape::Cone {
            base,
            base_radius,
            cap,
            cap_radius,
            open,
        })
    }

    fn disc(&mut self) -> Parsed<Shape> {
        let center = self.vec3("centre of the disc")?;
        self.comma();
        let normal = self.unit("normal of the disc")?;
        self.comma();
        let at = self.peek().span;
        let radius = self.finite("radius of the disc")?.abs();
        self.comma();
        let mut hole_radius = 0.0;
        if self.starts_expr() {
            hole_radius = self.finite("radius of the hole")?.abs();
        }
        if hole_radius >= radius {
            let message = format!("disc has no surface: radius {radius}, hole {hole_radius}");
            return Err(self.error("P0311", at, message));
        }
        Ok(Shape::Disc {
            center,
            normal,
            radius,
            hole_radius,
        })
    }

    fn torus(&mut self) -> Parsed<Shape> {
        let at = self.peek().span;
        let major = self.finite("major radius of the torus")?.abs();
        self.comma();
        let minor = self.finite("minor radius of the torus")?.abs();
        if major == 0.0 || minor == 0.0 {
            return Err(self.error("P0311", at, "radii of the torus must not be 0"));
        }
        Ok(Shape::Torus { major, minor })
    }

    fn triangle(&mut self, w: Word, span: Span) -> Parsed<Shape> {
        let smooth = w == Word::SmoothTriangle;
        let (vertices, normals) = self.corners(smooth)?;
        let [a, b, c] = vertices;
        if (b - a).cross(c - a) == DVec3::ZERO {
            self.warn(
                "P0314",
                span,
                "triangle has no surface, its corners lie on a line: it is left out",
            );
        }
        Ok(Shape::Triangle { vertices, normals })
    }

    /// Three corners, each with a normal if smooth.
    pub fn corners(&mut self, smooth: bool) -> Parsed<([DVec3; 3], Option<[DVec3; 3]>)> {
        let (mut vertices, mut normals) = ([DVec3::ZERO; 3], [DVec3::ZERO; 3]);
        for i in 0..3 {
            vertices[i] = self.vec3("corner of the triangle")?;
            self.comma();
            if smooth {
                normals[i] = self.unit("normal of the triangle")?;
                self.comma();
            }
        }
        Ok((vertices, smooth.then_some(normals)))
    }

    /// Whether the block ends here.
    pub fn at_close(&mut self) -> bool {
        matches!(self.peek().t, T::Mark(b'}') | T::End)
    }
}
