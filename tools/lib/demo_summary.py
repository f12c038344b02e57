"""Three lines on a run:  demo_summary.py RUN_DIR SOURCE"""

import json
import pathlib
import sys


def load(path):
    try:
        return json.loads(path.read_text())
    except FileNotFoundError:
        return {}


def length(metres):
    return f"{1000 * metres:.1f} mm" if metres < 0.1 else f"{metres:.2f} m"


def main():
    run, source = pathlib.Path(sys.argv[1]), sys.argv[2]
    report, evaluation = load(run / "report.json"), load(run / "eval.json")
    if not report:
        sys.exit(f"{run}/report.json is missing")

    states = report["frames_by_state"]
    others = [f"{count} {name}" for name, count in states.items() if count and name != "tracked"]
    print(f"Camera: tracked {states['tracked']} of {report['frames']} frames of {source}"
          f"{' (' + ', '.join(others) + ')' if others else ''}{'' if states['lost'] else ', never lost'}; "
          f"{report['ms_per_frame']['median']:.2f} ms a frame, {report['ms_per_frame']['p95']:.2f} ms at the 95th percentile.")

    planes, in_map = len(report.get("planes", [])), report["features_in_map"]
    print(f"Map:    {sum(in_map.values())} features at the end"
          + (f", {in_map['folded'] + in_map['fixed']} of them folded into {planes} planes" if planes else "")
          + f"; {report['features']['median']:.0f} were measured in a frame. The state had {report['state_dim']['max']:.0f} rows at most, "
          f"with their full covariance, in a block of {report['memory_bytes'] / 2**20:.2f} MiB that never grows.")

    unit = report.get("imu") or {}
    if unit.get("metric"):
        start = unit["start_frame"]
        turn = max(unit["gravity_W"]["sigma"])
        print(f"Unit:   lengths are in metres from frame {start} on, by a {'rest' if unit['start'] == 'rest' else 'motion'}; gravity is known to "
              f"{57.2957795 * turn:.2f} degrees at the end (the dashed line in the film is the horizon).")

    files = [name for name in ("side_by_side.mp4", "overlay.mp4", "trajectory.png", "trajectory.tum", "map.ply") if (run / name).exists()]
    others = len([entry for entry in run.iterdir() if entry.is_file()]) - len(files)
    where = f"See {run}: {', '.join(files)} and {others} more."
    if evaluation:
        nees = evaluation.get("nees_position")
        print(f"Truth:  {length(evaluation['ate_rmse_m'])} RMS off on a path of {evaluation['path_m']:.1f} m"
              + (f", position NEES {nees:.1f} (3 is honest)" if nees is not None else "") + f". {where}")
    else:
        print(f"Truth:  none was given. {where}")


if __name__ == "__main__":
    main()
