//! Double-double numbers, the reference where f64 does not suffice: the unevaluated sum of two f64, about 106 bits.
//!
//! Sums and products lose at most a few 2⁻¹⁰⁴ of the result (Joldeş, Muller & Popescu, Tight and Rigorous Error Bounds
//! for Basic Building Blocks of Double-Word Arithmetic, 2017), 2⁵¹ times less than what they judge.

use glam::{DAffine3, DMat3, DVec3};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// hi + lo, |lo| at most half a unit in the last place of hi.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dd {
    hi: f64,
    lo: f64,
}

/// a + b without any rounding (Knuth).
fn two_sum(a: f64, b: f64) -> Dd {
    let hi = a + b;
    let part = hi - a;
    Dd {
        hi,
        lo: (a - (hi - part)) + (b - part),
    }
}

/// a + b without any rounding where |a| ≥ |b| (Dekker).
fn quick_two_sum(a: f64, b: f64) -> Dd {
    let hi = a + b;
    Dd { hi, lo: b - (hi - a) }
}

impl Dd {
    /// The number 0.
    pub const ZERO: Dd = Dd { hi: 0.0, lo: 0.0 };

    /// A number that is exact already.
    pub fn new(x: impl Into<f64>) -> Dd {
        Dd { hi: x.into(), lo: 0.0 }
    }

    /// Rounded to f64.
    pub fn value(self) -> f64 {
        self.hi + self.lo
    }

    /// |x|.
    pub fn abs(self) -> Dd {
        if self.hi < 0.0 { -self } else { self }
    }

    /// √x, 0 for negative numbers: one Newton step from the f64 root doubles its digits.
    pub fn sqrt(self) -> Dd {
        if self.hi <= 0.0 {
            return Dd::ZERO;
        }
        let guess = Dd::new(self.hi.sqrt());
        guess + (self - guess * guess) / (guess + guess)
    }
}

impl Add for Dd {
    type Output = Dd;
    fn add(self, b: Dd) -> Dd {
        let (s, t) = (two_sum(self.hi, b.hi), two_sum(self.lo, b.lo));
        let s = quick_two_sum(s.hi, s.lo + t.hi);
        quick_two_sum(s.hi, s.lo + t.lo)
    }
}

impl Neg for Dd {
    type Output = Dd;
    fn neg(self) -> Dd {
        Dd {
            hi: -self.hi,
            lo: -self.lo,
        }
    }
}

impl Sub for Dd {
    type Output = Dd;
    fn sub(self, b: Dd) -> Dd {
        self + -b
    }
}

impl Mul for Dd {
    type Output = Dd;
    fn mul(self, b: Dd) -> Dd {
        let hi = self.hi * b.hi;
        let lo = self.hi.mul_add(b.hi, -hi) + (self.hi * b.lo + self.lo * b.hi);
        quick_two_sum(hi, lo)
    }
}

impl Div for Dd {
    type Output = Dd;
    fn div(self, b: Dd) -> Dd {
        let first = Dd::new(self.hi / b.hi);
        let rest = self - first * b;
        let second = Dd::new(rest.hi / b.hi);
        let third = (rest - second * b).hi / b.hi;
        first + second + Dd::new(third)
    }
}

/// A point or direction.
#[derive(Clone, Copy, Debug)]
pub struct Exact3(pub [Dd; 3]);

impl Exact3 {
    /// An f64 vector; f32 ones by way of it.
    pub fn new(v: DVec3) -> Exact3 {
        Exact3(v.to_array().map(Dd::new))
    }

    /// a·b.
    pub fn dot(self, b: Exact3) -> Dd {
        let [x, y, z] = [0, 1, 2].map(|i| self.0[i] * b.0[i]);
        x + y + z
    }

    /// a × b.
    pub fn cross(self, b: Exact3) -> Exact3 {
        let (a, b) = (self.0, b.0);
        let at = |i: usize, j: usize| a[i] * b[j] - a[j] * b[i];
        Exact3([at(1, 2), at(2, 0), at(0, 1)])
    }

    /// The vector times a number.
    pub fn scaled(self, s: Dd) -> Exact3 {
        Exact3(self.0.map(|x| x * s))
    }

    /// Rounded to f64.
    pub fn value(self) -> DVec3 {
        DVec3::from_array(self.0.map(Dd::value))
    }
}

impl Add for Exact3 {
    type Output = Exact3;
    fn add(self, b: Exact3) -> Exact3 {
        Exact3([0, 1, 2].map(|i| self.0[i] + b.0[i]))
    }
}

impl Sub for Exact3 {
    type Output = Exact3;
    fn sub(self, b: Exact3) -> Exact3 {
        Exact3([0, 1, 2].map(|i| self.0[i] - b.0[i]))
    }
}

/// The exact inverse (to 106 bits) of an f64 affine map.
#[derive(Clone, Debug)]
pub struct Inverse {
    rows: [Exact3; 3],
    translation: Exact3,
}

impl Inverse {
    /// Inverts by cofactors.
    pub fn of(map: &DAffine3) -> Inverse {
        let [a, b, c] = [map.matrix3.x_axis, map.matrix3.y_axis, map.matrix3.z_axis].map(Exact3::new);
        let det = a.dot(b.cross(c));
        let row = |v: Exact3| Exact3(v.0.map(|x| x / det));
        Inverse {
            rows: [row(b.cross(c)), row(c.cross(a)), row(a.cross(b))],
            translation: Exact3::new(map.translation),
        }
    }

    /// A direction in the map's own space.
    pub fn vector(&self, v: Exact3) -> Exact3 {
        Exact3(self.rows.map(|r| r.dot(v)))
    }

    /// A point in the map's own space.
    pub fn point(&self, p: Exact3) -> Exact3 {
        self.vector(p - self.translation)
    }

    /// A gradient of the map's own space in the world: the transposed inverse, in f64.
    pub fn gradient(&self, g: DVec3) -> DVec3 {
        let [x, y, z] = self.rows.map(Exact3::value);
        DMat3::from_cols(x, y, z) * g
    }
}

/// (1/3)·3 = 1, √2² = 2 and a sum that f64 cannot hold: the digits are there.
#[test]
fn double_double_numbers_have_thirty_digits() {
    let third = Dd::new(1.0) / Dd::new(3.0);
    assert!((third * Dd::new(3.0) - Dd::new(1.0)).value().abs() < 1e-31);
    let root = Dd::new(2.0).sqrt();
    assert!((root * root - Dd::new(2.0)).value().abs() < 1e-30);
    assert_eq!((Dd::new(1e16) + Dd::new(1.0) - Dd::new(1e16)).value(), 1.0);
    let product = Dd::new(1e8 + 1.0) * Dd::new(1e8 - 1.0) - Dd::new(1e16);
    assert_eq!(product.value(), -1.0);
}
