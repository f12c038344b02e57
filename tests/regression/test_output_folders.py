"""What programs write into a folder: an earlier run's files are replaced, and nothing of the user's is deleted or overwritten.

tools/demo deleted the folder that --out named, whatever it held; plots of an earlier run stayed beside the files of the next."""

import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, SOURCE, fail, skip, skip_in_cross_builds  # noqa: E402

CAPTURE = [BIN / "pf-capture", "--source", "sim:desk", "--headless", "--quiet", "--no-film", "--frames", "8", "--start", "target", "--out"]


def require(condition, message):
    if not condition:
        fail(message)


def run(*command):
    return subprocess.run([str(word) for word in command], text=True, capture_output=True, check=False, cwd=SOURCE)


def contents(folder):
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def check_refusal(name, folder, *command):
    """A folder of the user's is refused in one line, and stays as it is."""
    (folder / "thesis").mkdir(parents=True)
    (folder / "thesis" / "chapter.tex").write_text("years of work")
    (folder / "trajectory.txt").write_text("measured by hand")
    before = contents(folder)
    result = run(*command)
    lines = result.stderr.strip().splitlines()
    require(result.returncode in (1, 2), f"{name}: exit code {result.returncode}, {result.stderr}")
    require(len(lines) == 1 and str(folder) in lines[0] and "choose another --out" in lines[0], f"{name}: {result.stderr}")
    require(contents(folder) == before, f"{name}: the user's folder was changed")


def check_inputs(root, images):
    """What a program wrote into a folder, and is read now, is not deleted by --out or --record."""
    before = contents(images)
    read = [BIN / "pf-capture", "--source", f"images:{images}", "--headless", "--quiet", "--no-film"]
    desk = [BIN / "pf-capture", "--source", "sim:desk", "--headless", "--quiet", "--no-film", "--frames", "2", "--out", images]
    cases = [("--out of the source", [*read, "--out", images]), ("the same by another path", [*read, "--out", f"{images}/../{images.name}/"]),
             ("--record of the source", [*read, "--out", root / "elsewhere", "--record", images]),
             ("a calibration in --out", [*read[:1], "--source", "images:/nowhere", "--calib", images / "calib.yaml", "--out", images]),
             ("a target in --out", [*desk, "--start", f"target:{images}/target.yaml"])]
    if (BIN / "pf-calibrate").is_file():
        cases.append(("pf-calibrate", [BIN / "pf-calibrate", "--source", f"images:{images}/images", "--out", images]))
    for name, command in cases:
        result = run(*command)
        lines = result.stderr.strip().splitlines()
        require(result.returncode == (1 if name == "pf-calibrate" else 2) and len(lines) == 1 and "would delete; choose another --" in lines[0], f"{name}: {result.stderr}")
        require(contents(images) == before, f"{name}: what was read is gone")
    result = run(*read, "--out", images / "run")  # beside the images
    require(contents(images).keys() > before.keys(), f"--out inside of the source: {result.stderr}")
    for path in sorted((images / "run").iterdir()):
        path.unlink()
    (images / "run").rmdir()


def check_reports(root):
    """A report takes the place of an earlier one, and of nothing else of the user's."""
    report, tables = root / "report.json", root / "tables"
    room = [BIN / "pf-sim", "room", "--seeds", "1", "--frames", "12", "--json", report, "--csv", tables]
    for _ in range(2):
        result = run(*room)
        require(result.returncode == 0, f"a report and an earlier one: {result.stderr}")
    report.write_text('{"name": "package.json of a user"}')
    programs = [room, [BIN / "pf-bench", "covariance", "--json", report]] if (BIN / "pf-bench").is_file() else [room]
    for command in programs:
        result = run(*command)
        require(result.returncode == 2 and "is there and is no earlier report" in result.stderr, f"{command[0]}: {result.stderr}")
        require("package.json" in report.read_text(), f"{command[0]}: the user's report was overwritten")
    (tables / "checker_none.csv").write_text("measured by hand")
    result = run(BIN / "pf-sim", "checker", "--seeds", "1", "--frames", "2", "--csv", tables)
    require(result.returncode == 1 and "checker_none.csv: is there already" in result.stderr, f"pf-sim checker: {result.stderr}")
    require((tables / "checker_none.csv").read_text() == "measured by hand", "pf-sim checker: the user's table was overwritten")


def main():
    skip_in_cross_builds()
    if not CAPTURE[0].is_file():
        skip("pf-capture was not built")
    with tempfile.TemporaryDirectory(prefix="planefold_") as name:
        root = pathlib.Path(name)
        check_refusal("pf-capture", root / "a", *CAPTURE, root / "a")
        check_refusal("tools/demo", root / "b", SOURCE / "tools" / "demo", "--no-plots", "--out", root / "b")
        if (BIN / "pf-sim").is_file():
            check_refusal("pf-sim render", root / "c", BIN / "pf-sim", "render", "desk", "--frames", "2", "--out", root / "c")
            images = root / "images"
            for frames in (3, 2):  # the second time there is no third image
                result = run(BIN / "pf-sim", "render", "desk", "--frames", frames, "--out", images)
                require(result.returncode == 0, f"pf-sim render: {result.stderr}")
                require(len(list((images / "images").iterdir())) == frames, f"{frames} frames were asked for: {contents(images).keys()}")
            check_inputs(root, images)
            check_reports(root)
        if (BIN / "pf-calibrate").is_file():
            check_refusal("pf-calibrate", root / "e", BIN / "pf-calibrate", "--source", f"images:{root}", "--out", root / "e")

        # A second run takes the place of the first, plots with it; what the user put there stays.
        out = root / "run"
        require(run(*CAPTURE, out, "--tracks").returncode == 0, "the first run failed")
        with open(out / ".planefold", "a") as listed:
            listed.write("plots/\nplots/frames.png\n/etc/hostname\n../outside.txt\n")
        (out / "plots").mkdir()
        for path in (out / "plots" / "frames.png", out / "notes.txt", root / "outside.txt"):
            path.write_text("kept or not")
        require(run(*CAPTURE, out).returncode == 0, "the second run failed")
        require(not (out / "tracks.csv").exists(), "tracks.csv of the first run is still there")
        require(not (out / "plots").exists(), "plots of the first run are still there")
        require((out / "notes.txt").read_text() == "kept or not", "the user's notes are gone")
        require((root / "outside.txt").exists() and pathlib.Path("/etc/hostname").exists(), "a list reached outside of its folder")

        # A file of the user's under a name that a run would write.
        (out / "tracks.csv").write_text("the user's own")
        result = run(*CAPTURE, out, "--tracks")
        require(result.returncode == 2 and "tracks.csv: is there already" in result.stderr, f"a foreign tracks.csv: {result.stderr}")
        require((out / "tracks.csv").read_text() == "the user's own", "the user's tracks.csv was overwritten")


main()
