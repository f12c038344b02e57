"""Recovery after black frames, decision by decision: the dark coasts and is lost when it should be, the first images are searched, a pose is
found, its log-odds suffice, and it is the right one. What fails is named by its frame, its counts and its log-odds."""

import math
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from decisions import TRACKED, Run  # noqa: E402
from script import fail, skip_in_cross_builds  # noqa: E402

skip_in_cross_builds()

COAST_S = 1.0          # motion.coast_s
FROM_S, FRAMES = 2.0, 120
MAX_FRAMES = 10        # of light until the map is found again
MAX_OFF = 0.02         # [m] from the run without black frames, with a target
problems = []


def require(condition, test, subject, run, begin, end):
    if not condition:
        problems.append(f"{run.name}\n {test}: {subject}\n  {run.decisions(begin, end)}")


def check(folder, scene, backend, dark_s):
    words = ("--source", f"sim:{scene}", "--start", "target", "--backend", backend, "--frames", FRAMES)
    light = Run(folder / f"{scene}-{backend}", *words)
    run = Run(folder / f"{scene}-{backend}-{dark_s}", *words, "--cover", FROM_S, FROM_S + dark_s)
    first, back = run.frame_at(FROM_S), run.frame_at(FROM_S + dark_s)

    # The dark: predictions whose log-odds fall, lost after coast_s and not before.
    dark = range(first, back)
    require(all(run.frames[k]["reason"] == "nothing_in_view" for k in dark), "dark", "a black frame has another reason than nothing_in_view", run, first, back)
    require(all(run.number(k, "log_odds") <= run.number(k - 1, "log_odds") for k in dark), "dark", "the log-odds of a prediction rise", run, first - 1, back)
    lost_at = next((k for k in dark if run.frames[k]["state"] == "lost"), None)
    due = next((k for k in dark if run.number(k, "t_s") - run.number(first - 1, "t_s") > COAST_S + 1e-6), None)
    require(lost_at == due, "dark", f"lost in frame {lost_at}, and {COAST_S} s without a pose are over in frame {due}", run, back - 3, back + 1)

    # The light: searched, found, believed, in the place where the camera is.
    found = next((k for k in range(back, len(run)) if run.is_tracked(k)), len(run))
    shown = min(found, back + MAX_FRAMES) + 1
    require(run.number(back, "attempts") > 0, "search", f"the first image, frame {back}, is not searched", run, back, shown)
    require(found < back + MAX_FRAMES, "found", f"not found within {MAX_FRAMES} frames of light; the decisions of each:", run, back, shown)
    discarded = run.logged(" begins: ")
    require(discarded is None, "map", f"a new map begins in frame {discarded and discarded[0]}: {discarded and discarded[1]}", run, back, shown)
    if found == len(run):
        return
    require(run.number(found, "log_odds") >= TRACKED, "belief", f"frame {found} is tracked below {TRACKED}", run, found, found + 1)
    was_lost = any(run.frames[k]["state"] == "lost" for k in range(first, found))
    again = run.logged("found again")
    require((again is not None and again[0] == found) == was_lost, "log", f"the log says {again} of frame {found}", run, found, found + 1)
    after = [t for t in run.poses if t in light.poses and t >= run.number(found, "t_s") - 1e-6]
    off = max((math.dist(run.poses[t], light.poses[t]), t) for t in after)
    at = run.frame_at(off[1])
    print(f"{scene}, {backend}, {dark_s} s: found after {found - back + 1} frames of light, at most {1000 * off[0]:.1f} mm from the run without")
    require(off[0] < MAX_OFF, "place", f"{1000 * off[0]:.0f} mm from the run without black frames in frame {at}", run, at, at + 1)
    lost_again = [k for k in range(found, len(run)) if not run.is_tracked(k)]
    require(not lost_again, "afterwards", f"{len(lost_again)} frames are not tracked", run, *(lost_again[:1] + [lost_again[0] + 3] if lost_again else (0, 0)))


with tempfile.TemporaryDirectory() as root:
    for each_backend in ("filter", "window"):
        for each_dark in (0.5, 1.2):
            check(pathlib.Path(root), "desk", each_backend, each_dark)
    check(pathlib.Path(root), "room", "filter", 1.2)
if problems:
    fail("\n".join(problems))
