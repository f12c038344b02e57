"""The digest that tools/compare-trees compares: the same run gives it twice, it holds every kind of value, and one changed value is told by
run, frame and kind; runs of another length and of another seed are not the same."""

import importlib.machinery
import importlib.util
import os
import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import script  # noqa: E402

sys.dont_write_bytecode = True
PROGRAM = script.BIN / "pf-digest"
loader = importlib.machinery.SourceFileLoader("compare_trees", str(script.SOURCE / "tools/compare-trees"))
compare_trees = importlib.util.module_from_spec(importlib.util.spec_from_loader("compare_trees", loader))
loader.exec_module(compare_trees)


def digest(file, *words):
    subprocess.run([PROGRAM, *words], check=True, env={**os.environ, "PLANEFOLD_DIGEST": str(file)})
    return file


def expect(what, found, wanted):
    print(what, found)
    if found != wanted:
        script.fail(f"{what}: {found}, not {wanted}")


script.skip_in_cross_builds()
if not PROGRAM.is_file():
    script.skip("pf-digest was not built")
with tempfile.TemporaryDirectory(prefix="planefold_") as name:
    folder = pathlib.Path(name)
    once = digest(folder / "once", "sim:desk", "--frames", "60")
    again = digest(folder / "again", "sim:desk", "--frames", "60")
    expect("the same run", compare_trees.compare_digests(once, again), (60, None))

    lines = once.read_text().splitlines()
    kinds = lines[1].split()[1:]
    # What a plain run lacks: templates, a lens that is estimated, an inertial unit, corrections.
    richer = [digest(folder / "masks", "sim:desk", "--masks", "--lens", "--frames", "40"),
              digest(folder / "window", "sim:desk", "--backend", "window", "--frames", "60"),
              digest(folder / "unit", "sim:room", "--auto", "--imu", "--frames", "60"),
              digest(folder / "long", "sim:desk", "--frames", "101")]
    runs = [lines, *(file.read_text().splitlines() for file in richer)]
    for column, kind in enumerate(kinds, 1):
        changes = any(len({line.split()[column] for line in run[2:]}) > 1 for run in runs)
        # It tracks from the first frame on, the gauge is read in every hundredth frame, and patches lie on walls of a plan (pf-sim street).
        if not changes and kind not in ("state", "patches"):
            script.fail(f"'{kind}' is the same in all frames of all runs: it is not hashed")
    for column, kind in enumerate(kinds, 1):
        words = lines[22].split()
        words[column] = f"{int(words[column], 16) ^ 1:016x}"
        changed = folder / "changed"
        changed.write_text("\n".join(lines[:22] + [" ".join(words)] + lines[23:]) + "\n")
        expect("one value", compare_trees.compare_digests(once, changed), (20, f"run 1, frame 21: {kind}"))

    short = digest(folder / "short", "sim:desk", "--frames", "59")
    expect("a shorter run", compare_trees.compare_digests(once, short), (59, "run 1: NEW ends after frame 59"))
    other = digest(folder / "other", "sim:desk", "--frames", "60", "--auto")
    first = compare_trees.compare_digests(once, other)[1] or ""
    print("a start without the target", first)
    if not first.startswith("run 1, frame 1: state, pose"):
        script.fail(f"a start without the target: '{first}'")
