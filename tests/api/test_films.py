"""video:FILE: the same pixels, times and poses as from a folder of the film's frames; what is cut off, turned, missing, or badly named."""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "support"))
from films import FRAMES, HEIGHT, WIDTH, cut, ffmpeg, make_film, make_folder, skip_without_ffmpeg, t_us  # noqa: E402
from script import BIN, fail, skip, skip_in_cross_builds  # noqa: E402

failures = []


def require(condition, what):
    print("ok  " if condition else "FAIL", what)
    if not condition:
        failures.append(what)


def capture(*words, path=None):
    """Runs pf-capture in a folder where no file name needs a folder before it."""
    environment = dict(os.environ, PATH=path) if path is not None else None
    return subprocess.run([str(word) for word in (BIN / "pf-capture", *words, "--headless", "--no-film", "--quiet")], text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=120, check=False, env=environment)


def track(source, calibration, out, *more):
    result = capture("--source", source, "--calib", calibration, "--out", out, *more)
    if result.returncode != 0:
        fail(f"{source}: {result.returncode} {result.stderr}")
    return result.stderr


def rows(out):
    """frames.csv without the time that a frame took, and the trajectory."""
    lines = (out / "frames.csv").read_text().splitlines()
    names = lines[0].split(",")
    kept = [k for k, name in enumerate(names) if not name.startswith("ms")]
    return [[line.split(",")[k] for k in kept] for line in lines], (out / "trajectory.txt").read_text()


def times_us(out):
    times = [line.split()[0] for line in (out / "trajectory_all.txt").read_text().splitlines() if not line.startswith("#")]
    return [round(1e6 * float(time)) for time in times]


def equal_to_its_folder(root, folder, calibration):
    film = make_film(folder, root / "film.nut")
    track(f"images:{folder}", calibration, root / "a", "--record", root / "recorded_a")
    notes = track(f"video:{film}", calibration, root / "b", "--record", root / "recorded_b")
    require(notes == "", f"nothing is said of a film that is whole: {notes!r}")
    require(rows(root / "a") == rows(root / "b"), "frames and trajectory are those of the folder")
    a, b = ({path.name: path.read_bytes() for path in (root / name / "mav0" / "cam0" / "data").iterdir()}
            for name in ("recorded_a", "recorded_b"))
    require(len(a) == FRAMES and a == b, f"all {len(a)} pictures and their times are those of the folder")
    track(f"video:{film}", calibration, root / "c", "--skip", 10)
    track(f"images:{folder}", calibration, root / "d", "--skip", 10)
    require(rows(root / "c") == rows(root / "d"), "--skip leaves out the same frames")
    track(f"video:{film}", calibration, root / "c", "--there-and-back")
    track(f"images:{folder}", calibration, root / "d", "--there-and-back")
    require(rows(root / "c") == rows(root / "d"), "--there-and-back comes back over the same frames")
    return film


def variable_rate(root, folder, calibration):
    film = make_film(folder, root / "film.mkv", "-c:v", "libx264", "-crf", "12")
    track(f"video:{film}", calibration, root / "e")
    times = times_us(root / "e")
    wrong = [t for t in times if min(abs(t - t_us(i)) for i in range(FRAMES)) > 1000]
    require(len(times) > FRAMES // 2 and not wrong, f"{len(times)} times are within 1 ms of those of the film, {len(wrong)} are not")
    return film


def cut_off(root, nut, mkv, calibration):
    for film in (nut, mkv):
        short = cut(film, root / f"cut{film.suffix}")
        notes = track(f"video:{short}", calibration, root / "f")
        frames = len((root / "f" / "frames.csv").read_text().splitlines()) - 1
        require(FRAMES // 4 < frames < FRAMES, f"{short.name}: {frames} frames are tracked")
        require(f"{short.name}: is cut off after" in notes and " s (" in notes, f"{short.name}: says where: {notes.strip()}")
    mp4 = root / "film.mp4"
    ffmpeg("-i", mkv, "-c", "copy", mp4)
    refused("cut off before its index", f"video:{cut(mp4, root / 'cut.mp4')}", ["cut.mp4", "no index (moov)"], calibration)


def refused(what, source, parts, calibration, *more, path=None):
    result = capture("--source", source, *(("--calib", calibration) if calibration else ()), *more, path=path)
    lines = result.stderr.strip().splitlines()
    right = result.returncode != 0 and len(lines) == 1 and all(part in lines[0] for part in parts)
    require(right, f"{what}: {result.returncode} {lines}, which should say {parts}")


def refusals(root, film, folder, calibration):
    out = ("--out", root / "g")
    refused("a film for a folder", f"images:{film}", [f"is a film; write video:{film}"], calibration, *out)
    refused("a folder for a film", f"video:{folder}", [f"write images:{folder}"], calibration, *out)
    refused("no such film", f"video:{root}/none.mp4", ["none.mp4", "no such film"], calibration, *out)
    refused("no name", "video:", ["write video:FILE"], calibration, *out)
    refused("no film", f"video:{calibration}", [calibration.name, "finds no film"], calibration, *out)
    (root / "empty.mp4").write_bytes(b"")
    refused("an empty file", f"video:{root}/empty.mp4", ["empty.mp4", "0 bytes"], calibration, *out)
    if not hasattr(os, "geteuid") or os.geteuid() != 0:
        (root / "closed.mp4").write_bytes(b"x")
        (root / "closed.mp4").chmod(0)
        refused("a file of somebody else", f"video:{root}/closed.mp4", ["permissions"], calibration, *out)
    nothing = root / "nothing"
    nothing.mkdir()
    refused("no ffprobe", f"video:{film}", ["ffprobe", "install ffmpeg"], calibration, *out, path=str(nothing))
    (nothing / "ffprobe").symlink_to(shutil.which("ffprobe"))
    refused("no ffmpeg", f"video:{film}", ["program ffmpeg", "install ffmpeg"], calibration, *out, path=str(nothing))


def turned(root, mkv, calibration):
    turned_film = root / "turned.mp4"
    ffmpeg("-i", mkv, "-c", "copy", "-metadata:s:v:0", "rotate=90", turned_film)
    portrait = root / "portrait.yaml"
    text = calibration.read_text().replace(f"[{WIDTH}, {HEIGHT}]", f"[{HEIGHT}, {WIDTH}]")
    portrait.write_text(text.replace("159.5, 119.5", "119.5, 159.5"))
    refused("the calibration of pictures that are not rotated", f"video:{turned_film}", [f"is {HEIGHT} x {WIDTH}"], calibration,
            "--out", root / "h")
    track(f"video:{turned_film}", portrait, root / "h")


def odd_contents(root, mkv, folder, calibration):
    """What a file holds beside one film with square pixels, or in its place."""
    notes = {}
    for name, words in (("anamorphic.mkv", ("-c", "copy", "-aspect", "16:9")), ("two.mkv", ("-map", "0", "-map", "0", "-c", "copy")),
                        ("cover.mp4", ("-i", folder / "cover.jpg", "-map", "0", "-map", "1", "-c", "copy", "-disposition:v:1", "attached_pic"))):
        if name == "cover.mp4":
            ffmpeg("-i", mkv, "-frames:v", "1", folder / "cover.jpg")
        ffmpeg("-i", mkv, *words, root / name)
        notes[name] = track(f"video:{root / name}", calibration, root / "k")
        require(len((root / "k" / "frames.csv").read_text().splitlines()) == FRAMES + 1, f"{name}: all frames of the first film")
    require("pixels of 4:3, width to height" in notes["anamorphic.mkv"], f"pixels that are not square: {notes['anamorphic.mkv']}")
    require("holds 2 films; the first is taken" in notes["two.mkv"], f"two films in a file: {notes['two.mkv']}")
    require(notes["cover.mp4"] == "", f"a cover picture is no film: {notes['cover.mp4']}")
    for sound in ("sound.mp4", "sound.wav"):
        ffmpeg("-f", "lavfi", "-i", "sine=d=1", root / sound)
        refused("sound alone", f"video:{root / sound}", [sound, "holds sound", "but no film"], calibration, "--out", root / "k")


def pixels_of_a_film_without_calibration(root, mkv):
    """Pixels that are half as wide as high have a focal length of twice as many of them across."""
    film = root / "narrow.mkv"
    ffmpeg("-i", mkv, "-vf", f"scale={2 * WIDTH}:{HEIGHT},setsar=1/2", "-c:v", "ffv1", film)
    result = capture("--source", f"video:{film}", "--out", root / "l")
    text = (root / "l" / "calib_found.yaml").read_text() if result.returncode == 0 else ""
    fx, fy = (float(re.search(rf"{name}: ([\d.]+)", text)[1]) if text else 0.0 for name in ("fx", "fy"))
    require(abs(fx - 2 * fy) < 0.02 * fx, f"fx {fx} and fy {fy} of pixels of 1:2: {result.stderr}")


def odd_names(root, film, calibration):
    where = os.getcwd()
    os.chdir(root)
    for name in ("-vf null 'a' \"b\" $(c) %03d;.nut", "pipe:0", "http:--x", "concat:a|b"):
        shutil.copy(film, root / name)
        track(f"video:{name}", calibration, root / "i", "--frames", 5)
        require(True, f"a film of the name {name}")
    os.chdir(where)


def left_alone(root, film, calibration):
    """No program stays behind when a run ends before the film does."""
    before = set(children_of_all("ffmpeg"))
    track(f"video:{film}", calibration, root / "j", "--frames", 3)
    left = set(children_of_all("ffmpeg")) - before
    require(not [pid for pid in left if str(film) in command(pid)], "no ffmpeg stays behind")


def children_of_all(name):
    return [path.name for path in pathlib.Path("/proc").iterdir() if path.name.isdigit() and name in command(path.name)]


def command(pid):
    try:
        return pathlib.Path("/proc", pid, "cmdline").read_text(errors="replace").replace("\0", " ")
    except OSError:
        return ""


def main():
    skip_in_cross_builds()
    if not (BIN / "pf-capture").exists():
        skip("pf-capture was not built")
    skip_without_ffmpeg()
    with tempfile.TemporaryDirectory() as name:
        root = pathlib.Path(name)
        folder = make_folder(root)
        calibration = folder / "sensor.yaml"
        film = equal_to_its_folder(root, folder, calibration)
        mkv = variable_rate(root, folder, calibration)
        cut_off(root, film, mkv, calibration)
        refusals(root, film, folder, calibration)
        turned(root, mkv, calibration)
        odd_contents(root, mkv, folder, calibration)
        pixels_of_a_film_without_calibration(root, mkv)
        odd_names(root, film, calibration)
        left_alone(root, film, calibration)
    if failures:
        fail(f"{len(failures)} of the above")


if __name__ == "__main__":
    main()
