//! What a scene's files hold and its picture does not need is not opened, and takes no memory: half a gigabyte of
//! images, buffers and models that nothing drawn refers to, some of them not even there.

#![allow(unsafe_code)] // `wait4` is the one way to ask for the memory that a child took

use serde_json::{Value, json};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use tempfile::TempDir;

/// Unneeded files and their sizes; together more than 500 MB. Their contents are zeros and no image.
const HUGE: [(&str, u64); 6] = [
    ("huge.bin", 200 << 20),
    ("huge.png", 100 << 20),
    ("glow.png", 100 << 20),
    ("alpha.png", 60 << 20),
    ("huge.glb", 40 << 20),
    ("sky.hdr", 20 << 20),
];

/// What may come on top, in bytes.
const ALLOWED: u64 = 1 << 20;

struct Bench(TempDir);

impl Bench {
    fn new() -> Bench {
        let bench = Bench(tempfile::tempdir().expect("a temporary directory"));
        let wood = [
            [90, 60, 30, 255],
            [200, 150, 90, 255],
            [120, 90, 40, 255],
            [60, 30, 10, 255],
        ];
        let colors = image::ExtendedColorType::Rgba8;
        image::save_buffer(bench.path("wood.png"), wood.as_flattened(), 2, 2, colors).expect("an image is written");
        bench
    }

    fn path(&self, name: &str) -> std::path::PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), content).expect("a file is written");
    }

    /// Files with nothing in them but their size; they take no room on the disk.
    fn add_huge(&self) {
        for (name, size) in HUGE {
            let file = std::fs::File::create(self.path(name)).expect("a file is made");
            file.set_len(size).expect("it is long");
        }
    }

    /// Directories in their place: to open one as a file is an error.
    fn replace_huge_by_directories(&self) {
        for (name, _) in HUGE {
            std::fs::remove_file(self.path(name)).expect("it was there");
            std::fs::create_dir(self.path(name)).expect("a directory is made");
        }
    }

    /// A triangle with a texture; `more` adds everything that nobody needs.
    fn model(&self, more: bool) -> &'static str {
        let corners: [f32; 15] = [-1., -1., 0., 1., -1., 0., 0., 1., 0., 0., 0., 1., 0., 0.5, 1.];
        self.write("tri.bin", corners.map(f32::to_le_bytes).as_flattened());
        let mut model = json!({
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0}]}],
            "accessors": [
                {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [-1, -1, 0], "max": [1, 1, 0]},
                {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"},
            ],
            "bufferViews": [
                {"buffer": 0, "byteOffset": 0, "byteLength": 36},
                {"buffer": 0, "byteOffset": 36, "byteLength": 24},
            ],
            "buffers": [{"uri": "tri.bin", "byteLength": 60}],
            "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicFactor": 0}}],
            "textures": [{"source": 0}],
            "images": [{"uri": "wood.png"}],
        });
        if more {
            let mut add = |table: &str, element: Value| {
                model[table].as_array_mut().expect("a table").push(element);
            };
            add("scenes", json!({"nodes": [1], "name": "other"}));
            add("nodes", json!({"mesh": 1}));
            add(
                "meshes",
                json!({"primitives": [{"attributes": {"POSITION": 2}, "material": 1}]}),
            );
            let accessor = json!({"bufferView": 2, "componentType": 5126, "count": 9_000_000, "type": "VEC3"});
            add("accessors", accessor);
            add("bufferViews", json!({"buffer": 1, "byteLength": 108_000_000}));
            add("buffers", json!({"uri": "huge.bin", "byteLength": 209_715_200}));
            add("materials", json!({"name": "spare", "emissiveTexture": {"index": 1}}));
            for (image, uri) in ["huge.png", "glow.png", "missing.png"].into_iter().enumerate() {
                add("textures", json!({"source": image + 1}));
                add("images", json!({"uri": uri}));
            }
            // Emission is multiplied by a factor that is 0 unless it is given.
            model["materials"][0]["emissiveTexture"] = json!({"index": 2});
        }
        self.write("a.gltf", model.to_string());
        "a.gltf"
    }

    /// A text scene; `more` adds everything that nobody needs.
    fn text(&self, more: bool) -> &'static str {
        let mut text = "#version 3.8;
            camera { location <0, 1, -5> look_at 0 angle 40 }
            light_source { <2, 4, -3> rgb 1 }
            sphere { 0, 1 pigment { uv_mapping image_map { png \"wood.png\" } } }\n"
            .to_owned();
        if more {
            text += "
            #declare Spare = pigment { image_map { png \"huge.png\" } };
            #declare Thing = sphere { 0, 1 pigment { image_map { png \"alpha.png\" } } };
            #declare Model = gltf { \"huge.glb\" };
            #declare Nowhere = gltf { \"missing.glb\" };
            environment { image \"sky.hdr\" strength 0 }\n";
        }
        self.write("a.pts", text);
        "a.pts"
    }

    /// An OBJ with a material library; `more` adds everything that nobody needs.
    fn object(&self, more: bool) -> &'static str {
        let mut library = "newmtl wood\nKd 1 1 1\nmap_Kd wood.png\n".to_owned();
        if more {
            library += "newmtl spare\nKd 1 1 1\nmap_Kd huge.png\nmap_d alpha.png\nmap_Ke missing.png\n";
        }
        self.write("a.mtl", library);
        let corners = "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n";
        self.write("a.obj", format!("mtllib a.mtl\n{corners}usemtl wood\nf 1/1 2/2 3/3\n"));
        "a.obj"
    }

    fn command(&self, words: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_pts"));
        command.current_dir(self.0.path()).args(words);
        command
    }

    fn render(&self, scene: &str) -> Command {
        self.command(&["render", scene, "-r", "16x16", "-s", "1", "-j", "1", "-o", "out.png"])
    }

    fn picture(&self, scene: &str) -> Vec<u8> {
        let output = self.render(scene).output().expect("it starts");
        let told = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{scene}: {told}");
        for (name, _) in HUGE {
            assert!(!told.contains(&format!("warning: {name}")), "{scene}: {told}");
        }
        let picture = image::open(self.path("out.png")).expect("a picture");
        picture.into_rgb8().into_raw()
    }
}

/// The largest memory that a program had, in bytes: the least of three runs, since the pages that the system lends
/// vary a little.
fn peak_memory(command: &mut Command) -> u64 {
    let runs = (0..3).map(|_| {
        let child = command
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("it starts");
        memory_of(child)
    });
    runs.min().expect("three runs")
}

#[cfg(target_os = "linux")]
fn memory_of(child: Child) -> u64 {
    let (mut status, pid) = (0, child.id() as libc::pid_t);
    // SAFETY: both pointers are to values of our own; the child was started here and is waited for nowhere else.
    let (found, usage) = unsafe {
        let mut usage = std::mem::zeroed::<libc::rusage>();
        (libc::wait4(pid, &mut status, 0, &mut usage), usage)
    };
    assert!(found == pid && status == 0, "the child ended with status {status}");
    usage.ru_maxrss as u64 * 1024
}

type Write = fn(&Bench, bool) -> &'static str;

const KINDS: [Write; 3] = [Bench::model, Bench::text, Bench::object];

#[test]
#[cfg(target_os = "linux")]
fn unneeded_files_take_no_memory() {
    let total: u64 = HUGE.iter().map(|(_, size)| size).sum();
    assert!(total >= 500_000_000);
    for write in KINDS {
        let bench = Bench::new();
        let scene = write(&bench, false);
        let without = peak_memory(&mut bench.render(scene));
        write(&bench, true);
        bench.add_huge();
        let with = peak_memory(&mut bench.render(scene));
        assert!(
            with < without + ALLOWED,
            "{scene}: {with} bytes at most, and {without} without the files"
        );
    }
}

/// The same picture, whether the files are there, are directories, or are not written of at all.
#[test]
fn unneeded_files_are_not_opened() {
    for write in KINDS {
        let bench = Bench::new();
        let scene = write(&bench, false);
        let plain = bench.picture(scene);
        write(&bench, true);
        bench.add_huge();
        assert_eq!(bench.picture(scene), plain, "{scene}");
        if let Some(opened) = opened_by(&mut bench.render(scene), bench.0.path()) {
            assert!(
                opened.iter().any(|line| line.contains("wood.png")),
                "{scene}: {opened:#?}"
            );
            for (name, _) in HUGE {
                assert!(
                    !opened.iter().any(|line| line.contains(name)),
                    "{scene} opens {name}: {opened:#?}"
                );
            }
        }
        bench.replace_huge_by_directories();
        assert_eq!(bench.picture(scene), plain, "{scene}");
    }
}

/// The calls that open files, as `strace` tells; `None` where there is none.
fn opened_by(command: &mut Command, directory: &Path) -> Option<Vec<String>> {
    let log = directory.join("calls");
    let mut traced = Command::new("strace");
    traced.args(["-f", "-e", "trace=open,openat,creat", "-o"]).arg(&log);
    traced.arg(command.get_program()).args(command.get_args());
    let status = traced.current_dir(directory).stderr(Stdio::null()).status().ok()?;
    // Where processes must not be traced it fails, and there is nothing to read.
    let calls = std::fs::read_to_string(&log).ok().filter(|_| status.success())?;
    Some(calls.lines().map(str::to_owned).collect())
}

/// Of a text it names the files that only unused declarations name, with their places.
#[test]
fn inspect_names_files_of_unused_declarations() {
    let bench = Bench::new();
    bench.text(true);
    bench.add_huge();
    let output = bench
        .command(&["inspect", "a.pts", "--json"])
        .output()
        .expect("it starts");
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.success() && told.contains("note"),
        "a missing model is a note: {told}"
    );
    let found: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let pruned = found["pruned"].as_array().expect("a list");
    let named = |name: &str| {
        pruned
            .iter()
            .find(|p| p["name"].as_str().is_some_and(|n| n.ends_with(name)))
            .cloned()
    };
    for (name, kind) in [
        ("huge.png", "image"),
        ("alpha.png", "image"),
        ("huge.glb", "model"),
        ("sky.hdr", "image"),
    ] {
        let told = named(name).unwrap_or_else(|| panic!("{name} is not told: {pruned:#?}"));
        let size = HUGE.iter().find(|(huge, _)| *huge == name).map(|(_, size)| *size);
        assert_eq!(
            (&told["kind"], told["saved"]["bytes"].as_u64()),
            (&kind.into(), size),
            "{told}"
        );
    }
    assert_eq!(named("huge.png").map(|p| p["place"].clone()), Some("a.pts:6:56".into()));
    assert_eq!(found["files"], json!(["a.pts", "wood.png"]));
}

/// `inspect` names what is not opened, with sizes, and what is not there as no mistake.
#[test]
fn inspect_names_what_is_not_opened() {
    let bench = Bench::new();
    bench.model(true);
    bench.add_huge();
    let output = bench
        .command(&["inspect", "a.gltf", "--json"])
        .output()
        .expect("it starts");
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{told}");
    let found: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let pruned = found["pruned"].as_array().expect("a list");
    let about = |name: &str| {
        let of = pruned.iter().find(|p| p["name"] == name);
        of.unwrap_or_else(|| panic!("{name} is not told: {pruned:#?}")).clone()
    };
    for (name, size) in [
        ("huge.bin", 200 << 20),
        ("huge.png", 100 << 20),
        ("glow.png", 100 << 20),
    ] {
        let told = about(name);
        assert_eq!(told["saved"]["files"], json!([name]), "{told}");
        assert_eq!(told["saved"]["bytes"], json!(size), "{told}");
    }
    let missing = about("missing.png")["why"].to_string();
    assert!(missing.contains("not there"), "{missing}");
    assert_eq!(about("other")["kind"], "scene");
    assert_eq!(about("spare")["kind"], "material");
    let files: Vec<&str> = found["files"]
        .as_array()
        .expect("files")
        .iter()
        .filter_map(Value::as_str)
        .collect();
    assert_eq!(files, ["a.gltf", "tri.bin", "wood.png"]);
}
