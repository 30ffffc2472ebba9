//! Mode 0 of the packed views: elements as differences to the element before, byte by byte, sixteen elements at a time.
//! Version 0 is `EXT_meshopt_compression`'s; version 1 (`KHR_meshopt_compression`) adds control bits and channels.

use super::meshopt::{Bytes, CUT, frame};

/// How the difference of four bytes is to be read.
#[derive(Clone, Copy)]
enum Channel {
    /// Four bytes of their own.
    Bytes,
    /// Two 16-bit integers.
    Words,
    /// One 32-bit pattern, turned right by this many bits, to be combined by exclusive or.
    Bits(u32),
}

/// Bits per difference for the four modes of a group; 0 is no data, 8 plain bytes.
const BITS: [u8; 4] = [0, 2, 4, 8];
const SHORT_BITS: [u8; 4] = [0, 1, 2, 4];
const LONG_BITS: [u8; 4] = [1, 2, 4, 8];

/// Unpacks `count` elements of `stride` bytes.
pub(super) fn attributes(data: &[u8], count: usize, stride: usize) -> Result<Vec<u8>, &'static str> {
    if stride == 0 || stride > 256 || !stride.is_multiple_of(4) {
        return Err("its `byteStride` is not a multiple of 4 up to 256");
    }
    let is_newer = data.first() == Some(&0xA1);
    // At best two bits hold sixteen bytes, or (newer) 256.
    let most = if is_newer { 1024 } else { 64 };
    if count.checked_mul(stride).is_none_or(|n| n / most > data.len()) {
        return Err(CUT);
    }
    let (header, tail, channel_bytes) = match is_newer {
        true => (0xA1, (stride + stride / 4).max(24), stride / 4),
        false => (0xA0, stride.max(32), 0),
    };
    let (mut body, tail) = frame(data, header, tail)?;
    let (tail, channels) = tail.split_at(tail.len() - channel_bytes);
    let mut last = tail[tail.len() - stride..].to_vec();
    let channels: Result<Vec<Channel>, _> = (0..stride / 4).map(|c| channel(channels.get(c))).collect();
    let channels = channels?;

    let mut out = vec![0; count * stride];
    let block = ((8192 / stride) & !15).min(256);
    for elements in out.chunks_mut(block * stride) {
        let controls = if is_newer { body.take(stride / 4)? } else { &[] };
        for k in 0..stride {
            let control = controls.get(k / 4).map(|c| c >> (2 * (k % 4)) & 3);
            column(elements, k, stride, control, &mut body)?;
        }
        for element in elements.chunks_exact_mut(stride) {
            let fours = element
                .as_chunks_mut::<4>()
                .0
                .iter_mut()
                .zip(last.as_chunks_mut::<4>().0);
            for ((delta, last), channel) in fours.zip(&channels) {
                *last = add(*last, *delta, *channel);
                *delta = *last;
            }
        }
    }
    Ok(out)
}

fn channel(code: Option<&u8>) -> Result<Channel, &'static str> {
    match code.map_or((0, 0), |c| (c & 15, c >> 4)) {
        (0, 0) => Ok(Channel::Bytes),
        (1, 0) => Ok(Channel::Words),
        (2, turn) => Ok(Channel::Bits(turn.into())),
        _ => Err("its data have a channel of unknown mode"),
    }
}

/// Reads byte `k` of the differences of a block's elements into its place.
fn column(
    elements: &mut [u8],
    k: usize,
    stride: usize,
    control: Option<u8>,
    body: &mut Bytes,
) -> Result<(), &'static str> {
    let count = elements.len() / stride;
    let groups = count.div_ceil(16);
    let bits = match control {
        None => BITS,
        Some(0) => SHORT_BITS,
        Some(1) => LONG_BITS,
        Some(2) => return Ok(()), // all zero, as the output is already
        Some(_) => {
            let plain = body.take(count)?;
            elements
                .iter_mut()
                .skip(k)
                .step_by(stride)
                .zip(plain)
                .for_each(|(to, from)| *to = *from);
            return Ok(());
        }
    };
    let modes = body.take(groups.div_ceil(4))?;
    for group in 0..groups {
        let mode = modes[group / 4] >> (2 * (group % 4)) & 3;
        let deltas = group_deltas(bits[usize::from(mode)].into(), body)?;
        let column = elements[group * 16 * stride..].iter_mut().skip(k).step_by(stride);
        column.zip(deltas).for_each(|(to, from)| *to = from);
    }
    Ok(())
}

/// Sixteen differences of so many bits each; where all bits are set the difference follows as a byte.
fn group_deltas(bits: usize, body: &mut Bytes) -> Result<[u8; 16], &'static str> {
    match bits {
        0 => return Ok([0; 16]),
        8 => return body.take(16)?.try_into().map_err(|_| CUT),
        _ => {}
    }
    let packed = body.take(2 * bits)?;
    let escape = (1u8 << bits) - 1;
    let mut deltas = [0; 16];
    for (i, delta) in deltas.iter_mut().enumerate() {
        let bit = i * bits;
        // Single bits start at the lowest, all others at the highest.
        let shift = if bits == 1 { bit % 8 } else { 8 - bits - bit % 8 };
        let value = packed[bit / 8] >> shift & escape;
        *delta = if value == escape { body.byte()? } else { value };
    }
    Ok(deltas)
}

/// The element's four bytes from those of the element before and the difference.
fn add(last: [u8; 4], delta: [u8; 4], channel: Channel) -> [u8; 4] {
    match channel {
        Channel::Bytes => std::array::from_fn(|i| {
            let d = delta[i];
            last[i].wrapping_add((d >> 1) ^ (d & 1).wrapping_neg())
        }),
        Channel::Words => {
            let word = |b: [u8; 4], i| u16::from_le_bytes([b[i], b[i + 1]]);
            let sum = |i| {
                let d = word(delta, i);
                word(last, i)
                    .wrapping_add((d >> 1) ^ (d & 1).wrapping_neg())
                    .to_le_bytes()
            };
            let (low, high) = (sum(0), sum(2));
            [low[0], low[1], high[0], high[1]]
        }
        Channel::Bits(turn) => {
            let turned = u32::from_le_bytes(delta).rotate_right(turn);
            (u32::from_le_bytes(last) ^ turned).to_le_bytes()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::meshopt::tests::unpacked;

    /// Written by the extension's reference encoder at its highest level: floats, words, and bytes of each control mode.
    const NEWER: &str = "a19fb7db00757775777575777577757577757577757775757775777575777577757577757775757775777575004042424240\
        4242424042424240424242424042424240424242404242424240424242404242424000000102010102020100020058585858\
        5858585858585858585858585858585858585858585858585858585858585858585858152aaaaaaaaaaaaaaaaaaa00000099\
        99999999999999999999999999999999999999999999999999999999999999999999999999990002060a0e12161a1e22262a\
        2e32363a3e42464a4e52565a5e62666a6e72767a7e82868a8e92969a15124924924924924924920000003e3e3e3e3e3e3e3e\
        3e3e3e3e3e3e3e3e3e3e3e3e3e3e3e3e3e3e3e3e3e3e3e3e3e3e3e3e3e3e3e0000000000000000000000803f000088130007\
        0100000100";

    #[test]
    fn the_newer_version_unpacks_to_what_was_packed() {
        let element = |i: u16| {
            let mut bytes = (1.0 + f32::from(i) * 0.001).to_le_bytes().to_vec();
            bytes.extend((i * 300).to_le_bytes());
            bytes.extend((5000 - i * 77).to_le_bytes());
            bytes.extend([(i * i) as u8, 7, u8::from(i.is_multiple_of(3)), (i * 31) as u8]);
            bytes
        };
        let want: Vec<u8> = (0..40).flat_map(element).collect();
        assert_eq!(unpacked("ATTRIBUTES", "NONE", 40, 12, NEWER), want);
    }
}
