//! `camera { … }`, and its meaning: the order of the items does not matter, transforms come last.

use super::transform::TRANSFORM_TEXTS;
use crate::diag::{Diagnostic, Span};
use crate::lang::desc::{CameraDesc, Desc};
use crate::lang::eval::{Interp, Parsed, Stop, T, Value};
use crate::lang::syntax::Word;
use crate::scene::{Aspect, Camera, Place, Projection};
use glam::{DAffine3, DVec3};
use std::rc::Rc;

const CAMERA_TEXTS: &[&str] = &[
    "location",
    "look_at",
    "right",
    "up",
    "sky",
    "direction",
    "angle",
    "perspective",
    "orthographic",
    "aperture",
    "focal_point",
    "blur_samples",
    "lens_radius",
    "focus_distance",
];

impl CameraDesc {
    fn new(span: Span) -> CameraDesc {
        CameraDesc {
            location: DVec3::ZERO,
            look_at: None,
            right: None,
            up: None,
            sky: DVec3::Y,
            direction: DVec3::Z,
            angle: None,
            orthographic: false,
            unsupported: None,
            lens_radius: None,
            focus_distance: None,
            aperture: 0.0,
            focal_point: None,
            blur_samples: 0.0,
            transform: DAffine3::IDENTITY,
            span,
        }
    }
}

impl Interp<'_> {
    /// A camera, beginning with its word.
    pub fn camera(&mut self) -> Parsed<Rc<CameraDesc>> {
        let span = self.bump().span;
        let mut camera = match &self.scene.default_camera {
            Some(c) => (**c).clone(),
            None => CameraDesc::new(span),
        };
        camera.span = span;
        self.block(|s| s.camera_items(&mut camera))?;
        Ok(Rc::new(camera))
    }

    fn camera_items(&mut self, c: &mut CameraDesc) -> Parsed<()> {
        let depth = self.depth();
        let mut failed = false;
        loop {
            let tok = self.peek_item();
            match tok.t {
                T::Mark(b'}') | T::End => break,
                T::Mark(b',' | b';') => {
                    self.bump();
                    continue;
                }
                _ => {}
            }
            let before = self.steps();
            if let Some(stop) = self.missing_brace(
                tok,
                &[
                    Word::LightSource,
                    Word::Sphere,
                    Word::Plane,
                    Word::Box,
                    Word::Union,
                    Word::Object,
                    Word::Background,
                    Word::GlobalSettings,
                ],
            ) {
                return Err(stop);
            }
            if self.camera_item(c).is_err() {
                failed = true;
                self.recover(
                    depth,
                    before,
                    &[Word::Location, Word::LookAt, Word::Angle, Word::Right, Word::Up],
                );
            }
        }
        if failed { Err(Stop) } else { Ok(()) }
    }

    fn camera_item(&mut self, c: &mut CameraDesc) -> Parsed<()> {
        let tok = self.peek();
        let w = match tok.t {
            T::Name(n) if self.scopes.get(n).is_some() => {
                let span = c.span;
                match self.take_value()? {
                    Value::Desc(Desc::Camera(named)) => *c = (*named).clone(),
                    Value::Poison => return Err(Stop),
                    other => {
                        let message = format!("expected a camera, found {}", other.kind());
                        return Err(self.error("P0303", tok.span, message));
                    }
                }
                c.span = span;
                return Ok(());
            }
            T::Word(w) => w,
            _ => return Err(self.unexpected("`camera`", CAMERA_TEXTS, tok)),
        };
        if let Some(t) = self.transform_word(w)? {
            c.transform = t * c.transform;
            return self.check_transform(&c.transform, tok);
        }
        self.bump();
        match w {
            Word::Location => c.location = self.vec3("location")?,
            Word::LookAt => c.look_at = Some(self.vec3("look_at")?),
            Word::Right => c.right = Some(self.vec3("right")?),
            Word::Up => c.up = Some(self.vec3("up")?),
            Word::Sky => c.sky = self.vec3("sky")?,
            Word::Direction => c.direction = self.vec3("direction")?,
            Word::Angle => {
                let at = self.peek().span;
                let angle = self.finite("angle")?;
                if self.eat(b',') || matches!(self.peek().t, T::Number(_)) {
                    self.finite("vertical angle")?;
                }
                if !(angle > 0.0 && angle <= 360.0) {
                    return Err(self.error(
                        "P0311",
                        at,
                        format!("angle must be between 0 and 180 degrees, found {angle}"),
                    ));
                }
                c.angle = Some(angle);
            }
            Word::Perspective => c.orthographic = false,
            Word::Orthographic => c.orthographic = true,
            Word::LensRadius => c.lens_radius = Some(self.within("lens_radius", 0.0, f64::MAX)?),
            Word::FocusDistance => {
                c.focus_distance = Some(self.within("focus_distance", f64::MIN_POSITIVE, f64::MAX)?)
            }
            Word::Aperture => c.aperture = self.within("aperture", 0.0, f64::MAX)?,
            Word::FocalPoint => c.focal_point = Some(self.vec3("focal_point")?),
            Word::BlurSamples => {
                c.blur_samples = self.finite("blur_samples")?;
                if self.eat(b',') {
                    c.blur_samples = self.finite("blur_samples")?;
                }
            }
            Word::Confidence | Word::Variance => {
                self.finite("value")?;
            }
            Word::Normal => {
                self.warn_once(
                    "P0409",
                    tok.span,
                    "a camera's `normal` is not supported yet and is left out",
                );
                self.skip_block()?;
            }
            Word::Fisheye
            | Word::UltraWideAngle
            | Word::Omnimax
            | Word::Panoramic
            | Word::Spherical
            | Word::Cylinder
            | Word::MeshCamera => {
                c.unsupported = Some((w.text(), tok.span));
                self.skip_arguments()?;
            }
            _ => {
                let stop = self.unexpected("`camera`", &[CAMERA_TEXTS, TRANSFORM_TEXTS].concat(), tok);
                return Err(stop);
            }
        }
        Ok(())
    }

    /// The camera as the renderer needs it.
    pub fn final_camera(&mut self, c: &CameraDesc) -> Parsed<Camera> {
        if let Some((word, span)) = c.unsupported {
            let d = Diagnostic::error("P0404", format!("the `{word}` camera is not supported yet")).at(span, "");
            return Err(self.report(d.hint("`perspective` and `orthographic` are")));
        }
        let [width, height] = self.resolution().map(f64::from);
        // Until 3.8 the picture was 4:3 whatever the image's shape.
        let default_right = if self.scene_version >= 3.8 {
            DVec3::X * (width / height)
        } else {
            DVec3::X * (4.0 / 3.0)
        };
        let mut right = c.right.unwrap_or(default_right);
        let mut up = c.up.unwrap_or(DVec3::Y);
        let mut direction = c.direction;
        let (right_length, up_length) = (right.length(), up.length());
        if !(right_length > 0.0 && up_length > 0.0 && direction.length() > 0.0) {
            return Err(self.error(
                "P0315",
                c.span,
                "`right`, `up` and `direction` of the camera must have a length",
            ));
        }
        let handed = if up.cross(direction).dot(right) < 0.0 {
            -1.0
        } else {
            1.0
        };
        if let (Some(angle), false) = (c.angle, c.orthographic) {
            if angle >= 180.0 {
                return Err(self.error(
                    "P0311",
                    c.span,
                    format!("angle must be below 180 degrees, found {angle}"),
                ));
            }
            direction = direction.normalize() * (right_length / (2.0 * (angle / 2.0).to_radians().tan()));
        }
        let mut look_distance = None;
        if let Some(target) = c.look_at {
            let view = target - c.location;
            look_distance = Some(view.length());
            let Some(axis) = view.try_normalize() else {
                return Err(self.error("P0315", c.span, "camera looks at its own location"));
            };
            // The sine of the angle between the two; below a few roundings it has no direction of its own.
            let across = c.sky.normalize_or_zero().cross(axis);
            let side = match across.try_normalize().filter(|_| across.length() > 4.0 * f64::EPSILON) {
                Some(side) => side,
                // Looking straight along `sky`: any upright choice will do, POV-Ray's is the old right.
                None => {
                    let message = "the camera looks along `sky`, which then does not say where up is; \
                                   another axis is taken";
                    self.warn_once("P0413", c.span, message);
                    up.cross(axis)
                        .try_normalize()
                        .or_else(|| direction.cross(axis).try_normalize())
                        .unwrap_or_else(|| axis.any_orthonormal_vector())
                }
            };
            up = axis.cross(side) * up_length;
            right = side * right_length * handed;
            direction = axis * direction.length();
        }
        if c.orthographic && ((c.right.is_none() && c.up.is_none()) || c.angle.is_some()) {
            let distance = look_distance.unwrap_or(1.0);
            let mut scale = distance / c.direction.length();
            if let Some(angle) = c.angle {
                scale = distance * 2.0 * (angle.min(179.9) / 2.0).to_radians().tan() / right_length;
            }
            right *= scale;
            up *= scale;
        }
        let axis = direction.normalize();
        let lens_radius = c
            .lens_radius
            .unwrap_or(if c.blur_samples > 0.0 { c.aperture / 2.0 } else { 0.0 });
        if lens_radius == 0.0 && c.lens_radius.is_some() {
            self.note_idle("lens", "its radius is 0: the camera is a pinhole", c.span);
        }
        let to_focus = c.focal_point.map(|p| (p - c.location).dot(axis)).filter(|&d| d > 0.0);
        let focus_distance = c.focus_distance.or(to_focus).or(look_distance).unwrap_or(1.0);
        let t = &c.transform;
        let scale = t.transform_vector3(axis).length();
        Ok(Camera {
            name: String::new(),
            location: t.transform_point3(c.location),
            direction: t.transform_vector3(direction),
            right: t.transform_vector3(right),
            up: t.transform_vector3(up),
            aspect: Aspect::AsWritten,
            projection: if c.orthographic {
                Projection::Orthographic
            } else {
                Projection::Perspective
            },
            lens_radius: lens_radius * scale,
            focus_distance: focus_distance * scale,
            motion: Vec::new(),
            place: Place::Text(c.span),
        })
    }
}
