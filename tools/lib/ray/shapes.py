"""Geometry as POV-Ray text. All numbers are metres in W (right-handed, z up); what is drawn at random depends on the generator alone."""

import numpy as np

TEXTURES = """
#declare Plain = finish { ambient 0.25 diffuse 0.7 }
#macro Grey(G) texture { pigment { rgb G } finish { Plain } } #end
#macro Speckled(A, B, S) texture { pigment { granite color_map { [0 rgb A] [1 rgb B] } scale S } finish { Plain } } #end
#macro Cloudy(A, B, S) texture { pigment { bozo turbulence 0.6 octaves 4 color_map { [0 rgb A] [1 rgb B] } scale S } finish { Plain } } #end
#macro Wooden(A, B, S) texture { pigment { wood turbulence 0.12 color_map { [0 rgb A] [1 rgb B] } scale <S, S, 6 * S> rotate <88, 3, 12> }
  finish { Plain } } #end
#macro Bricks(A, B, S) texture { pigment { brick rgb A, rgb B brick_size <0.25, 0.25, 0.075> * S mortar 0.012 * S translate 0.017 }
  finish { Plain } } #end
#macro Leaves(A, B, S) texture { pigment { wrinkles turbulence 0.8 color_map { [0 rgb A] [0.5 rgb B] [1 rgb A * 0.3] } scale S }
  finish { Plain } } #end
#macro Metal(A, S) texture { pigment { bozo color_map { [0 rgb A] [1 rgb A * 1.12] } scale <S, S, 40 * S> }
  finish { ambient 0.2 diffuse 0.6 reflection 0.12 specular 0.3 } } #end
"""


def vector(v):
    return "<" + ",".join(f"{float(x):.5f}" for x in v) + ">"


def box(a, b, texture, more=""):
    a, b = np.minimum(a, b), np.maximum(a, b)
    return f"box {{ {vector(a)}, {vector(np.maximum(b, a + 1e-4))} {texture} {more} }}\n"


def grey(value):
    return f"Grey({float(value):.3f})"


def lamp(p, strength, shadows=False):
    return f"light_source {{ {vector(p)} rgb {strength:.3f} {'' if shadows else 'shadowless'} }}\n"


def room(a, b, wall, floor, ceiling):
    """The inside of a box: six slabs."""
    (x0, y0, z0), (x1, y1, z1) = a, b
    e = 0.1
    return "".join([box((x0 - e, y0 - e, z0 - e), (x1 + e, y1 + e, z0), floor),
                    box((x0 - e, y0 - e, z1), (x1 + e, y1 + e, z1 + e), ceiling),
                    box((x0 - e, y0, z0), (x0, y1, z1), wall), box((x1, y0, z0), (x1 + e, y1, z1), wall),
                    box((x0, y0 - e, z0), (x1, y0, z1), wall), box((x0, y1, z0), (x1, y1 + e, z1), wall)])


class Wall:
    """A vertical face for flat things: origin is a corner at the floor, along its horizontal axis, out its normal (both axes of W)."""

    def __init__(self, origin, along, out):
        self.origin, self.along, self.out = (np.asarray(v, dtype=float) for v in (origin, along, out))

    def at(self, s, z, depth):
        return self.origin + s * self.along + depth * self.out + np.array([0, 0, z])

    def panel(self, s, z, width, height, texture, depth=0.004):
        return box(self.at(s, z, -0.001), self.at(s + width, z + height, depth), texture)

    def poster(self, s, z, width, height, random):
        """A sheet with a frame, blocks and lines like those of print."""
        light = random.uniform(0.5, 0.9)
        text = self.panel(s, z, width, height, grey(random.uniform(0.05, 0.4)), 0.010) + self.panel(
            s + 0.03 * width, z + 0.03 * height, 0.94 * width, 0.94 * height, grey(light), 0.012)
        for _ in range(random.integers(3, 7)):
            w, h = random.uniform(0.1, 0.5, 2) * (width, height)
            text += self.panel(s + random.uniform(0.05, 0.95) * (width - w), z + random.uniform(0.05, 0.95) * (height - h), w, h,
                               grey(random.uniform(0.03, 0.8)), 0.013 + 0.001 * random.random())
        for row in range(random.integers(3, 9)):
            at = s + 0.08 * width
            while at < s + 0.85 * width:
                w = random.uniform(0.02, 0.09) * width
                text += self.panel(at, z + height * (0.9 - 0.05 * row), w, 0.022 * height, grey(random.uniform(0.02, 0.2)), 0.015)
                at += w + 0.015 * width
        return text

    def door(self, s, random, width=0.9, height=2.05):
        wood = random.uniform(0.25, 0.5)
        return (self.panel(s - 0.07, 0, width + 0.14, height + 0.07, grey(0.7), 0.02)
                + self.panel(s, 0, width, height, f"Wooden({wood:.3f}, {0.7 * wood:.3f}, 0.06)", 0.03)
                + self.panel(s + 0.08 * width, 1.0, 0.12, 0.03, grey(0.75), 0.08) + self.panel(s + 0.3 * width, 1.55, 0.25, 0.08,
                        grey(0.85), 0.034)
                + self.panel(s + 0.34 * width, 1.57, 0.10, 0.04, grey(0.1), 0.036))

    def window(self, s, z, width, height, random, depth=0.05):
        text = self.panel(s - 0.1, z - 0.1, width + 0.2, height + 0.2, grey(random.uniform(0.55, 0.75)), depth)
        for k in range(2):
            text += self.panel(s + k * width / 2 + 0.03, z + 0.03, width / 2 - 0.06, height - 0.06, grey(random.uniform(0.06, 0.16)),
                               depth + 0.01)
        if random.random() < 0.6:
            text += self.panel(s + 0.04, z + height * random.uniform(0.3, 0.7), width * random.uniform(0.2, 0.45), 0.1 * height,
                               grey(random.uniform(0.3, 0.6)), depth + 0.012)
        return text
