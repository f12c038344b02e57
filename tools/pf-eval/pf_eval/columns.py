"""Which column of a table of poses holds what."""

import re

from . import Refused
from .tables import read_text, split_unit

TIMES = {"s": 1.0, "sec": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}
LENGTHS = {"m": 1.0, "cm": 1e-2, "mm": 1e-3}
IMAGE = re.compile(r".*\.(png|jpe?g|p[gpn]m|tiff?|bmp|webp|exr)", re.IGNORECASE)
# Of a ROS message as rostopic echo -p, PlotJuggler and bagpy name its fields: the end of the name, and what it holds.
ROS = ((r"header\.stamp", "stamp"), (r"stamp\.secs?", "secs"), (r"stamp\.n(?:ano)?secs?", "nsecs"), (r"(?:position|translation)\.([xyz])", "p"),
       (r"(?:orientation|rotation)\.([wxyz])", "q"), (r"header\.seq|(?:child_)?frame_id|covariance.*|(?:linear|angular)\.[xyz]", ""))


def _role(column):
    """What a column of a header holds: t, px .. pz, qw .. qz, "" for what is passed over, None for what is not known; and its unit. Of
    ROS also stamp [ns], secs and nsecs, which come before a time of arrival."""
    name, unit = split_unit(column)
    for end, role in ROS:
        found = re.search(r"(?:^|\.)(?:" + end + ")$", name)
        if found:
            return role + "".join(filter(None, found.groups())), unit
    if name.strip("%") in ("t", "time", "timestamp", "timestamps", "stamp", "seconds", "sec"):
        return "t", unit or {"seconds": "s", "sec": "s"}.get(name, "")
    short = re.sub(r"[^a-z]", "", re.sub(r"_?rs_[rs]?|_rs", "", name))
    found = re.fullmatch(r"(?:p|t|pos|position|translation|trans)?([xyz])", short)
    if found:
        return "p" + found[1], unit
    found = re.fullmatch(r"(?:q|quat|quaternion|orientation|rot|rotation)([wxyz])", short)
    if found:
        return "q" + found[1], unit
    return ("" if re.match(r"(v|b|bw|ba|vel|bias|velocity)([xyz_]|$)", name) else None), unit


def _roles(table):
    """({role: column}, factors of time and length, names that are not known)."""
    roles, factors, unknown = {}, {"t": None, "p": 1.0}, []
    for column, name in enumerate(table.header):
        role, unit = _role(name)
        if role is None:
            if column not in table.texts or not IMAGE.fullmatch(table.texts[column]):
                unknown.append(name)
        elif role:
            if role in roles:
                raise Refused(f"{table.path}: its header names column '{name}' twice")
            roles[role] = column
            known = TIMES if role == "t" else LENGTHS
            if unit and role[0] in "tp":
                if unit not in known:
                    raise Refused(f"{table.path}: the unit of its column '{name}' is not known; known are {', '.join(known)}")
                factors[role[0]] = known[unit]
    return roles, factors, unknown


def by_header(table):
    """(t, its unit or None, p [m], q as w x y z) by the names of the columns, or None where the header is a remark."""
    roles, factors, unknown = _roles(table)
    wanted = ["px", "py", "pz", "qw", "qx", "qy", "qz"]
    clock = ["stamp"] if "stamp" in roles else ["secs", "nsecs"] if {"secs", "nsecs"} <= set(roles) else ["t"]
    if not set(wanted + clock) <= set(roles) or set(roles) - {"t", "stamp", "secs", "nsecs"} != set(wanted):
        return None
    if unknown:
        raise Refused(f"{table.path}: its column '{unknown[0]}' is not known; known are a time, a position, a quaternion, velocity and biases")
    used = [roles[role] for role in clock + wanted]
    table.require_finite(used)
    numbers = table.numbers[:, used]
    t, unit = numbers[:, 0], factors["t"]
    if len(clock) == 2:
        t, unit = t + 1e-9 * numbers[:, 1], 1.0
    elif clock == ["stamp"]:
        unit = TIMES["ns"]
    return t, unit, factors["p"] * numbers[:, -7:-4], numbers[:, -4:]


def without_names(table):
    """The numbers of a table without a header, (n, columns); names of images are left out."""
    for column, word in table.texts.items():
        if not IMAGE.fullmatch(word):
            raise Refused(f"{table.path}: line {table.lines[0]} has '{word}' in column {column + 1}, which is no number")
    rest = [column for column in range(table.numbers.shape[1]) if column not in table.texts]
    table.require_finite(rest)
    return table.numbers[:, rest]


def refuse_other_files(path):
    """Files with poses of the same scene that are no tables of them."""
    text = read_text(path)[:2000].lstrip()
    if text[:1] in ("{", "["):
        raise Refused(f"{path}: is JSON; a table of poses is needed, as TUM's: timestamp tx ty tz qx qy qz qw")
    if "IMAGE_ID, QW, QX" in text:
        raise Refused(f"{path}: is COLMAP's images.txt, which has poses T_CW by names of images and no times; write their inverses as TUM's rows: "
                      "timestamp tx ty tz qx qy qz qw")
