"""Writes the seeds of the fuzz targets: small files that use as much of the formats as fits. Run it in this folder."""
import base64, json, struct, zlib

def png(w, h):
    rows = b"".join(b"\0" + b"".join(bytes((x * 40 % 256, y * 60 % 256, 128, 255 - x)) for x in range(w)) for y in range(h))
    chunk = lambda t, d: struct.pack(">I", len(d)) + t + d + struct.pack(">I", zlib.crc32(t + d))
    head = struct.pack(">IIBBBBB", w, h, 8, 6, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b"")

class Model:
    def __init__(self):
        self.bin, self.views, self.accessors = b"", [], []
    def view(self, data, **extra):
        self.bin += b"\0" * (-len(self.bin) % 4)
        self.views.append({"buffer": 0, "byteOffset": len(self.bin), "byteLength": len(data), **extra})
        self.bin += data
        return len(self.views) - 1
    def accessor(self, kind, component, values, **extra):
        code = {5120: "b", 5121: "B", 5122: "h", 5123: "H", 5125: "I", 5126: "f"}[component]
        width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT4": 16}[kind]
        view = self.view(struct.pack("<%d%s" % (len(values), code), *values))
        self.accessors.append({"bufferView": view, "componentType": component, "count": len(values) // width, "type": kind, **extra})
        return len(self.accessors) - 1

def rich():
    m = Model()
    square = [0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0]
    p = m.accessor("VEC3", 5126, square, min=[0, 0, 0], max=[1, 1, 0])
    n = m.accessor("VEC3", 5126, [0, 0, 1] * 4)
    t = m.accessor("VEC4", 5126, [1, 0, 0, 1] * 4)
    uv = m.accessor("VEC2", 5126, [0, 1, 1, 1, 0, 0, 1, 0])
    uv1 = m.accessor("VEC2", 5123, [0, 65535, 65535, 65535, 0, 0, 65535, 0], normalized=True)
    c = m.accessor("VEC4", 5121, [255, 128, 0, 255] * 4, normalized=True)
    j = m.accessor("VEC4", 5121, [0, 1, 0, 0] * 4)
    w = m.accessor("VEC4", 5126, [0.5, 0.5, 0, 0] * 4)
    i = m.accessor("SCALAR", 5123, [0, 1, 2, 2, 1, 3])
    strip = m.accessor("SCALAR", 5121, [0, 1, 2, 3])
    small = m.accessor("VEC3", 5120, [0, 0, 0, 127, 0, 0, 0, 127, 0], normalized=True)
    delta = m.accessor("VEC3", 5126, [0, 0, 0.5] * 4)
    places = m.view(struct.pack("<HH", 1, 3)); values = m.view(struct.pack("<6f", 0, 0, 1, 0, 0, 2))
    m.accessors.append({"componentType": 5126, "count": 4, "type": "VEC3", "sparse": {"count": 2,
        "indices": {"bufferView": places, "componentType": 5123}, "values": {"bufferView": values}}})
    sparse = len(m.accessors) - 1
    inverse = m.accessor("MAT4", 5126, [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] * 2)
    many = m.accessor("VEC3", 5126, [2, 0, 0, 4, 0, 0])
    turn = m.accessor("VEC4", 5122, [0, 23170, 0, 23170] * 2, normalized=True)
    times = m.accessor("SCALAR", 5126, [0, 0.5, 1], min=[0], max=[1])
    moves = m.accessor("VEC3", 5126, [0, 0, 0, 1, 0, 0, 1, 1, 0])
    spins = m.accessor("VEC4", 5126, [0, 0, 0, 1, 0, 1, 0, 0, 0, 0, 0, 1])
    weights = m.accessor("SCALAR", 5126, [0, 0, 1, 0, 0, 1])
    packed = bytes.fromhex("a0" + "".join("03" + d + "00" * 13 for d in ("000201", "000002", "000000", "000000")) + "00" * 32)
    stream = m.view(packed)
    m.views.append({"buffer": 0, "byteLength": 12, "byteStride": 4, "extensions": {"EXT_meshopt_compression": {"buffer": 0,
        "byteOffset": m.views[stream]["byteOffset"], "byteLength": len(packed), "byteStride": 4, "count": 3, "mode": "ATTRIBUTES"}}})
    m.accessors.append({"bufferView": len(m.views) - 1, "componentType": 5121, "count": 3, "type": "VEC3"})
    unpacked = len(m.accessors) - 1
    picture = m.view(png(5, 4))
    ktx2 = open("../../tests/pictures/ramp-rgba-etc1s.ktx2", "rb").read()
    info = lambda k=0, **e: {"index": k, "extensions": {"KHR_texture_transform": {"offset": [0.5, 0], "rotation": 0.3, "scale": [2, -2]}}, **e}
    glass = {"KHR_materials_transmission": {"transmissionFactor": 0.9, "transmissionTexture": info()}, "KHR_materials_ior": {"ior": 1.4},
        "KHR_materials_volume": {"thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [0.5, 0.9, 0.7]},
        "KHR_materials_dispersion": {"dispersion": 1}}
    coat = {"KHR_materials_clearcoat": {"clearcoatFactor": 1, "clearcoatRoughnessFactor": 0.2, "clearcoatNormalTexture": info()},
        "KHR_materials_sheen": {"sheenColorFactor": [0.2, 0.3, 0.4], "sheenRoughnessFactor": 0.5},
        "KHR_materials_specular": {"specularFactor": 0.5, "specularColorFactor": [1, 0.5, 0.2]},
        "KHR_materials_anisotropy": {"anisotropyStrength": 0.6, "anisotropyRotation": 1, "anisotropyTexture": info()},
        "KHR_materials_iridescence": {"iridescenceFactor": 1, "iridescenceThicknessTexture": info()},
        "KHR_materials_emissive_strength": {"emissiveStrength": 3},
        "KHR_materials_diffuse_transmission": {"diffuseTransmissionFactor": 0.3}}
    old = {"KHR_materials_pbrSpecularGlossiness": {"diffuseTexture": info(), "specularFactor": [0.2, 0.2, 0.2], "glossinessFactor": 0.4}}
    one = {"attributes": {"POSITION": p, "NORMAL": n, "TANGENT": t, "TEXCOORD_0": uv, "TEXCOORD_1": uv1, "COLOR_0": c, "JOINTS_0": j,
        "WEIGHTS_0": w}, "indices": i, "material": 0, "targets": [{"POSITION": delta}, {"POSITION": sparse, "NORMAL": sparse}],
        "extensions": {"KHR_materials_variants": {"mappings": [{"material": 1, "variants": [0]}]}}}
    m.json = {"asset": {"version": "2.0", "generator": "seed"}, "scene": 0, "scenes": [{"name": "s", "nodes": [0, 1, 5, 6, 7]}, {}],
        "extensionsUsed": ["KHR_texture_transform"], "extensionsRequired": ["KHR_mesh_quantization"],
        "nodes": [{"mesh": 0, "skin": 0, "weights": [0.5, 0.25]}, {"children": [2, 3, 4], "rotation": [0, 0, 0, 1]}, {"camera": 0,
            "translation": [0, 0, 5], "extensions": {"KHR_lights_punctual": {"light": 0}}}, {"mesh": 1, "matrix": [1, 0, 0, 0, 0.5, 1, 0,
            0, 0, 0, -1, 0, 3, 0, 0, 1]}, {"camera": 1, "extensions": {"KHR_lights_punctual": {"light": 1}, "KHR_node_visibility":
            {"visible": False}}}, {"mesh": 1, "extensions": {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": many, "ROTATION":
            turn}}}}, {"scale": [1, 0, 1], "mesh": 2}, {"mesh": 2, "extensions": {"KHR_lights_punctual": {"light": 2}}}],
        "meshes": [{"weights": [1, 0], "primitives": [one]}, {"primitives": [{"attributes": {"POSITION": p, "TEXCOORD_0": uv, "NORMAL": n},
            "indices": strip, "mode": 5, "material": 1}, {"attributes": {"POSITION": small}, "material": 2}]},
            {"primitives": [{"attributes": {"POSITION": unpacked}}, {"attributes": {"POSITION": p}, "mode": 6}, {"attributes":
            {"POSITION": p}, "mode": 0}]}],
        "materials": [{"name": "a", "pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0.2, 0.8], "baseColorTexture": info(),
            "metallicRoughnessTexture": info(1)}, "normalTexture": info(scale=0.5), "occlusionTexture": info(), "emissiveFactor": [1, 1, 0],
            "emissiveTexture": info(texCoord=1), "alphaMode": "MASK", "alphaCutoff": 0.3, "doubleSided": True, "extensions": coat},
            {"pbrMetallicRoughness": {"metallicFactor": 0}, "extensions": glass, "normalTexture": info(1)}, {"extensions": old,
            "alphaMode": "BLEND"}, {"extensions": {"KHR_materials_unlit": {}}}],
        "textures": [{"source": 0, "sampler": 0}, {"source": 0, "extensions": {"KHR_texture_basisu": {"source": 1}}}],
        "samplers": [{"magFilter": 9728, "wrapS": 33071, "wrapT": 33648}],
        "images": [{"bufferView": picture, "mimeType": "image/png"}, {"uri": "data:image/ktx2;base64," + base64.b64encode(ktx2).decode()}],
        "skins": [{"joints": [1, 2], "inverseBindMatrices": inverse, "skeleton": 1}],
        "cameras": [{"type": "perspective", "perspective": {"yfov": 1, "znear": 0.1, "aspectRatio": 1.5}}, {"type": "orthographic",
            "orthographic": {"xmag": 2, "ymag": 1, "znear": 0, "zfar": 9}}],
        "animations": [{"channels": [{"sampler": 0, "target": {"node": 1, "path": "translation"}}, {"sampler": 1, "target": {"node": 2,
            "path": "rotation"}}, {"sampler": 2, "target": {"node": 0, "path": "weights"}}], "samplers": [{"input": times, "output": moves},
            {"input": times, "output": spins, "interpolation": "STEP"}, {"input": times, "output": weights}]}],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "spot", "intensity": 3, "range": 9, "spot": {"outerConeAngle": 0.7,
            "innerConeAngle": 0.2}}, {"type": "directional", "color": [1, 0.9, 0.8]}, {"type": "point"}]}, "KHR_materials_variants":
            {"variants": [{"name": "v"}]}},
        "accessors": m.accessors, "bufferViews": m.views}
    return m

def write(m, name):
    text = dict(m.json, buffers=[{"byteLength": len(m.bin), "uri": "data:application/octet-stream;base64," + base64.b64encode(m.bin).decode()}])
    open("gltf/%s.gltf" % name, "w").write(json.dumps(text))
    head = json.dumps(dict(m.json, buffers=[{"byteLength": len(m.bin)}])).encode()
    head += b" " * (-len(head) % 4); data = m.bin + b"\0" * (-len(m.bin) % 4)
    open("gltf/%s.glb" % name, "wb").write(b"glTF" + struct.pack("<IIII", 2, 28 + len(head) + len(data), len(head), 0x4E4F534A)
        + head + struct.pack("<II", len(data), 0x4E4942) + data)

OBJ = """# seed
mtllib model.mtl
o one
g group other
v 0 0 0
v 1 0 0 1 0 0
v 1 1 0 1 0.5 0.25 0.1
v 0 1 0
v 0.5 0.5 1 \\
1.0
vt 0 0
vt 1 0
vt 1 1 0
vt 0 1
vn 0 0 1
vn 0 0.6 0.8
usemtl a
s 1
f 1/1/1 2/2/1 3/3/2 4/4/2
f -5//-1 -4//-1 -1//-2 # note
usemtl glass
s off
f 1 2 5
f 2 3 5
g
usemtl \xe4
f 3 4 5 1 2
l 1 2 3
p 1
#mtl
newmtl a
Kd 0.8 0.5 0.2
Ks 0.5 0.5 0.5
Ns 96
Ke 0.1 0 0
Ka 1 1 1
illum 2
map_Kd -s 2 2 1 -o 0.5 0 0 -clamp on t.png
map_Bump -bm 0.5 b_normal.png
norm n.png
map_d -imfchan m t.png
Pr 0.4
Pm 0.9
Ps 0.1
Pc 0.5
Pcr 0.03
aniso 0.2
anisor 0.1
newmtl glass
d 0.1
Ni 1.5
Tf 0.9 1 0.9
illum 7
newmtl \xe4
Tr 0.5
Kd xyz 0.1 0.2
Kd spectral file.rfl
"""
write(rich(), "rich")
open("obj/rich.obj", "wb").write(OBJ.encode("latin-1"))
