"""Recorded sessions of observations for run_session.c, and what it makes of them."""

import math
import random
import struct

TARGETS = 6
SEED = 20
WIDTH, HEIGHT, FOCAL = 320, 240, 260.0
SIGMA_PX = 0.3
RECORD = "<q4i10d"


def rotation(a, b, c):
    """Camera to world: turns about x, then y, then z."""
    ca, sa, cb, sb, cc, sc = math.cos(a), math.sin(a), math.cos(b), math.sin(b), math.cos(c), math.sin(c)
    return [[cc * cb, cc * sb * sa - sc * ca, cc * sb * ca + sc * sa],
            [sc * cb, sc * sb * sa + cc * ca, sc * sb * ca - cc * sa],
            [-sb, cb * sa, cb * ca]]


def camera(t):
    """A hand that sways in front of the scene: rotation and place in the world."""
    place = [0.30 * math.sin(0.9 * t), 0.18 * math.sin(1.3 * t + 0.4) - 0.07, -1.25 + 0.22 * math.sin(0.6 * t)]
    return rotation(0.10 * math.sin(1.1 * t), 0.14 * math.sin(0.8 * t), 0.08 * math.sin(0.7 * t)), place


def quaternion(r):
    w = 0.5 * math.sqrt(max(1e-12, 1 + r[0][0] + r[1][1] + r[2][2]))
    return [w, (r[2][1] - r[1][2]) / (4 * w), (r[0][2] - r[2][0]) / (4 * w), (r[1][0] - r[0][1]) / (4 * w)]


def scene(generator, features):
    """Points of the target and others on the wall z = 0, as many on the floor, and the rest in between."""
    points = [[x, y, 0.0] for x, y in ((-0.2, -0.15), (0.2, -0.15), (0.2, 0.15), (-0.2, 0.15), (0.0, -0.15), (0.0, 0.15))]
    while len(points) < features:
        x, y, z = generator.uniform(-0.75, 0.75), generator.uniform(-0.55, 0.45), generator.uniform(-0.3, 0.7)
        where = len(points) % 5
        points.append([x, y, 0.0] if where < 2 else [x, 0.5, min(z, 0.0) - 0.1] if where < 4 else [x, y, -abs(z) / 2])
    return points


def write_session(path, frames, features, rate_hz=30.0):
    """The camera's truth by frame: its places in the world."""
    generator = random.Random(SEED)
    print(f"seed {SEED}, {frames} frames of {features} features", flush=True)
    points = scene(generator, features)
    first_rotation, first_place = camera(0.0)
    head = struct.pack("<I7i", 0x31534650, frames, WIDTH, HEIGHT, features, 13 + 6 * features, min(features, 60), TARGETS)
    head += struct.pack("<5d", FOCAL, FOCAL, 159.5, 119.5, SIGMA_PX)
    head += struct.pack("<9d", *quaternion(first_rotation), *(v + 0.005 for v in first_place), 0.02, 0.01)
    for k in range(16):
        head += struct.pack("<3d", *(points[k] if k < TARGETS else (0, 0, 0)))
    truth = []
    with open(path, "wb") as file:
        file.write(head)
        for k in range(frames):
            r, p = camera(k / rate_hz)
            truth.append(p)
            seen = []
            for number, point in enumerate(points):
                d = [point[i] - p[i] for i in range(3)]
                x, y, z = (sum(r[i][j] * d[i] for i in range(3)) for j in range(3))
                u, v = FOCAL * x / z + 159.5, FOCAL * y / z + 119.5
                u, v = u + generator.gauss(0, SIGMA_PX), v + generator.gauss(0, SIGMA_PX)
                if z > 0.1 and 2 < u < WIDTH - 3 and 2 < v < HEIGHT - 3:
                    seen.append(struct.pack("<IIdd", number, 0, u, v))
            file.write(struct.pack("<qii", 1_000_000_000 + round(1e9 * k / rate_hz), len(seen), 0) + b"".join(seen))
    return truth


def read_result(path):
    """Per frame: (t_ns, status, features, state_dim, inliers), place, sigma of the place."""
    data = open(path, "rb").read()
    return [(row[0:5], row[9:12], row[12:15]) for row in struct.iter_unpack(RECORD, data)]


def furthest_apart(one, other):
    """Largest distance between two runs' places in the same frame [m]."""
    return max(math.dist(a[1], b[1]) for a, b in zip(one, other, strict=True))


def furthest_from_truth(result, truth):
    return max(math.dist(row[1], place) for row, place in zip(result, truth, strict=True))


def check_tracks(result, truth, frames, features):
    """The run has all of its frames, tracks to the end, holds a map, and is where it should be."""
    if len(result) != frames or result[-1][0][1] != 0 or result[-1][0][2] < features // 2:
        raise SystemExit(f"FAIL: {len(result)} frames of {frames}, the last one says {result[-1:]}")
    off = furthest_from_truth(result, truth)
    print(f"the last frame has {result[-1][0][2]} features and {result[-1][0][3]} states; at most {off:.4f} m from the truth")
    if off > 0.05:
        raise SystemExit(f"FAIL: {off} m from the truth")
