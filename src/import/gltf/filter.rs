//! The filters of packed views, undone: unit vectors, rotations, floats and colours from shorter codes.

/// Undoes the filter `name` on elements of `stride` bytes.
pub(super) fn apply(name: &str, stride: usize, data: &mut [u8]) -> Result<(), &'static str> {
    match (name, stride) {
        ("NONE", _) => {}
        ("OCTAHEDRAL", 4) => data.as_chunks_mut::<4>().0.iter_mut().for_each(|e| {
            let [x, y, one, w] = e.map(|b| f32::from(b as i8));
            let v = octahedral(x, y, one).map(|v| (v * 127.0).round() as i8 as u8);
            *e = [v[0], v[1], v[2], w as i8 as u8];
        }),
        ("OCTAHEDRAL", 8) => words(data, |[x, y, one, w]| {
            let v = octahedral(x.into(), y.into(), one.into()).map(|v| (v * 32767.0).round() as i16);
            [v[0], v[1], v[2], w]
        }),
        ("QUATERNION", 8) => words(data, quaternion),
        ("EXPONENTIAL", _) => data.as_chunks_mut::<4>().0.iter_mut().for_each(|e| {
            let code = i32::from_le_bytes(*e);
            let mantissa = f64::from((code << 8) >> 8);
            *e = ((mantissa * f64::from(code >> 24).exp2()) as f32).to_le_bytes();
        }),
        ("COLOR", 4) => data.as_chunks_mut::<4>().0.iter_mut().for_each(|e| {
            let code = [
                i32::from(e[0]),
                i32::from(e[1] as i8),
                i32::from(e[2] as i8),
                i32::from(e[3]),
            ];
            *e = color(code, 255.0).map(|v| v as u8);
        }),
        ("COLOR", 8) => words(data, |e| {
            let unsigned = |v: i16| i32::from(v as u16);
            let code = [unsigned(e[0]), i32::from(e[1]), i32::from(e[2]), unsigned(e[3])];
            color(code, 65535.0).map(|v| v as u16 as i16)
        }),
        _ => return Err("its `filter` is unknown, or does not go with its `byteStride`"),
    }
    Ok(())
}

/// Maps elements of four 16-bit integers.
fn words(data: &mut [u8], f: impl Fn([i16; 4]) -> [i16; 4]) {
    for element in data.as_chunks_mut::<8>().0 {
        let input = std::array::from_fn(|i| i16::from_le_bytes([element[2 * i], element[2 * i + 1]]));
        for (i, v) in f(input).into_iter().enumerate() {
            element[2 * i..2 * i + 2].copy_from_slice(&v.to_le_bytes());
        }
    }
}

/// A unit vector from its place on the unfolded octahedron; `one` is the code of 1.
fn octahedral(x: f32, y: f32, one: f32) -> [f32; 3] {
    let (x, y) = (x / one, y / one);
    let z = 1.0 - x.abs() - y.abs();
    let fold = z.min(0.0);
    let (x, y) = (x - fold.copysign(x), y - fold.copysign(y));
    let length = (x * x + y * y + z * z).sqrt();
    [x / length, y / length, z / length]
}

/// A rotation from its three smaller components, scaled by √2; the last word holds the code of 1 and, in its two
/// lowest bits, which component is the fourth.
fn quaternion(e: [i16; 4]) -> [i16; 4] {
    let scale = std::f32::consts::FRAC_1_SQRT_2 / f32::from(e[3] | 3);
    let [x, y, z] = [e[0], e[1], e[2]].map(|v| f32::from(v) * scale);
    let w = (1.0 - x * x - y * y - z * z).max(0.0).sqrt();
    let largest = (e[3] & 3) as usize;
    let mut out = [0; 4];
    for (i, v) in [w, x, y, z].into_iter().enumerate() {
        out[(largest + i) % 4] = (v * 32767.0).round() as i16;
    }
    out
}

/// A colour from luma, two chroma differences and alpha, whose highest bit tells the precision.
fn color([y, co, cg, alpha]: [i32; 4], most: f32) -> [f32; 4] {
    let bits = i32::BITS - alpha.leading_zeros();
    let one = (1 << bits.min(16)) - 1;
    let a = alpha & (one >> 1);
    let rgba = [y + co - cg, y + cg, y - co - cg, (a << 1) | (a & 1)];
    rgba.map(|v| (v as f32 * (most / one as f32)).round())
}

#[cfg(test)]
mod tests {
    use super::super::meshopt::tests::{floats, unpacked};

    // Written by the extension's reference encoder with 8, 15 and 12 bits.
    const DIRECTIONS: &str = "a0070074936a9170a995689170879867906dff000000a69a69900700a06b90699c936c8f6a99a56e8f6895ff000000\
        8071926700000000000000000000000000000000000000000000000000000000000036007f00";
    const FLOATS: &str = "a000060f0ffffff888888840201f1010102fff000000370404040005088080008000000000060f0ffffff77777773f1f2\
        00f0f0f30ff00000038030303011000000005288080008000000007007500c4c3626262da30323032303232ff000000a8181818060f0ffffff8\
        8a888840222110121031ff0000003904040400053880800011800000000000000000000000000000000000000000000000000000f2000000f2\
        000000f2";
    const ROTATIONS: &str = "a0000007009db1d9f0a4a4cdf2c2a69ca6c4f6c9ff000000eeaaf2d50602424203133133132e0000000400000500\
        0c000003c00000000400000000000000000000000000000000000000000000000000000000000000ff07";

    #[test]
    fn filters_give_back_vectors_floats_and_rotations_to_their_bits() {
        let codes = unpacked("ATTRIBUTES", "OCTAHEDRAL", 20, 4, DIRECTIONS);
        for (i, code) in codes.as_chunks::<4>().0.iter().enumerate() {
            let (sin, cos) = (i as f32 * 0.3).sin_cos();
            let want = [cos * 0.6, sin * 0.6, if i % 2 == 0 { 0.8 } else { -0.8 }];
            for k in 0..3 {
                assert!((f32::from(code[k] as i8) / 127.0 - want[k]).abs() < 0.02, "{i}");
            }
        }
        let numbers = floats(&unpacked("ATTRIBUTES", "EXPONENTIAL", 20, 12, FLOATS));
        for (i, v) in numbers.chunks(3).enumerate() {
            let x = i as f32;
            for (found, want) in v.iter().zip([x * 0.5, -x, 1e-3 * x]) {
                assert!((found - want).abs() <= 1e-4 * want.abs(), "{i}: {found} {want}");
            }
        }
        let codes = unpacked("ATTRIBUTES", "QUATERNION", 20, 8, ROTATIONS);
        for (i, code) in codes.as_chunks::<8>().0.iter().enumerate() {
            let (sin, cos) = (i as f32 * 0.15).sin_cos();
            let q: Vec<f32> = code
                .as_chunks::<2>()
                .0
                .iter()
                .map(|b| f32::from(i16::from_le_bytes(*b)) / 32767.0)
                .collect();
            // q and −q are the same rotation.
            let dot = q[1] * sin + q[3] * cos;
            assert!(
                dot.abs() > 1.0 - 5e-4 && q[0].abs().max(q[2].abs()) < 1e-3,
                "{i}: {q:?}"
            );
        }
    }

    #[test]
    fn colours_come_back_from_luma_and_chroma_at_their_own_precision() {
        let mut full = [100, 20, (-10i8) as u8, 0xFF];
        super::apply("COLOR", 4, &mut full).unwrap();
        assert_eq!(full, [130, 90, 90, 255]);
        // Five bits: alpha 0b1_0000 is none, and luma 31 is 1.
        let mut coarse = [31, 0, 0, 0b1_0000];
        super::apply("COLOR", 4, &mut coarse).unwrap();
        assert_eq!(coarse, [255, 255, 255, 0]);
    }
}
