"""A geometric simulation of 500 frames goes the same way on a 64-bit ARM processor as here: to 1e-9 m, in double."""

import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent / "session"))
import cross  # noqa: E402
import script  # noqa: E402
import session  # noqa: E402

FRAMES, FEATURES, BOUND = 500, 40, 1e-9


def compare(name):
    cross.skip_without(name)
    built = cross.build(name, "planefold")
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        recording = folder / "session.bin"
        truth = session.write_session(recording, FRAMES, FEATURES)
        cross.run_session(folder, script.BUILD / "lib" / "libplanefold.a", recording, folder / "here.bin")
        cross.run_session(folder, built / "lib" / "libplanefold.a", recording, folder / "there.bin", name)
        here, there = (session.read_result(folder / f) for f in ("here.bin", "there.bin"))
        session.check_tracks(here, truth, FRAMES, FEATURES)
        apart = session.furthest_apart(here, there)
        print(f"{name}: at most {apart:.3g} m apart in {FRAMES} frames, allowed {BOUND:g} m")
        if not apart <= BOUND:
            script.fail(f"the two runs are {apart:.3g} m apart")


if __name__ == "__main__":
    compare("aarch64")
