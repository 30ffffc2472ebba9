//! The test of eight boxes in vector instructions, the one place where the compiler does not find them by itself.
//!
//! All versions compute the same operations in the same order, so they give the same bits. A comparison with NaN keeps
//! what is there: `maxps` and `minps` return their second operand then.

use super::node::WIDTH;

/// Eight boxes, the planes sorted by where a ray enters and leaves, and that ray.
pub struct BoxTest<'a> {
    /// Planes entered, by axis.
    pub entered: [&'a [f32; WIDTH]; 3],
    /// Planes left, by axis.
    pub left: [&'a [f32; WIDTH]; 3],
    /// Start as the planes entered see it.
    pub near_origin: &'a [f32; 3],
    /// Start as the planes left see it.
    pub far_origin: &'a [f32; 3],
    /// 1/direction for the planes entered.
    pub inverse: &'a [f32; 3],
    /// 1/direction for the planes left, widened by the rounding of the quotients.
    pub far_inverse: &'a [f32; 3],
    /// Boxes that begin beyond this are not met.
    pub t_max: f32,
}

/// An instruction set.
pub trait Isa: Copy {
    /// The set of boxes met, and where each is entered.
    fn meet(test: &BoxTest) -> (u32, [f32; WIDTH]);
}

/// What every machine of the target has.
#[derive(Clone, Copy, Debug)]
pub struct Baseline;

/// 256-bit vectors. Only to be used below a function with that target feature.
#[cfg(target_arch = "x86_64")]
#[derive(Clone, Copy, Debug)]
pub struct Avx2;

#[cfg(not(target_arch = "x86_64"))]
impl Isa for Baseline {
    #[inline(always)]
    fn meet(test: &BoxTest) -> (u32, [f32; WIDTH]) {
        meet_by_lane(test)
    }
}

/// The definition.
#[cfg(any(test, not(target_arch = "x86_64")))]
#[inline(always)]
pub fn meet_by_lane(test: &BoxTest) -> (u32, [f32; WIDTH]) {
    let mut near = [0.0f32; WIDTH];
    let mut far = [test.t_max; WIDTH];
    for axis in 0..3 {
        for i in 0..WIDTH {
            let t = (test.entered[axis][i] - test.near_origin[axis]) * test.inverse[axis];
            near[i] = if t > near[i] { t } else { near[i] };
            let t = (test.left[axis][i] - test.far_origin[axis]) * test.far_inverse[axis];
            far[i] = if t < far[i] { t } else { far[i] };
        }
    }
    let mut hits = 0;
    for i in 0..WIDTH {
        hits |= u32::from(near[i] <= far[i]) << i;
    }
    (hits, near)
}

#[cfg(target_arch = "x86_64")]
#[allow(unsafe_code)]
mod x86 {
    use super::{Avx2, Baseline, BoxTest, Isa, WIDTH};
    use std::arch::x86_64::*;

    impl Isa for Baseline {
        #[inline(always)]
        fn meet(test: &BoxTest) -> (u32, [f32; WIDTH]) {
            let mut entry = [0.0f32; WIDTH];
            let mut hits = 0;
            for half in [0, 4] {
                // SAFETY: SSE2 belongs to x86-64; each load and store covers four of the eight floats from `half` on.
                unsafe {
                    let mut near = _mm_setzero_ps();
                    let mut far = _mm_set1_ps(test.t_max);
                    for axis in 0..3 {
                        let planes = _mm_loadu_ps(test.entered[axis].as_ptr().add(half));
                        let t = _mm_sub_ps(planes, _mm_set1_ps(test.near_origin[axis]));
                        near = _mm_max_ps(_mm_mul_ps(t, _mm_set1_ps(test.inverse[axis])), near);
                        let planes = _mm_loadu_ps(test.left[axis].as_ptr().add(half));
                        let t = _mm_sub_ps(planes, _mm_set1_ps(test.far_origin[axis]));
                        far = _mm_min_ps(_mm_mul_ps(t, _mm_set1_ps(test.far_inverse[axis])), far);
                    }
                    hits |= (_mm_movemask_ps(_mm_cmple_ps(near, far)) as u32) << half;
                    _mm_storeu_ps(entry.as_mut_ptr().add(half), near);
                }
            }
            (hits, entry)
        }
    }

    impl Isa for Avx2 {
        #[inline(always)]
        fn meet(test: &BoxTest) -> (u32, [f32; WIDTH]) {
            let mut entry = [0.0f32; WIDTH];
            // SAFETY: the caller runs below a function with AVX2; each load and store covers exactly eight floats.
            unsafe {
                let mut near = _mm256_setzero_ps();
                let mut far = _mm256_set1_ps(test.t_max);
                for axis in 0..3 {
                    let planes = _mm256_loadu_ps(test.entered[axis].as_ptr());
                    let t = _mm256_sub_ps(planes, _mm256_set1_ps(test.near_origin[axis]));
                    near = _mm256_max_ps(_mm256_mul_ps(t, _mm256_set1_ps(test.inverse[axis])), near);
                    let planes = _mm256_loadu_ps(test.left[axis].as_ptr());
                    let t = _mm256_sub_ps(planes, _mm256_set1_ps(test.far_origin[axis]));
                    far = _mm256_min_ps(_mm256_mul_ps(t, _mm256_set1_ps(test.far_inverse[axis])), far);
                }
                let hits = _mm256_movemask_ps(_mm256_cmp_ps::<_CMP_LE_OQ>(near, far)) as u32;
                _mm256_storeu_ps(entry.as_mut_ptr(), near);
                (hits, entry)
            }
        }
    }
}

#[cfg(all(test, target_arch = "x86_64"))]
mod tests {
    use super::*;
    use crate::math::stats::Pcg;

    #[target_feature(enable = "avx2")]
    fn meet_wide(test: &BoxTest) -> (u32, [f32; WIDTH]) {
        Avx2::meet(test)
    }

    /// Oracle: the definition by lane, with zeros, infinities and NaN products among the numbers.
    #[test]
    fn all_versions_give_the_same_bits() {
        let mut rng = Pcg::new(1);
        let special = [0.0, -0.0, 1.0, -1.0, f32::INFINITY, f32::NEG_INFINITY, 1e-38, 3e38];
        let mut number = || {
            if rng.next_u32().is_multiple_of(3) {
                special[rng.next_u32() as usize % special.len()]
            } else {
                rng.next_f32() * 4.0 - 2.0
            }
        };
        for _ in 0..20_000 {
            let planes: [[f32; WIDTH]; 6] = [[0; WIDTH]; 6].map(|p| p.map(|_: i32| number()));
            let [a, b, c, d] = [[0; 3]; 4].map(|v| v.map(|_: i32| number()));
            let test = BoxTest {
                entered: [&planes[0], &planes[1], &planes[2]],
                left: [&planes[3], &planes[4], &planes[5]],
                near_origin: &a,
                far_origin: &b,
                inverse: &c,
                far_inverse: &d,
                t_max: number(),
            };
            let bits = |(hits, near): (u32, [f32; WIDTH])| (hits, near.map(f32::to_bits));
            let want = bits(meet_by_lane(&test));
            assert_eq!(bits(Baseline::meet(&test)), want);
            if std::arch::is_x86_feature_detected!("avx2") {
                // SAFETY: just detected.
                #[allow(unsafe_code)]
                let wide = unsafe { meet_wide(&test) };
                assert_eq!(bits(wide), want);
            }
        }
    }

    /// A ray in the plane of a slab: (plane − start)·(1/0) is 0·∞, which is no number. Whichever axis it is and on whichever
    /// side, what the other two say stands, in every version: as first, middle and last operand of the maximum and of the
    /// minimum.
    #[test]
    fn a_quotient_without_value_keeps_what_the_other_axes_say() {
        // The other axes meet the box where 1 ≤ t ≤ 2, or 3 ≤ t ≤ 2, which is nowhere.
        for (entry, hit) in [(1.0, true), (3.0, false)] {
            for axis in 0..3 {
                for zero in [0.0f32, -0.0] {
                    for (nan_near, nan_far) in [(true, false), (false, true), (true, true)] {
                        let plane =
                            |a: usize, value: f32, nan: bool| [if a == axis && nan { 0.0 } else { value }; WIDTH];
                        let near = [0, 1, 2].map(|a| plane(a, entry, nan_near));
                        let far = [0, 1, 2].map(|a| plane(a, 2.0, nan_far));
                        let inverse = |nan: bool| {
                            let mut v = [1.0f32; 3];
                            if nan {
                                v[axis] = 1.0 / zero;
                            }
                            v
                        };
                        let test = BoxTest {
                            entered: [&near[0], &near[1], &near[2]],
                            left: [&far[0], &far[1], &far[2]],
                            near_origin: &[0.0; 3],
                            far_origin: &[0.0; 3],
                            inverse: &inverse(nan_near),
                            far_inverse: &inverse(nan_far),
                            t_max: 10.0,
                        };
                        let want = (if hit { 255 } else { 0 }, [entry; WIDTH]);
                        assert_eq!(meet_by_lane(&test), want, "axis {axis}");
                        assert_eq!(Baseline::meet(&test), want, "axis {axis}");
                        if std::arch::is_x86_feature_detected!("avx2") {
                            // SAFETY: just detected.
                            #[allow(unsafe_code)]
                            let wide = unsafe { meet_wide(&test) };
                            assert_eq!(wide, want, "axis {axis}");
                        }
                    }
                }
            }
        }
    }

    /// A start without a number meets every box, so that the primitives decide; an end without one meets none.
    #[test]
    fn not_a_number_as_start_meets_all_boxes_and_as_end_none() {
        let plane = [0.5f32; WIDTH];
        for (start, t_max, met) in [(f32::NAN, 1.0, 255), (0.0, f32::NAN, 0)] {
            let test = BoxTest {
                entered: [&plane; 3],
                left: [&plane; 3],
                near_origin: &[start; 3],
                far_origin: &[start; 3],
                inverse: &[1.0; 3],
                far_inverse: &[1.0; 3],
                t_max,
            };
            assert_eq!((meet_by_lane(&test).0, Baseline::meet(&test).0), (met, met));
        }
    }
}
