"""pf-sim room with a camera drawn from its prior: considered or estimated, the filter is as honest as with the right one; taken as exact, it
is not. A considered calibration stays where it was given, so its errors must be small against what the linearisation bears:
lib/docs/theory/lens.md."""

import json
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from script import BIN, fail, run  # noqa: E402


def nees(lens, scale):
    with tempfile.TemporaryDirectory() as folder:
        report = pathlib.Path(folder) / "report.json"
        run(BIN / "pf-sim", "room", "--seeds", 20, "--frames", 300, "--jobs", 2, "--gauge-every", 0, "--sigma-px", 0.1, "--lens", lens,
            "--lens-scale", scale, "--json", report)
        case = json.loads(report.read_text())["cases"]["A"]
    print(f"{lens}, {scale}: position {case['nees_position']}, pose {case['nees_pose']['mean']:.2f}, map {case['map_nees']:.2f}, "
          f"lens {case.get('lens_nees')}")
    if case["lost_runs"]:
        fail("a run was lost")
    return case


for lens, scale in (("consider", 0.2), ("estimate", 0.2)):
    case = nees(lens, scale)
    for name, dof in (("nees_position", 3), ("nees_pose", 6)):
        if abs(case[name]["mean"] - dof) > 3 * case[name]["standard_error"] + 0.1 * dof:
            fail(f"{lens}: {name} is {case[name]['mean']:.2f}, {dof} expected")
    if not case["lens_nees"] < 9:  # mean of 20 with 5 degrees of freedom: 5 +- 0.7
        fail(f"{lens}: the lens has an NEES of {case['lens_nees']:.1f}, 5 expected")
if nees("exact", 0.2)["nees_pose"]["mean"] < 20:
    fail("a wrong lens taken as exact does no harm here: this test would see nothing")
