"""Time and memory of loading large GLBs: parse, decode, build of the tree.

    python3 tests/bench/loading.py [PTS] [FOLDER]

PTS is the program (default target/release/pts), FOLDER keeps the generated files (default target/bench). Each file is
inspected on two cores, which reads it, decodes its images and builds its trees but renders nothing. Printed are CPU
and wall seconds, both also for each million triangles (goal: wall <= 1.5 on two quiet cores), and the peak of memory,
also as a multiple of what the program holds in the end (goal: <= 3). CPU seconds hold on a busy machine too.
Needs numpy.
"""
import json, os, pathlib, struct, subprocess, sys, tempfile, time, zlib
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]


def png(pixels):
    height, width, _ = pixels.shape
    rows = np.concatenate([np.zeros((height, 1), np.uint8), pixels.reshape(height, -1)], axis=1).tobytes()
    chunk = lambda t, d: struct.pack(">I", len(d)) + t + d + struct.pack(">I", zlib.crc32(t + d))
    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows, 1)) + chunk(b"IEND", b"")


class Glb:
    def __init__(self):
        self.blobs, self.length, self.json = [], 0, {"asset": {"version": "2.0"}, "bufferViews": [], "accessors": []}

    def view(self, data):
        data += b"\0" * (-len(data) % 4)
        self.json["bufferViews"].append({"buffer": 0, "byteOffset": self.length, "byteLength": len(data)})
        self.blobs.append(data)
        self.length += len(data)
        return len(self.json["bufferViews"]) - 1

    def accessor(self, array, kind, component):
        view = self.view(array.tobytes())
        self.json["accessors"].append({"bufferView": view, "componentType": component, "count": len(array), "type": kind})
        return len(self.json["accessors"]) - 1

    def write(self, path, primitives):
        self.json |= {"scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}], "meshes": [{"primitives": primitives}],
                      "buffers": [{"byteLength": self.length}]}
        text = json.dumps(self.json).encode()
        text += b" " * (-len(text) % 4)
        with open(path, "wb") as f:
            f.write(b"glTF" + struct.pack("<IIII", 2, 28 + len(text) + self.length, len(text), 0x4E4F534A) + text)
            f.write(struct.pack("<II", self.length, 0x4E4942) + b"".join(self.blobs))


def sheet(glb, side, attributes, shift=0.0):
    """A bumpy sheet of 2 (side - 1)^2 triangles."""
    rng = np.random.default_rng(1)
    line = np.linspace(0, 1, side, dtype=np.float32)
    u, v = np.meshgrid(line, line, indexing="ij")
    height = 0.05 * np.sin(37 * u) * np.cos(29 * v) + 0.002 * rng.random((side, side), dtype=np.float32)
    flat = lambda *columns: np.stack(columns, -1).reshape(-1, len(columns)).astype("<f4")
    out = {"POSITION": glb.accessor(flat(u + shift, height, v), "VEC3", 5126)}
    if "n" in attributes:
        n = flat(-1.85 * np.cos(37 * u) * np.cos(29 * v), np.ones_like(u), 1.45 * np.sin(37 * u) * np.sin(29 * v))
        n /= np.linalg.norm(n, axis=1, keepdims=True)
        out["NORMAL"] = glb.accessor(n.astype("<f4"), "VEC3", 5126)
    if "u" in attributes:
        out["TEXCOORD_0"] = glb.accessor(flat(u, v), "VEC2", 5126)
    if "t" in attributes:
        out["TANGENT"] = glb.accessor(np.tile(np.array([1, 0, 0, 1], "<f4"), (side * side, 1)), "VEC4", 5126)
    i, j = np.meshgrid(np.arange(side - 1), np.arange(side - 1), indexing="ij")
    a = (i * side + j).reshape(-1)
    corners = np.stack([a, a + 1, a + side, a + side, a + 1, a + side + 1], -1).reshape(-1).astype("<u4")
    return {"attributes": out, "indices": glb.accessor(corners, "SCALAR", 5125)}


def textures(glb, count, size):
    rng = np.random.default_rng(2)
    ramp = np.linspace(0, 200, size)[:, None, None]
    images = []
    for _ in range(count):
        noise = rng.integers(0, 24, (size, size, 3))
        images.append({"bufferView": glb.view(png((ramp + noise).astype(np.uint8))), "mimeType": "image/png"})
    glb.json["images"] = images
    glb.json["textures"] = [{"source": i} for i in range(count)]
    glb.json["materials"] = [{"pbrMetallicRoughness": {"baseColorTexture": {"index": i}}} for i in range(count)]


def make(folder):
    """Generates the files that are not there yet; their names with their triangles."""
    plain = {"positions": (1500, ""), "normals-uvs": (1300, "nu"), "tangents": (1150, "nut"), "mikktspace": (1150, "nu")}
    files = {}
    for name, (side, attributes) in plain.items():
        path = folder / f"{name}.glb"
        files[path] = 2 * (side - 1) ** 2
        if not path.exists():
            glb = Glb()
            primitive = sheet(glb, side, attributes)
            if name in ("tangents", "mikktspace"):
                textures(glb, 1, 64)
                glb.json["materials"] = [{"normalTexture": {"index": 0}}]
                primitive["material"] = 0
            glb.write(path, [primitive])
    path = folder / "parts.glb"
    files[path] = 25 * 2 * 249**2
    if not path.exists():
        glb = Glb()
        glb.write(path, [sheet(glb, 250, "nu", 1.1 * k) for k in range(25)])
    path = folder / "textures.glb"
    files[path] = 16 * 2
    if not path.exists():
        glb = Glb()
        textures(glb, 16, 2048)
        glb.write(path, [sheet(glb, 2, "u", 1.1 * k) | {"material": k} for k in range(16)])
    return files


def measure(program, path):
    """Wall, CPU seconds, peak and final bytes of one run."""
    begun = time.monotonic()
    with tempfile.TemporaryFile() as out:
        cores = set(sorted(os.sched_getaffinity(0))[:2])
        limit = lambda: os.sched_setaffinity(0, cores)
        command = [program, "inspect", "--json", str(path)]
        child = subprocess.Popen(command, stdout=out, stderr=subprocess.DEVNULL, preexec_fn=limit)
        _, status, usage = os.wait4(child.pid, 0)
        wall = time.monotonic() - begun
        assert status == 0, f"{path}: status {status}"
        out.seek(0)
        found = json.load(out)
    held = found["mesh_bytes"] + found["image_bytes"]
    return wall, usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024, held


def main():
    program = sys.argv[1] if len(sys.argv) > 1 else str(ROOT / "target/release/pts")
    folder = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else ROOT / "target/bench"
    folder.mkdir(parents=True, exist_ok=True)
    print(f"{'file':16} {'MB':>5} {'triangles':>10} {'wall':>6} {'CPU':>6} {'wall/1e6':>8} {'CPU/1e6':>8} {'peak MB':>8} {'x held':>6}")
    for path, triangles in make(folder).items():
        wall, cpu, peak, held = min(measure(program, path) for _ in range(3))
        each = max(triangles, 1) / 1e6
        rates = f"{wall / each:8.2f} {cpu / each:8.2f}" if triangles > 1000 else f"{'':8} {'':8}"
        size = path.stat().st_size / 1e6
        print(f"{path.stem:16} {size:5.0f} {triangles:10} {wall:6.2f} {cpu:6.2f} {rates} {peak / 1e6:8.0f} {peak / held:6.2f}")


main()
