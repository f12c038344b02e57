"""Runs that go on from saves of themselves have the digests of runs that were never saved: with an inertial unit in both back ends, an open lens, templates
with masks, places, and a covered lens."""

import os
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import script  # noqa: E402

PROGRAM = script.BIN / "pf-digest"
EVERY = "3"  # frames from save to save
RUNS = [
    ["sim:room", "--auto", "--imu", "--frames", "90"],
    ["sim:room", "--auto", "--imu", "--backend", "window", "--frames", "200"],
    ["sim:desk", "--masks", "--lens", "--frames", "40"],
    ["sim:room", "--backend", "window", "--lens", "--frames", "60"],
    ["sim:room", "--places", "8", "--black-from", "40", "--black", "12", "--frames", "80"],
]


def digest(file, words, **more):
    subprocess.run([PROGRAM, *words], check=True, env={**os.environ, "PLANEFOLD_DIGEST": str(file), **more})
    return file.read_text()


script.skip_in_cross_builds()
if not PROGRAM.is_file():
    script.skip("pf-digest was not built")
with tempfile.TemporaryDirectory(prefix="planefold_") as name:
    for number, words in enumerate(RUNS):
        plain = digest(pathlib.Path(name) / f"plain{number}", words)
        continued = digest(pathlib.Path(name) / f"continued{number}", words, PLANEFOLD_DIGEST_CONTINUE=EVERY)
        print(*words, len(plain.splitlines()), "lines")
        if continued != plain:
            first = next(k for k, (a, b) in enumerate(zip(plain.splitlines(), continued.splitlines())) if a != b)
            script.fail(f"{' '.join(words)}: line {first + 1} is another one in the run that goes on")
