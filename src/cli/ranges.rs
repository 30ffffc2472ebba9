//! The values of `--samples`, `--tile` and `--region`.

use super::values::MAX_SPP;
use crate::render::settings::Region;
use std::fmt;
use std::ops::Range;
use std::str::FromStr;

/// `a..b`: the samples from number a to before number b, counted from 0.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SampleRange(pub Range<u32>);

impl FromStr for SampleRange {
    type Err = String;

    fn from_str(text: &str) -> Result<SampleRange, String> {
        let wrong = || format!("`{text}` is not a range of samples; write a..b with a < b, for example 0..256");
        let (begin, end) = text.split_once("..").ok_or_else(wrong)?;
        let number = |text: &str| text.trim().parse::<u32>().ok().filter(|n| *n <= MAX_SPP);
        match (number(begin), number(end)) {
            (Some(begin), Some(end)) if begin < end => Ok(SampleRange(begin..end)),
            _ => Err(wrong()),
        }
    }
}

/// `k/n`: band k of n bands of rows, counted from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tile {
    k: u32,
    n: u32,
}

impl FromStr for Tile {
    type Err = String;

    fn from_str(text: &str) -> Result<Tile, String> {
        let numbers = text
            .split_once('/')
            .and_then(|(k, n)| Some((k.trim().parse().ok()?, n.trim().parse().ok()?)));
        match numbers {
            Some((k, n)) if k < n => Ok(Tile { k, n }),
            _ => Err(format!(
                "`{text}` is not a tile; write k/n with k from 0 to n - 1, for example 0/4 to 3/4"
            )),
        }
    }
}

impl fmt::Display for Tile {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}/{}", self.k, self.n)
    }
}

impl Tile {
    /// The rows of the band; an error if there are more bands than rows.
    pub fn region(&self, width: u32, height: u32) -> Result<Region, String> {
        if self.n > height {
            return Err(format!(
                "--tile {self}: a picture of {height} rows has no {} bands of rows",
                self.n
            ));
        }
        let row = |k: u32| (u64::from(k) * u64::from(height) / u64::from(self.n)) as u32;
        Ok(Region {
            x0: 0,
            y0: row(self.k),
            x1: width,
            y1: row(self.k + 1),
        })
    }
}

/// `x0,y0,x1,y1` in pixels from the top left, the end excluded.
pub fn region(text: &str) -> Result<Region, String> {
    let numbers: Option<Vec<u32>> = text.split(',').map(|n| n.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x0, y0, x1, y1]) if x0 < x1 && y0 < y1 => Ok(Region { x0, y0, x1, y1 }),
        _ => Err(format!(
            "`{text}` is not a region; write x0,y0,x1,y1 in pixels from the top left with x0 < x1 and y0 < y1"
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_of_samples_is_not_empty() {
        assert_eq!("16..48".parse(), Ok(SampleRange(16..48)));
        for wrong in ["", "5", "5..5", "6..5", "..5", "5..", "-1..5", "0..=5", "0..4294967295"] {
            assert!(wrong.parse::<SampleRange>().is_err(), "{wrong} was accepted");
        }
    }

    #[test]
    fn tiles_cover_all_rows_once() {
        for (n, height) in [(1, 1), (3, 10), (7, 7), (5, 601)] {
            let mut next = 0;
            for k in 0..n {
                let band = format!("{k}/{n}").parse::<Tile>().unwrap().region(4, height).unwrap();
                assert_eq!((band.x0, band.x1, band.y0), (0, 4, next));
                assert!(band.y1 > band.y0);
                next = band.y1;
            }
            assert_eq!(next, height);
        }
        assert!("0/11".parse::<Tile>().unwrap().region(4, 10).is_err());
        for wrong in ["", "1", "4/4", "0/0", "-1/4", "a/b"] {
            assert!(wrong.parse::<Tile>().is_err(), "{wrong} was accepted");
        }
    }

    #[test]
    fn a_region_has_pixels() {
        assert_eq!(region("1, 2,3,4").map(|r| r.pixels()), Ok(4));
        for wrong in ["", "0,0,4", "4,0,4,8", "0,9,4,8", "0,0,4,-8", "0,0,4,8,9"] {
            assert!(region(wrong).is_err(), "{wrong} was accepted");
        }
    }
}
