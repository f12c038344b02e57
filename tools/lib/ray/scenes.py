"""The scenes: geometry, path, camera and sensor, each from a generator; options.py says what they show."""

import dataclasses

import numpy as np

from .camera import Camera
from .sensor import Sensor
from .shapes import TEXTURES, Wall, box, grey, lamp, room, vector


@dataclasses.dataclass
class Scene:
    text: str
    keys: list
    camera: Camera
    sensor: Sensor = dataclasses.field(default_factory=Sensor)
    shake_deg: float = 0.4
    shake_m: float = 0.004


def corridor(random):
    text = box((-1, -0.1, -0.1), (25, 1.9, 0), "Cloudy(0.30, 0.42, 0.05)") + box((23, 1.9, -0.1), (25, 14, 0), "Cloudy(0.30, 0.42, 0.05)")
    text += box((-1, -0.1, 2.6), (25, 14, 2.7), "Speckled(0.62, 0.7, 0.3)")
    white = "Cloudy(0.60, 0.66, 0.4)"
    for a, b in (((-1.1, 0, 0), (-1, 1.9, 2.6)), ((-1, -0.1, 0), (25, 0, 2.6)), ((-1, 1.9, 0), (23, 2, 2.6)),
                 ((25, -0.1, 0), (25.1, 14, 2.6)),
                 ((22.9, 1.9, 0), (23, 14, 2.6)), ((23, 14, 0), (25, 14.1, 2.6))):
        text += box(a, b, white)
    walls = [(Wall((0, 0, 0), (1, 0, 0), (0, 1, 0)), 22), (Wall((0, 1.9, 0), (1, 0, 0), (0, -1, 0)), 22),
             (Wall((25, 2, 0), (0, 1, 0), (-1, 0, 0)), 11), (Wall((23, 2.4, 0), (0, 1, 0), (1, 0, 0)), 11),
             (Wall((25, 0.1, 0), (0, 1, 0), (-1, 0, 0)), 2),
             (Wall((23, 14, 0), (1, 0, 0), (0, -1, 0)), 2)]
    for wall, length in walls:
        text += wall.panel(0, 0, length, 0.09, grey(0.25), 0.012)
        s = random.uniform(0.2, 0.8)
        while s < length - 1.1:
            text += wall.door(s, random) if random.random() < 0.5 else wall.poster(s, random.uniform(1.1, 1.4), random.uniform(0.4, 0.9),
                                                                                    random.uniform(0.5, 0.9), random)
            s += random.uniform(1.4, 2.6)
    for k in range(0, 24, 4):
        text += lamp((k + 0.5, 0.95, 2.4), 0.30)
    for k in range(4, 14, 4):
        text += lamp((24, k, 2.4), 0.30)
    keys = [(0, 0.3, 0.9, 1.5, 8, -4), (1, 0.3, 0.9, 1.5, 8, -4), (15, 10.5, 1.0, 1.52, -8, -2), (29, 21.5, 0.9, 1.5, 5, -4),
            (32, 23.3, 0.9, 1.5, 35, -2),
            (35, 24.0, 1.7, 1.5, 88, -3), (47, 24.0, 8.0, 1.5, 84, -4), (56, 24.0, 12.0, 1.52, 95, -2), (60, 24.0, 12.4, 1.5, 92, -2)]
    return Scene(text, keys, Camera(fov_deg=72, rate_hz=15, exposure_s=0.012))


def outdoor(random):
    text = "sky_sphere { pigment { gradient z color_map { [0 rgb 0.75] [0.4 rgb 0.5] } } }\n"
    text += box((-60, -60, -0.1), (60, 60, 0), "Leaves(0.10, 0.19, 0.06)") + box((-60, 4.6, -0.05), (60, 6.2, 0.02),
            "Speckled(0.3, 0.42, 0.2)")
    x = -18.0
    while x < 34:
        width, height, deep = random.uniform(6, 10), random.uniform(4.5, 7), random.uniform(9.5, 10.5)
        base = random.uniform(0.3, 0.6)
        face = f"Bricks({0.8 * base:.3f}, {base:.3f}, 1)" if random.random() < 0.5 else f"Cloudy({base:.3f}, {1.12 * base:.3f}, 0.5)"
        text += box((x, deep, 0), (x + width, deep + 8, height), face)
        text += f"prism {{ linear_sweep {x:.3f}, {x + width:.3f}, 4 <{deep - 0.3:.3f},{height:.3f}>, <{deep + 8.3:.3f},{height:.3f}>, "
        text += f"<{deep + 4:.3f},{height + 2.6:.3f}>, <{deep - 0.3:.3f},{height:.3f}> "
        text += f"matrix <0,1,0, 1,0,0, 0,0,1, 0,0,0> Bricks(0.12, 0.2, 1.3) }}\n"
        wall = Wall((x, deep, 0), (1, 0, 0), (0, -1, 0))
        for level in range(int(height / 2.6)):
            s = random.uniform(0.5, 0.9)
            while s < width - 1.4:
                text += wall.door(s, random) if level == 0 and random.random() < 0.25 else wall.window(s, 0.9 + 2.6 * level, 1.1, 1.3,
                        random)
                s += random.uniform(1.8, 2.4)
        x += width + random.choice([0, 0, 3.0])
    for _ in range(9):
        at, tall = np.array([random.uniform(-14, 26), random.uniform(5.5, 8.5), 0]), random.uniform(2.5, 4.5)
        text += f"cone {{ {vector(at)}, 0.16, {vector(at + [0, 0, tall])}, 0.08 Leaves(0.18, 0.08, 0.05) }}\n"
        for _ in range(14):
            to = at + [0, 0, tall] + 0.9 * random.standard_normal(3)
            text += f"sphere {{ {vector(to)}, {random.uniform(0.25, 0.7):.3f} Leaves(0.16, 0.05, 0.06) }}\n"
    for _ in range(40):
        at = np.array([random.uniform(-14, 26), random.uniform(1.5, 4.4), 0])
        text += f"sphere {{ {vector(at)}, {random.uniform(0.05, 0.2):.3f} Leaves(0.25, 0.08, 0.03) }}\n"
    text += "light_source { <-30, -60, 60> rgb 0.75 }\n"
    keys = [(0, 0, 0, 1.6, 75, 14), (1, 0, 0, 1.6, 75, 14), (5, 4, 0, 1.6, 60, 15), (8, 7, 0.2, 1.6, 25, 14), (11, 10, 0.3, 1.6, 80, 16),
            (14, 12.5, 0.2, 1.6, 120, 18),
            (17, 15, 0, 1.6, 90, 14), (20, 18, 0, 1.6, 60, 14)]
    return Scene(text, keys, Camera(fov_deg=62, rate_hz=25, exposure_s=0.003), Sensor(full_well=9000))


def desk(random):
    text = room((-2.5, -2.5, 0), (2.5, 2.0, 2.6), "Cloudy(0.42, 0.46, 0.3)", "Wooden(0.2, 0.3, 0.05)", grey(0.6))
    text += box((-0.9, 0.6, 0.70), (0.9, 1.5, 0.74), "Wooden(0.30, 0.20, 0.03)")
    back = Wall((-2.5, 2.0, 0), (1, 0, 0), (0, -1, 0))
    for s, z, w, h in ((0.3, 1.2, 0.6, 0.8), (1.8, 1.1, 0.5, 0.4), (2.5, 1.25, 0.42, 0.6), (3.1, 1.0, 0.4, 0.3)):
        text += back.poster(s, z, w, h, random)
    text += back.panel(3.85, 0.95, 1.0, 1.3, "texture { pigment { rgb 1 } finish { ambient 1 diffuse 0 } }", 0.01)
    for s in (3.8, 4.32, 4.84):
        text += back.panel(s, 0.9, 0.05, 1.4, grey(0.3), 0.04)
    for _ in range(26):
        at, size = np.array([random.uniform(-0.8, 0.75), random.uniform(0.75, 1.4), 0.74]), random.uniform(0.02, 0.14, 3)
        if random.random() < 0.3:
            text += f"cylinder {{ {vector(at)}, {vector(at + [0, 0, size[2] + 0.04])}, {size[0] / 2 + 0.01:.3f} "
            text += f"Speckled({random.uniform(0, 0.3):.2f}, 0.5, 0.03) }}\n"
            continue
        text += box(at, at + size, f"Cloudy({random.uniform(0.03, 0.5):.2f}, {random.uniform(0.1, 0.6):.2f}, 0.03)")
        text += Wall(at, (1, 0, 0), (0, -1, 0)).panel(0.1 * size[0], 0.2 * size[2], 0.6 * size[0], 0.4 * size[2],
                                                      grey(random.uniform(0.02, 0.6)), 0.002)
    text += lamp((-0.4, 0.4, 2.5), 0.17, True) + lamp((0.9, -0.5, 2.5), 0.1)
    keys = [(0, -0.3, -0.1, 1.25, 92, -22), (1, -0.3, -0.1, 1.25, 92, -22), (4, 0.25, 0.0, 1.2, 98, -22), (6, 0.2, -0.1, 1.3, 62, -10),
            (8, 0.1, 0.0, 1.3, 60, -8),
            (10, -0.2, 0.1, 1.2, 95, -22), (13, -0.6, 0.3, 1.15, 80, -20), (15, -0.2, 0.0, 1.3, 58, -6), (17, 0.1, 0.1, 1.25, 95,
                    -20), (20, 0.2, 0.2, 1.2, 100, -25)]
    return Scene(text, keys, Camera(fov_deg=66, exposure_s=0.005, readout_s=0.03), Sensor(flicker=0.35, auto_exposure=True, gain=2.2))


def lift(random):
    steel = "Metal(0.42, 0.01)"
    text = box((-0.8, -0.7, -0.1), (0.8, 0.9, 0), "Speckled(0.1, 0.3, 0.05)") + box((-0.8, -0.7, 2.3), (0.8, 0.9, 2.4), grey(0.7))
    text += box((-0.9, -0.7, 0), (-0.8, 0.9, 2.3), steel) + box((-0.8, -0.8, 0), (0.8, -0.7, 2.3), steel) + box((-0.8, 0.9, 0),
            (0.8, 1.0, 2.3), steel)
    text += box((0.7, -0.7, 0), (0.8, -0.5, 2.3), steel) + box((0.7, 0.5, 0), (0.8, 0.9, 2.3), steel) + box((0.7, -0.7, 2.05),
            (0.8, 0.9, 2.3), steel)
    front = Wall((0.7, 0.9, 0), (0, -1, 0), (-1, 0, 0))
    text += front.panel(0.08, 0.95, 0.22, 0.75, "Metal(0.6, 0.02)", 0.01)
    for k in range(12):
        text += front.panel(0.12 + 0.08 * (k % 2), 1.0 + 0.11 * (k // 2), 0.045, 0.045, grey(0.15 + 0.6 * (k % 3 == 0)), 0.02)
    text += front.panel(0.55, 2.1, 0.5, 0.13, grey(0.05), 0.01) + front.panel(0.75, 2.13, 0.05, 0.08, grey(0.9), 0.012)
    text += Wall((-0.8, 0.9, 0), (1, 0, 0), (0, -1, 0)).poster(0.85, 1.2, 0.4, 0.6, random) + Wall((-0.8, -0.7, 0), (1, 0, 0),
            (0, 1, 0)).poster(0.9, 1.15, 0.45, 0.55, random)
    for side in (-1, 1):
        wall = Wall((0.83, min(0, 0.5 * side), 0), (0, 1, 0), (-1, 0, 0))
        text += "union {\n" + box((0.83, min(0, 0.5 * side), 0), (0.87, max(0, 0.5 * side), 2.05), "Metal(0.5, 0.008)")
        text += wall.poster(0.10, 1.15, 0.3, 0.42, random) + wall.panel(0.05, 0.2, 0.4, 0.06, grey(0.15)) + wall.panel(0.1, 1.8, 0.1,
                0.1, grey(0.8))
        text += f"translate y * {side} * 0.48 * (min(max((Now - 4) / 2.2, 0), 1)) }}\n"
    text += box((0.9, -4, -0.1), (9, 4, 0), "Cloudy(0.25, 0.4, 0.12)") + box((0.9, -4, 2.8), (9, 4, 2.9), grey(0.65)) + box((9, -4, 0),
            (9.1, 4, 2.8), "Cloudy(0.5, 0.6, 0.3)")
    text += box((0.9, 4, 0), (9, 4.1, 2.8), "Bricks(0.3, 0.45, 1)") + box((0.9, -4.1, 0), (9, -4, 2.8), "Cloudy(0.5, 0.6, 0.3)")
    for wall, length in ((Wall((9, -4, 0), (0, 1, 0), (-1, 0, 0)), 8), (Wall((1, 4, 0), (1, 0, 0), (0, -1, 0)), 7),
                         (Wall((1, -4, 0), (1, 0, 0), (0, 1, 0)), 7)):
        for s in np.arange(0.4, length - 1, 1.6):
            text += wall.door(s, random) if random.random() < 0.4 else wall.poster(s, 1.1, 0.8, 0.9, random)
    text += lamp((0, 0, 2.2), 0.45) + lamp((4, 0, 2.7), 0.5) + lamp((7, 2, 2.7), 0.3)
    keys = [(0, -0.55, 0.05, 1.5, -5, -6), (1, -0.55, 0.05, 1.5, -5, -6), (3, -0.5, -0.15, 1.5, 8, -4), (5, -0.5, 0.1, 1.5, 2, -4),
            (7, -0.4, 0, 1.5, 0, -4), (9, 0.3, 0, 1.5, 0, -4),
            (12, 2.2, 0.3, 1.5, 20, -3), (15, 4.5, 0.6, 1.5, 0, -3), (16, 4.6, 0.6, 1.5, -10, -3)]
    return Scene(text, keys, Camera(fov_deg=80, exposure_s=0.010))


def shelf(random):
    text = box((-4, 1.5, 0), (8, 1.6, 2.3), grey(0.35)) + box((-6, -3, -0.1), (9, 1.5, 0), "Cloudy(0.4, 0.5, 0.1)")
    for level, z in enumerate((0.15, 0.55, 0.95, 1.35, 1.75, 2.15)):
        text += box((-4, 1.0, z - 0.03), (8, 1.5, z), grey(0.55)) + box((-4, 0.99, z - 0.06), (8, 1.0, z), grey(0.75))
        x = -3.9
        while x < 7.8 and level < 5:
            w, h, count = random.uniform(0.08, 0.2), random.uniform(0.18, 0.32), random.integers(4, 10)
            kind = np.random.default_rng(random.integers(1 << 30))
            body, marks = kind.uniform(0.1, 0.7), [(kind.uniform(0, 0.6), kind.uniform(0, 0.8), *kind.uniform(0.1, 0.4, 2),
                                                    kind.uniform(0.02, 0.85)) for _ in range(6)]
            name = f"Packet{level}_{int(1000 * (x + 4))}"
            face = Wall((0, 0, 0), (1, 0, 0), (0, -1, 0))
            text += f"#declare {name} = union {{ " + box((0, 0, 0), (w, 0.25, h), grey(body))
            text += "".join(face.panel(a * w, b * h, c * w, d * h, grey(g), 0.002 + 0.0002 * k) for k,
                            (a, b, c, d, g) in enumerate(marks)) + "}\n"
            for k in range(count):
                text += f"object {{ {name} translate {vector((x + k * (w + 0.006), 1.03 + 0.015 * random.random(), z))} }}\n"
            text += Wall((0, 0.99, 0), (1, 0, 0), (0, -1, 0)).panel(x + 0.1, z - 0.055, 0.07, 0.045, grey(0.9), 0.002)
            x += count * (w + 0.006) + 0.02
    text += "".join(lamp((x, -0.8, 2.8), 0.3) for x in (-2, 2, 6))
    keys = [(0, 0, 0, 1.4, 90, -8), (0.7, 0, 0, 1.4, 90, -8), (4, 1.5, 0.05, 1.4, 84, -8), (6, 2.2, -0.05, 1.3, 95, -12),
            (8, 3.2, 0, 1.4, 90, -5), (10, 4.2, 0, 1.4, 88, -8)]
    return Scene(text, keys, Camera(fov_deg=64, rate_hz=60, exposure_s=0.006))


def turns(random):
    text = room((-2.5, -2.2, 0), (2.5, 2.2, 2.5), "Cloudy(0.5, 0.57, 0.3)", "Wooden(0.25, 0.4, 0.05)", grey(0.65))
    walls = [(Wall((-2.5, -2.2, 0), (1, 0, 0), (0, 1, 0)), 5), (Wall((2.5, -2.2, 0), (0, 1, 0), (-1, 0, 0)), 4.4),
             (Wall((-2.5, 2.2, 0), (1, 0, 0), (0, -1, 0)), 5),
             (Wall((-2.5, -2.2, 0), (0, 1, 0), (1, 0, 0)), 4.4)]
    for wall, length in walls:
        for s in np.arange(0.4, length - 0.9, 1.1):
            text += wall.poster(s, random.uniform(1.0, 1.4), random.uniform(0.4, 0.8), random.uniform(0.4, 0.8), random)
    for _ in range(12):
        at, size = np.array([random.uniform(-2.2, 1.8), random.choice([-2.1, 1.5]), 0]), random.uniform(0.3, 0.7, 3)
        text += box(at, at + size, f"Cloudy({random.uniform(0.05, 0.3):.2f}, {random.uniform(0.3, 0.6):.2f}, 0.08)")
    text += lamp((-1, 0, 2.4), 0.45) + lamp((1.2, 0.5, 2.4), 0.3)
    keys = [(0, -1, -0.2, 1.5, 0, -5), (0.6, -1, -0.2, 1.5, 0, -5), (3, -0.6, 0.3, 1.45, 10, -6), (5, 0.1, 0.1, 1.5, 0, -5),
            (5.75, 0.2, 0.1, 1.5, 90, -5), (7, 0.3, 0.4, 1.5, 90, -5),
            (7.9, 0.3, 0.5, 1.5, -18, -4), (9, 0.5, 0.4, 1.5, -18, -4), (10.5, 0.5, 0.1, 1.5, 162, -6), (12, 0.2, 0, 1.5, 170,
                    -6), (13.4, -0.3, 0.2, 1.5, 0, -5), (15, -0.6, 0, 1.5, 0, -5)]
    return Scene(text, keys, Camera(fov_deg=100, exposure_s=0.008))


def white(random):
    text = room((-3, -2.5, 0), (3, 2.5, 2.5), grey(0.62), "Cloudy(0.5, 0.54, 0.4)", grey(0.7))
    far, left, right = Wall((3, -2.5, 0), (0, 1, 0), (-1, 0, 0)), Wall((-3, 2.5, 0), (1, 0, 0), (0, -1, 0)), Wall((-3, -2.5, 0),
            (1, 0, 0), (0, 1, 0))
    text += far.poster(1.2, 1.2, 0.6, 0.45, random) + far.poster(3.0, 1.15, 0.5, 0.7, random) + left.poster(4.2, 1.2, 0.5, 0.5,
            random) + right.poster(3.8, 1.1, 0.5, 0.6, random)
    text += far.door(2.0, random).replace("Wooden", "Cloudy") + left.panel(3.0, 0.3, 0.09, 0.09, grey(0.8), 0.01)
    for wall, length in ((far, 5), (left, 6), (right, 6)):
        text += wall.panel(0, 0, length, 0.07, grey(0.5), 0.01)
    text += box((1.9, -2.2, 0), (2.5, -1.6, 0.7), grey(0.3)) + lamp((0, 0, 2.4), 0.42) + lamp((1.5, 1, 2.3), 0.2)
    keys = [(0, -2.2, 0, 1.45, 0, -6), (1, -2.2, 0, 1.45, 0, -6), (6, -1.6, 0.8, 1.45, -8, -5), (12, -1.5, -0.8, 1.4, 8, -6),
            (18, -0.6, -0.4, 1.5, 0, -5), (24, 0, 0.7, 1.45, 6, -5),
            (30, -0.4, 0, 1.45, -6, -6)]
    return Scene(text, keys, Camera(fov_deg=50, rate_hz=10, exposure_s=0.012))


SCENES = {scene.__name__: scene for scene in (corridor, outdoor, desk, lift, shelf, turns, white)}


def make(name, seed):
    scene = SCENES[name](np.random.default_rng(seed))
    scene.text = TEXTURES + scene.text
    return scene
