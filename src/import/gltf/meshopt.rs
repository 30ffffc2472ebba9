//! `EXT_meshopt_compression` and `KHR_meshopt_compression`: views whose bytes are packed by the bit streams of the
//! extensions' appendix A and filtered by their appendix B. Every read is checked; the output is bounded by the
//! input's length.

use super::{deltas, filter};

/// How a view is packed.
pub(super) struct Packing<'a> {
    /// `ATTRIBUTES`, `TRIANGLES` or `INDICES`.
    pub mode: &'a str,
    /// `NONE`, `OCTAHEDRAL`, `QUATERNION`, `EXPONENTIAL` or `COLOR`.
    pub filter: &'a str,
    /// Elements.
    pub count: usize,
    /// Bytes of an element.
    pub stride: usize,
}

/// The unpacked bytes, `count · stride` of them, or what is wrong.
pub(super) fn unpack(packing: &Packing, data: &[u8]) -> Result<Vec<u8>, &'static str> {
    let (count, stride) = (packing.count, packing.stride);
    match packing.mode {
        "ATTRIBUTES" => {
            let mut out = deltas::attributes(data, count, stride)?;
            filter::apply(packing.filter, stride, &mut out)?;
            Ok(out)
        }
        "TRIANGLES" => triangles(data, count).and_then(|indices| index_bytes(&indices, stride)),
        "INDICES" => sequence(data, count).and_then(|indices| index_bytes(&indices, stride)),
        _ => Err("its `mode` is none of ATTRIBUTES, TRIANGLES, INDICES"),
    }
}

pub(super) const CUT: &str = "its data end too early";

/// A reader that knows where its data end.
pub(super) struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    pub fn take(&mut self, n: usize) -> Result<&'a [u8], &'static str> {
        let (head, rest) = self.0.split_at_checked(n).ok_or(CUT)?;
        self.0 = rest;
        Ok(head)
    }

    pub fn byte(&mut self) -> Result<u8, &'static str> {
        self.take(1).map(|b| b[0])
    }

    /// An unsigned LEB128 number of at most 32 bits.
    fn varint(&mut self) -> Result<u32, &'static str> {
        let mut value = 0u32;
        for shift in [0, 7, 14, 21, 28] {
            let byte = self.byte()?;
            value |= u32::from(byte & 0x7F) << shift;
            if byte < 0x80 {
                return Ok(value);
            }
        }
        Err("a number in its data is too long")
    }
}

/// Splits a stream into what follows its header byte and its tail.
pub(super) fn frame(data: &[u8], header: u8, tail: usize) -> Result<(Bytes<'_>, &[u8]), &'static str> {
    match data.split_first() {
        Some((found, rest)) if *found == header => {
            let body = rest.len().checked_sub(tail).ok_or(CUT)?;
            let (body, tail) = rest.split_at(body);
            Ok((Bytes(body), tail))
        }
        Some(_) => Err("its data have the header of another mode or version"),
        None => Err(CUT),
    }
}

fn unzigzag(v: u32) -> u32 {
    (v >> 1) ^ (v & 1).wrapping_neg()
}

/// A queue of the sixteen newest values; 0 is the newest.
#[derive(Default)]
struct Newest<T> {
    values: [T; 16],
    next: usize,
}

impl<T: Copy> Newest<T> {
    fn push(&mut self, value: T) {
        self.values[self.next % 16] = value;
        self.next += 1;
    }

    fn get(&self, age: usize) -> T {
        self.values[(self.next + 31 - age) % 16]
    }
}

/// Mode 1: triangles, most of them as one byte that names an edge and a vertex met lately.
fn triangles(data: &[u8], count: usize) -> Result<Vec<u32>, &'static str> {
    if !count.is_multiple_of(3) {
        return Err("its `count` of indices is not a multiple of 3");
    }
    if count / 3 > data.len() {
        return Err(CUT);
    }
    let (mut body, table) = frame(data, 0xE1, 16)?;
    let codes = body.take(count / 3)?;
    let mut out = Vec::with_capacity(count);
    let (mut edges, mut vertices) = (Newest::<(u32, u32)>::default(), Newest::<u32>::default());
    let (mut next, mut last) = (0u32, 0u32);
    let new_vertex = |next: &mut u32| {
        *next = next.wrapping_add(1);
        next.wrapping_sub(1)
    };
    let explicit = |last: &mut u32, body: &mut Bytes| -> Result<u32, &'static str> {
        *last = last.wrapping_add(unzigzag(body.varint()?));
        Ok(*last)
    };
    for &code in codes {
        let (high, low) = (usize::from(code >> 4), usize::from(code & 15));
        if high < 15 {
            let (a, b) = edges.get(high);
            let c = match low {
                0 => new_vertex(&mut next),
                1..=12 => vertices.get(low),
                13 | 14 => {
                    last = if low == 13 {
                        last.wrapping_sub(1)
                    } else {
                        last.wrapping_add(1)
                    };
                    last
                }
                _ => explicit(&mut last, &mut body)?,
            };
            if !(1..=12).contains(&low) {
                vertices.push(c);
            }
            edges.push((c, b));
            edges.push((a, c));
            out.extend([a, b, c]);
            continue;
        }
        let aux = if low < 14 { table[low] } else { body.byte()? };
        if low >= 14 && aux == 0 {
            next = 0;
        }
        let mut corner = |how: usize| -> Result<u32, &'static str> {
            match how {
                0 => Ok(new_vertex(&mut next)),
                15 => explicit(&mut last, &mut body),
                age => Ok(vertices.get(age - 1)),
            }
        };
        let hows = [
            if low == 15 { 15 } else { 0 },
            usize::from(aux >> 4),
            usize::from(aux & 15),
        ];
        let abc = [corner(hows[0])?, corner(hows[1])?, corner(hows[2])?];
        for (vertex, how) in abc.into_iter().zip(hows) {
            if how == 0 || how == 15 {
                vertices.push(vertex);
            }
        }
        let [a, b, c] = abc;
        edges.push((b, a));
        edges.push((c, b));
        edges.push((a, c));
        out.extend(abc);
    }
    Ok(out)
}

/// Mode 2: indices as differences to the newest of either of two sequences.
fn sequence(data: &[u8], count: usize) -> Result<Vec<u32>, &'static str> {
    if count > data.len() {
        return Err(CUT);
    }
    let (mut body, _) = frame(data, 0xD1, 4)?;
    let mut last = [0u32; 2];
    let mut index = || {
        let v = body.varint()?;
        let last = &mut last[(v & 1) as usize];
        *last = last.wrapping_add(unzigzag(v >> 1));
        Ok(*last)
    };
    (0..count).map(|_| index()).collect()
}

/// Indices as little-endian integers of 2 or 4 bytes.
fn index_bytes(indices: &[u32], stride: usize) -> Result<Vec<u8>, &'static str> {
    match stride {
        2 => {
            let short = |i: &u32| u16::try_from(*i).map_err(|_| "an index does not fit into 2 bytes");
            let short: Result<Vec<u16>, _> = indices.iter().map(short).collect();
            Ok(short?.iter().flat_map(|i| i.to_le_bytes()).collect())
        }
        4 => Ok(indices.iter().flat_map(|i| i.to_le_bytes()).collect()),
        _ => Err("its `byteStride` is neither 2 nor 4"),
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    // Streams written by the extension's reference encoder.
    const VERTICES: &str = "a00000050cccccccffff8080404040cc0000004020050c8000007e8000000000000700ffffffffffffffffffff\
        ffffffffffff000000ffffffff07007e7d7e7d7e7d7e7d7e7d7e7d7e7d7eff0000007d7e7d7e00000000000000000000000000000000000000\
        000000000000000000000000000000803e";
    const STRIP: &str = "e1f01000100010001000100010001000100010007687566778a9866589689801690000";
    const STRIP_AS_SEQUENCE: &str = "d1000404000208020404000208020404000208020404000208020404000208020404000208020404000208\
        020404000208020404000208020800000000";

    fn bytes(hex: &str) -> Vec<u8> {
        let digits: Vec<u8> = hex.bytes().filter(u8::is_ascii_hexdigit).collect();
        let byte = |d: &[u8]| u8::from_str_radix(std::str::from_utf8(d).unwrap(), 16).unwrap();
        digits.chunks(2).map(byte).collect()
    }

    pub(in crate::import::gltf) fn unpacked(
        mode: &str,
        filter: &str,
        count: usize,
        stride: usize,
        hex: &str,
    ) -> Vec<u8> {
        let packing = Packing {
            mode,
            filter,
            count,
            stride,
        };
        let data = bytes(hex);
        for length in 0..data.len() {
            assert!(
                unpack(&packing, &data[..length]).is_err() || length + 32 > data.len(),
                "cut at {length}"
            );
        }
        unpack(&packing, &data).unwrap()
    }

    pub(in crate::import::gltf) fn floats(bytes: &[u8]) -> Vec<f32> {
        bytes
            .as_chunks::<4>()
            .0
            .iter()
            .map(|b| f32::from_le_bytes(*b))
            .collect()
    }

    #[test]
    fn streams_of_the_reference_encoder_unpack_to_what_was_packed() {
        let corner = |i: u32| [(i / 2) as f32, (i % 2) as f32, 0.25];
        let want: Vec<f32> = (0..20).flat_map(corner).collect();
        assert_eq!(floats(&unpacked("ATTRIBUTES", "NONE", 20, 12, VERTICES)), want);
        // Packing may turn a triangle, but keeps which way it faces.
        let smallest_first = |t: &[u32]| {
            let first = (0..3).min_by_key(|k| t[*k]).unwrap();
            [t[first], t[(first + 1) % 3], t[(first + 2) % 3]]
        };
        let face = |i: u32| {
            if i.is_multiple_of(2) {
                [i, i + 1, i + 2]
            } else {
                [i, i + 2, i + 1]
            }
        };
        let want: Vec<[u32; 3]> = (0..18).map(face).collect();
        for (mode, hex) in [("TRIANGLES", STRIP), ("INDICES", STRIP_AS_SEQUENCE)] {
            let long = unpacked(mode, "NONE", 54, 4, hex);
            let indices: Vec<u32> = long.as_chunks::<4>().0.iter().map(|b| u32::from_le_bytes(*b)).collect();
            assert_eq!(
                indices.chunks(3).map(smallest_first).collect::<Vec<_>>(),
                want,
                "{mode}"
            );
            let short = unpacked(mode, "NONE", 54, 2, hex);
            let narrow: Vec<u8> = long.as_chunks::<4>().0.iter().flat_map(|b| [b[0], b[1]]).collect();
            assert_eq!(short, narrow);
        }
    }
}
