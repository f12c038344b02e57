"""What was estimated of the inertial unit, over time: biases, how well gravity is known, delay and readout."""

import numpy as np

from . import style

AXES = (("x", style.RED), ("y", style.GREEN), ("z", style.BLUE))
SIGMAS = 3  # of the bands


def band(axis, t, value, sigma, colour, label):
    axis.fill_between(t, value - SIGMAS * sigma, value + SIGMAS * sigma, color=colour, alpha=0.15, linewidth=0)
    axis.plot(t, value, color=colour, label=label)


def limits(axis, values, sigmas):
    """As wide as the last half of the bands: what is not known at the beginning would make all else a line."""
    half = len(values[0]) // 2
    low = min(np.min((v - SIGMAS * s)[half:]) for v, s in zip(values, sigmas))
    high = max(np.max((v + SIGMAS * s)[half:]) for v, s in zip(values, sigmas))
    low, high = min(low, min(v.min() for v in values)), max(high, max(v.max() for v in values))
    room = 0.08 * max(high - low, 1e-9)
    axis.set_ylim(low - room, high + room)


def biases(axis, table, t, name, scale, unit, title):
    values = [scale * table[f"{name}_bias_{x}"] for x, _ in AXES]
    sigmas = [scale * np.maximum(table[f"sigma_{name}_{x}"], 0) for x, _ in AXES]
    for (x, colour), value, sigma in zip(AXES, values, sigmas):
        band(axis, t, value, sigma, colour, x)
    limits(axis, values, sigmas)
    axis.set_title(f"{title} [{unit}]")


def draw(path_png, table, start, title):
    """table: columns of inertial.csv; start: the time that counts as zero. None where gravity was never known."""
    known = table["metric"] > 0
    if known.sum() < 2:
        return None
    table = {name: column[known] for name, column in table.items()}
    t = table["t_s"] - start
    constants = [(name, label) for name, label in (("delay_s", "Delay"), ("readout_s", "Readout")) if (table[f"sigma_{name}"] > 0).all()]
    figure, axes = style.plt.subplots(3 + len(constants), 1, figsize=(10.5, 5.2 + 1.6 * len(constants)), sharex=True, layout="constrained")
    biases(axes[0], table, t, "gyro", 180 / np.pi, "°/s", f"Bias of the gyro, bands of {SIGMAS} sigma")
    biases(axes[1], table, t, "accel", 1, "m/s²", "Bias of the accelerometer")
    gravity = 180 / np.pi * np.hypot(np.maximum(table["sigma_gravity_1"], 0), np.maximum(table["sigma_gravity_2"], 0))
    axes[2].plot(t, gravity, color=style.VIOLET)
    axes[2].set_yscale("log")
    axes[2].set_title("Standard deviation of gravity's direction [°]")
    for axis, (name, label) in zip(axes[3:], constants):
        value, sigma = 1e3 * table[name], 1e3 * table[f"sigma_{name}"]
        band(axis, t, value, sigma, style.ORANGE, label)
        limits(axis, [value], [sigma])
        axis.set_title(f"{label} [ms]")
    axes[0].legend(loc="lower right", bbox_to_anchor=(1.0, 0.97), ncols=3)
    resting = table["resting"] > 0
    for axis in axes:
        axis.fill_between(t, 0, 1, where=resting, transform=axis.get_xaxis_transform(), color=style.LIGHT, linewidth=0, zorder=0)
    axes[-1].set_xlabel("time [s]; grey: at rest")
    figure.suptitle(title, x=0.01, ha="left", fontsize=9, color=style.GREY)
    return style.save(figure, path_png)
