"""pf-eval map: what a saved map holds. Reads the format of lib/docs/reference/map_format.md by itself, and needs nothing but Python."""

import argparse
import json
import pathlib
import struct
import sys

from . import Refused
from .command_line import OneLineParser
from .output_folder import write

DESCRIPTION = """Says what is in a map that pf-capture --save-map or pf_save_map has written.

  pf-eval map FILE [--ply FILE.ply] [--json [FILE]]"""

MAGIC = b"\x89PFMAP\r\n"
HEADER, SECTION = struct.Struct("<8sIIQII"), struct.Struct("<IIQII")
PORTABLE, CONTINUE = 1, 2
TAGS = ["LENS", "WRLD", "PLAN", "PLAC"]  # and ANCH behind them, where there are anchors
PATCH = 22 * 22
KERNELS = {1: "reference", 2: "portable", 3: "avx2", 4: "avx512", 5: "neon"}
MODELS = {1: "pinhole", 2: "radtan", 3: "equidistant", 4: "division"}


def crc_table():
    table = []
    for value in range(256):
        for _ in range(8):
            value = value >> 1 ^ (0x82F63B78 if value & 1 else 0)
        table.append(value)
    return table


CRC = crc_table()


def crc32c(data):
    crc = 0xFFFFFFFF
    for byte in data:
        crc = CRC[(crc ^ byte) & 255] ^ crc >> 8
    return crc ^ 0xFFFFFFFF


class Numbers:
    """Numbers of a section, one after the other."""

    def __init__(self, name, data):
        self.name, self.data, self.at = name, data, 0

    def take(self, form):
        form = struct.Struct("<" + form)
        if self.at + form.size > len(self.data):
            raise Refused(f"{self.name} is too short")
        values = form.unpack_from(self.data, self.at)
        self.at += form.size
        return values

    def end(self):
        if self.at != len(self.data):
            raise Refused(f"{self.name} has another length")


def sections_of(data):
    if len(data) < HEADER.size or data[:8] != MAGIC:
        raise Refused("it is no saved map")
    _, version, kind, total, count, crc = HEADER.unpack_from(data)
    if version != 0:
        raise Refused(f"its format has version {version}; this program reads version 0")
    if crc != crc32c(data[:HEADER.size - 4]):
        raise Refused("its header is damaged")
    if kind not in (PORTABLE, CONTINUE):
        raise Refused(f"it is of kind {kind}, which this program does not know")
    if total != len(data):
        raise Refused(f"it has {len(data)} bytes and should have {total}")
    at, found = HEADER.size, {}
    for _ in range(count):
        if at + SECTION.size > len(data):
            raise Refused("a section is missing")
        tag, version, length, crc, _ = SECTION.unpack_from(data, at)
        name = tag.to_bytes(4, "little").decode("ascii", "replace")
        payload = data[at + SECTION.size:at + SECTION.size + length]
        if len(payload) != length or crc != crc32c(data[at:at + 16] + payload):
            raise Refused(f"section {name} is damaged")
        found[name] = Numbers(name, payload)
        at += SECTION.size + length
    known = (TAGS, [*TAGS, "ANCH"]) if kind == PORTABLE else (["ORIG", "LIVE"],)
    if list(found) not in known or at != len(data):
        raise Refused("it has not the sections of its kind")
    return found


def read_origin(sections):
    """What a context that goes on has to have in common with the one that was saved."""
    version, scalar, kernels, config, block = sections["ORIG"].take("4IQ")
    sections["ORIG"].end()
    return {"kind": "continue", "release": f"{version >> 16}.{version >> 8 & 255}.{version & 255}",
            "scalar": {8: "double", 4: "float"}.get(scalar, str(scalar)), "kernels": KERNELS.get(kernels, str(kernels)),
            "config": f"{config:08x}", "block_bytes": block, "live_bytes": len(sections["LIVE"].data)}


def text_of_origin(origin):
    return (f"  {origin['bytes'] / 1000:.1f} kB to go on with at the next frame: release {origin['release']}, {origin['scalar']}, "
            f"kernels {origin['kernels']}, config {origin['config']}, block of {origin['block_bytes']} bytes")


def read_lens(numbers):
    model, width, height, _ = numbers.take("4I")
    values = numbers.take("12d")
    numbers.end()
    return {"model": MODELS.get(model, str(model)), "width": width, "height": height,
            "fx": values[0], "fy": values[1], "cx": values[2], "cy": values[3], "distortion": list(values[4:])}


def read_planes(numbers):
    planes = []
    for _ in range(numbers.take("I")[0]):
        plane, points, vertices, _ = numbers.take("4I")
        R = numbers.take("9d")
        origin = numbers.take("3d")
        covariance = numbers.take("6d")
        outline = [numbers.take("2d") for _ in range(vertices)]
        normal = [R[2], R[5], R[8]]
        corners = [[origin[i] + R[3 * i] * u + R[3 * i + 1] * v for i in range(3)] for u, v in outline]
        area = 0.5 * sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(outline, outline[1:] + outline[:1]))
        planes.append({"id": plane, "max_points": points, "normal": normal,
                       "distance": sum(n * p for n, p in zip(normal, origin)), "area": area,
                       "sigma_distance": covariance[5] ** 0.5, "outline": corners})
    numbers.end()
    return planes


def rotate(q, v):
    """Of a quaternion w x y z."""
    w, u = q[0], q[1:]
    cross = lambda a, b: [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    t = [2 * x for x in cross(u, v)]
    return [x + w * y + z for x, y, z in zip(v, t, cross(u, t))]


def read_places(numbers):
    places = []
    for _ in range(numbers.take("I")[0]):
        place, count = numbers.take("2I")
        (depth,), q, p = numbers.take("d"), numbers.take("4d"), numbers.take("3d")
        numbers.take("21d")
        points = []
        for _ in range(count):
            feature, plane, observations, _, _, _, _ = numbers.take("3I4B")
            ray, (rho,) = numbers.take("3d"), numbers.take("d")
            covariance = numbers.take("6d")
            numbers.take("9d")
            numbers.take("4Q")
            pixels = numbers.take(f"{PATCH}s")[0]
            at = rotate(q, [x / rho for x in ray])
            points.append({"id": feature, "plane": plane, "observations": observations,
                           "p_W": [x + y for x, y in zip(p, at)], "grey": pixels[PATCH // 2 + 11],
                           "sigma": (covariance[0] + covariance[2] + covariance[5]) ** 0.5})
        places.append({"id": place, "q_WK": list(q), "p_WK": list(p), "depth": depth, "points": points})
    numbers.end()
    return places


def product(q, r):
    """Of quaternions w x y z."""
    w, x, y, z = q
    W, X, Y, Z = r
    return [w * W - x * X - y * Y - z * Z, w * X + x * W + y * Z - z * Y, w * Y - x * Z + y * W + z * X,
            w * Z + x * Y - y * X + z * W]


def read_anchors(numbers, places):
    """Where the view that an anchor was set from has it: one on a plane has not been put onto that as the map has it."""
    by_id = {place["id"]: place for place in places}
    world = {"q_WK": [1.0, 0.0, 0.0, 0.0], "p_WK": [0.0, 0.0, 0.0]}
    anchors = []
    for _ in range(numbers.take("I")[0]):
        anchor, place, plane, _ = numbers.take("4I")
        if place and place not in by_id:
            raise Refused(f"place {place} holds anchor {anchor}, and there is no such place")
        q, p = (by_id[place] if place else world)["q_WK"], (by_id[place] if place else world)["p_WK"]
        for _ in range(2):  # from the place to the view, and from there to the anchor
            relative_q, relative_p = numbers.take("4d"), numbers.take("3d")
            numbers.take("21d")
            p = [a + b for a, b in zip(p, rotate(q, relative_p))]
            q = product(q, relative_q)
        anchors.append({"id": anchor, "place": place, "plane": plane, "q_WA": list(q), "p_WA": p})
    numbers.end()
    return anchors


def read(path):
    try:
        data = pathlib.Path(path).read_bytes()
    except OSError as error:
        raise Refused(f"{path}: {error.strerror}") from error
    try:
        found = sections_of(data)
        if "ORIG" in found:
            return {"bytes": len(data), **read_origin(found)}
        gravity = list(found["WRLD"].take("3d"))
        found["WRLD"].end()
        places = read_places(found["PLAC"])
        return {"bytes": len(data), "lens": read_lens(found["LENS"]), "gravity_W": gravity if any(gravity) else None,
                "planes": read_planes(found["PLAN"]), "places": places,
                "anchors": read_anchors(found["ANCH"], places) if "ANCH" in found else []}
    except Refused as refused:
        raise Refused(f"{path}: {refused}") from refused


def points_of(saved):
    """Each point once, as the place knows it that is least uncertain."""
    best = {}
    for place in saved["places"]:
        for point in place["points"]:
            if point["id"] not in best or point["sigma"] < best[point["id"]]["sigma"]:
                best[point["id"]] = point
    return [best[key] for key in sorted(best)]


def to_ply(saved):
    """Points in their grey level, places in red, and anchors in blue."""
    rows = [(*point["p_W"], point["grey"], point["grey"], point["grey"]) for point in points_of(saved)]
    rows += [(*place["p_WK"], 255, 0, 0) for place in saved["places"]]
    rows += [(*anchor["p_WA"], 64, 128, 255) for anchor in saved["anchors"]]
    head = ["ply", "format ascii 1.0", "comment pf-eval map", f"element vertex {len(rows)}"]
    head += [f"property float {axis}" for axis in "xyz"] + [f"property uchar {c}" for c in ("red", "green", "blue")]
    return "\n".join(head + ["end_header"] + [f"{x:.6g} {y:.6g} {z:.6g} {r} {g} {b}" for x, y, z, r, g, b in rows]) + "\n"


def summary_of(saved):
    if saved.get("kind") == "continue":
        return saved
    points = points_of(saved)
    return {"bytes": saved["bytes"], "lens": saved["lens"], "gravity_W": saved["gravity_W"],
            "places": [{"id": place["id"], "points": len(place["points"]), "p_WK": place["p_WK"], "depth": place["depth"]}
                       for place in saved["places"]],
            "points": len(points), "points_on_planes": sum(point["plane"] != 0 for point in points),
            "planes": [{key: value for key, value in plane.items() if key != "outline"} for plane in saved["planes"]],
            "anchors": saved["anchors"]}


def text_of(summary):
    if summary.get("kind") == "continue":
        return text_of_origin(summary)
    lens, lines = summary["lens"], []
    lines.append(f"  {summary['bytes'] / 1000:.1f} kB, of a {lens['model']} camera of {lens['width']} x {lens['height']} "
                 f"pixels, f {lens['fx']:.1f}")
    lines.append(f"  {len(summary['places'])} places with {summary['points']} points, {summary['points_on_planes']} of them on planes")
    for place in summary["places"]:
        x, y, z = place["p_WK"]
        lines.append(f"  place {place['id']:5d}  {place['points']:3d} points, at {x:.3f} {y:.3f} {z:.3f}, median depth {place['depth']:.3g}")
    for plane in summary["planes"]:
        x, y, z = plane["normal"]
        lines.append(f"  plane {plane['id']:5d}  normal {x:.3f} {y:.3f} {z:.3f}, distance {plane['distance']:.3f}, area {plane['area']:.3g}")
    for anchor in summary["anchors"]:
        x, y, z = anchor["p_WA"]
        lies = f"on plane {anchor['plane']}" if anchor["plane"] else "on no plane"
        lines.append(f"  anchor {anchor['id']:4d}  at {x:.3f} {y:.3f} {z:.3f}, {lies}")
    if summary["gravity_W"] is not None:
        lines.append("  gravity {:.3f} {:.3f} {:.3f}".format(*summary["gravity_W"]))
    return "\n".join(lines)


def main(words):
    parser = OneLineParser(prog="pf-eval map", description=DESCRIPTION, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", metavar="FILE")
    parser.add_argument("--ply", metavar="FILE.ply", help="points and places as a cloud")
    parser.add_argument("--json", metavar="FILE", nargs="?", const="-", help="as JSON, to a file or the output")
    options = parser.parse_args(words)
    try:
        saved = read(options.file)
        summary = summary_of(saved)
        if options.ply and saved.get("kind") == "continue":
            raise Refused(f"{options.file}: it is to go on with, and lists no places; save a portable map for --ply")
        as_json = summary if options.json == "-" else {**summary, "written_by": "pf-eval"}  # so that a later run may take its place
        for path, text, mark in ((options.ply, to_ply(saved) if options.ply else "", "comment pf-eval map"),
                                 (options.json, json.dumps(as_json, indent=2) + "\n", '"written_by": "pf-eval"')):
            if path == "-":
                sys.stdout.write(text)
            elif path:
                write(path, text, mark)
        if options.json != "-":
            print(f"{options.file}\n{text_of(summary)}")
    except Refused as refused:
        print(f"pf-eval: {refused}", file=sys.stderr)
        return 1
    return 0
