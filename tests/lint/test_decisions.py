"""Each comparison by which something is accepted or rejected has a row in tools/lib/decisions.tsv that says for which likelihood it stands, each row
a comparison, and lib/docs/results/decisions.md is what tools/count-decisions makes of them."""

import pathlib
import subprocess
import sys
import tempfile

import source

TOOL = source.ROOT / "tools/count-decisions"
TUNING = """namespace pf::tuning {
namespace match {
inline constexpr float kMinScore = 0.8f;  ///< correlation
inline constexpr int kRounds = 3;         ///< of an iteration
}  // namespace match
}  // namespace pf::tuning
"""
CODE = """#include "track/tuning.h"
using namespace tuning::match;
bool find(const Match& m, Scalar gate) {  // kMinScore < 3 is a comment
  const float least = 2 * kMinScore;
  for (int round = 0; round < kRounds; ++round) step();
  if (!(m.score >= kMinScore) || static_cast<float>(m.d2) > gate) return false;
  return m.sum < least && 2 * m.agree >= m.searched && m.count > 0;
}
"""
EXPECTED = {"m.score >= kMinScore", "static_cast<float>(m.d2) > gate", "m.sum < least", "2 * m.agree >= m.searched"}


def comparisons_of_a_small_tree():
    """What the tool finds in a tree whose decisions are known."""
    with tempfile.TemporaryDirectory() as folder:
        room = pathlib.Path(folder) / "lib/src/track"
        room.mkdir(parents=True)
        (room / "tuning.h").write_text(TUNING)
        (room / "find.cpp").write_text(CODE)
        listed = subprocess.run([sys.executable, TOOL, "--tree", folder, "--list", "?"], capture_output=True, text=True, check=True).stdout
        return {line.removeprefix("track/find.cpp: ") for line in listed.splitlines() if not line.startswith(" ")}


problems = []
found = comparisons_of_a_small_tree()
if found != EXPECTED:
    problems.append(f"tools/count-decisions finds {sorted(found)} where {sorted(EXPECTED)} are")
checked = subprocess.run([sys.executable, TOOL, "--check"], capture_output=True, text=True, check=False)
if checked.returncode != 0:
    problems += (checked.stdout + checked.stderr).strip().splitlines()
page = subprocess.run([sys.executable, TOOL, "--page", "--stdout"], capture_output=True, text=True, check=False).stdout
if page != (source.ROOT / "lib/docs/results/decisions.md").read_text():
    problems.append("lib/docs/results/decisions.md: is not what the sources say; run tools/count-decisions --page")
source.report(problems)
