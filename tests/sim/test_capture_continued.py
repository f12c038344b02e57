"""A run of pf-capture that goes on from --save-map --map-kind continue writes the lines of one that never ended; pf-eval map says what the
file is, and a run of another config refuses it by name."""

import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, skip_in_cross_builds  # noqa: E402

FIRST, THEN = 60, 30  # frames


def capture(out, *options, expect=0):
    words = [BIN / "pf-capture", "--source", "sim:room", "--headless", "--no-film", "--quiet", "--out", out, *options]
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False)
    if done.returncode != expect:
        fail(f"{' '.join(map(str, options))}: exit status {done.returncode}, not {expect}: {done.stderr}")
    return done.stderr


def lines(out):
    return [line for line in (out / "trajectory.txt").read_text().splitlines() if not line.startswith("#")]


skip_in_cross_builds()
with tempfile.TemporaryDirectory(prefix="planefold_") as scratch:
    root = pathlib.Path(scratch)
    for backend in ("filter", "window"):
        saved = root / f"{backend}.live"
        capture(root / "first", "--backend", backend, "--frames", FIRST, "--save-map", saved, "--map-kind", "continue")
        capture(root / "then", "--backend", backend, "--skip", FIRST, "--frames", THEN, "--map", saved)
        capture(root / "whole", "--backend", backend, "--frames", FIRST + THEN, "--max-places", 16)
        if lines(root / "first") + lines(root / "then") != lines(root / "whole"):
            fail(f"the {backend} does not go on as it would have")
        why = capture(root / "other", "--backend", backend, "--max-planes", 5, "--map", saved, expect=2)
        if "another config" not in why:
            fail(f"a run of another config says {why}")
        said = subprocess.run([BIN / "pf-eval", "map", saved], capture_output=True, text=True, check=True).stdout
        print(said)
        if "to go on with" not in said:
            fail("pf-eval map does not say that the file is to go on with")
    if capture(root / "late", "--backend", "window", "--frames", 2, "--map", saved, expect=1).find("leave out those of before with --skip") < 0:
        fail("a map that goes on after a later frame: the line does not name --skip")
    mine = root / "thesis.tex"
    mine.write_text("years")
    for option in ("--ply", "--json"):
        said = subprocess.run([BIN / "pf-eval", "map", saved, option, mine], capture_output=True, text=True, check=False)
        if said.returncode != 1 or said.stderr.count("\n") != 1 or mine.read_text() != "years":
            fail(f"pf-eval map {option} over another file: {said.returncode}, {said.stderr}")
    again = [subprocess.run([BIN / "pf-eval", "map", saved, "--json", root / "map.json"], check=False).returncode for _ in range(2)]
    if again != [0, 0]:
        fail("pf-eval map --json does not replace its own file")
