"""Masks as files: --mask and mask.png beside the frames keep the programs from what is masked, and what is wrong with one is said in one line
that names it."""

import csv
import json
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile
import zlib

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, run, skip, skip_in_cross_builds  # noqa: E402

CAPTURE, CALIBRATE = BIN / "pf-capture", BIN / "pf-calibrate"
WIDTH, HEIGHT, FRAMES = 320, 240, 40
ROW = HEIGHT // 2


def write_mask(path, width=WIDTH, height=HEIGHT, grey=lambda x, y: 255 if y < ROW else 0):
    rows = b"".join(b"\0" + bytes(grey(x, y) for x in range(width)) for y in range(height))

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))
    return path


def capture(film, out, *words):
    return [CAPTURE, "--source", f"images:{film}", "--headless", "--no-film", "--quiet", "--out", out, *words]


def matches_below(out):
    with open(out / "tracks.csv") as file:
        return sum(1 for row in csv.DictReader(file) if row["status"] in ("inlier", "outlier", "new") and float(row["measured_v"] or -1) >= ROW)


def expect(names, *words):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False)
    if done.returncode == 0 or done.stderr.strip().count("\n") or not all(name in done.stderr for name in names):
        fail(f"{words}: {done.returncode}, {done.stderr}, expected {names}")


def test_masks_should_keep_matches_out(film, folder):
    out = folder / "out"
    run(*capture(film, out, "--tracks"))
    if matches_below(out) == 0:
        fail("nothing was matched in the lower half without a mask")
    plain = (out / "trajectory.txt").read_text()
    mask = write_mask(folder / "half.png")
    for backend in ("filter", "window"):
        run(*capture(film, out, "--tracks", "--mask", mask, "--backend", backend))
        if matches_below(out):
            fail(f"{backend}: {matches_below(out)} matches on what is masked")
    for place in (film, film / "images"):
        shutil.copy(mask, place / "mask.png")
        run(*capture(film, out, "--tracks"))
        if matches_below(out):
            fail(f"mask.png in {place} was not found")
        if json.loads((out / "report.json").read_text())["frames"] != FRAMES:
            fail("mask.png was taken for a frame")
        run(*capture(film, out, "--mask", "none"))
        if (out / "trajectory.txt").read_text() != plain:
            fail("--mask none is not as without a mask")
        (place / "mask.png").unlink()


def test_wrong_masks_should_be_refused_in_one_line(film, folder):
    out = folder / "out"
    small = write_mask(folder / "small.png", WIDTH // 2)
    grey = write_mask(folder / "grey.png", grey=lambda x, y: 128 if (x, y) == (7, 9) else 255)
    black = write_mask(folder / "black.png", grey=lambda x, y: 0)
    text = folder / "text.png"
    text.write_text("no picture")
    cases = ((small, [f"{WIDTH // 2} x {HEIGHT}", f"{WIDTH} x {HEIGHT}"]), (grey, ["128", "7, 9"]), (text, ["PNG"]),
             (folder / "nowhere.png", ["nowhere.png"]))
    for mask, names in cases:
        expect([mask.name, *names], *capture(film, out, "--mask", mask))
        if CALIBRATE.is_file():
            expect([mask.name, *names], CALIBRATE, "--source", f"images:{film}", "--out", folder / "calibration", "--mask", mask)
    expect([black.name, "whole image"], *capture(film, out, "--mask", black))
    shutil.copy(grey, film / "mask.png")
    expect(["mask.png", "128"], *capture(film, out))
    (film / "mask.png").unlink()


skip_in_cross_builds()
if not CAPTURE.is_file():
    skip("pf-capture was not built")
if not (BIN / "pf-sim").is_file():
    skip("pf-sim, which renders the film, was not built")
with tempfile.TemporaryDirectory(prefix="planefold_") as made:
    root = pathlib.Path(made)
    run(BIN / "pf-sim", "render", "desk", "--out", root / "film", "--frames", FRAMES, "--width", WIDTH)
    test_masks_should_keep_matches_out(root / "film", root)
    test_wrong_masks_should_be_refused_in_one_line(root / "film", root)
