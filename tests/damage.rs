//! The bodies of the fuzz targets `gltf`, `obj` and `picture` over their seeds, and over thousands of damaged copies
//! that are the same on every run: no panic, no hang, no memory without end.
//!
//! `PTS_DAMAGE=200000 cargo test --release --test damage` damages more (copies for each of the three).

#[path = "support/model_damage.rs"]
mod model_damage;

use pts::math::stats::Pcg;
use std::path::Path;
use std::time::{Duration, Instant};

/// Much longer than the slowest takes: some hundred million numbers may be read for the smallest file.
const LIMIT: Duration = Duration::from_secs(60);
/// Most memory that all of this may take at a time.
const MEMORY: u64 = 2 << 30;
/// What a count, an offset or a factor may become.
const NUMBERS: [&str; 14] = [
    "0",
    "-1",
    "1",
    "2",
    "3",
    "255",
    "65535",
    "65536",
    "2147483648",
    "4294967295",
    "18446744073709551615",
    "1e308",
    "0.5",
    "5126",
];

fn seeds(folders: &[&str]) -> Vec<Vec<u8>> {
    let mut paths = Vec::new();
    for folder in folders {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
        paths.extend(
            std::fs::read_dir(root)
                .expect("a folder of seeds")
                .flatten()
                .map(|e| e.path()),
        );
    }
    paths.sort();
    paths.retain(|p| p.is_file());
    paths.into_iter().map(|p| std::fs::read(p).expect("a seed")).collect()
}

fn below(rng: &mut Pcg, n: usize) -> usize {
    rng.next_u32() as usize % n.max(1)
}

/// Puts a number in the place of one of a text's. A GLB's lengths stay: the rest is padded or cut.
fn change_number(rng: &mut Pcg, bytes: &mut Vec<u8>) {
    let is_glb = bytes.starts_with(b"glTF") && bytes.len() > 20;
    let (start, end) = if is_glb {
        let length = u32::from_le_bytes([bytes[12], bytes[13], bytes[14], bytes[15]]) as usize;
        (20, (20 + length).min(bytes.len()))
    } else {
        (0, bytes.len())
    };
    let from = start + below(rng, end - start);
    let Some(first) = (from..end).find(|&i| bytes[i].is_ascii_digit()) else {
        return;
    };
    let last = (first..end).find(|&i| !bytes[i].is_ascii_digit()).unwrap_or(end);
    let number = NUMBERS[below(rng, NUMBERS.len())];
    if !is_glb {
        bytes.splice(first..last, number.bytes());
        return;
    }
    // The text keeps its length if spaces at its end can give way.
    let tail = end - bytes[start..end].iter().rev().take_while(|b| **b == b' ').count();
    let mut text = bytes[start..first].to_vec();
    text.extend(number.bytes());
    text.extend(&bytes[last..tail]);
    let grown = text.len().next_multiple_of(4);
    text.resize(grown, b' ');
    bytes.splice(start..end, text);
    bytes[12..16].copy_from_slice(&(grown as u32).to_le_bytes());
}

fn damage(rng: &mut Pcg, seeds: &[Vec<u8>]) -> Vec<u8> {
    let mut bytes = seeds[below(rng, seeds.len())].clone();
    for _ in 0..=below(rng, 4) {
        if bytes.is_empty() {
            break;
        }
        let (at, n) = (below(rng, bytes.len()), 1 + below(rng, 64));
        match below(rng, 9) {
            0 => bytes[at] ^= 1 << below(rng, 8),
            1 => bytes[at] = rng.next_u32() as u8,
            2 => bytes.truncate(at),
            3 => drop(bytes.drain(at..(at + n).min(bytes.len()))),
            4 => {
                let copy = bytes[at..(at + n).min(bytes.len())].to_vec();
                let to = below(rng, bytes.len());
                bytes.splice(to..to, copy);
            }
            5 => {
                let other = &seeds[below(rng, seeds.len())];
                let from = below(rng, other.len());
                let part = other[from..(from + n).min(other.len())].to_vec();
                bytes.splice(at..(at + part.len()).min(bytes.len()), part);
            }
            _ => change_number(rng, &mut bytes),
        }
    }
    bytes
}

/// The most memory that this process ever had, where the system tells.
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:"))?;
    line.trim()
        .strip_suffix("kB")?
        .trim()
        .parse::<u64>()
        .ok()
        .map(|kb| kb << 10)
}

/// Checks the seeds, then damaged copies; at a panic the test says which.
fn run(name: &str, folders: &[&str], check: fn(&[u8])) {
    let seeds = seeds(folders);
    assert!(seeds.len() >= 3, "{name} has only {} seeds", seeds.len());
    let count = std::env::var("PTS_DAMAGE").map_or(1500, |n| n.parse().expect("a number"));
    let mut rng = Pcg::new(7);
    for i in 0..seeds.len() + count {
        let bytes = seeds.get(i).cloned().unwrap_or_else(|| damage(&mut rng, &seeds));
        let begun = Instant::now();
        let result = std::panic::catch_unwind(|| check(&bytes));
        let elapsed = begun.elapsed();
        let memory = peak_memory().unwrap_or(0);
        if result.is_err() || elapsed > LIMIT || memory > MEMORY {
            let file = std::env::temp_dir().join(format!("pts-damage-{name}-{i}"));
            std::fs::write(&file, &bytes).expect("a place for the case");
            let memory = memory >> 20;
            panic!(
                "{name} {i} took {elapsed:?}, at most {memory} MiB so far: see {}",
                file.display()
            );
        }
    }
}

#[test]
fn damaged_gltf_ends_in_an_error_or_a_scene() {
    let folders = ["fuzz/seeds/gltf", "tests/gltf/data", "tests/bad/gltf"];
    run("gltf", &folders, model_damage::check_gltf);
}

#[test]
fn damaged_obj_ends_in_an_error_or_a_scene() {
    run("obj", &["fuzz/seeds/obj", "tests/bad/obj"], model_damage::check_obj);
}

#[test]
fn damaged_pictures_end_in_an_error_or_a_picture() {
    run(
        "picture",
        &["tests/pictures", "tests/bad/images"],
        model_damage::check_picture,
    );
}
