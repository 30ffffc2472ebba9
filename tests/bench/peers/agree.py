#!/usr/bin/env python3
"""Holds pts's own error estimates against a peer's reference (reference.py) and prints rows of a Markdown table.

    agree.py PTS SCENE GOAL[,GOAL…] RUNS REFERENCE.exr [REFERENCE.exr…]

PTS is the binary. For each goal the twin of SCENE is rendered RUNS times, each with its own seed, until pts says that
its error is below the goal; `pts compare` then measures E against each reference, whose own noise is subtracted. One
more render of 2048 samples in 16 nets shows whether the two programs differ by more than noise. Pictures are kept
beside the first reference and not made again. Exit code 1: blocks differ beyond noise, or so few runs keep their bound
that a promise of 90 % is two standard deviations off.
"""

import json
import os
import subprocess
import sys

import mitsuba as mi
import numpy as np
from scenes import SCENES

mi.set_variant("scalar_rgb")
HERE = os.path.dirname(os.path.abspath(__file__))


def reference_error(path):
    """E of the reference's own noise, its samples per pixel and who made it."""
    bitmap = mi.Bitmap(path)
    names = [bitmap.struct_()[i].name for i in range(bitmap.channel_count())]
    layers = np.array(bitmap, dtype=np.float64)
    of = lambda wanted: layers[:, :, [names.index(n) for n in wanted]]
    mean, error = of("RGB"), of([f"stderr.{c}" for c in "RGB"])
    y = mean @ [0.2126, 0.7152, 0.0722]
    e = np.sqrt(np.mean(error**2 / (y**2 + 0.01 * y.mean() ** 2)[:, :, None]))
    told = json.loads(str(bitmap.metadata()["pts"]))
    return e, told["spp"], told["peer"], mean.shape[0]


def render(pts, scene, side, output, *rules):
    """What pts says of its own picture; the answer is kept beside it."""
    kept = output + ".json"
    if not os.path.exists(kept):
        twin = os.path.join(HERE, scene["twin"])
        command = [pts, "render", twin, "-I", os.path.dirname(output) or ".", "-r", f"{side}x{side}", "--filter", "box"]
        command += [*scene["flags"], "-j", "1", "--progress", "json", "-o", output, *rules]
        lines = subprocess.run(command, capture_output=True, text=True, check=False).stderr.splitlines()
        done = [line for line in lines if '"event":"done"' in line]
        if not done:
            sys.exit("\n".join([" ".join(command), *lines[-5:]]))
        with open(kept, "w") as file:
            file.write(done[-1])
    with open(kept) as file:
        return json.load(file)


def compare(pts, image, reference):
    command = [pts, "compare", "--format", "json", image, reference]
    return json.loads(subprocess.run(command, capture_output=True, text=True, check=True).stdout)


def main(pts, name, goals, runs, *references):
    scene, runs, agreed = SCENES[name], int(runs), True
    folder = os.path.dirname(references[0])
    side = reference_error(references[0])[3]
    long = os.path.join(folder, f"pts-{name}.exr")
    render(pts, scene, side, long, "--spp", "2048", "--nets", "16", "--seed", "1000")
    table = []
    for reference in references:
        own, spp, peer, _ = reference_error(reference)
        c = compare(pts, long, reference)
        noise, bias = c["noise"], max(c["noise"]["bias_z"], key=abs)
        agreed &= noise["differing"] == 0
        farthest = f"farthest z = {noise['farthest']['z']:+.1f}"
        row = [name, peer, str(spp), f"{100 * own:.2f} %", f"{c['energy']['ratio']:.4f} (z = {bias:+.1f})"]
        print(" | ".join(["", *row, f"{noise['differing']} of {noise['blocks']} ({farthest})", ""]).strip())
        for goal in goals.split(","):
            estimates, bounds, truths, samples, missed = [], [], [], [], 0
            for seed in range(1, runs + 1):
                image = os.path.join(folder, f"pts-{name}-{goal.rstrip('%')}-{seed}.exr")
                told = render(pts, scene, side, image, "--error", goal, "--seed", str(seed))
                missed += told["stop"] != "error"
                estimates.append(told["error"]["error"])
                bounds.append(told["error"]["bound"])
                samples.append(told["spp"])
                truths.append(np.sqrt(max(compare(pts, image, reference)["e"] ** 2 - own**2, 0)))
            e, u, t = map(np.array, (estimates, bounds, truths))
            kept = int((t <= u).sum())
            agreed &= kept >= 0.9 * runs - 2 * np.sqrt(0.09 * runs)
            low, mid, high = np.quantile(t, [0.1, 0.5, 0.9])
            row = [name, peer, goal, f"{np.median(samples):.0f}", f"{100 * np.median(e):.2f} %"]
            row += [f"{100 * np.median(u):.2f} %", f"{100 * mid:.2f} % ({100 * low:.2f} … {100 * high:.2f})"]
            reached = int((t <= float(goal.rstrip("%")) / 100).sum())
            row += [f"{np.median(t / e):.3f}", f"{kept} of {runs}", f"{reached} of {runs}"]
            table.append("| " + " | ".join(row) + f" |{f' {missed} missed' if missed else ''}")
    print("\n".join(table))
    sys.exit(0 if agreed else 1)


if __name__ == "__main__":
    if len(sys.argv) < 6:
        sys.exit(__doc__)
    main(*sys.argv[1:])
