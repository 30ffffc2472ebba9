//! KTX2 textures: Basis Universal (ETC1S and UASTC, packed or not) by its transcoder, and plain texels.
//!
//! Only the largest level of one flat image is read. What the file says of its colour space is left aside: whether
//! numbers are colours is the business of whoever refers to the picture.

use super::decode::{Limits, check_size, damaged, pixels};
use super::{Picture, Texels};
use crate::diag::Diagnostic;
use basisu::{DecodeFlags, SourceFormat, TargetFormat, Transcoder};
use ruzstd::io::Read;

/// The first bytes of every KTX2 file.
pub(super) const MAGIC: [u8; 12] = *b"\xabKTX 20\xbb\r\n\x1a\n";
pub(super) const LABEL: &str = "KTX2";

/// What the header says.
struct Header {
    format: u32,
    width: u32,
    height: u32,
    scheme: u32,
    /// Where the data of the largest level lie, and how many bytes they have when they are unpacked.
    offset: u64,
    length: u64,
    unpacked: u64,
}

/// One texel is this many numbers of this kind in the order red, green, blue, alpha.
struct Plain {
    channels: usize,
    kind: Kind,
    is_bgr: bool,
}

#[derive(Clone, Copy)]
enum Kind {
    Byte,
    Word,
    Half,
    Float,
}

impl Kind {
    fn size(self) -> usize {
        match self {
            Kind::Byte => 1,
            Kind::Word | Kind::Half => 2,
            Kind::Float => 4,
        }
    }
}

/// Vulkan's numbers of the formats that are plain texels.
fn plain(format: u32) -> Option<Plain> {
    let (channels, kind) = match format {
        9 | 15 => (1, Kind::Byte),
        16 | 22 => (2, Kind::Byte),
        23 | 29 | 30 | 36 => (3, Kind::Byte),
        37 | 43 | 44 | 50 => (4, Kind::Byte),
        70 => (1, Kind::Word),
        77 => (2, Kind::Word),
        84 => (3, Kind::Word),
        91 => (4, Kind::Word),
        76 => (1, Kind::Half),
        83 => (2, Kind::Half),
        90 => (3, Kind::Half),
        97 => (4, Kind::Half),
        100 => (1, Kind::Float),
        103 => (2, Kind::Float),
        106 => (3, Kind::Float),
        109 => (4, Kind::Float),
        _ => return None,
    };
    let is_bgr = matches!(format, 30 | 36 | 44 | 50);
    Some(Plain { channels, kind, is_bgr })
}

/// Columns, rows and bytes of a texel when decoded.
pub(super) fn measure(bytes: &[u8], limits: Limits) -> Result<(u32, u32, u64), Diagnostic> {
    let header = Header::read(bytes, limits)?;
    let texel = plain(header.format).map_or(4, |p| match p.kind {
        Kind::Byte => 4,
        Kind::Word => 8,
        Kind::Half | Kind::Float => 16,
    });
    Ok((header.width, header.height, texel))
}

/// The picture in the file.
pub(super) fn decode(bytes: &[u8], limits: Limits) -> Result<Picture, Diagnostic> {
    let header = Header::read(bytes, limits)?;
    let (width, height) = (header.width, header.height);
    let texels = match plain(header.format) {
        Some(plain) => plain_texels(bytes, &header, &plain)?,
        None => transcode(bytes, &header)?,
    };
    Ok(Picture { width, height, texels })
}

impl Header {
    fn read(bytes: &[u8], limits: Limits) -> Result<Header, Diagnostic> {
        let cut = || damaged(LABEL, "its header is cut");
        let word = |at: usize| bytes.get(at..at + 4)?.try_into().ok().map(u32::from_le_bytes);
        let long = |at: usize| bytes.get(at..at + 8)?.try_into().ok().map(u64::from_le_bytes);
        let field = |i: usize| word(12 + 4 * i).ok_or_else(cut);
        let level = |i: usize| long(80 + 8 * i).ok_or_else(cut);
        let (width, height, depth) = (field(2)?, field(3)?, field(4)?);
        let (layers, faces) = (field(5)?, field(6)?);
        if height == 0 || depth > 1 || layers > 1 || faces != 1 {
            let shape = format!("{width}x{height}x{depth}, {layers} layers, {faces} faces");
            return Err(damaged(LABEL, &format!("it is no flat picture: {shape}")));
        }
        check_size(LABEL, width.into(), height.into(), limits)?;
        let header = Header {
            format: field(0)?,
            width,
            height,
            scheme: field(8)?,
            offset: level(0)?,
            length: level(1)?,
            unpacked: level(2)?,
        };
        // Blocks take 16 bytes each, for at least 4 × 4 texels or (plain ones) for one.
        let blocks = u64::from(width.div_ceil(4)) * u64::from(height.div_ceil(4));
        let most = match plain(header.format) {
            Some(_) => u64::from(width) * u64::from(height) * 16,
            None => blocks * 16,
        };
        if header.unpacked > most {
            let found = header.unpacked;
            return Err(damaged(
                LABEL,
                &format!("{width}x{height} texels cannot take {found} bytes"),
            ));
        }
        Ok(header)
    }

    fn texels(&self) -> usize {
        self.width as usize * self.height as usize
    }
}

/// Basis Universal to 8 bits a channel, or to floats where it holds light.
fn transcode(bytes: &[u8], header: &Header) -> Result<Texels, Diagnostic> {
    let failed = |e: basisu::Error| match e {
        basisu::Error::InvalidData | basisu::Error::Truncated => damaged(
            LABEL,
            &format!(
                "it holds no Basis Universal texture that is whole (format {})",
                header.format
            ),
        ),
        other => damaged(LABEL, &format!("{other:?}")),
    };
    let texture = Transcoder::new(bytes).map_err(failed)?;
    let is_light = matches!(
        texture.source_format(),
        SourceFormat::UastcHdr4x4 | SourceFormat::AstcHdr6x6 | SourceFormat::UastcHdr6x6
    );
    let target = if is_light {
        TargetFormat::RgbHalf
    } else {
        TargetFormat::Rgba32
    };
    let mut data = texture.transcode(0, target, DecodeFlags::NONE).map_err(failed)?;
    if is_light {
        let halves: Vec<f32> = data.as_chunks::<2>().0.iter().map(|b| half(*b)).collect();
        return counted(header, Texels::RgbF32(pixels(halves)));
    }
    if texture.has_alpha() {
        return counted(header, Texels::Rgba8(pixels(data)));
    }
    for i in 0..data.len() / 4 {
        data.copy_within(4 * i..4 * i + 3, 3 * i);
    }
    data.truncate(data.len() / 4 * 3);
    data.shrink_to_fit();
    counted(header, Texels::Rgb8(pixels(data)))
}

fn counted(header: &Header, texels: Texels) -> Result<Texels, Diagnostic> {
    if texels.len() != header.texels() {
        return Err(damaged(LABEL, "it holds fewer texels than its header promises"));
    }
    Ok(texels)
}

fn plain_texels(bytes: &[u8], header: &Header, plain: &Plain) -> Result<Texels, Diagnostic> {
    let cut = || damaged(LABEL, "its data end too early");
    let start = usize::try_from(header.offset).map_err(|_| cut())?;
    let stored = header.offset.checked_add(header.length);
    let stored = stored.and_then(|end| bytes.get(start..usize::try_from(end).ok()?));
    let stored = stored.ok_or_else(cut)?;
    // The header was checked: no more than 16 bytes a texel.
    let needed = header.texels() * plain.channels * plain.kind.size();
    let unpacked: Vec<u8>;
    let data = match header.scheme {
        0 => stored.get(..needed).ok_or_else(cut)?,
        2 => {
            let mut out = vec![0; needed];
            let mut stream = ruzstd::StreamingDecoder::new(stored)
                .map_err(|e| damaged(LABEL, &format!("its Zstandard data are malformed: {e}")))?;
            stream.read_exact(&mut out).map_err(|_| cut())?;
            unpacked = out;
            &unpacked
        }
        scheme => return Err(damaged(LABEL, &format!("packing scheme {scheme} is not supported"))),
    };
    let order = if plain.is_bgr { [2, 1, 0, 3] } else { [0, 1, 2, 3] };
    let channels = plain.channels;
    Ok(match plain.kind {
        Kind::Byte => {
            let (value, of) = (|b: &[u8]| b[0], u8::MAX);
            match channels {
                1 => Texels::Gray8(data.to_vec()),
                4 => Texels::Rgba8(gather(data, channels, 1, order, of, value)),
                _ => Texels::Rgb8(gather(data, channels, 1, [order[0], order[1], order[2]], 0, value)),
            }
        }
        Kind::Word => {
            let value = |b: &[u8]| u16::from_le_bytes([b[0], b[1]]);
            match channels {
                1 => Texels::Gray16(data.as_chunks::<2>().0.iter().map(|b| value(b)).collect()),
                4 => Texels::Rgba16(gather(data, channels, 2, order, u16::MAX, value)),
                _ => Texels::Rgb16(gather(data, channels, 2, [0, 1, 2], 0, value)),
            }
        }
        Kind::Half => floats(data, channels, 2, |b| half([b[0], b[1]])),
        Kind::Float => floats(data, channels, 4, |b| f32::from_le_bytes([b[0], b[1], b[2], b[3]])),
    })
}

fn floats(data: &[u8], channels: usize, size: usize, value: impl Fn(&[u8]) -> f32) -> Texels {
    match channels {
        1 => Texels::GrayF32(data.chunks_exact(size).map(value).collect()),
        4 => Texels::RgbaF32(gather(data, channels, size, [0, 1, 2, 3], 1.0, value)),
        _ => Texels::RgbF32(gather(data, channels, size, [0, 1, 2], 0.0, value)),
    }
}

/// Texels of N channels, channel i of them being the file's channel `order[i]`, or `missing` where it has none.
fn gather<T: Copy, const N: usize>(
    data: &[u8],
    channels: usize,
    size: usize,
    order: [usize; N],
    missing: T,
    value: impl Fn(&[u8]) -> T,
) -> Vec<[T; N]> {
    let texel = |t: &[u8]| order.map(|c| t.get(c * size..(c + 1) * size).map_or(missing, &value));
    data.chunks_exact(channels * size).map(texel).collect()
}

/// A number of 16 bits (IEEE 754 binary16).
fn half(bytes: [u8; 2]) -> f32 {
    exr::prelude::f16::from_le_bytes(bytes).to_f32()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pictures::decode as any;

    const RAMPS: [(&str, bool, &[u8]); 6] = [
        (
            "etc1s",
            false,
            include_bytes!("../../tests/pictures/ramp-rgb-etc1s.ktx2"),
        ),
        (
            "uastc",
            false,
            include_bytes!("../../tests/pictures/ramp-rgb-uastc.ktx2"),
        ),
        (
            "zstd",
            false,
            include_bytes!("../../tests/pictures/ramp-rgb-uastc-zstd.ktx2"),
        ),
        (
            "etc1s",
            true,
            include_bytes!("../../tests/pictures/ramp-rgba-etc1s.ktx2"),
        ),
        (
            "uastc",
            true,
            include_bytes!("../../tests/pictures/ramp-rgba-uastc.ktx2"),
        ),
        (
            "zstd",
            true,
            include_bytes!("../../tests/pictures/ramp-rgba-uastc-zstd.ktx2"),
        ),
    ];

    /// The picture that the reference encoder was given: texel (x, y) is (15x, 28y, 40), alpha 255 − 12x.
    #[test]
    fn ramps_of_every_packing_come_back_but_for_the_loss_of_their_blocks() {
        for (name, alpha, bytes) in RAMPS {
            let picture = any(bytes, name, Limits::default()).unwrap();
            assert_eq!(
                (picture.width, picture.height, picture.has_alpha()),
                (18, 10, alpha),
                "{name}"
            );
            let mut worst = 0.0f32;
            for (x, y) in (0..18).flat_map(|x| (0..10).map(move |y| (x, y))) {
                let a = if alpha { 255 - 12 * x } else { 255 };
                let wanted = [15 * x, 28 * y, 40, a].map(|v| v as f32 / 255.0);
                let found = picture.rgba(x, y).unwrap();
                worst = wanted.iter().zip(found).fold(worst, |w, (a, b)| w.max((a - b).abs()));
            }
            // A block of ETC1S has one colour at four brightnesses, but the ramp has two colours that vary: across a
            // block red changes by 45 and green by 84. UASTC has two colours and their mixtures.
            let most = if name == "etc1s" { 84.0 / 255.0 } else { 45.0 / 255.0 };
            assert!(worst <= most, "{name} {alpha}: {worst}");
        }
    }

    #[test]
    fn zstandard_changes_no_bit() {
        let [plain, packed] = [RAMPS[4].2, RAMPS[5].2].map(|b| any(b, "x", Limits::default()).unwrap());
        assert_eq!(plain, packed);
    }

    /// A file of 2 × 1 texels in a plain format.
    fn file(format: u32, data: &[u8]) -> Vec<u8> {
        let mut out = MAGIC.to_vec();
        for word in [format, 1, 2, 1, 0, 0, 1, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0] {
            out.extend(word.to_le_bytes());
        }
        for long in [104u64, data.len() as u64, data.len() as u64] {
            out.extend(long.to_le_bytes());
        }
        out.extend(data);
        out
    }

    #[test]
    fn plain_texels_keep_their_precision() {
        let texels = |format, data: &[u8]| any(&file(format, data), "x", Limits::default()).unwrap().texels;
        assert_eq!(texels(9, &[1, 2]), Texels::Gray8(vec![1, 2]));
        assert_eq!(texels(22, &[1, 2, 3, 4]), Texels::Rgb8(vec![[1, 2, 0], [3, 4, 0]]));
        assert_eq!(
            texels(43, &[1, 2, 3, 4, 5, 6, 7, 8]),
            Texels::Rgba8(vec![[1, 2, 3, 4], [5, 6, 7, 8]])
        );
        assert_eq!(
            texels(44, &[1, 2, 3, 4, 5, 6, 7, 8]),
            Texels::Rgba8(vec![[3, 2, 1, 4], [7, 6, 5, 8]])
        );
        let halves = [0x3C00u16, 0x4000, 0xC000, 0x3800, 0x3C00, 0, 0, 0];
        let data: Vec<u8> = halves.iter().flat_map(|h| h.to_le_bytes()).collect();
        assert_eq!(
            texels(97, &data),
            Texels::RgbaF32(vec![[1.0, 2.0, -2.0, 0.5], [1.0, 0.0, 0.0, 0.0]])
        );
        let data: Vec<u8> = [1.5f32, 2.5].iter().flat_map(|h| h.to_le_bytes()).collect();
        assert_eq!(texels(100, &data), Texels::GrayF32(vec![1.5, 2.5]));
    }

    #[test]
    fn cut_and_damaged_files_are_errors_or_other_pictures_but_never_panic() {
        let mut files: Vec<Vec<u8>> = RAMPS.iter().map(|r| r.2.to_vec()).collect();
        files.push(file(43, &[0; 8]));
        for file in files {
            for length in 0..file.len().min(300) {
                assert!(any(&file[..length], "x", Limits::default()).is_err(), "cut at {length}");
            }
            for (at, flip) in (0..file.len()).flat_map(|at| [1, 0x40, 0xFF].map(|f| (at, f))) {
                let mut file = file.clone();
                file[at] ^= flip;
                let _ = any(&file, "x", Limits::default());
            }
        }
    }
}
