#!/usr/bin/env python3
"""What effects cost in instructions, counted by valgrind's callgrind with set-up subtracted: the difference of two runs
that differ in samples alone. Prints the tables of docs/effects.md.

    cargo build --release && python3 tests/bench/effects/prices.py [kernels] [used] [unused]

Needs valgrind and takes some minutes.
"""
import re
import subprocess
import sys
import tempfile
import zlib
import struct
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
PTS = ROOT / "target/release/pts"
SIZE = (40, 30)
SAMPLES = (4, 12)

# A room of 2x2x4 with a lamp in its ceiling, closed around the camera, and two balls. {CAMERA}, {WALL}, {BALL} and {REST}
# are where variants differ.
ROOM = """
camera {{ location <0, 1, -2.6> look_at <0, 0.9, 0> angle 50 right x*4/3 {CAMERA} }}
#declare White = material {{ diffuse {{ color rgb 0.7 }} }}
#declare Wall = material {{ {WALL} }}
#declare Ball = material {{ {BALL} }}
#macro Quad(A, B, C, M) mesh2 {{
  vertex_vectors {{ 4, A, B, B + C - A, C }}
  uv_vectors {{ 4, <0, 0>, <1, 0>, <1, 1>, <0, 1> }}
  face_indices {{ 2, <0, 1, 2>, <0, 2, 3> }}
  material {{ M }}
}} #end
Quad(<-1, 0, -3>, <1, 0, -3>, <-1, 0, 1>, Wall)
Quad(<-1, 2, -3>, <-1, 2, 1>, <1, 2, -3>, White)
Quad(<-1, 0, 1>, <1, 0, 1>, <-1, 2, 1>, Wall)
Quad(<-1, 0, -3>, <-1, 2, -3>, <1, 0, -3>, White)
Quad(<-1, 0, -3>, <-1, 0, 1>, <-1, 2, -3>, White)
Quad(<1, 0, -3>, <1, 2, -3>, <1, 0, 1>, White)
Quad(<-0.3, 2, -0.3>, <-0.3, 2, 0.3>, <0.3, 2, -0.3>, material {{ diffuse {{ color rgb 0 }} emission rgb 12 }})
sphere {{ <-0.45, 0.35, 0.3>, 0.35 material {{ Ball }} }}
sphere {{ <0.45, 0.35, -0.2>, 0.35 material {{ Ball }} }}
{REST}
"""
DIFFUSE = "diffuse { color rgb 0.7 }"
# What makes the balls, the camera, the walls or the air ask for an effect.
USED = {
    "textures": {"WALL": 'diffuse { color pigment { uv_mapping image_map { png "checks.png" } } }'},
    "bump": {"WALL": 'texture { pigment { rgb 0.7 } finish { diffuse 1 } normal { uv_mapping bump_map { png "checks.png" bump_size 0.1 } } }'},
    "alpha": {"BALL": "texture { pigment { rgbt <0.7, 0.7, 0.7, 0.5> } finish { diffuse 1 } }"},
    "media": {"REST": "media { scattering { 1, rgb 0.3 } }"},
    "media (absorption in glass)": {"BALL": "glass { color rgb 1 ior 1.5 absorption rgb <1, 2, 3> }"},
    "media (fog)": {"REST": "fog { distance 8 color rgb 0.5 }"},
    "dispersion": {"BALL": "glass { color rgb 1 ior 1.5 dispersion 30 }"},
    "lens": {"CAMERA": "lens_radius 0.05 focus_distance 2.6"},
    "motion": {"REST": "render { shutter 1 } sphere { <0, 1.2 + 0.2*clock, 0>, 0.2 material { Ball } }"},
    "environment": {"REST": "environment { color rgb 0.2 }"},
    "specular": {"BALL": "specular { color rgb 0.9 }"},
    "glass": {"BALL": "glass { color rgb 1 ior 1.5 }"},
    "glossy": {"BALL": "glossy { color rgb 0.7 roughness 0.3 }"},
    "translucent": {"BALL": "translucent { color rgb 0.7 transmit 0.5 }"},
}
# The same effects asked for by one pebble behind the camera, of a seventh of the balls' size.
PEBBLE = "sphere {{ <0.5, 0.05, -2.9>, 0.05 material {{ {} }} }}"
PRESENT = {
    "textures": 'diffuse { color pigment { uv_mapping image_map { png "checks.png" } } }',
    "alpha": USED["alpha"]["BALL"],
    "media": "glass { color rgb 1 ior 1.5 absorption rgb <1, 2, 3> }",
    "dispersion": USED["dispersion"]["BALL"],
    "specular": USED["specular"]["BALL"],
    "glass": USED["glass"]["BALL"],
    "glossy": USED["glossy"]["BALL"],
    "translucent": USED["translucent"]["BALL"],
}
PRESENT_REST = {"motion": "render { shutter 1 } sphere { <0.5, 0.05 + 0.01*clock, -2.9>, 0.05 material { White } }"}
# Declared, and without any effect.
UNUSED = {
    "material": "#declare Spare = material { glass { color rgb 1 ior 1.5 dispersion 30 } }",
    "image": '#declare Spare = texture { pigment { image_map { png "missing.png" } } }',
    "dark lamp": "light_source { <0, 1, 0>, rgb 0 }",
    "black sky": "environment { color rgb 0 }",
    "fog of no density": "fog { distance 0 color rgb 0.5 }",
    "empty medium": "media { absorption rgb 0 }",
    "shutter over what stands still": "render { shutter 1 }",
    "full coverage": "sphere { <0, 5, 0>, 0.01 pigment { rgbt <1, 1, 1, 0> } no_shadow no_image no_reflection }",
}
UNUSED_CAMERA = {"lens of radius 0": "lens_radius 0 focus_distance 2.6"}


def checks(path):
    """An 8x8 checkerboard of greys, as PNG."""
    rows = b"".join(b"\0" + bytes(60 if (x + y) % 2 else 200 for x in range(8)) for y in range(8))

    def chunk(kind, data):
        crc = struct.pack(">I", zlib.crc32(kind + data))
        return struct.pack(">I", len(data)) + kind + data + crc

    header = struct.pack(">IIBBBBB", 8, 8, 8, 0, 0, 0, 0)
    parts = [chunk(b"IHDR", header), chunk(b"IDAT", zlib.compress(rows)), chunk(b"IEND", b"")]
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + b"".join(parts))


def count(scene, *flags):
    """Instructions per sample of a pixel."""
    at = []
    for spp in SAMPLES:
        command = ["valgrind", "--tool=callgrind", "--cache-sim=no", "--callgrind-out-file=/dev/null", PTS, "render"]
        command += [scene, "-o", Path(scratch.name) / "out.exr", "--width", SIZE[0], "--height", SIZE[1], "--seed", 1]
        command += ["--spp", spp, "--threads", 1, "-qq", *flags]
        ran = subprocess.run([str(word) for word in command], capture_output=True, text=True, cwd=scratch.name)
        found = re.search(r"Collected : (\d+)", ran.stderr)
        if ran.returncode or not found:
            sys.exit(f"{scene} {' '.join(flags)}:\n{ran.stderr}")
        at.append(int(found.group(1)))
    return (at[1] - at[0]) / ((SAMPLES[1] - SAMPLES[0]) * SIZE[0] * SIZE[1])


def room(**parts):
    path = Path(scratch.name) / "room.pts"
    path.write_text(ROOM.format(**{"CAMERA": "", "WALL": DIFFUSE, "BALL": DIFFUSE, "REST": "", **parts}))
    return path


def kernels():
    print("| scene | its own kernel | instructions per sample | all effects forced | own / all |\n|---|---|---|---|---|")
    for name in ["cornell_quads", "cornell", "spiral"]:
        scene = ROOT / f"scenes/{name}.pts"
        own, everything = count(scene), count(scene, "--force-effects", "all")
        print(f"| `{name}` | surfaces | {own:.0f} | {everything:.0f} | {own / everything:.3f} |", flush=True)
    print("\n| scene | effect forced | ratio to its own kernel |\n|---|---|---|")
    for name in ["cornell_quads", "cornell", "spiral"]:
        scene = ROOT / f"scenes/{name}.pts"
        own = count(scene)
        for effect in ["textures", "alpha", "media", "motion"]:
            print(f"| `{name}` | {effect} | {count(scene, '--force-effects', effect) / own:.3f} |", flush=True)


def used():
    plain = count(room())
    print(f"| effect | used | merely present |\n|---|---|---|\n| (the room without any) | {plain:.0f} instructions | |")
    for effect, parts in USED.items():
        row = f"{count(room(**parts)) / plain:.3f}"
        rest = PRESENT_REST.get(effect) or (PEBBLE.format(PRESENT[effect]) if effect in PRESENT else None)
        present = f"{count(room(REST=rest)) / plain:.3f}" if rest else ""
        print(f"| {effect} | {row} | {present} |", flush=True)


def unused():
    plain = count(room())
    print("| declared, without effect | ratio |\n|---|---|")
    for what, rest in UNUSED.items():
        print(f"| {what} | {count(room(REST=rest)) / plain:.4f} |", flush=True)
    for what, camera in UNUSED_CAMERA.items():
        print(f"| {what} | {count(room(CAMERA=camera)) / plain:.4f} |", flush=True)


with tempfile.TemporaryDirectory() as folder:

    class scratch:
        name = folder

    checks(Path(folder) / "checks.png")
    for part in sys.argv[1:] or ["kernels", "used", "unused"]:
        {"kernels": kernels, "used": used, "unused": unused}[part]()
        print()
