"""What a run of pf-capture decided frame by frame, for tests that name the decision that went wrong: frames.csv and the log."""

import csv
import json
import math
import re

from script import BIN, SOURCE, run

MIN_INLIERS = 8


def tuned(file, name):
    """A number of a tuning.h."""
    found = re.search(rf"\b{name} = (?:Scalar\()?([-\d.]+)", (SOURCE / "lib/src" / file).read_text())
    return float(found[1])


TRACKED = tuned("belief/tuning.h", "kTracked")


class Run:
    """A run of pf-capture, with its decisions. words: its options."""

    def __init__(self, out, *words):
        self.name = " ".join(str(word) for word in words)
        run(BIN / "pf-capture", *words, "--headless", "--no-film", "--quiet", "--out", out)
        report = json.loads((out / "report.json").read_text())
        self.log = report["log"]
        self.start_frame = report["start_frame"]
        with open(out / "frames.csv", encoding="utf-8") as file:
            self.frames = list(csv.DictReader(file))
        self.poses, self.truth = positions(out / "trajectory.txt"), positions(out / "truth.tum")

    def __len__(self):
        return len(self.frames)

    def number(self, frame, name):
        return float(self.frames[frame][name])

    def is_tracked(self, frame):
        return self.frames[frame]["tracked"] == "1"

    def frame_at(self, seconds):
        """The first frame that is not before a time."""
        return next(k for k in range(len(self)) if self.number(k, "t_s") >= seconds - 1e-6)

    def logged(self, words):
        """(frame, line) of the first line with these words; None."""
        for line in self.log:
            found = re.match(r"frame (\d+): (.*)", line)
            if found and words in line:
                return int(found[1]), found[2]
        return None

    def decision(self, frame):
        """The first bound that a frame does not meet, in the order in which they are tested."""
        row = self.frames[frame]
        attempts, matches, consensus, inliers = (int(row[name]) for name in ("attempts", "matches", "consensus", "inliers"))
        agree, log_odds = max(consensus, inliers), float(row["log_odds"])
        if attempts == 0:
            why = "nothing was searched for"
        elif row["tracked"] == "1":
            why = f"tracked by {inliers} of {matches} features"
        elif matches < MIN_INLIERS:
            why = f"{matches} features found, {MIN_INLIERS} needed"
        elif agree < MIN_INLIERS:
            why = f"{agree} features agree with one pose, {MIN_INLIERS} needed"
        elif log_odds < TRACKED:
            why = f"{TRACKED} needed of the log-odds"
        else:
            why = "the pose is not used"
        numbers = f"{attempts} searched for, {matches} found, {agree} agree with one pose, log-odds {log_odds:.2f}"
        return f"frame {frame} ({row['state']}, reason {row['reason']}): {why} ({numbers})"

    def decisions(self, begin, end):
        return "\n  ".join(self.decision(k) for k in range(max(0, begin), min(end, len(self))))

    def shape_error(self, begin, end):
        """Largest error of a distance between two tracked places of frames begin .. end, over the largest distance, where the unit of length is
        free; None with fewer than five. It needs no alignment."""
        times = sorted(t for t in self.poses if t in self.truth and self.number(begin, "t_s") - 1e-6 <= t <= self.number(min(end, len(self) - 1), "t_s") + 1e-6)
        pairs = [(math.dist(self.poses[a], self.poses[b]), math.dist(self.truth[a], self.truth[b])) for i, a in enumerate(times) for b in times[:i]]
        if len(times) < 5:
            return None
        scale = sum(e * t for e, t in pairs) / sum(t * t for _, t in pairs)
        return max(abs(e - scale * t) for e, t in pairs) / (scale * max(t for _, t in pairs))


def positions(path):
    """{time: position} of a trajectory."""
    rows = [line.split() for line in path.read_text().splitlines() if line and line[0] != "#"]
    return {round(float(row[0]), 6): tuple(float(word) for word in row[1:4]) for row in rows}
