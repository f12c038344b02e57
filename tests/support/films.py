"""Films for tests, made by ffmpeg from frames of a scene; their times are not evenly spaced."""

import pathlib
import shutil
import subprocess

from script import BIN, skip

FRAMES = 40
WIDTH, HEIGHT = 320, 240


def t_us(i):
    """Time of frame i in microseconds: the rate varies, and the first time is not 0."""
    return 2_000_000 + 33_333 * i + 4_001 * (i % 3)


def skip_without_ffmpeg():
    if not (shutil.which("ffmpeg") and shutil.which("ffprobe")):
        skip("ffmpeg is not installed (Debian: ffmpeg)")


def ffmpeg(*words):
    subprocess.run(["ffmpeg", "-v", "error", "-nostdin", "-y", *[str(word) for word in words]], check=True, timeout=60)


def passthrough():
    """How this ffmpeg calls its way to keep frames and times as they are."""
    text = subprocess.run(["ffmpeg", "-v", "error", "-h", "full"], check=True, timeout=60, text=True, stdout=subprocess.PIPE).stdout
    return ("-fps_mode" if "-fps_mode" in text else "-vsync", "passthrough")


def make_folder(root, frames=FRAMES):
    """images:FOLDER of a rendered scene, with its calibration."""
    subprocess.run([str(word) for word in (BIN / "pf-capture", "--source", "sim:desk", "--frames", frames, "--record", root / "record",
                                           "--out", root / "made", "--headless", "--no-film", "--quiet")],
                   check=True, timeout=120, stdout=subprocess.DEVNULL)
    folder = root / "folder"
    (folder / "images").mkdir(parents=True)
    pictures = sorted((root / "record" / "mav0" / "cam0" / "data").iterdir(), key=lambda path: int(path.stem))
    lines = []
    for i, picture in enumerate(pictures):
        name = f"{i:04d}{picture.suffix}"
        picture.rename(folder / "images" / name)
        lines.append(f"{i} {t_us(i) // 1_000_000}.{t_us(i) % 1_000_000:06d} {name}\n")
    (folder / "times.txt").write_text("".join(lines))
    (root / "record" / "mav0" / "cam0" / "sensor.yaml").rename(folder / "sensor.yaml")
    return folder


def make_film(folder, film, *codec, time_base="1/1000000"):
    """A film of the folder's images at the folder's times."""
    picture = next((folder / "images").iterdir())
    filters = f"settb=1/1000000,setpts=2000000+33333*N+4001*mod(N\\,3),format={'yuv420p' if codec else 'gray'}"
    ffmpeg("-i", folder / "images" / f"%04d{picture.suffix}", "-vf", filters, *(codec or ("-c:v", "ffv1")), *passthrough(),
           "-enc_time_base", time_base, f"file:{film}")
    return pathlib.Path(film)


def cut(film, cut_film, share=0.6):
    data = film.read_bytes()
    cut_film.write_bytes(data[: int(len(data) * share)])
    return cut_film
