"""What is done to a picture: functions of (grey levels, number of the frame, generator) that give grey levels."""

import io

import numpy as np
from PIL import Image, ImageDraw, ImageFilter


def as_grey(values):
    return np.clip(np.rint(values), 0, 255).astype(np.uint8)


def noise(sigma):
    return lambda image, _, draw: as_grey(image + draw.normal(0, sigma, image.shape))


def blur(sigma):
    return lambda image, *_: np.asarray(Image.fromarray(image).filter(ImageFilter.GaussianBlur(sigma)))


def gamma(power):
    table = as_grey(255 * (np.arange(256) / 255) ** power)
    return lambda image, *_: table[image]


def light(gain, offset=0):
    return lambda image, *_: as_grey(gain * image + offset)


def flicker(image, _, draw):
    return as_grey(image * (1 + draw.uniform(-0.2, 0.2)))


def exposure(image, number, _):
    jump = np.random.default_rng(1000 + number // 30).uniform(-1, 1)
    return as_grey(image * 1.6 ** jump)


def vignette(image, *_):
    height, width = image.shape
    y, x = np.mgrid[0:height, 0:width]
    r2 = ((x - width / 2) ** 2 + (y - height / 2) ** 2) / (width ** 2 / 4 + height ** 2 / 4)
    return as_grey(image * (1 - 0.6 * r2))


def speckles(image, _, draw):
    out = image.copy()
    hit = draw.random(image.shape) < 1 / 500
    out[hit] = 255 * draw.integers(0, 2, hit.sum())
    return out


def compressed(image, *_):
    buffer = io.BytesIO()
    Image.fromarray(image).save(buffer, "JPEG", quality=15)
    return np.asarray(Image.open(buffer))


def dust(image, *_):
    height, width = image.shape
    draw, shade = np.random.default_rng(17), np.ones(image.shape)
    y, x = np.mgrid[0:height, 0:width]
    for _ in range(12):
        r2 = (x - draw.uniform(0, width)) ** 2 + (y - draw.uniform(0, height)) ** 2
        shade *= 1 - 0.7 * np.exp(-r2 / (2 * (width * draw.uniform(0.005, 0.02)) ** 2))
    return as_grey(image * shade)


def body(image, *_):
    """Blocks of dark grey levels in the lower fifth, with a rounded upper edge: the same in every frame."""
    height, width = image.shape
    top = height - height // 5
    draw, side = np.random.default_rng(5), max(4, width // 80)
    blocks = draw.integers(10, 110, (height // side + 2, width // side + 2))
    y, x = np.mgrid[0:height, 0:width]
    inside = y >= top + 0.1 * height * ((x - width / 2) / (width / 2)) ** 2
    return np.where(inside, blocks[y // side, x // side], image).astype(np.uint8)


def date(image, number, _):
    picture = Image.fromarray(image)
    text = f"2026-03-14 12:{number // 1800 % 60:02d}:{number // 30 % 60:02d}.{number % 30:02d}"
    small = Image.new("L", (6 * len(text) + 4, 14), 0)
    ImageDraw.Draw(small).text((2, 1), text, fill=255)
    scale = max(1, image.shape[1] // 320)
    large = small.resize((small.width * scale, small.height * scale), Image.NEAREST)
    picture.paste(255, (6, image.shape[0] - large.height - 6), large)
    ImageDraw.Draw(picture).text((6, 6), "CAM 1  REC", fill=255)
    return np.asarray(picture)


def frame(image, *_):
    out = image.copy()
    height, width = out.shape
    thick = max(1, width // 320)
    for at in (height // 4, 3 * height // 4):
        out[at:at + thick, width // 4:3 * width // 4] = 255
    for at in (width // 4, 3 * width // 4):
        out[height // 4:3 * height // 4, at:at + thick] = 255
    reach = width // 40
    out[height // 2:height // 2 + thick, width // 2 - reach:width // 2 + reach] = 255
    out[height // 2 - reach:height // 2 + reach, width // 2:width // 2 + thick] = 255
    return out


def zoom(first, frames):
    """From frame `first` on the middle 85 % fill the picture, reached over so many frames."""
    def change(image, number, _):
        share = min(max((number - first + 1) / frames, 0), 1)
        left, up = (side * 0.075 * share for side in (image.shape[1], image.shape[0]))
        if share == 0:
            return image
        box = (left, up, image.shape[1] - left, image.shape[0] - up)
        return np.asarray(Image.fromarray(image).resize((image.shape[1], image.shape[0]), Image.BICUBIC, box=box))
    return change


CHANGES = {
    "noise-3": noise(3), "noise-5": noise(5), "noise-8": noise(8), "blur-1": blur(1), "blur-2": blur(2), "gamma-bright": gamma(0.6),
    "gamma-dark": gamma(1.7), "half-light": light(0.5), "low-contrast": light(0.25, 90), "flicker": flicker, "exposure": exposure,
    "vignette": vignette, "speckles": speckles, "dust": dust, "compressed": compressed, "body": body, "date": date, "frame": frame,
}
# Those that need to know how many pictures there are.
CHANGES_OF_LENGTH = {
    "zoom": lambda length: zoom(min(100, length // 2), 1),
    "zoom-slow": lambda length: zoom(min(60, length // 3), min(60, length // 3)),
}
