"""plot-sim: a picture of per-frame tables, and one line for what is none."""

import pathlib
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import venv  # noqa: E402

venv.enter()
from script import SOURCE, fail  # noqa: E402

HEAD = "frame,nees_position,rmse_m,sigma_m,state_dim,bound_low,bound_high"
ROWS = "".join(f"{i},{2 + i % 3},0.01,0.012,200,2.5,3.5\n" for i in range(40))


def plot_sim(*words):
    return subprocess.run([sys.executable, SOURCE / "tools" / "plot-sim", *words], text=True, capture_output=True, check=False)


with tempfile.TemporaryDirectory(prefix="planefold_") as name:
    root = pathlib.Path(name)
    (root / "good.csv").write_text(f"{HEAD}\n{ROWS}")
    (root / "runs.csv").write_text("run,lost\n1,0\n")
    (root / "words.csv").write_text(f"{HEAD}\n{ROWS}7,starting,0,0,0,0,0\n")
    (root / "short.csv").write_text(f"{HEAD}\n{ROWS}7,3\n")
    (root / "empty.csv").write_text("")
    (root / "picture.csv").write_bytes(bytes(range(256)))
    drawn = plot_sim(root / "good.csv", "--out", root / "good.png")
    if drawn.returncode != 0 or not (root / "good.png").is_file():
        fail(f"no picture: {drawn.stderr}")
    for file, part in (("none.csv", "none.csv: cannot be read"), ("runs.csv", "runs.csv: has no column frame"), ("words.csv", "words.csv: holds something"),
                       ("short.csv", "short.csv: holds something"), ("empty.csv", "empty.csv: has no rows"), ("picture.csv", "picture.csv: ")):
        refused = plot_sim(root / file, "--out", root / "x.png")
        if refused.returncode != 1 or len(refused.stderr.splitlines()) != 1 or part not in refused.stderr or (root / "x.png").exists():
            fail(f"{file}: code {refused.returncode}, {refused.stderr}")
    for out in (root / "x.film", root / "nowhere" / "x.png"):
        refused = plot_sim(root / "good.csv", "--out", out)
        if refused.returncode != 1 or len(refused.stderr.splitlines()) != 1 or "cannot be written" not in refused.stderr:
            fail(f"{out}: code {refused.returncode}, {refused.stderr}")
