//! A decoded picture in the precision of its file.

/// Texels row by row from the top left. The stored numbers are the file's: 8- and 16-bit ones usually encoded
/// (sRGB), floats linear; what they mean is the texture's business.
#[derive(Clone, Debug, PartialEq)]
pub enum Texels {
    /// One byte, shown as grey.
    Gray8(Vec<u8>),
    /// Three bytes.
    Rgb8(Vec<[u8; 3]>),
    /// Four bytes, alpha not premultiplied.
    Rgba8(Vec<[u8; 4]>),
    /// One 16-bit number, shown as grey.
    Gray16(Vec<u16>),
    /// Three 16-bit numbers.
    Rgb16(Vec<[u16; 3]>),
    /// Four 16-bit numbers, alpha not premultiplied.
    Rgba16(Vec<[u16; 4]>),
    /// One float, shown as grey.
    GrayF32(Vec<f32>),
    /// Three floats.
    RgbF32(Vec<[f32; 3]>),
    /// Four floats, as stored (OpenEXR: colour premultiplied with alpha).
    RgbaF32(Vec<[f32; 4]>),
}

/// A decoded picture; `texels` holds `width · height` of them and neither side is 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// The texels.
    pub texels: Texels,
}

impl Texels {
    /// How many there are.
    pub fn len(&self) -> usize {
        match self {
            Texels::Gray8(t) => t.len(),
            Texels::Rgb8(t) => t.len(),
            Texels::Rgba8(t) => t.len(),
            Texels::Gray16(t) => t.len(),
            Texels::Rgb16(t) => t.len(),
            Texels::Rgba16(t) => t.len(),
            Texels::GrayF32(t) => t.len(),
            Texels::RgbF32(t) => t.len(),
            Texels::RgbaF32(t) => t.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The numbers of each texel where they are floats, which may be anything; nothing where they are integers.
    pub fn floats_mut(&mut self) -> impl Iterator<Item = &mut [f32]> {
        let (texels, channels): (&mut [f32], _) = match self {
            Texels::GrayF32(t) => (t, 1),
            Texels::RgbF32(t) => (t.as_flattened_mut(), 3),
            Texels::RgbaF32(t) => (t.as_flattened_mut(), 4),
            _ => (&mut [], 1),
        };
        texels.chunks_exact_mut(channels)
    }

    /// Keeps the first `count`, and no memory for the others.
    pub fn truncate(&mut self, count: usize) {
        fn cut<T>(texels: &mut Vec<T>, count: usize) {
            texels.truncate(count);
            texels.shrink_to_fit();
        }
        match self {
            Texels::Gray8(t) => cut(t, count),
            Texels::Rgb8(t) => cut(t, count),
            Texels::Rgba8(t) => cut(t, count),
            Texels::Gray16(t) => cut(t, count),
            Texels::Rgb16(t) => cut(t, count),
            Texels::Rgba16(t) => cut(t, count),
            Texels::GrayF32(t) => cut(t, count),
            Texels::RgbF32(t) => cut(t, count),
            Texels::RgbaF32(t) => cut(t, count),
        }
    }

    /// Bytes that one texel takes in memory.
    pub fn bytes_per_texel(&self) -> usize {
        match self {
            Texels::Gray8(_) => 1,
            Texels::Rgb8(_) => 3,
            Texels::Rgba8(_) | Texels::GrayF32(_) => 4,
            Texels::Gray16(_) => 2,
            Texels::Rgb16(_) => 6,
            Texels::Rgba16(_) => 8,
            Texels::RgbF32(_) => 12,
            Texels::RgbaF32(_) => 16,
        }
    }

    /// The texel at this position as RGBA, integers scaled to [0, 1], alpha 1 where the file has none.
    /// No transfer curve is applied. `None` past the end.
    pub fn rgba(&self, index: usize) -> Option<[f32; 4]> {
        let byte = |v: u8| f32::from(v) / 255.0;
        let word = |v: u16| f32::from(v) / 65535.0;
        Some(match self {
            Texels::Gray8(t) => gray(byte(*t.get(index)?)),
            Texels::Rgb8(t) => opaque(t.get(index)?.map(byte)),
            Texels::Rgba8(t) => t.get(index)?.map(byte),
            Texels::Gray16(t) => gray(word(*t.get(index)?)),
            Texels::Rgb16(t) => opaque(t.get(index)?.map(word)),
            Texels::Rgba16(t) => t.get(index)?.map(word),
            Texels::GrayF32(t) => gray(*t.get(index)?),
            Texels::RgbF32(t) => opaque(*t.get(index)?),
            Texels::RgbaF32(t) => *t.get(index)?,
        })
    }
}

impl Picture {
    /// Whether the texels are floats, hence linear light rather than encoded.
    pub fn is_float(&self) -> bool {
        matches!(self.texels, Texels::GrayF32(_) | Texels::RgbF32(_) | Texels::RgbaF32(_))
    }

    /// Whether the file has an alpha channel.
    pub fn has_alpha(&self) -> bool {
        matches!(self.texels, Texels::Rgba8(_) | Texels::Rgba16(_) | Texels::RgbaF32(_))
    }

    /// The texel in column `x` of row `y` (from the top) as [`Texels::rgba`] gives it; `None` outside.
    pub fn rgba(&self, x: u32, y: u32) -> Option<[f32; 4]> {
        if x >= self.width || y >= self.height {
            return None;
        }
        self.texels.rgba(y as usize * self.width as usize + x as usize)
    }
}

fn gray(v: f32) -> [f32; 4] {
    [v, v, v, 1.0]
}

fn opaque([r, g, b]: [f32; 3]) -> [f32; 4] {
    [r, g, b, 1.0]
}
