"""A library that reads its tuned numbers from a table computes as ever where the table is empty, and otherwise with the table's numbers."""

import os
import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import script  # noqa: E402

FRAMES = 60


def digest(program, backend, table):
    """Digest of the built-in desk in one back end."""
    with tempfile.TemporaryDirectory() as folder:
        file = pathlib.Path(folder) / "digest"
        script.run(program, "sim:desk", "--frames", FRAMES, "--backend", backend,
                   env={**os.environ, "PLANEFOLD_DIGEST": str(file), "PLANEFOLD_TUNING": str(table)})
        return file.read_text()


script.skip_unless_plain_native_build()
with tempfile.TemporaryDirectory(prefix="planefold_") as name:
    build, table = pathlib.Path(name) / "build", pathlib.Path(name) / "table"
    script.run("cmake", "-S", script.SOURCE, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=Release", "-DPLANEFOLD_UNITY=ON",
               "-DPLANEFOLD_BUILD_TESTS=OFF", "-DPLANEFOLD_TUNABLE=ON")
    script.run("cmake", "--build", build, "--target", "pf-digest")
    for backend in ("filter", "window"):
        table.write_text("")
        now = digest(script.BIN / "pf-digest", backend, table)
        if digest(build / "bin/pf-digest", backend, table) != now:
            script.fail(f"{backend}: with an untouched table the numbers differ from those of a build without one")
        table.write_text("frame.noise.kPriorFrames 16\n")
        if digest(build / "bin/pf-digest", backend, table) == now:
            script.fail(f"{backend}: the table has no effect")
