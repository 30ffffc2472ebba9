#!/usr/bin/env python3
"""Renders one scene of scenes.py with Mitsuba or Cycles, several times, and writes the mean and its standard error.

    reference.py mitsuba|cycles SCENE SPP RUNS OUTPUT.exr [SIDE]

SPP samples in each of RUNS independent runs, SIDE×SIDE pixels (48), one thread, box filter. The spread of the runs is
the standard error (channels stderr.*), which `pts compare` understands. Needs mitsuba; for cycles bpy too.
"""

import json
import os
import sys
import tempfile

import drjit
import mitsuba as mi
import numpy as np
from scenes import SCENES

mi.set_variant("scalar_rgb")


def right_handed(p):
    return [float(p[0]), float(p[1]), -float(p[2])]


def grid(width, height, u, v):
    """Directions of an equirectangular image's texels, whose centre is +z and whose right half shows +x."""
    phi, theta = np.meshgrid(2 * np.pi * (u - 0.5), np.pi * v)
    return np.stack([np.sin(theta) * np.sin(phi), np.cos(theta), np.sin(theta) * np.cos(phi)], axis=-1)


def write_sky(function, path, width=512, height=256):
    """The sky for the twin: texels are squares, sampled at their centres."""
    at = grid(width, height, (np.arange(width) + 0.5) / width, (np.arange(height) + 0.5) / height)
    mi.Bitmap(function(at).astype(np.float32)).write(path)


class Mitsuba:
    name = f"Mitsuba {mi.__version__}"

    def __init__(self, scene, side):
        camera = scene["camera"]
        to_world = mi.ScalarTransform4f().look_at(
            origin=right_handed(camera["location"]), target=right_handed(camera["look_at"]), up=[0, 1, 0]
        )
        sensor = {"type": "perspective", "fov_axis": "x", "fov": camera["angle"], "to_world": to_world}
        if "lens" in camera:
            sensor |= {"type": "thinlens", "aperture_radius": camera["lens"], "focus_distance": camera["focus"]}
        sensor["film"] = {
            "type": "hdrfilm", "width": side, "height": side, "pixel_format": "rgb", "component_format": "float32",
            "rfilter": {"type": "box"},
        }  # fmt: skip
        sensor["sampler"] = {"type": "independent"}
        world = {"type": "scene", "integrator": {"type": "path", "max_depth": -1}, "sensor": sensor}
        world |= {f"object{i}": self.shape(o) for i, o in enumerate(scene["objects"])}
        if scene["sky"]:
            world["sky"] = {"type": "envmap", "bitmap": self.sky(scene["sky"])}
        self.scene = mi.load_dict(world)

    @staticmethod
    def sky(function, width=512, height=256):
        """Mitsuba's centre is our −z, and its first and last rows lie on the poles."""
        at = grid(width, height, (np.arange(width) + 0.5) / width + 0.5, np.arange(height) / (height - 1))
        return mi.Bitmap(function(at).astype(np.float32))

    @staticmethod
    def shape(o):
        kind, *values = o["material"]
        rgb = lambda c: {"type": "rgb", "value": list(c)}
        bsdf = {
            "diffuse": lambda c: {"type": "twosided", "b": {"type": "diffuse", "reflectance": rgb(c)}},
            "lamp": lambda albedo, _: {"type": "diffuse", "reflectance": rgb([albedo] * 3)},
            "mirror": lambda c: {"type": "conductor", "material": "none", "specular_reflectance": rgb(c)},
            # Mitsuba's outside is air of 1.000277 unless told.
            "glass": lambda ior: {"type": "dielectric", "int_ior": ior, "ext_ior": 1.0},
        }[kind](*values)
        if "center" in o:
            return {"type": "sphere", "center": right_handed(o["center"]), "radius": o["radius"], "bsdf": bsdf}
        a, b, c, d = (np.array(right_handed(p)) for p in o["quad"])
        x, y = (b - a) / 2, (d - a) / 2
        n = np.cross(x, y)
        m = np.eye(4)
        m[:3] = np.column_stack([x, y, n / np.linalg.norm(n), (a + c) / 2])
        shape = {"type": "rectangle", "to_world": mi.ScalarTransform4f(m), "bsdf": bsdf}
        if kind == "lamp":
            assert n[1] < 0, "the lamp must face down"
            shape["emitter"] = {"type": "area", "radiance": rgb(values[1])}
        return shape

    def render(self, seed, spp):
        # One thread is enough to render and too few to write: the EXR writer of Mitsuba 3.9 then waits for ever.
        drjit.set_thread_count(1)
        image = np.array(mi.render(self.scene, seed=seed, spp=spp), dtype=np.float64)
        drjit.set_thread_count(2)
        return image


class Cycles:
    def __init__(self, scene, side):
        import bpy

        self.bpy, self.name = bpy, f"Cycles {bpy.app.version_string}"
        bpy.ops.wm.read_factory_settings(use_empty=True)
        s = self.s = bpy.context.scene
        s.render.engine = "CYCLES"
        s.render.resolution_x = s.render.resolution_y = side
        s.render.resolution_percentage = 100
        s.render.threads_mode, s.render.threads = "FIXED", 1
        s.render.image_settings.file_format, s.render.image_settings.color_depth = "OPEN_EXR", "32"
        c = s.cycles
        # Everything that trades accuracy for time is off.
        c.device, c.pixel_filter_type = "CPU", "BOX"
        c.use_adaptive_sampling = c.use_denoising = False
        c.sample_clamp_direct = c.sample_clamp_indirect = c.blur_glossy = c.light_sampling_threshold = 0
        for bounces in ("max", "diffuse", "glossy", "transmission"):
            setattr(c, f"{bounces}_bounces", 1024)
        assert not scene["sky"] and "lens" not in scene["camera"] and all("quad" in o for o in scene["objects"])
        self.camera(scene["camera"])
        for i, o in enumerate(scene["objects"]):
            mesh = bpy.data.meshes.new(f"quad{i}")
            mesh.from_pydata([right_handed(p) for p in o["quad"]], [], [(0, 1, 2, 3)])
            mesh.materials.append(self.material(*o["material"]))
            s.collection.objects.link(bpy.data.objects.new(f"quad{i}", mesh))

    def camera(self, camera):
        """The cameras of these scenes look along an axis: Blender's looks along −z with y up, as ours does then."""
        assert camera["location"][:2] == camera["look_at"][:2]
        data = self.bpy.data.cameras.new("camera")
        data.sensor_fit, data.angle = "HORIZONTAL", np.radians(camera["angle"])
        self.s.camera = self.bpy.data.objects.new("camera", data)
        self.s.camera.location = right_handed(camera["location"])
        self.s.collection.objects.link(self.s.camera)

    def material(self, kind, *values):
        material = self.bpy.data.materials.new(kind)
        material.use_nodes = True
        nodes, links = material.node_tree.nodes, material.node_tree.links
        nodes.clear()
        color = lambda c: (*c, 1.0)
        if kind == "metal":
            surface = nodes.new("ShaderNodeBsdfAnisotropic")
            surface.distribution, surface.inputs["Roughness"].default_value = "GGX", values[0]
            surface.inputs["Color"].default_value = color((1, 1, 1))
        else:
            surface = nodes.new("ShaderNodeBsdfDiffuse")
            surface.inputs["Roughness"].default_value = 0
            surface.inputs["Color"].default_value = color([values[0]] * 3 if kind == "lamp" else values[0])
        end = surface.outputs[0]
        if kind == "lamp":
            light, both = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeAddShader")
            light.inputs["Color"].default_value = color(values[1])
            for i, output in enumerate((light.outputs[0], end)):
                links.new(output, both.inputs[i])
            end = both.outputs[0]
        links.new(end, nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
        return material

    def render(self, seed, spp):
        self.s.cycles.seed, self.s.cycles.samples = seed, spp
        with tempfile.TemporaryDirectory() as directory:
            self.s.render.filepath = os.path.join(directory, "run.exr")
            self.bpy.ops.render.render(write_still=True)
            image = mi.Bitmap(self.s.render.filepath)
        return np.array(image, dtype=np.float64)[:, :, :3]


def main(peer, name, spp, runs, output, side=48):
    scene, spp, runs, side = SCENES[name], int(spp), int(runs), int(side)
    renderer = {"mitsuba": Mitsuba, "cycles": Cycles}[peer](scene, side)
    if scene["sky"]:
        write_sky(scene["sky"], os.path.join(os.path.dirname(output), "sky.exr"))
    images = np.stack([renderer.render(seed, spp) for seed in range(runs)])
    mean, error = images.mean(axis=0), images.std(axis=0, ddof=1) / np.sqrt(runs)
    layers = np.concatenate([mean, error], axis=2).astype(np.float32)
    names = ["R", "G", "B", "stderr.R", "stderr.G", "stderr.B"]
    bitmap = mi.Bitmap(layers, mi.Bitmap.PixelFormat.MultiChannel, names)
    bitmap.metadata()["pts"] = json.dumps({"peer": renderer.name, "spp": spp * runs, "nets": runs})
    bitmap.write(output)


if __name__ == "__main__":
    if len(sys.argv) not in (6, 7):
        sys.exit(__doc__)
    main(*sys.argv[1:])
