//! Channels that are the same all over a picture.

use super::Texels;

impl Texels {
    /// Which of red, green, blue and alpha have the same number in all texels. Alpha that the file does not have is 1
    /// everywhere. Numbers that are not a number (NaN) differ from all. All of them for a picture without texels.
    pub fn uniform(&self) -> [bool; 4] {
        match self {
            Texels::Gray8(t) => gray(t),
            Texels::Gray16(t) => gray(t),
            Texels::GrayF32(t) => gray(t),
            Texels::Rgb8(t) => opaque(same(t)),
            Texels::Rgb16(t) => opaque(same(t)),
            Texels::RgbF32(t) => opaque(same(t)),
            Texels::Rgba8(t) => same(t),
            Texels::Rgba16(t) => same(t),
            Texels::RgbaF32(t) => same(t),
        }
    }
}

fn gray<T: PartialEq>(texels: &[T]) -> [bool; 4] {
    let same = texels.iter().all(|t| texels.first() == Some(t));
    [same, same, same, true]
}

fn opaque([r, g, b]: [bool; 3]) -> [bool; 4] {
    [r, g, b, true]
}

/// Ends at the first texel by which no channel is left.
fn same<T: PartialEq, const N: usize>(texels: &[[T; N]]) -> [bool; N] {
    let mut same = [true; N];
    let Some(first) = texels.first() else { return same };
    for texel in texels {
        for (same, (a, b)) in same.iter_mut().zip(texel.iter().zip(first)) {
            *same &= a == b;
        }
        if same == [false; N] {
            break;
        }
    }
    same
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_channel_is_judged_by_itself() {
        let opaque = Texels::Rgba8(vec![[1, 2, 3, 255], [1, 9, 3, 255], [1, 2, 3, 255]]);
        assert_eq!(opaque.uniform(), [true, false, true, true]);
        assert_eq!(
            Texels::Rgb16(vec![[1, 2, 3], [0, 2, 4]]).uniform(),
            [false, true, false, true]
        );
        assert_eq!(Texels::Gray8(vec![7, 7]).uniform(), [true; 4]);
        assert_eq!(Texels::GrayF32(vec![7.0, 7.5]).uniform(), [false, false, false, true]);
        assert_eq!(
            Texels::RgbF32(vec![[f32::NAN, 0.0, -0.0]]).uniform(),
            [false, true, true, true]
        );
    }
}
