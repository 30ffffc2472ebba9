//! The house rules that a compiler does not check: imports go down only, no bare epsilons, nothing hidden.

use std::fs;
use std::path::{Path, PathBuf};

/// Floors of the house; a module may use modules of lower floors only. `scene` and `render` share a floor and
/// may not use each other; so do `lang`, `import` and `compile`, and `load`, `output` and `study`.
const FLOORS: &[&[&str]] = &[
    &["math", "diag", "files"],
    &["pictures"],
    &["scene", "render"],
    &["lang", "import", "compile"],
    &["load", "output", "study"],
    &["cli"],
];

fn sources(dir: &Path, out: &mut Vec<PathBuf>) {
    let mut entries: Vec<PathBuf> = fs::read_dir(dir).unwrap().map(|e| e.unwrap().path()).collect();
    entries.sort();
    for path in entries {
        if path.is_dir() {
            sources(&path, out);
        } else if path.extension().is_some_and(|e| e == "rs") {
            out.push(path);
        }
    }
}

/// All sources but those of test modules.
fn all_sources() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    sources(&root, &mut files);
    let name = |p: &Path| p.strip_prefix(&root).unwrap().to_string_lossy().into_owned();
    let is_test = |name: &str| name.contains("/tests/") || name.ends_with("/tests.rs");
    let read = |p: &PathBuf| (name(p), fs::read_to_string(p).unwrap());
    files.iter().map(read).filter(|(name, _)| !is_test(name)).collect()
}

fn floor(module: &str) -> Option<(usize, usize)> {
    FLOORS
        .iter()
        .enumerate()
        .find_map(|(f, rooms)| Some((f, rooms.iter().position(|r| *r == module)?)))
}

/// The part of a source before its tests.
fn without_tests(text: &str) -> &str {
    text.split("#[cfg(test)]")
        .next()
        .unwrap()
        .split("#[cfg(all(test")
        .next()
        .unwrap()
}

#[test]
fn imports_go_down_only() {
    let mut wrong = Vec::new();
    for (name, text) in all_sources() {
        let module = name.split(['/', '.']).next().unwrap();
        let Some(own) = floor(module) else { continue };
        for (number, line) in without_tests(&text).lines().enumerate() {
            if line.trim_start().starts_with("//") {
                continue;
            }
            for rest in line.split("crate::").skip(1) {
                let used: String = rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
                let Some(other) = floor(&used) else { continue };
                let sideways = other.0 == own.0 && other.1 != own.1 && own.0 != 0;
                if other.0 > own.0 || sideways {
                    wrong.push(format!("src/{name}:{}: {module} uses {used}", number + 1));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "upward or sideways imports:\n{}", wrong.join("\n"));
}

/// Numbers like 1e-4 in geometry, scattering and light code are almost always a threshold that some scene
/// violates. The few that are not stand here with their reason.
#[test]
fn engine_code_has_no_bare_epsilons() {
    let mut wrong = Vec::new();
    for (name, text) in all_sources() {
        if ![
            "render/shape",
            "render/accel",
            "render/bsdf",
            "render/light",
            "render/geometry",
        ]
        .iter()
        .any(|p| name.starts_with(p))
        {
            continue;
        }
        for (number, line) in without_tests(&text).lines().enumerate() {
            let code = line.split("//").next().unwrap();
            let small = code.match_indices("e-").any(|(i, _)| {
                let before = code[..i].chars().next_back().is_some_and(|c| c.is_ascii_digit());
                let digits: String = code[i + 2..].chars().take_while(char::is_ascii_digit).collect();
                before && digits.parse::<u32>().is_ok_and(|d| d >= 3)
            });
            if small && !line.contains("// reason:") && !code.contains("const ") {
                wrong.push(format!("src/{name}:{}: {}", number + 1, line.trim()));
            }
        }
    }
    assert!(
        wrong.is_empty(),
        "name the bound, or end the line with `// reason: …`:\n{}",
        wrong.join("\n")
    );
}

#[test]
fn files_stay_within_one_room() {
    let long: Vec<String> = all_sources()
        .iter()
        .filter(|(_, text)| text.lines().count() > 500)
        .map(|(name, text)| format!("src/{name}: {} lines", text.lines().count()))
        .collect();
    assert!(long.is_empty(), "split these:\n{}", long.join("\n"));
}

/// The engine's elementary functions are portable ones; the platform's differ in the last bit.
#[test]
fn the_engine_calls_no_platform_functions() {
    let forbidden = [
        ".sin()",
        ".cos()",
        ".sin_cos()",
        ".tan()",
        ".exp()",
        ".ln()",
        ".powf(",
        ".powi(",
        ".acos()",
        ".atan2(",
    ];
    let mut wrong = Vec::new();
    for (name, text) in all_sources() {
        if !name.starts_with("render/") {
            continue;
        }
        for (number, line) in without_tests(&text).lines().enumerate() {
            let code = line.split("//").next().unwrap();
            if forbidden.iter().any(|f| code.contains(f)) || code.contains("mul_add") {
                wrong.push(format!("src/{name}:{}: {}", number + 1, line.trim()));
            }
        }
    }
    assert!(wrong.is_empty(), "use math::portable:\n{}", wrong.join("\n"));
}
