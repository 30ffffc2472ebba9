//! Random places, sizes and maps for property tests, with fixed seeds.

use super::support::*;
use crate::math::stats::Pcg;
use crate::render::ray::Ray;
use glam::{DAffine3, DMat3, DQuat, DVec3, Vec3};
use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed, TestRunner};

/// Runs a property over many values. The seed is fixed, so each run tests the same values; nothing is written to disk.
pub fn for_all<S: Strategy>(seed: u64, cases: u32, values: S, check: impl Fn(S::Value) -> Result<(), TestCaseError>) {
    let config = Config {
        cases,
        failure_persistence: None,
        rng_seed: RngSeed::Fixed(seed),
        ..Config::default()
    };
    if let Err(e) = TestRunner::new(config).run(&values, check) {
        panic!("{e}");
    }
}

/// Log-uniform between 10⁻⁸ and 10⁸.
pub fn magnitude() -> impl Strategy<Value = f64> {
    (-8.0..8.0f64).prop_map(|e| 10f64.powf(e))
}

/// A point whose coordinates have independent magnitudes and signs.
pub fn place() -> impl Strategy<Value = DVec3> {
    let coordinate = || (magnitude(), any::<bool>()).prop_map(|(m, minus)| if minus { -m } else { m });
    (coordinate(), coordinate(), coordinate()).prop_map(|(x, y, z)| DVec3::new(x, y, z))
}

/// A linear map of size about 1: turned, in a quarter of the cases each also mirrored, stretched by up to 10³ either way
/// per axis before turning, sheared after.
pub fn linear() -> impl Strategy<Value = DMat3> {
    let unit = || -1.0..1.0f64;
    let triple = move || (unit(), unit(), unit()).prop_map(|(x, y, z)| DVec3::new(x, y, z));
    (triple(), triple(), triple(), 0..4u32, any::<bool>()).prop_map(|(turn, stretch, shear, kind, mirror)| {
        let turn = DMat3::from_quat(DQuat::from_scaled_axis(turn * std::f64::consts::PI));
        let mut scale = if kind == 0 {
            DVec3::ONE
        } else {
            stretch.map(|x| 1e3f64.powf(x))
        };
        if mirror {
            scale.x = -scale.x;
        }
        let shear = if kind == 3 { shear * 3.0 } else { DVec3::ZERO };
        let shear = DMat3::from_cols(
            DVec3::X,
            DVec3::new(shear.x, 1.0, 0.0),
            DVec3::new(shear.y, shear.z, 1.0),
        );
        shear * turn * DMat3::from_diagonal(scale)
    })
}

/// Where something stands, how large it is, how it is turned, stretched and sheared; and random numbers for the rest.
#[derive(Clone, Debug)]
pub struct Placing {
    /// Its middle in the world.
    pub place: DVec3,
    /// Its size.
    pub size: f64,
    /// What happens to it apart from its size.
    pub linear: DMat3,
    /// Start of a random sequence.
    pub seed: u64,
}

/// Any of them. Half stand within ten sizes of the origin, where their points have digits to spare.
pub fn placing() -> impl Strategy<Value = Placing> {
    (place(), magnitude(), linear(), any::<u64>(), any::<bool>()).prop_map(|(place, size, linear, seed, near)| {
        let place = if near {
            // Between a millionth and ten times the size away.
            place.map(|x| x.signum() * size * 10f64.powf(x.abs().log10() * 0.4375 - 2.5))
        } else {
            place
        };
        Placing {
            place,
            size,
            linear,
            seed,
        }
    })
}

impl Placing {
    /// The whole map.
    pub fn map(&self) -> DAffine3 {
        DAffine3::from_mat3_translation(self.linear * self.size, self.place)
    }

    /// A ray from outside near or far, or from inside, towards somewhere inside; rounded to f32 last.
    pub fn ray(&self, rng: &mut Pcg, i: usize) -> Ray {
        let map = self.map();
        let away = [3.0, 3.0, 30.0, 1e3, 0.3, 2.0, 10.0, 1e5][i % 8];
        let start = map.transform_point3(direction(rng).as_dvec3() * away).as_vec3();
        let target = map.transform_point3(in_cube(rng) * 0.9);
        let mut dir = (target - start.as_dvec3()).as_vec3();
        if i.is_multiple_of(3) {
            dir = dir.try_normalize().unwrap_or(dir);
        }
        Ray::new(start, dir)
    }
}

/// Around the whole sphere; every second one grazing, down to angles of 10⁻⁶.
pub fn leaving_direction(ng: Vec3, i: usize, rng: &mut Pcg) -> Vec3 {
    let w = direction(rng);
    if i % 2 == 1 {
        return w;
    }
    let shrink = 10f32.powi(-(i as i32 / 2) - 1);
    (w - ng * w.dot(ng) * (1.0 - shrink)).normalize()
}
