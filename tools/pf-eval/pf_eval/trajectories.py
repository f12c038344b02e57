"""Trajectories as programs and data sets write them.

  TUM     8 columns: timestamp tx ty tz qx qy qz qw, cut by blanks or commas
  EuRoC   8 or 17 columns of a CSV in nanoseconds: timestamp, px, py, pz, qw, qx, qy, qz, and velocity and biases, which are passed over;
          11 are VINS'
  KITTI   12 columns without a time: the upper three rows of T_WC; 16 columns: all four; before them a time or the number of the frame
  folder  a file of four rows for each frame, as frame-000012.pose.txt
  header  columns in any order where the first line names them, as ROS names them too

Numbers of rows before a time, and names of images, are passed over. Anything else is refused by file, row and what was met.
"""

import pathlib
import re

import numpy as np
from scipy.spatial.transform import Rotation

from . import Refused
from .columns import TIMES, by_header, refuse_other_files, without_names
from .notes import note
from .tables import Table, is_number, read_text, split

KNOWN = ("known are 8 (TUM: timestamp tx ty tz qx qy qz qw), 8, 11 or 17 of a CSV in nanoseconds (EuRoC: timestamp, position, qw, qx, qy, qz, ..), "
         "12 or 16 (KITTI: rows of T_WC), 13 or 17 with a time or number before them, or a header that names them")
MAX_FRAMES = 1e8  # whole numbers below are numbers of frames
FIRST_NS = 1e17  # whole numbers from here on are nanoseconds since 1970, below these are of finer units than seconds
SINCE_1970 = ((FIRST_NS, "ns", "nanoseconds"), (1e14, "us", "microseconds"), (1e11, "ms", "milliseconds"))
UNIT_QUATERNION = 0.01
MAX_RATIO = 400.0     # of the steps of truth and run: more is another unit
SLOWEST_CAMERA = 0.5  # [s] from frame to frame of a run, beside which a truth that counts by 1 has frame numbers


class Trajectory:
    """Poses T_WC by time. t [s], p (n,3) [m], q (n,4) as w x y z, covariance (n,6,6) of (theta, p) or None.

    counts   t are numbers of frames, not times
    of_body  the poses are those of the body that the camera is mounted on
    """

    def __init__(self, t, p, q, covariance=None, source="", counts=False, of_body=False):
        self.t, self.p, self.q, self.covariance, self.source = t, p, q, covariance, source
        self.counts, self.of_body = counts, of_body

    def __len__(self):
        return len(self.t)

    def select(self, index):
        covariance = None if self.covariance is None else self.covariance[index]
        return Trajectory(self.t[index], self.p[index], self.q[index], covariance, self.source, self.counts, self.of_body)

    def rotations(self):
        """(n,3,3), R_WC."""
        w, x, y, z = self.q.T
        return np.stack([1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
                         2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                         2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
                        axis=1).reshape(-1, 3, 3)

    def path(self):
        """Length of the way [m]."""
        return float(np.linalg.norm(np.diff(self.p, axis=0), axis=1).sum())


def _clean(path, t, p, q, lines, **kinds):
    """In order of time, without repeated times, quaternions of length 1."""
    length = np.linalg.norm(q, axis=1)
    bad = np.flatnonzero(np.abs(length - 1) > UNIT_QUATERNION)
    if len(bad):
        raise Refused(f"{path}: line {lines[bad[0]]} has a quaternion of length {length[bad[0]]:.4g}, not 1; {KNOWN}")
    order = np.argsort(t, kind="stable")
    order = order[np.concatenate([[True], np.diff(t[order]) > 0])]
    return Trajectory(t[order], p[order], (q / length[:, None])[order], source=str(path), **kinds)


def _seconds(path, t, unit=None):
    """Times in seconds. unit: 1e-9 .. 1 where the file says it; else by how large they are."""
    if unit is not None:
        return unit * t
    for first, short, name in SINCE_1970:
        if np.median(t) > first:
            if short != "ns":
                note(f"{path}: times like {t[0]:.0f} are taken as {name}; a first line can say it: # timestamp [{short}] ..")
            return TIMES[short] * t
    return t


def _matrices(path, numbers, lines):
    """(p, q) of rows of T_WC."""
    T = numbers.reshape(len(numbers), -1, 4)
    R = T[:, :3, :3]
    off = np.abs(np.einsum("nij,nkj->nik", R, R) - np.eye(3)).max(axis=(1, 2))
    last = np.abs(T[:, 3] - [0, 0, 0, 1]).max(axis=1) if T.shape[1] == 4 else np.zeros(len(T))
    bad = np.flatnonzero((off > UNIT_QUATERNION) | (np.linalg.det(R) < 0) | (last > 1e-6))
    if len(bad):
        raise Refused(f"{path}: line {lines[bad[0]]} has {numbers.shape[1]} columns that are no rows of a rotation and a translation; {KNOWN}")
    return T[:, :3, 3], Rotation.from_matrix(R).as_quat()[:, [3, 0, 1, 2]]


def _times_beside(path, count):
    """Seconds of the rows of a file without times, from KITTI's times.txt; None where there is none."""
    path = pathlib.Path(path)
    for times in (path.parent / "times.txt", path.parent.parent / "sequences" / path.stem / "times.txt"):
        if times.is_file() and times != path:
            words = [split(line) for line in map(str.strip, read_text(times).splitlines()) if line and line[0] != "#"]
            columns = {len(row) for row in words}
            if len(columns) != 1 or not all(is_number(row[-2 if len(row) == 3 else 0]) for row in words):
                raise Refused(f"{times}: is no table of times")
            if len(words) != count:
                raise Refused(f"{times}: has {len(words)} times for the {count} rows of {path}")
            return np.array([float(row[-2 if len(row) == 3 else 0]) for row in words])
    return None


def read_trajectory(path):
    """A trajectory in one of the forms above."""
    path = pathlib.Path(path)
    if path.is_dir():
        return read_pose_files(path)
    refuse_other_files(path)
    table = Table(path, texts=True)
    named = by_header(table) if table.header else None
    if table.has_header_row and not named:
        raise Refused(f"{path}: its header ({', '.join(table.header)}) names no time, position and quaternion; {KNOWN}")
    if named:
        t, unit, p, q = named
        return _clean(path, _seconds(path, t, unit), p, q, table.lines, of_body=any("_rs_" in name.lower() for name in table.header))
    return _by_count(path, without_names(table), table.lines)


def _by_count(path, numbers, lines):
    """A trajectory by how many columns there are."""
    columns = numbers.shape[1]
    if columns == 9 and _is_counting(numbers[:, 0]) and not _is_counting(numbers[:, 1]):
        numbers, columns = numbers[:, 1:], 8
    if columns in (13, 17) and (columns == 13 or _are_whole_matrices(numbers)):
        p, q = _matrices(path, numbers[:, 1:], lines)
        counts = bool((numbers[:, 0] == np.floor(numbers[:, 0])).all() and np.median(numbers[:, 0]) < MAX_FRAMES)
        return _clean(path, numbers[:, 0] if counts else _seconds(path, numbers[:, 0]), p, q, lines, counts=counts)
    whole_ns = (numbers[:, 0] == np.floor(numbers[:, 0])).all() and np.median(numbers[:, 0]) > FIRST_NS
    if columns == 17 or (columns in (8, 11) and whole_ns and _is_cut_by_commas(path)):
        return _clean(path, 1e-9 * numbers[:, 0], numbers[:, 1:4], numbers[:, 4:8], lines, of_body=True)
    if columns == 8:
        return _clean(path, _seconds(path, numbers[:, 0]), numbers[:, 1:4], numbers[:, [7, 4, 5, 6]], lines)
    if columns in (12, 16):
        p, q = _matrices(path, numbers, lines)
        t = _times_beside(path, len(p))
        return _clean(path, np.arange(len(p)) if t is None else t, p, q, lines, counts=t is None)
    raise Refused(f"{path}: line {lines[0]} has {columns} columns; {KNOWN}")


def _are_whole_matrices(numbers):
    return (numbers[:, -4:] == [0, 0, 0, 1]).all()


def _is_cut_by_commas(path):
    return any("," in line for line in map(str.strip, read_text(path).splitlines()) if line and line[0] not in "#%")


def read_pose_files(folder):
    """A trajectory from a file of four rows for each frame; frames whose pose is not finite are left out."""
    files = sorted(path for path in folder.iterdir() if path.name.endswith("pose.txt") and re.search(r"\d", path.name))
    if not files:
        raise Refused(f"{folder}: is a folder, a file is needed (or a folder with frame-000000.pose.txt and so on)")
    count, rows = [], []
    for path in files:
        table = Table(path)
        if table.numbers.shape != (4, 4):
            raise Refused(f"{path}: has {table.numbers.shape[0]} rows of {table.numbers.shape[1]} columns; a pose has 4 of 4")
        if np.isfinite(table.numbers).all():
            count.append(float(re.findall(r"\d+", path.name)[0]))
            rows.append(table.numbers.ravel())
    if len(rows) < len(files):
        note(f"{folder}: {len(files) - len(rows)} of its poses are not finite and left out")
    if not rows:
        raise Refused(f"{folder}: has no finite pose")
    p, q = _matrices(folder, np.array(rows), [1] * len(rows))
    return _clean(folder, np.array(count), p, q, [1] * len(rows), counts=True)


def _is_counting(t):
    return len(t) > 2 and (t == np.floor(t)).all() and np.median(np.diff(t)) == 1.0


def _overlap(a, b):
    """Share of the shorter of two spans that lies in both."""
    shorter = min(a[-1] - a[0], b[-1] - b[0])
    both = min(a[-1], b[-1]) - max(a[0], b[0])
    return both / shorter if shorter > 0 else float(both >= 0)


def on_one_clock(run, truth, frame_times=None):
    """(run, truth) with times that can be compared: frame numbers get times, and another unit is recognised by the other's times.

    frame_times  [s] of the run's frames by their number, NaN where one is not known; None: no list of frames
    """
    if run.counts and truth.counts:
        return run, truth
    if run.counts:
        return _in_rows_of(run, truth), truth
    step = np.median(np.diff(run.t)) if len(run) > 1 else 0.0
    if truth.counts or (_is_counting(truth.t) and 0 < step < SLOWEST_CAMERA):
        return run, _count(truth, run, frame_times)
    if len(truth) < 2 or len(run) < 2 or (_overlap(run.t, truth.t) > 0 and 1 / MAX_RATIO < np.median(np.diff(truth.t)) / step < MAX_RATIO):
        return run, truth
    for short, name in (("ms", "milliseconds"), ("us", "microseconds"), ("ns", "nanoseconds")):
        for one, other in ((truth, run), (run, truth)):
            scaled = TIMES[short] * one.t
            if _overlap(scaled, other.t) > 0.5 and 0.1 < (scaled[-1] - scaled[0]) / (other.t[-1] - other.t[0]) < 10:
                note(f"{one.source}: times like {one.t[0]:.6g} fit those of {other.source} as {name}, and are taken so")
                moved = one.select(slice(None))
                moved.t = scaled
                return (run, moved) if one is truth else (moved, truth)
    return run, truth


def _in_rows_of(run, truth):
    """A run without times, row by row of a truth of the same length."""
    if len(run) != len(truth):
        raise Refused(f"{run.source}: has no times, and {len(run)} rows where {truth.source} has {len(truth)}; "
                      "put the times.txt of the sequence beside it")
    timed = run.select(slice(None))
    timed.t, timed.counts = truth.t, False
    note(f"{run.source}: has no times; its rows are taken as those of {truth.source}")
    return timed


def _count(truth, run, frame_times):
    """Times of a truth that is numbered by frames: those of the run's frames by their number, or else at the rate of the run from 0 s on.

    Numbers in a column of times (a truth that does not count by rows) mean the latter first: frame k of such a sequence is at k times the
    step, wherever the sequence begins.
    """
    numbers = truth.t.astype(int)
    step = float(np.median(np.diff(run.t))) if len(run) > 1 else 0.0

    def timed(t):
        found = truth.select(np.isfinite(t))
        found.t, found.counts = t[np.isfinite(t)], False
        return found

    at_rate = timed(step * truth.t)
    fits = step > 0 and len(at_rate) > 1 and _overlap(at_rate.t, run.t) > 0.5
    if frame_times is not None and not (fits and not truth.counts):
        known = np.full(max(numbers.max() + 1, 0), np.nan)
        known[:len(frame_times)] = frame_times[:len(known)]
        by_number = timed(np.where(numbers >= 0, known[numbers], np.nan))
        if len(by_number):
            note(f"{truth.source}: has no times; its rows are taken as the frames of the run by their numbers")
            return by_number
    if not step > 0:
        raise Refused(f"{truth.source}: has no times, and {run.source} has too few poses to tell the rate of frames")
    note(f"{truth.source}: has frame numbers and no times; they are taken at {1 / step:.4g} Hz from 0 s on; a times.txt beside it can say them")
    return at_rate
