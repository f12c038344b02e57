"""Every program says in one line what is wrong with its command line, and ends with 2; every tool has a --help."""

import pathlib
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, SOURCE, fail, skip, skip_in_cross_builds  # noqa: E402

NEED_NOTHING = ("adjust-run", "adjust-tags", "compare-runs", "compare-trees", "demo", "fuzz", "package", "plot-gee2007", "plot-masoud", "plot-run", "plot-servant",
                "plot-sim", "ray-sequence", "sweep-tuning", "test", "update-golden", "walls-from-geojson", "walls-from-obj")
IN_ENVIRONMENT = ("compare-runs", "plot-gee2007", "plot-masoud", "plot-run", "plot-servant", "plot-sim", "ray-sequence")
COMMANDS = ("pf-bench", "pf-replay", "pf-sim")
WRITE = {  # what cannot be written
    "pf-bench": [["frame", "--json", "/dev/null/x.json"]], "pf-replay": [["follow", "x", "--json", "/"]],
    "pf-sim": [[name, "--json", "/dev/null/x.json"] for name in ("room", "rendered", "box", "street", "vio", "checker", "gee2007")]
    + [[name, "--csv", "/dev/null/x"] for name in ("room", "rendered", "box", "street", "vio", "road")],
}
TOOLS = [  # words, and what the line says
    (["demo", "--jobs", "many"], "'many'"), (["demo", "--jobs"], "--jobs"), (["demo", "--jobs", "0"], "'0'"), (["fuzz", "1", "--jobs", "x"], "'x'"),
    (["fuzz"], "minutes"), (["fuzz", "3x"], "'3x'"), (["test", "--budget", "much"], "'much'"),
    (["package", "deb", "--jobs", "2.5"], "'2.5'"), (["package", "x86"], "aarch64, armhf or deb"),
    (["package"], "aarch64, armhf or deb"), (["update-golden", "--all"], "--all"),
    (["walls-from-geojson"], "FILE"), (["walls-from-obj", "x", "--sigma-offset", "0"], "0 is not above zero"),
    (["package", "deb", "--build"], "--build needs a value"), (["demo", "--source"], "--source needs a value"), (["fuzz", "1", "--only"], "--only needs a value"),
    (["count-decisions", "--list", "x"], "'x'"), (["draw-rooms", "--prnt"], "--prnt"), (["docs", "--out", "/dev/null/x"], "/dev/null/x"),
    (["remake-results", "x"], "x: is no table"), (["remake-results", "--bin", "/dev"], "holds no pf-*"), (["sweep-tuning", "--seeds", "0", "x"], "--seeds"),
    (["compare-trees"], "OLD"), (["plot-masoud"], "folder"), (["plot-gee2007"], "folder"),
    (["ray-sequence", "desk"], "OUT"), (["ray-sequence", "moon", "x"], "moon"), (["ray-sequence", "desk", "x", "--fov", "180"], "--fov 180"),
]
# Words that nobody can mean: what is typed wrong is met by the name that is like it, and a number by its range.
MISTAKES = {
    "pf-capture": [(["--framse", "9"], "(is it --frames?)"), (["--calibration", "x"], "(is it --calib?)"), (["--frames"], "--frames needs a value"),
                   (["--source", "sim:desk", "--source", "sim:room"], "--source is there more than once"), (["--gravity", "1,2"], "needs 3 numbers"),
                   (["--gravity", "1,x,2"], "'1,x,2' cannot be read"), (["--map-kind", "both"], "'both' is none of portable, continue"),
                   (["--patches", "99"], "from 0 to 32")],
    "pf-calibrate": [(["--sorce", "x"], "(is it --source?)"), (["--views", "3"], "'3' is not a whole number from 6 to 200"), (["--size", "99"], "needs 2 numbers")],
    "pf-sim": [(["rom"], "(is it room?)"), (["room", "--seds", "1"], "(is it --seeds?)"), (["room", "--seeds", "1.5"], "'1.5' is not a whole number"),
               (["room", "--first-seed", "-1"], "at least 0"), (["room", "--fold-sigma", "-1"], "at least 0"), (["gee2007", "--sigma-step", "nan"], "'nan'"),
               (["rendered", "--blur", "99"], "from 1 to 64"), (["rendered", "--sigma-px", "-1"], "at least 0"), (["vio", "--turn", "nan"], "'nan'"), ([], "which command?")],
    "pf-bench": [(["frame", "--kernels", "fast"], "'fast' is none of auto"), (["frame", "--patches", "4"], "--walls"), (["frme"], "(is it frame?)")],
}
failures = []


def said(*words):
    return subprocess.run([str(word) for word in words], text=True, capture_output=True, timeout=100, check=False, cwd=SOURCE)


def expect_refusal(parts, program, *words, folder=BIN):
    result = said(folder / program, *words)
    lines = result.stderr.splitlines()
    if result.returncode != 2 or len(lines) != 1 or not all(part in lines[0] for part in (f"{program}: ", "--help", *parts)) or result.stdout:
        failures.append(f"{program} {' '.join(words)}: code {result.returncode}, {result.stderr!r}, without {parts}")
    print(program, *words, result.returncode, result.stderr.strip())


def main():
    skip_in_cross_builds()
    programs = [name for name in (*COMMANDS, "pf-capture", "pf-calibrate", "pf-digest") if (BIN / name).is_file()]
    if not programs:
        skip("no program is part of this build")
    for program in programs:
        expect_refusal([], program)
        expect_refusal(["--nonsense"], program, "--nonsense")
        for words, part in MISTAKES.get(program, []):
            expect_refusal([part], program, *words)
        # Known before a run of hours, and not after it.
        for words in WRITE.get(program, []):
            expect_refusal([], program, *words)
        if program in COMMANDS:
            expect_refusal(["'nonsense'"], program, "nonsense")
        if said(BIN / program, "--help").returncode != 0:
            failures.append(f"{program} --help does not end with 0")
    with tempfile.TemporaryDirectory(prefix="planefold_") as name:
        for words in (["room", "--seeds", "1", "--frames", "5"], ["rendered", "--seeds", "1", "--frames", "2"]):
            report = pathlib.Path(name) / words[0] / "reports" / "x.json"
            if "pf-sim" in programs and (said(BIN / "pf-sim", *words, "--json", report).returncode != 0 or not report.is_file()):
                failures.append(f"pf-sim {words[0]} does not make the folder of its report")
        mine = pathlib.Path(name) / "calib.yaml"
        mine.write_text("mine\n")
        if "pf-replay" in programs and (said(BIN / "pf-replay", "record", mine, "--frames", "20").returncode != 1 or mine.read_text() != "mine\n"):
            failures.append("pf-replay record writes over a file that is there")
    if "pf-sim" in programs:
        for words in (["room", "--seeds", "0"], ["room", "--lens", "x"], ["rendered", "--scene", "x"], ["rendered", "--frames", "0"],
                      ["gee2007", "--jobs", "0"], ["render", "x", "--out", "/tmp/x"], ["box", "--cases", "x"], ["street", "--seeds", "0"],
                      # What does not belong together, or is no experiment.
                      ["box", "--rate", "0"], ["street", "--rate", "0"], ["room", "--target-points", "5"], ["room", "--in-view", "9"],
                      ["gee2007", "--hypotheses", "0"], ["gee2007", "--filter", "library", "--hypotheses", "9"], ["rendered", "--as-global"],
                      ["rendered", "--focal-error", "0.1"], ["vio", "--fault-at", "3"], ["vio", "--scene", "room"], ["vio", "--no-imu", "--delay", "0.01"],
                      ["vio", "--delay", "9"], ["vio", "--sigma-px", "0"]):
            result = said(BIN / "pf-sim", *words)
            if result.returncode != 2 or result.stderr.count("\n") != 1 or result.stdout:
                failures.append(f"pf-sim {' '.join(words)}: code {result.returncode}, {result.stderr!r}")
        result = said(BIN / "pf-sim", "kidnap", "--source", "images:/nowhere")
        if result.returncode != 1 or "/nowhere" not in result.stderr:
            failures.append(f"pf-sim kidnap of a missing folder: code {result.returncode}, {result.stderr!r}")
    for (tool, *words), part in TOOLS:
        expect_refusal([part], tool, *words, folder=SOURCE / "tools")
    for tool in NEED_NOTHING:
        result = said(SOURCE / "tools" / tool, "--help")
        if result.returncode != 0 or tool not in result.stdout or result.stderr:
            failures.append(f"tools/{tool} --help: code {result.returncode}, {result.stdout[:100]!r}, {result.stderr[:200]!r}")
    # Where the environment for plots is not there yet, and could not be made: neither help nor a mistake needs it.
    with tempfile.TemporaryDirectory(prefix="planefold_") as name:
        shutil.copytree(SOURCE / "tools", pathlib.Path(name) / "tools", ignore=shutil.ignore_patterns("__pycache__"))
        shutil.copy(SOURCE / "CMakeLists.txt", name)
        for tool in IN_ENVIRONMENT:
            for words, code in ((["--help"], 0), (["--nonsense"], 2)):
                result = subprocess.run([sys.executable, f"{name}/tools/{tool}", *words], text=True, capture_output=True, timeout=100, check=False,
                                        env={"PATH": name})
                if result.returncode != code or "Traceback" in result.stderr:
                    failures.append(f"tools/{tool} {words[0]} without an environment: code {result.returncode}, {result.stderr[-200:]!r}")
    if failures:
        fail("\n  ".join([f"{len(failures)} found:", *failures]))


main()
