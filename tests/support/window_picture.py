"""What the window of pf-capture shows, read off a picture of the screen, and whether it says the same as the files of the run.

Which frame is shown is read off the time line; the marks of that frame must be where tracks.csv says, in the colour of what they
are, no others may be there, and the time line must have the states of frames.csv, whose sum is in report.json."""

import itertools
import json
import math
import re
import struct
import zlib

from script import fail

WIDTH, HEIGHT, STRIP, LINE = 640, 480, 40, 6
ZOOM = 2  # the pictures of sim:desk are half as large
POINT, INVERSE_DEPTH = (0.21, 0.86, 0.50), (0.30, 0.68, 1.00)
STATES = {"starting": (0.52, 0.57, 0.64), "tracking": POINT, "coasting": (1.00, 0.70, 0.22), "lost": (1.00, 0.33, 0.33)}
GRID = (0.16, 0.19, 0.23)
RADIUS = 2.4  # of the dot of a point that was measured


def levels(colour, alpha=1.0, ground=(0.0, 0.0, 0.0)):
    return tuple(255.0 * (alpha * c + (1.0 - alpha) * g) for c, g in zip(colour, ground))


def plane_colour(number):
    """As in examples/capture/plane_colour.h."""
    hue = (0.08 + 0.61803398875 * number) % 1.0
    return tuple(0.36 + 0.62 * min(1.0, max(0.0, abs((hue + shift) % 1.0 * 6.0 - 3.0) - 1.0)) for shift in (0.0, 2 / 3, 1 / 3))


def is_near(pixel, colour, tolerance):
    return all(abs(a - b) <= tolerance for a, b in zip(pixel, colour))


class Screen:
    """What a screen shows: rows of blue, green, red and a byte that says nothing."""

    def __init__(self, width, height, stride, data):
        self.width, self.height, self.stride, self.data = width, height, stride, data
        self.left = self.top = 0
        self.window = (width, height)

    @classmethod
    def from_xwd(cls, data):
        """From what Xvfb keeps its pixels in."""
        head = struct.unpack(">25I", data[:100])
        width, height, order, bits, stride, colours = head[4], head[5], head[7], head[11], head[12], head[19]
        if bits != 32 or order != 0:
            fail(f"the screen has {bits} bits per pixel in byte order {order}")
        return cls(width, height, stride, data[head[0] + 12 * colours:])

    @classmethod
    def from_ppm(cls, data):
        """From what QEMU writes of an emulated screen."""
        head = re.match(rb"P6\s+(\d+)\s+(\d+)\s+255\s", data)
        if head is None:
            fail("the emulator's picture of the screen is no PPM of 8 bits")
        width, height = int(head.group(1)), int(head.group(2))
        rgb = data[head.end():head.end() + 3 * width * height]
        pixels = bytearray(4 * width * height)
        pixels[0::4], pixels[1::4], pixels[2::4] = rgb[2::3], rgb[1::3], rgb[0::3]
        return cls(width, height, 4 * width, bytes(pixels))

    def pixel(self, x, y):
        at = (self.top + y) * self.stride + 4 * (self.left + x)
        return self.data[at + 2], self.data[at + 1], self.data[at]

    def rows(self):
        """Rows of the window as RGB bytes, rounded to steps of 8, which halves the size of a picture and cannot be seen."""
        rounded = bytes(min(255, (level + 4) // 8 * 8) for level in range(256))
        for y in range(self.window[1]):
            row = self.data[(self.top + y) * self.stride + 4 * self.left:][:4 * self.window[0]]
            rgb = bytearray(3 * self.window[0])
            rgb[0::3], rgb[1::3], rgb[2::3] = row[2::4], row[1::4], row[0::4]
            yield bytes(rgb).translate(rounded)

    def places_of(self, colour):
        """Where in the picture a colour is, but for rounding."""
        red, green, blue = (sorted({math.floor(c), math.ceil(c)}) for c in colour)
        for rgb in itertools.product(red, green, blue):
            pattern = bytes(reversed(rgb))
            for y in range(HEIGHT):
                begin = (self.top + y) * self.stride + 4 * self.left
                at = self.data.find(pattern, begin, begin + 4 * WIDTH)
                while at >= 0:
                    if (at - begin) % 4 == 0:
                        yield (at - begin) // 4, y
                    at = self.data.find(pattern, at + 1, begin + 4 * WIDTH)

    def find_window(self):
        """The window is what is not black. False: there is none yet."""
        rows = [self.data[y * self.stride:y * self.stride + 4 * self.width] for y in range(self.height)]
        black = bytes(4 * self.width)
        used = [y for y, row in enumerate(rows) if row != black]
        if not used:
            return False
        middle = rows[used[0]]
        lit = [x for x in range(self.width) if any(middle[4 * x:4 * x + 3])]
        self.left, self.top = lit[0], used[0]
        self.window = (lit[-1] - lit[0] + 1, used[-1] - used[0] + 1)
        return True

    def write_png(self, path):
        def chunk(kind, data):
            return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

        rows, before = [], bytes(3 * self.window[0])
        for row in self.rows():  # each row as its difference from the one above
            rows.append(b"\2" + bytes((a - b) & 255 for a, b in zip(row, before)))
            before = row
        head = struct.pack(">IIBBBBB", *self.window, 8, 2, 0, 0, 0)
        path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(b"".join(rows), 9)) +
                         chunk(b"IEND", b""))


def frames_on_time_line(screen, frames):
    """Colours of the time line of a run of so many frames, a column for each frame that it has."""
    y = screen.window[1] - LINE // 2
    columns = [screen.pixel(int((i + 0.5) * screen.window[0] / frames), y) for i in range(frames)]
    grid = levels(GRID)
    return [c for c in columns if not is_near(c, grid, 3)]


def state_of(pixel):
    names = [name for name, colour in STATES.items() if is_near(pixel, levels(colour, 0.9, GRID), 4)]
    return names[0] if names else f"the colour {pixel}"


def check_marks(screen, frame, tracks, problems):
    """Gives how many measured points were found in the picture."""
    inliers = [(float(t[9]), float(t[10]), t[3]) for t in tracks if t[2] == "inlier"]
    places = [(float(t[9] or t[4]), float(t[10] or t[5])) for t in tracks]
    colours = {"point": levels(POINT), "inverse_depth": levels(INVERSE_DEPTH)}
    planes = [levels(plane_colour(number)) for number in range(1, 33)]
    found = 0
    for u, v, kind in inliers:
        x, y = int(ZOOM * (u + 0.5)), int(ZOOM * (v + 0.5))
        if not (3 <= x < WIDTH - 3 and 3 <= y < HEIGHT - 3):
            continue
        around = [screen.pixel(x + i, y + j) for i in (-1, 0, 1) for j in (-1, 0, 1)]
        allowed = planes + ([colours[kind]] if kind in colours else [])
        if any(is_near(p, c, 6) for p in around for c in allowed):
            found += 1
        elif sum(abs(u - a) < 7 / ZOOM and abs(v - b) < 7 / ZOOM for a, b in places) < 2:  # its neighbour's mark does not hide it
            problems.append(f"frame {frame}: no mark of a measured {kind} at {u:.1f}, {v:.1f}: {around[4]}")
    for colour in colours.values():
        for x, y in screen.places_of(colour):
            if not any(abs(x - ZOOM * (u + 0.5)) <= RADIUS + 2 and abs(y - ZOOM * (v + 0.5)) <= RADIUS + 2 for u, v, _ in inliers):
                problems.append(f"frame {frame}: a mark at {x}, {y} that no measured point has")
    return found, len(inliers)


def check(screens, out, frames, least):
    """Holds screens, in order, against the files of a run; at least so many of its frames must be on them. Gives the last."""
    table = [line.split(",") for line in (out / "frames.csv").read_text().splitlines()[1:]]
    states = [row[1] for row in table]
    inlier_counts = [int(row[4]) for row in table]
    report = json.loads((out / "report.json").read_text())
    tracks = {}
    for line in (out / "tracks.csv").read_text().splitlines()[1:]:
        row = line.split(",")
        tracks.setdefault(int(row[0]), []).append(row)
    problems, seen, last, total = [], [], None, 0
    for screen in screens:
        if not screen.find_window() or screen.window[1] != HEIGHT + STRIP:
            continue
        line = frames_on_time_line(screen, frames)
        frame = len(line) - 1
        if frame < 0 or frame in seen:
            continue
        drawn = [state_of(pixel) for pixel in line]
        if drawn != states[:frame + 1]:
            problems.append(f"frame {frame}: the time line shows {drawn}, frames.csv says {states[:frame + 1]}")
        found, count = check_marks(screen, frame, tracks.get(frame, []), problems)
        if count != inlier_counts[frame]:
            problems.append(f"frame {frame}: tracks.csv has {count} measured points, frames.csv {inlier_counts[frame]}")
        if found < 0.8 * count:
            problems.append(f"frame {frame}: {found} marks of {count} measured points")
        total += found
        seen.append(frame)
        last = screen
        if frame == frames - 1 and drawn.count("tracking") != report["tracked"]:
            problems.append(f"the time line has {drawn.count('tracking')} tracked frames, report.json {report['tracked']}")
    print(f"{len(seen)} of {frames} frames were seen on the screen, {total} marks where the files say")
    if seen != sorted(seen) or len(seen) < least or total < 20 * len(seen) // 2:
        problems.append(f"too little was seen, or not in order: frames {seen}, {total} marks")
    if problems:
        fail("\n  ".join([f"{len(problems)} found:", *problems[:20]]))
    return last
