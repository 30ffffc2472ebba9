//! Materials as the engine evaluates them: recipes that turn a surface point into a [`Bsdf`].
//!
//! `compile` fills these from the description. A recipe with textures is evaluated at every hit; mixtures and the
//! glTF set choose among models by random numbers, which is unbiased because scattering is linear in them.

use super::bsdf::Bsdf;
use super::bsdf::diffuse::{Diffuse, OrenNayar, Translucent};
use super::bsdf::finish::Finish;
use super::bsdf::fresnel::{f0_from_eta, fresnel_dielectric};
use super::bsdf::glossy::{Coat, Glossy, SmoothCoat};
use super::bsdf::metal::Metal;
use super::bsdf::microfacet::{ALPHA_DELTA, Ggx};
use super::bsdf::principled::{Base, Clearcoat, Principled};
use super::bsdf::rough_glass::{RoughGlass, RoughThinGlass};
use super::bsdf::sheen::Sheen;
use super::bsdf::specular::{Glass, Specular, ThinGlass};
use super::surface::Attributes;
use super::texture::Textures;
use crate::math::frame::Frame;
use crate::math::portable::sin_cos_turns;
use crate::math::robust::try_normalize;
use glam::{Vec3, Vec4};

/// `factor · texture.rgb`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColorInput {
    /// Constant factor, linear RGB.
    pub factor: Vec3,
    /// Index of a texture.
    pub texture: Option<u32>,
}

impl ColorInput {
    /// Black everywhere.
    pub const BLACK: ColorInput = ColorInput::constant(Vec3::ZERO);
    /// White everywhere.
    pub const WHITE: ColorInput = ColorInput::constant(Vec3::ONE);

    /// The same colour everywhere.
    pub const fn constant(factor: Vec3) -> ColorInput {
        ColorInput { factor, texture: None }
    }

    /// The colour at a point.
    pub fn eval(&self, textures: &Textures, attrs: &Attributes) -> Vec3 {
        match self.texture {
            None => self.factor,
            Some(id) => self.factor * textures.eval(id, attrs).truncate(),
        }
    }

    /// Whether it can be anything but black.
    pub fn is_black(&self) -> bool {
        self.factor == Vec3::ZERO
    }
}

/// `factor · texture.channel`, channel 0..4 for R, G, B, A.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScalarInput {
    /// Constant factor.
    pub factor: f32,
    /// Index of a texture, and the channel taken from it.
    pub texture: Option<(u32, u8)>,
}

impl ScalarInput {
    /// The same number everywhere.
    pub const fn constant(factor: f32) -> ScalarInput {
        ScalarInput { factor, texture: None }
    }

    /// The number at a point.
    pub fn eval(&self, textures: &Textures, attrs: &Attributes) -> f32 {
        match self.texture {
            None => self.factor,
            Some((id, channel)) => {
                let v: Vec4 = textures.eval(id, attrs);
                self.factor * v.to_array().get(usize::from(channel)).copied().unwrap_or(1.0)
            }
        }
    }

    /// The number at a point, brought into [0, 1]; NaN is 0.
    fn unit(&self, cx: &Shading<'_>) -> f32 {
        self.eval(cx.textures, cx.attrs).max(0.0).min(1.0)
    }
}

/// How coverage is used.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Alpha {
    /// Always there.
    Opaque,
    /// Fully there where the value reaches the cutoff.
    Mask(ScalarInput, f32),
    /// There with this probability.
    Blend(ScalarInput),
}

/// A tangent-space normal map, +y up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NormalMap {
    /// Index of a data texture.
    pub texture: u32,
    /// Factor on x and y.
    pub scale: f32,
}

/// The glTF set; see the fields of the same names in `scene`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)] // the names are glTF's
pub struct PrincipledInputs {
    pub base_color: ColorInput,
    pub metallic: ScalarInput,
    pub roughness: ScalarInput,
    /// Infinite for F0 = 1 (glTF's 0).
    pub ior: f32,
    pub specular: ScalarInput,
    pub specular_color: ColorInput,
    pub transmission: ScalarInput,
    pub thick: bool,
    pub clearcoat: ScalarInput,
    pub clearcoat_roughness: ScalarInput,
    pub sheen_color: ColorInput,
    pub sheen_roughness: ScalarInput,
    pub anisotropy: ScalarInput,
    /// Radians, counter-clockwise from the tangent.
    pub anisotropy_rotation: f32,
    pub diffuse_transmission: ScalarInput,
    pub diffuse_transmission_color: ColorInput,
}

/// POV-Ray's pigment and finish, see the fields of the same names in `scene`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)] // the names are POV-Ray's
pub struct FinishInputs {
    pub color: ColorInput,
    pub filter: f32,
    pub transmit: f32,
    pub diffuse: f32,
    pub diffuse_back: f32,
    pub brilliance: f32,
    pub phong: f32,
    pub phong_size: f32,
    pub specular: f32,
    /// POV-Ray's scale: exponent 1/roughness.
    pub roughness: f32,
    pub metallic: f32,
    pub reflection_min: Vec3,
    pub reflection_max: Vec3,
    pub reflection_falloff: f32,
    pub reflection_fresnel: bool,
    pub reflection_metallic: f32,
    pub conserve_energy: bool,
    /// Bends what passes.
    pub ior: Option<f32>,
}

/// How a surface scatters.
#[derive(Clone, Debug, PartialEq)]
#[allow(missing_docs)] // the fields are those of `scene`'s variants
pub enum SurfaceModel {
    /// Scatters nothing.
    Black,
    /// Lambert, or Oren–Nayar where σ (radians) is not 0.
    Diffuse { color: ColorInput, sigma: ScalarInput },
    /// A perfect mirror.
    Specular { color: ColorInput },
    /// A dielectric solid of [`Material::ior`]; roughness is perceptual.
    Glass { color: ColorInput, roughness: ScalarInput },
    /// A coat of [`Material::ior`] over a diffuse base, or a conductor.
    Glossy {
        color: ColorInput,
        roughness: ScalarInput,
        metal: bool,
    },
    /// A thin sheet.
    Translucent { color: ColorInput, transmit: ScalarInput },
    /// The glTF set.
    Principled(Box<PrincipledInputs>),
    /// POV-Ray's pigment and finish.
    Finish(Box<FinishInputs>),
    /// (1 − weight)·a + weight·b: indices of materials that stand before this one.
    Mix { a: u32, b: u32, weight: ScalarInput },
}

/// A material.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Scattering.
    pub surface: SurfaceModel,
    /// Emitted radiance.
    pub emission: ColorInput,
    /// Whether the side of the geometric normal emits.
    pub emits_front: bool,
    /// Whether the other side emits.
    pub emits_back: bool,
    /// Coverage.
    pub alpha: Alpha,
    /// Perturbs the shading normal.
    pub normal_map: Option<NormalMap>,
    /// Absorption coefficient inside, per world unit.
    pub absorption: Vec3,
    /// Index of refraction inside (glass), or of the coat (glossy).
    pub ior: f32,
    /// 20 / Abbe number; 0 for no dispersion.
    pub dispersion: f32,
    /// Whether it bounds a solid that refracts or absorbs: crossing it enters or leaves a medium.
    pub interior: bool,
    /// Whether evaluating it reads [`Attributes`].
    pub needs_attributes: bool,
}

/// What evaluating a material needs besides itself.
#[derive(Clone, Copy, Debug)]
pub struct Shading<'a> {
    /// All materials, for mixtures.
    pub materials: &'a [Material],
    /// All textures.
    pub textures: &'a Textures,
    /// The surface point.
    pub attrs: &'a Attributes,
    /// Index of refraction of what encloses the object.
    pub outer_ior: f32,
    /// The channel that a path follows after its first dispersive hit.
    pub channel: Option<u8>,
}

impl Material {
    /// A material that only scatters, outside of any medium.
    pub fn new(surface: SurfaceModel) -> Material {
        Material {
            surface,
            emission: ColorInput::BLACK,
            emits_front: true,
            emits_back: true,
            alpha: Alpha::Opaque,
            normal_map: None,
            absorption: Vec3::ZERO,
            ior: 1.5,
            dispersion: 0.0,
            interior: false,
            needs_attributes: false,
        }
    }

    /// The index of refraction inside for one channel (0, 1, 2), or the middle one.
    /// Source: KHR_materials_dispersion: n ∓ (n−1)·0.025·dispersion for red and blue.
    pub fn ior_at(&self, channel: Option<u8>) -> f32 {
        let half_spread = (self.ior - 1.0) * 0.025 * self.dispersion;
        match channel {
            Some(0) => self.ior - half_spread,
            Some(2) => self.ior + half_spread,
            _ => self.ior,
        }
    }

    /// The scattering at a point. `random` gives numbers in [0, 1) for the choices of mixtures; it is called only then.
    pub fn bsdf<F: FnMut() -> f32>(&self, cx: &Shading<'_>, random: &mut F) -> Bsdf {
        match &self.surface {
            SurfaceModel::Black => Bsdf::Black,
            SurfaceModel::Diffuse { color, sigma } => {
                let albedo = color.eval(cx.textures, cx.attrs);
                let sigma = sigma.eval(cx.textures, cx.attrs);
                if sigma > 0.0 {
                    Bsdf::OrenNayar(OrenNayar::from_sigma(albedo, sigma))
                } else {
                    Bsdf::Diffuse(Diffuse { albedo })
                }
            }
            SurfaceModel::Specular { color } => {
                let color = color.eval(cx.textures, cx.attrs);
                Bsdf::Specular(Specular { color, grazing: color })
            }
            SurfaceModel::Glass { color, roughness } => {
                let color = color.eval(cx.textures, cx.attrs);
                let alpha = roughness_to_alpha(roughness.unit(cx));
                solid(color, self.relative_ior(cx), alpha).bsdf()
            }
            SurfaceModel::Glossy {
                color,
                roughness,
                metal,
            } => {
                let color = color.eval(cx.textures, cx.attrs);
                let alpha = roughness_to_alpha(roughness.unit(cx));
                if *metal {
                    conductor(color, Ggx::isotropic(alpha)).bsdf()
                } else {
                    let eta = self.relative_ior(cx);
                    // A coat thinner than what surrounds it reflects like its reciprocal, short of total reflection.
                    let coat = Coat::Dielectric {
                        eta: eta.max(1.0 / eta),
                    };
                    coated(color, Vec3::ZERO, coat, Ggx::isotropic(alpha)).bsdf()
                }
            }
            SurfaceModel::Translucent { color, transmit } => {
                let color = color.eval(cx.textures, cx.attrs);
                let t = transmit.unit(cx);
                Bsdf::Translucent(Translucent {
                    front: color * (1.0 - t),
                    back: color * t,
                })
            }
            SurfaceModel::Principled(p) => self.principled(p, cx, random),
            SurfaceModel::Finish(f) => Bsdf::Finish(f.lobes(cx)),
            SurfaceModel::Mix { a, b, weight } => {
                let id = if random() < weight.unit(cx) { *b } else { *a };
                match cx.materials.get(id as usize) {
                    // Parts stand before their mixture, which therefore cannot contain itself.
                    Some(part) => part.bsdf(cx, random),
                    None => Bsdf::Black,
                }
            }
        }
    }

    /// n_inside / n_outside.
    fn relative_ior(&self, cx: &Shading<'_>) -> f32 {
        self.ior_at(cx.channel) / cx.outer_ior
    }

    /// The glTF set: metal, transmission or plastic by chance, then its layers.
    fn principled<F: FnMut() -> f32>(&self, p: &PrincipledInputs, cx: &Shading<'_>, random: &mut F) -> Bsdf {
        let color = p.base_color.eval(cx.textures, cx.attrs).clamp(Vec3::ZERO, Vec3::ONE);
        let alpha = roughness_to_alpha(p.roughness.unit(cx));
        let anisotropy = p.anisotropy.unit(cx);
        let ggx = Ggx::anisotropic(alpha + (1.0 - alpha) * anisotropy * anisotropy, alpha);
        let base = if chance(p.metallic.unit(cx), random) {
            conductor(color, ggx)
        } else {
            let f90 = p.specular.unit(cx);
            let f0 = p.specular_color.eval(cx.textures, cx.attrs).max(Vec3::ZERO) * f0_from_eta(p.ior / cx.outer_ior);
            let f0 = f0.min(Vec3::ONE) * f90;
            if chance(p.transmission.unit(cx), random) {
                if p.thick {
                    solid(color, self.relative_ior(cx), alpha)
                } else {
                    match ggx {
                        None => Base::ThinGlass(ThinGlass { color, f0, f90 }),
                        Some(ggx) => Base::RoughThinGlass(RoughThinGlass { color, f0, f90, ggx }),
                    }
                }
            } else {
                let share = p.diffuse_transmission.unit(cx);
                let back = p.diffuse_transmission_color.eval(cx.textures, cx.attrs);
                let back = back.clamp(Vec3::ZERO, Vec3::ONE) * share;
                coated(color * (1.0 - share), back, Coat::Schlick { f0, f90 }, ggx)
            }
        };
        let strength = p.clearcoat.unit(cx);
        let coat = if strength > 0.0 {
            let alpha = roughness_to_alpha(p.clearcoat_roughness.unit(cx));
            Clearcoat {
                strength,
                ggx: Ggx::isotropic(alpha),
            }
        } else {
            Clearcoat::NONE
        };
        let sheen = if p.sheen_color.is_black() {
            Sheen::NONE
        } else {
            let tint = p.sheen_color.eval(cx.textures, cx.attrs).clamp(Vec3::ZERO, Vec3::ONE);
            Sheen::new(tint, p.sheen_roughness.unit(cx))
        };
        Principled { base, coat, sheen }.into_bsdf()
    }

    /// Emitted radiance at a point, seen from the front or the back.
    pub fn emission(&self, cx: &Shading<'_>, front: bool) -> Vec3 {
        if if front { self.emits_front } else { self.emits_back } {
            self.emission.eval(cx.textures, cx.attrs)
        } else {
            Vec3::ZERO
        }
    }

    /// Coverage at a point, in [0, 1].
    pub fn alpha(&self, cx: &Shading<'_>) -> f32 {
        match &self.alpha {
            Alpha::Opaque => 1.0,
            Alpha::Mask(value, cutoff) => {
                if value.eval(cx.textures, cx.attrs) >= *cutoff {
                    1.0
                } else {
                    0.0
                }
            }
            Alpha::Blend(value) => value.unit(cx),
        }
    }

    /// Share of light per channel that a shadow ray of a lamp keeps when it passes through unbent, in POV-Ray's manner;
    /// zero for what is opaque, or rough (its scattering reaches lamps by itself). `cos` = |cosθ| at the surface.
    /// A solid's reflectance is that of entering, on both crossings: the real, bent ray has the same on its way out.
    /// Coverage is not included.
    pub fn straight_transmittance(&self, cx: &Shading<'_>, cos: f32) -> Vec3 {
        match &self.surface {
            SurfaceModel::Glass { color, roughness } => {
                let eta = self.relative_ior(cx);
                if is_rough_solid(eta, roughness_to_alpha(roughness.unit(cx))) {
                    return Vec3::ZERO;
                }
                let r = fresnel_dielectric(cos, eta.max(1.0 / eta));
                color.eval(cx.textures, cx.attrs) * (1.0 - r)
            }
            SurfaceModel::Finish(f) => {
                let mut lobes = f.lobes(cx);
                lobes.eta = lobes.eta.max(1.0 / lobes.eta);
                lobes.passage(Vec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos))
            }
            SurfaceModel::Principled(p) => self.principled_straight(p, cx, cos),
            SurfaceModel::Mix { a, b, weight } => {
                let w = weight.unit(cx);
                let part = |id: u32| {
                    cx.materials
                        .get(id as usize)
                        .map_or(Vec3::ZERO, |m| m.straight_transmittance(cx, cos))
                };
                part(*a) * (1.0 - w) + part(*b) * w
            }
            SurfaceModel::Black
            | SurfaceModel::Diffuse { .. }
            | SurfaceModel::Specular { .. }
            | SurfaceModel::Glossy { .. }
            | SurfaceModel::Translucent { .. } => Vec3::ZERO,
        }
    }

    fn principled_straight(&self, p: &PrincipledInputs, cx: &Shading<'_>, cos: f32) -> Vec3 {
        let share = p.transmission.unit(cx) * (1.0 - p.metallic.unit(cx));
        if share <= 0.0 {
            return Vec3::ZERO;
        }
        // The choices that lead to transmission, with certainty.
        let sure = PrincipledInputs {
            metallic: ScalarInput::constant(0.0),
            transmission: ScalarInput::constant(1.0),
            ..*p
        };
        let wo = Vec3::new((1.0 - cos * cos).max(0.0).sqrt(), 0.0, cos);
        let (base, keep) = match self.principled(&sure, cx, &mut || 0.5) {
            Bsdf::Principled(b) => (b.base.bsdf(), b.keep_base(wo)),
            other => (other, 1.0),
        };
        let passes = match base {
            Bsdf::Glass(g) => g.color * (1.0 - fresnel_dielectric(cos, g.eta.max(1.0 / g.eta))),
            Bsdf::ThinGlass(t) => t.color * (Vec3::ONE - t.reflectance(cos)),
            _ => Vec3::ZERO,
        };
        passes * (share * keep)
    }

    /// The shading frame at a point: its z axis is the shading normal on the side of `ng`, its x axis the direction of
    /// anisotropy if there is one.
    ///
    /// `ng` and `ns` are the surface's geometric and interpolated normals, on one side; `wo` points to the viewer, on
    /// either side. The normal is bent such that `wo` and its mirror direction lie on the viewer's side of the surface.
    pub fn shading_frame(&self, cx: &Shading<'_>, ng: Vec3, ns: Vec3, wo: Vec3) -> Frame {
        let mut n = ns;
        if let Some(map) = &self.normal_map {
            n = mapped_normal(map, cx, ns).unwrap_or(ns);
        }
        if n != ng {
            n = if ng.dot(wo) < 0.0 {
                -visible_normal(-ng, -n, wo)
            } else {
                visible_normal(ng, n, wo)
            };
        }
        match &self.surface {
            SurfaceModel::Principled(p) if p.anisotropy.factor > 0.0 => {
                let frame = Frame::from_normal_and_tangent(n, cx.attrs.tangent);
                let turns = p.anisotropy_rotation / std::f32::consts::TAU;
                let (s, c) = sin_cos_turns(turns - turns.floor());
                let bitangent = if frame.b.dot(cx.attrs.bitangent) < 0.0 {
                    -frame.b
                } else {
                    frame.b
                };
                Frame::from_normal_and_tangent(n, frame.t * c + bitangent * s)
            }
            _ => Frame::from_normal(n),
        }
    }
}

/// α of a perceptual roughness.
fn roughness_to_alpha(roughness: f32) -> f32 {
    roughness * roughness
}

/// Whether an event of probability `p` happens; certain ones ask for no number.
fn chance<F: FnMut() -> f32>(p: f32, random: &mut F) -> bool {
    p >= 1.0 || (p > 0.0 && random() < p)
}

/// A rough boundary deviates refracted light by about α·|η−1|; below the limit for mirrors it is a smooth one.
fn is_rough_solid(eta: f32, alpha: f32) -> bool {
    alpha >= ALPHA_DELTA && alpha * (eta - 1.0).abs() >= ALPHA_DELTA
}

/// The boundary of a dielectric solid.
fn solid(color: Vec3, eta: f32, alpha: f32) -> Base {
    match Ggx::isotropic(alpha) {
        Some(ggx) if is_rough_solid(eta, alpha) => Base::RoughGlass(RoughGlass { color, eta, ggx }),
        _ => Base::Glass(Glass { color, eta }),
    }
}

/// A conductor.
fn conductor(f0: Vec3, ggx: Option<Ggx>) -> Base {
    match ggx {
        Some(ggx) => Base::Metal(Metal { f0, ggx }),
        None => Base::Specular(Specular {
            color: f0,
            grazing: Vec3::ONE,
        }),
    }
}

/// A coat over a diffuse base.
fn coated(base: Vec3, back: Vec3, coat: Coat, ggx: Option<Ggx>) -> Base {
    match ggx {
        Some(ggx) => Base::Glossy(Glossy { base, back, coat, ggx }),
        None => Base::SmoothCoat(SmoothCoat { base, back, coat }),
    }
}

impl FinishInputs {
    /// POV-Ray's surface at a point, energy to be limited by [`Finish`] itself.
    fn lobes(&self, cx: &Shading<'_>) -> Finish {
        let color = self.color.eval(cx.textures, cx.attrs).max(Vec3::ZERO);
        let opacity = (1.0 - self.filter - self.transmit).clamp(0.0, 1.0);
        // Phong's exponent counts the angle to the mirror direction, about twice that to the half vector.
        let (phong_s, blinn_s) = (4.0 * self.phong_size, 1.0 / self.roughness);
        let phong = Finish::highlight_weight(self.phong.max(0.0), phong_s);
        let blinn = Finish::highlight_weight(self.specular.max(0.0), blinn_s);
        let amount = phong + blinn;
        let ggx = if amount > 0.0 {
            // Both at once are one lobe of the mean width, each by its weight.
            let (a, b) = (Finish::highlight_alpha(phong_s), Finish::highlight_alpha(blinn_s));
            Ggx::isotropic((phong * a + blinn * b) / amount)
        } else {
            None
        };
        let tinted = |share: f32| Vec3::ONE + (color - Vec3::ONE) * share;
        Finish {
            diffuse: color * (opacity * self.diffuse.max(0.0)),
            diffuse_back: color * (opacity * self.diffuse_back.max(0.0)),
            brilliance: self.brilliance.max(0.0),
            highlight: tinted(self.metallic) * amount,
            ggx,
            mirror_min: self.reflection_min * tinted(self.reflection_metallic),
            mirror_max: self.reflection_max * tinted(self.reflection_metallic),
            falloff: if self.reflection_fresnel {
                f32::NAN
            } else {
                self.reflection_falloff
            },
            passes: (color * self.filter + Vec3::splat(self.transmit)).max(Vec3::ZERO),
            eta: self.ior.map_or(1.0, |ior| ior / cx.outer_ior),
            conserve: self.conserve_energy,
        }
    }
}

/// The normal map's normal in world space, on the side of `ns`; `None` without a tangent frame.
fn mapped_normal(map: &NormalMap, cx: &Shading<'_>, ns: Vec3) -> Option<Vec3> {
    let t = cx.textures.eval(map.texture, cx.attrs).truncate() * 2.0 - Vec3::ONE;
    let tangent = try_normalize(cx.attrs.tangent - ns * ns.dot(cx.attrs.tangent))?;
    let bitangent = ns.cross(tangent);
    let bitangent = if bitangent.dot(cx.attrs.bitangent) < 0.0 {
        -bitangent
    } else {
        bitangent
    };
    let n = try_normalize(tangent * (t.x * map.scale) + bitangent * (t.y * map.scale) + ns * t.z)?;
    (n.dot(ns) > 0.0).then_some(n)
}

/// The unit normal nearest to `n` in the plane of `ng` and the mirror direction such that `wo` (ng·wo ≥ 0) is mirrored
/// to the upper side of the surface. Black rims come from normals that mirror the view into the surface.
///
/// The mirror direction is lifted to a small height above the tangent plane, lower for grazing views, and the half vector
/// between it and `wo` is the new normal. Source: Keller et al., The Iray Light Transport Simulation, 2017, §A.3.
fn visible_normal(ng: Vec3, n: Vec3, wo: Vec3) -> Vec3 {
    let cos_g = ng.dot(wo);
    let height = (0.9 * cos_g).min(0.01);
    let cos = n.dot(wo);
    let mirror = n * (2.0 * cos) - wo;
    let mirror_height = mirror.dot(ng);
    if cos > 0.0 && mirror_height >= height {
        return n;
    }
    // A normal that faces away has no mirror direction of its own: the limit as it turns away is −wo.
    let along = if cos > 0.0 { mirror } else { -wo };
    match try_normalize(along - ng * along.dot(ng)) {
        Some(side) => {
            let lifted = side * (1.0 - height * height).max(0.0).sqrt() + ng * height;
            try_normalize(lifted + wo).unwrap_or(ng)
        }
        None => ng,
    }
}
