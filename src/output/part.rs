//! Part files, `.ptspart`: the sums of some pixels and samples of a picture, exact to the bit.
//!
//! All numbers are little-endian. `PTSPART` and a line feed; the format's version (u32); columns, rows, nets and
//! channels of the picture (4 × u32); length of a JSON header (u32) and the header, which says what picture this is
//! part of. Then the runs, row by row: row, first column, end column, number of sample ranges (4 × u32), the ranges
//! (2 × u32 each) and the sums (f64), as [`Run`] has them. `u32::MAX` in place of a row ends the runs; FNV-1a of all
//! bytes before it (u64) ends the file.

use super::OutputError;
use super::write::write_with;
use crate::math::fnv::Fnv;
use crate::render::pixels::{Pixels, Rows, Run, Shape, pixel_len};
use serde_json::Value;
use std::io::{self, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};

/// The ending of part files.
pub const EXTENSION: &str = "ptspart";

const MAGIC: &[u8; 8] = b"PTSPART\n";
const VERSION: u32 = 1;
const END: u32 = u32::MAX;
/// Most pixels along one side and most nets and channels that a file is believed to have.
const MOST: Shape = Shape {
    width: 1 << 16,
    height: 1 << 16,
    nets: 16,
    channels: 64,
};

/// A part file in memory.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// What picture this is part of: a JSON object.
    pub header: Value,
    /// The sums.
    pub pixels: Pixels,
}

/// Why a part file cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PartError {
    /// The file system refused.
    #[error("cannot read {path:?}: {reason}")]
    Io {
        /// The file.
        path: PathBuf,
        /// What failed.
        reason: String,
    },
    /// Something else altogether.
    #[error("{0:?} is no part file: it does not begin as one")]
    Foreign(PathBuf),
    /// Written by a later version of this program.
    #[error("{path:?} has part format {found}, which is newer than {VERSION}, the newest this version of pts reads")]
    Newer {
        /// The file.
        path: PathBuf,
        /// Its format.
        found: u32,
    },
    /// The end is missing.
    #[error("{0:?} is cut off: its end is missing; render that part again")]
    Truncated(PathBuf),
    /// The bytes are not those that were written.
    #[error("{path:?} is damaged ({reason}); render that part again")]
    Damaged {
        /// The file.
        path: PathBuf,
        /// What shows it.
        reason: &'static str,
    },
}

/// Whether a path names a part file.
pub fn is_part(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case(EXTENSION))
}

/// Writes a part file, whole or not at all: an old one of the same name stays until the new one is complete.
pub fn write_part(path: &Path, header: &Value, rows: &dyn Rows) -> Result<(), OutputError> {
    write_with(path, |file| {
        let mut out = Hashed {
            inner: io::BufWriter::with_capacity(1 << 20, file),
            hash: Fnv::default(),
        };
        write_rows(&mut out, header, rows)?;
        let hash = out.hash.value();
        out.write_all(&hash.to_le_bytes())?;
        out.flush()
    })
}

fn write_rows(out: &mut impl Write, header: &Value, rows: &dyn Rows) -> io::Result<()> {
    let shape = rows.shape();
    let text = header.to_string();
    out.write_all(MAGIC)?;
    let numbers = [
        VERSION,
        shape.width,
        shape.height,
        shape.nets,
        shape.channels,
        text.len() as u32,
    ];
    numbers.iter().try_for_each(|n| out.write_all(&n.to_le_bytes()))?;
    out.write_all(text.as_bytes())?;
    for y in 0..shape.height {
        for run in rows.row(y) {
            let place = [y, run.columns.start, run.columns.end, run.samples.len() as u32];
            let ranges = run.samples.iter().flat_map(|r| [r.start, r.end]);
            place
                .into_iter()
                .chain(ranges)
                .try_for_each(|n| out.write_all(&n.to_le_bytes()))?;
            run.sums.iter().try_for_each(|s| out.write_all(&s.to_le_bytes()))?;
        }
    }
    out.write_all(&END.to_le_bytes())
}

/// Counts what passes through into a fingerprint.
struct Hashed<W> {
    inner: W,
    hash: Fnv,
}

impl<W: Write> Write for Hashed<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let n = self.inner.write(bytes)?;
        self.hash.write(&bytes[..n]);
        Ok(n)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

/// Reads a part file.
pub fn read_part(path: &Path) -> Result<Part, PartError> {
    let bytes = std::fs::read(path).map_err(|e| PartError::Io {
        path: path.to_owned(),
        reason: e.to_string(),
    })?;
    decode(&bytes).map_err(|fault| match fault {
        Fault::Foreign => PartError::Foreign(path.to_owned()),
        Fault::Newer(found) => PartError::Newer {
            path: path.to_owned(),
            found,
        },
        Fault::Truncated => PartError::Truncated(path.to_owned()),
        Fault::Damaged(reason) => PartError::Damaged {
            path: path.to_owned(),
            reason,
        },
    })
}

/// What can be wrong with the bytes.
#[derive(Debug, PartialEq)]
enum Fault {
    Foreign,
    Newer(u32),
    Truncated,
    Damaged(&'static str),
}

fn decode(bytes: &[u8]) -> Result<Part, Fault> {
    let mut cursor = Cursor(bytes);
    if cursor.take(MAGIC.len()).map_err(|_| Fault::Foreign)? != MAGIC {
        return Err(Fault::Foreign);
    }
    let version = cursor.number()?;
    if version > VERSION {
        return Err(Fault::Newer(version));
    }
    let [width, height, nets, channels, text] = cursor.numbers()?;
    let shape = Shape {
        width,
        height,
        nets,
        channels,
    };
    let all = |shape: Shape| [shape.width, shape.height, shape.nets, shape.channels];
    let makes_sense = |(n, most)| (1..=most).contains(&n);
    if version == 0 || !all(shape).into_iter().zip(all(MOST)).all(makes_sense) {
        return Err(Fault::Damaged("its first numbers make no sense"));
    }
    let (text, pixels) = (cursor.take(text as usize)?, decode_runs(&mut cursor, shape));
    // A wrong number may lead anywhere: what was read counts only if the fingerprint is right.
    let found = bytes.split_last_chunk::<8>().map(|(body, hash)| {
        let mut expected = Fnv::default();
        expected.write(body);
        expected.value() == u64::from_le_bytes(*hash)
    });
    let pixels = pixels?;
    if found != Some(true) {
        return Err(Fault::Damaged("its fingerprint does not fit"));
    }
    let header = serde_json::from_slice(text).map_err(|_| Fault::Damaged("its header is no JSON"))?;
    Ok(Part { header, pixels })
}

fn decode_runs(cursor: &mut Cursor, shape: Shape) -> Result<Pixels, Fault> {
    let mut pixels = Pixels::new(shape);
    // The end of the run before.
    let mut last = (0, 0);
    loop {
        let y = cursor.number()?;
        if y == END {
            break;
        }
        let [x0, x1, ranges] = cursor.numbers()?;
        if y >= shape.height || x0 >= x1 || x1 > shape.width || (y, x0) < last || ranges == 0 {
            return Err(Fault::Damaged("a run of pixels has no place in the picture"));
        }
        last = (y, x1);
        cursor.must_have(u64::from(ranges) * 8)?;
        let mut samples: Vec<Range<u32>> = Vec::with_capacity(ranges as usize);
        for _ in 0..ranges {
            let [begin, end] = cursor.numbers()?;
            if begin >= end || samples.last().is_some_and(|before| begin <= before.end) {
                return Err(Fault::Damaged("ranges of samples are out of order"));
            }
            samples.push(begin..end);
        }
        let per_pixel = pixel_len(&samples, shape.nets, shape.channels as usize) as u64;
        let length = per_pixel.saturating_mul(u64::from(x1 - x0)).saturating_mul(8);
        cursor.must_have(length)?;
        let (numbers, _) = cursor.take(length as usize)?.as_chunks::<8>();
        pixels.rows[y as usize].push(Run {
            columns: x0..x1,
            samples,
            sums: numbers.iter().map(|n| f64::from_le_bytes(*n)).collect(),
        });
    }
    match cursor.0.len() {
        8 => Ok(pixels),
        n if n < 8 => Err(Fault::Truncated),
        _ => Err(Fault::Damaged("something follows its end")),
    }
}

/// The bytes that are still to be read.
struct Cursor<'a>(&'a [u8]);

impl<'a> Cursor<'a> {
    fn must_have(&self, n: u64) -> Result<(), Fault> {
        if n > self.0.len() as u64 {
            Err(Fault::Truncated)
        } else {
            Ok(())
        }
    }

    fn take(&mut self, n: usize) -> Result<&'a [u8], Fault> {
        let (taken, rest) = self.0.split_at_checked(n).ok_or(Fault::Truncated)?;
        self.0 = rest;
        Ok(taken)
    }

    fn number(&mut self) -> Result<u32, Fault> {
        let (number, rest) = self.0.split_first_chunk::<4>().ok_or(Fault::Truncated)?;
        self.0 = rest;
        Ok(u32::from_le_bytes(*number))
    }

    fn numbers<const N: usize>(&mut self) -> Result<[u32; N], Fault> {
        let mut numbers = [0; N];
        for n in &mut numbers {
            *n = self.number()?;
        }
        Ok(numbers)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn part() -> Pixels {
        let shape = Shape {
            width: 5,
            height: 3,
            nets: 4,
            channels: 3,
        };
        let run = |columns: Range<u32>, samples: &[(u32, u32)]| {
            let samples: Vec<Range<u32>> = samples.iter().map(|(begin, end)| *begin..*end).collect();
            let n = columns.len() * pixel_len(&samples, 4, 3);
            let sums = (0..n).map(|i| (i as f64).sqrt()).collect();
            Run { columns, samples, sums }
        };
        let mut pixels = Pixels::new(shape);
        pixels.rows[0].push(run(0..5, &[(3, 200)]));
        pixels.rows[2].push(run(1..2, &[(0, 16), (40, 41)]));
        pixels.rows[2].push(run(4..5, &[(0, 100)]));
        pixels
    }

    fn file() -> Vec<u8> {
        let dir = tempfile::tempdir().expect("a directory");
        let path = dir.path().join("a.ptspart");
        write_part(&path, &json!({"seed": 7}), &part()).expect("it is written");
        std::fs::read(path).expect("it is there")
    }

    #[test]
    fn what_is_written_is_read() {
        let read = decode(&file()).expect("it is whole");
        assert_eq!((read.header, read.pixels), (json!({"seed": 7}), part()));
    }

    #[test]
    fn a_file_that_ends_early_is_refused_wherever_it_ends() {
        let file = file();
        for end in 8..file.len() {
            assert_eq!(
                decode(&file[..end]),
                Err(Fault::Truncated),
                "{end} of {} bytes",
                file.len()
            );
        }
    }

    #[test]
    fn every_flipped_bit_is_noticed() {
        let file = file();
        for at in 0..file.len() {
            for bit in [0, 3, 7] {
                let mut bytes = file.clone();
                bytes[at] ^= 1 << bit;
                assert!(decode(&bytes).is_err(), "bit {bit} of byte {at}");
            }
        }
    }

    #[test]
    fn foreign_and_newer_files_are_named_as_such() {
        assert_eq!(decode(b"\x89PNG\r\n\x1a\n..."), Err(Fault::Foreign));
        assert_eq!(decode(b""), Err(Fault::Foreign));
        let mut newer = file();
        newer[8] = 2;
        assert_eq!(decode(&newer), Err(Fault::Newer(2)));
    }
}
