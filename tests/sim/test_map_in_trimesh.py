"""map.ply opens in trimesh: without planes as a cloud of points, with planes as a mesh that keeps the points."""

import pathlib
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
import script  # noqa: E402
import venv  # noqa: E402

venv.enter()
try:
    import trimesh
except ImportError:
    script.skip("trimesh is not in build/venv; the next run of pf-eval brings it")
PROGRAM = script.BIN / "pf-capture"
if not PROGRAM.exists():
    script.skip("pf-capture was not built")
script.skip_in_cross_builds()


def count(path, element):
    """Of the file's header; 0 where it does not name the element."""
    words = path.read_text().partition(f"element {element} ")[2].split()
    return int(words[0]) if words else 0


with tempfile.TemporaryDirectory() as folder:
    for frames, kind in ((10, trimesh.PointCloud), (150, trimesh.Trimesh)):
        out = pathlib.Path(folder) / str(frames)
        script.run(PROGRAM, "--source", "sim:desk", "--start", "target", "--frames", frames, "--headless", "--no-film", "--quiet", "--out", out)
        vertices, faces = count(out / "map.ply", "vertex"), count(out / "map.ply", "face")
        opened = trimesh.load(out / "map.ply", process=False)
        print(f"{frames} frames: {vertices} vertices, {faces} faces, {opened}")
        if not isinstance(opened, kind) or len(opened.vertices) != vertices or vertices < 20:
            script.fail(f"map.ply with {vertices} vertices and {faces} faces opens as {opened}")
        if kind is trimesh.Trimesh and not (faces > 0 and len(opened.faces) >= faces and opened.area > 0.01):
            script.fail(f"map.ply: {faces} outlines open as {len(opened.faces)} triangles of {opened.area} m^2")
