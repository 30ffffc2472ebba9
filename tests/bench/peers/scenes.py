"""The scenes of the .pts twins in words that Mitsuba and Cycles share.

Coordinates and angles are those of the .pts files: left-handed, y up. A peer that is right-handed negates z.
"""

import math

import numpy as np

WHITE = ("diffuse", (0.73, 0.73, 0.73))
RED = ("diffuse", (0.63, 0.06, 0.05))
GREEN = ("diffuse", (0.14, 0.45, 0.09))


def quad(a, b, c, d, material):
    return {"quad": [a, b, c, d], "material": material}


def sphere(center, radius, material):
    return {"center": center, "radius": radius, "material": material}


def box(low, high, turn, shift, material):
    """Six quads, turned by degrees about y, then shifted."""
    s, c = math.sin(math.radians(turn)), math.cos(math.radians(turn))

    def corner(i):
        x, y, z = [(low, high)[i >> axis & 1][axis] for axis in range(3)]
        return (c * x + s * z + shift[0], y + shift[1], -s * x + c * z + shift[2])

    # Corner i has bit 0 for x, bit 1 for y, bit 2 for z; each face goes round once, seen from outside.
    faces = [(0, 4, 6, 2), (1, 3, 7, 5), (0, 1, 5, 4), (2, 6, 7, 3), (0, 2, 3, 1), (4, 5, 7, 6)]
    return [quad(*map(corner, face), material) for face in faces]


def shell(lx, lz, lamp):
    """The room: a ceiling with a hole that the lamp fills, and an open front."""
    return [
        quad((-1, 0, -1), (-1, 0, 1), (1, 0, 1), (1, 0, -1), WHITE),
        quad((-1, 2, -1), (1, 2, -1), (1, 2, -lz), (-1, 2, -lz), WHITE),
        quad((-1, 2, lz), (1, 2, lz), (1, 2, 1), (-1, 2, 1), WHITE),
        quad((-1, 2, -lz), (-lx, 2, -lz), (-lx, 2, lz), (-1, 2, lz), WHITE),
        quad((lx, 2, -lz), (1, 2, -lz), (1, 2, lz), (lx, 2, lz), WHITE),
        # Anticlockwise seen from below in right-handed coordinates: in Mitsuba only that side shines.
        quad((-lx, 2, -lz), (-lx, 2, lz), (lx, 2, lz), (lx, 2, -lz), lamp),
        quad((-1, 0, 1), (-1, 2, 1), (1, 2, 1), (1, 0, 1), WHITE),
        quad((-1, 0, -1), (-1, 2, -1), (-1, 2, 1), (-1, 0, 1), RED),
        quad((1, 0, -1), (1, 0, 1), (1, 2, 1), (1, 2, -1), GREEN),
    ]


def blocks(material):
    return box((-0.3, 0, -0.3), (0.3, 1.2, 0.3), 17, (-0.35, 0, 0.32), material) + box(
        (-0.3, 0, -0.3), (0.3, 0.6, 0.3), -17, (0.33, 0, -0.35), material
    )


def sky(d):
    """Radiance from unit directions (…, 3): a gradient and a broad glow, smooth enough for any interpolation."""
    d = np.asarray(d, dtype=float)
    sun = np.array([0.6, 0.6, -0.5]) / math.sqrt(0.97)
    gradient = (0.6 + 0.4 * d[..., 1:2]) * np.array([0.35, 0.45, 0.65])
    return gradient + np.exp(12 * (d @ sun - 1))[..., None] * np.array([6.0, 5.0, 3.5])


LAMP = ("lamp", 0.78, tuple(0.9 * c for c in (18.4, 15.6, 8.0)))
ROOM_CAMERA = {"location": (0, 1, -4.9), "look_at": (0, 1, 0), "angle": 32}

# name → the .pts twin beside this file (or in scenes/), what the twin must be rendered with, camera, objects, sky.
SCENES = {
    "room": {
        "twin": "../../../scenes/cornell_quads.pts",
        "flags": [],
        "camera": ROOM_CAMERA,
        "objects": shell(0.24, 0.19, LAMP) + blocks(WHITE),
        "sky": None,
    },
    "metal": {
        "twin": "metal.pts",
        "flags": ["--no-multiple-scattering"],
        "camera": ROOM_CAMERA,
        "objects": shell(0.24, 0.19, LAMP) + blocks(("metal", 0.4)),
        "sky": None,
    },
    "balls": {
        "twin": "balls.pts",
        "flags": [],
        "camera": ROOM_CAMERA,
        "objects": shell(0.5, 0.5, ("lamp", 0.5, (5, 4.5, 3.5)))
        + [
            sphere((0.42, 0.45, -0.30), 0.40, ("glass", 1.5)),
            sphere((-0.42, 0.40, 0.30), 0.40, ("mirror", (0.95, 0.85, 0.70))),
        ],
        "sky": None,
    },
    "lens": {
        "twin": "lens.pts",
        "flags": [],
        "camera": {"location": (0, 1.6, -6), "look_at": (0, 0.6, 0), "angle": 36, "lens": 0.15, "focus": 6},
        "objects": [
            quad((-30, 0, -30), (-30, 0, 30), (30, 0, 30), (30, 0, -30), ("diffuse", (0.50, 0.48, 0.45))),
            sphere((-0.75, 0.50, -2.2), 0.50, ("diffuse", (0.70, 0.20, 0.15))),
            sphere((0.25, 0.65, 0.2), 0.65, ("mirror", (0.90, 0.90, 0.90))),
            sphere((1.50, 0.60, 3.0), 0.60, ("diffuse", (0.15, 0.35, 0.70))),
            sphere((-1.60, 0.80, 4.0), 0.80, ("diffuse", (0.60, 0.60, 0.20))),
        ],
        "sky": sky,
    },
}
