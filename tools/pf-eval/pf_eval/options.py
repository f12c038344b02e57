"""pf-eval: what its command line may hold. Needs nothing but Python, so that --help and --version do not either."""

import argparse

from .command_line import OneLineParser

DESCRIPTION = """Compares a run of pf-capture with ground truth.

  pf-eval RUN [--truth FILE] [--planes FILE.json] [--align none|se3|sim3] [--json [FILE]]
  pf-eval RUN --corners FILE.csv --target FILE.yaml [--calib FILE] [--json [FILE]]
  pf-eval RUN --planes-truth [--truth FILE] [--depth DIR [--depth-unit M]] [--json [FILE]]
  pf-eval RUN --there-and-back [--json [FILE]]
  pf-eval RUN --relative [--truth FILE] [--align none|sim3] [--json [FILE]]
  pf-eval map FILE [--ply FILE.ply] [--json [FILE]]

RUN is an output folder of pf-capture, or a trajectory. Trajectories (RUN and --truth) are read in these forms, with blanks, commas or
semicolons, byte order marks and quotes: TUM (timestamp tx ty tz qx qy qz qw), EuRoC's CSV, KITTI's rows of twelve (with the times.txt
beside them or in sequences/NN), folders of frame-000000.pose.txt, and columns that a header names."""

NOTES = """Truth is taken within 10 ms of a frame: the nearest pose, or interpolated where truth comes at least 1.5 times as
often as the frames ("association" says which). Errors are those of evo after Umeyama alignment of positions; rpe_rmse_m is
from frame to frame. After an alignment rot_rmse_deg and rot_max_deg are what is left by the rotation that fits the rotations best;
rot_by_positions_rmse_deg uses the one that the positions gave, which is not known about a nearly straight path
(alignment_degenerate; a note says so). Truth is of the camera; EuRoC's data.csv is of the body, and T_BS of the camera's sensor.yaml is
applied ("frame" says which was compared). Without --truth the one that report.json names is taken. NEES is given for runs in the truth's own
frame only, so with --align none; nees_position has 3 degrees of freedom, nees_pose 6. A plane of the run is a true one when it is
within 10 degrees and, in the middle of its outline, 10 cm of it, after an alignment by the rotations of the trajectory.
--planes-truth reads a run of pf-capture --tracks and judges which members of its planes are right: by the surfaces of a scene (sim:), by
depth images (--depth: PNG of 16 bits, one for each frame of the sequence in the order of their names), or else by the run's own tracks,
triangulated with the true poses (3 degrees of parallax, 0.5 px). Shares are of the features found in a frame: could_fold lie on a true
plane with eight or more of them, could_tell have 3 degrees of parallax as well; earned are on a plane of the run by their own parallax,
on_trial only began on it. power: of those, the share that is earned. A plane is false where fewer than 70 % of its earned
members lie on one true plane.
--there-and-back reads a run of pf-capture --there-and-back, where each image has two poses that should be one: their distance is
given as a share of the path's extent, the largest distance between two places of the way there.
--relative reads a run of pf-capture --relative N: the NEES of its motions over N frames against the truth, per degree of freedom
(1 expected). No alignment of frames is needed. With --align none a motion has 6 degrees of freedom. With sim3 it has 5, since the
scale of each is free; with one scale for each map (one_scale) all of a map's motions have 6 each less one.

"coverage" is the share of the sequence's frames that have a tracked pose in the map that is compared, "first_pose_s" the time from the
first frame to the first tracked pose; both need frames.csv of the run.

Exit code: 0 done, 1 something cannot be used (one line says what), 2 the command line is wrong."""


def arguments(words):
    parser = OneLineParser(prog="pf-eval", description=DESCRIPTION, epilog=NOTES,
                           formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", metavar="RUN", nargs="?")
    parser.add_argument("--truth", metavar="FILE", help="a file in one of the forms, or a folder of poses; default: report.json names it")
    parser.add_argument("--align", choices=["none", "se3", "sim3"],
                        help="default: none where report.json says that the run started from a target, se3 where an inertial unit "
                             "measured its lengths, else sim3")
    parser.add_argument("--planes", metavar="FILE.json", help="true planes: {\"planes\": [{\"name\", \"normal\", \"distance\"}]}")
    parser.add_argument("--planes-truth", action="store_true", help="which members of the run's planes are right")
    parser.add_argument("--depth", metavar="DIR", help="depth images, for --planes-truth")
    parser.add_argument("--depth-unit", metavar="M", type=float, default=0.001, help="of one grey level; 0.0002 of TUM and ICL-NUIM")
    parser.add_argument("--corners", metavar="FILE.csv", help="frame,t,u_TL,v_TL,u_TR,v_TR,u_BR,v_BR,u_BL,v_BL")
    parser.add_argument("--target", metavar="FILE.yaml", help="the target that the run was started from")
    parser.add_argument("--calib", metavar="FILE", help="of --corners: default calib.yaml in RUN, or beside the corners; of a body's truth: "
                        "default cam0/sensor.yaml beside it")
    parser.add_argument("--there-and-back", action="store_true", help="the two poses of each image; needs no truth")
    parser.add_argument("--relative", action="store_true", help="the motions of relative.csv against the truth")
    parser.add_argument("--skip-frames", metavar="N", type=int, default=0, help="leave out corners of the first N frames")
    parser.add_argument("--json", metavar="FILE", nargs="?", const="-", help="results as JSON, to a file or the output")
    parser.add_argument("--per-frame", metavar="FILE.csv", help="errors frame by frame")
    parser.add_argument("--version", action="store_true", help="print the version, and do nothing else")  # the program in bin/ does
    options = parser.parse_args(words)
    if options.run is None and options.json not in (None, "-"):  # --json RUN
        options.run, options.json = options.json, "-"
    if options.run is None:
        parser.error("which RUN?")
    if options.relative and (options.corners or options.there_and_back or options.planes or options.align == "se3"):
        parser.error("--relative goes with --truth and --align none or sim3")
    if [options.truth is not None, options.corners is not None, options.there_and_back].count(True) > 1:
        parser.error("give one of --truth, --corners and --there-and-back")
    if options.planes_truth and (options.corners or options.there_and_back or options.planes or options.relative):
        parser.error("--planes-truth goes with --truth and --depth")
    if options.depth and not options.planes_truth:
        parser.error("--depth needs --planes-truth")
    if not 0 < options.depth_unit < 1:
        parser.error("--depth-unit is in metres, above 0 and below 1")
    if options.planes and (options.corners or options.there_and_back):
        parser.error("--planes needs a truth")
    if options.corners and not options.target:
        parser.error("--corners needs --target")
    if options.target and not options.corners:
        parser.error("--target needs --corners")
    if options.skip_frames < 0 or options.skip_frames > 0 and not options.corners:
        parser.error("--skip-frames is a number of frames of --corners, 0 or more")
    return options
