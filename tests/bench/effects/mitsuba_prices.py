#!/usr/bin/env python3
"""What effects cost in Mitsuba where a scene has none of them: CPU seconds of the Cornell box, 128x128, 64 samples, in
turns. Prints the last table of docs/effects.md.

    pip install mitsuba==3.9.1 && python3 tests/bench/effects/mitsuba_prices.py [rounds]
"""
import sys
import time

import mitsuba as mi
import numpy

mi.set_variant("scalar_rgb")
ROUNDS = int(sys.argv[1]) if len(sys.argv) > 1 else 5


def box():
    scene = mi.cornell_box()
    scene["integrator"] = {"type": "path", "max_depth": 16}
    scene["sensor"]["film"].update(width=128, height=128)
    scene["sensor"]["sampler"]["sample_count"] = 64
    return scene


def volumes(scene):
    scene["integrator"]["type"] = "volpath"


def lens(scene):
    scene["sensor"].update(type="thinlens", aperture_radius=1e-6, focus_distance=5.0)


def coverage(scene):
    scene["white"] = {"type": "mask", "opacity": 1.0, "nested": scene["white"]}


def texel(scene):
    white = mi.Bitmap(numpy.full((1, 1, 3), 0.885809, "float32"))
    scene["white"] = {"type": "diffuse", "reflectance": {"type": "bitmap", "bitmap": white, "raw": True}}


def sky(scene):
    scene["sky"] = {"type": "constant", "radiance": {"type": "rgb", "value": 0.0}}


def lamps(scene):
    for i in range(4):
        scene[f"lamp{i}"] = {"type": "point", "position": [0, 0.5, 0.1 * i], "intensity": {"type": "rgb", "value": 0.0}}


variants = {"the box as it is": None, "an integrator for media, without any": volumes, "a lens of next to no radius": lens}
variants |= {"coverage of 1": coverage, "an image of one texel": texel, "a black sky": sky, "four dark lamps": lamps}
scenes = {}
for name, change in variants.items():
    scene = box()
    if change:
        change(scene)
    scenes[name] = mi.load_dict(scene)
seconds = {name: [] for name in scenes}
for seed in range(ROUNDS):
    for name, scene in scenes.items():
        begun = time.process_time()
        mi.render(scene, seed=seed)
        seconds[name].append(time.process_time() - begun)
base = sorted(seconds["the box as it is"])
median = lambda times: sorted(times)[len(times) // 2]
print("| declared, without effect | median of the ratios | least time over least time |\n|---|---|---|")
for name, times in seconds.items():
    ratios = [t / b for t, b in zip(times, seconds["the box as it is"])]
    print(f"| {name} | {median(ratios):.2f} | {min(times) / base[0]:.2f} |")
