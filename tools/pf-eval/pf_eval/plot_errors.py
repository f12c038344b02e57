"""Errors against truth over time: with their 3-sigma bounds in the truth's own frame, as lengths after alignment."""

import numpy as np
from scipy.stats import chi2

from . import style

COLOURS = (style.RED, style.GREEN, style.BLUE)


def _breaks(t, values):
    """A line is interrupted where frames are missing."""
    gaps = np.flatnonzero(np.diff(t) > 3 * np.median(np.diff(t))) + 1 if len(t) > 2 else []
    return np.insert(t, gaps, np.nan), np.insert(np.asarray(values, dtype=float), gaps, np.nan, axis=0)


def _metres(largest):
    return (1000.0, "mm") if largest < 0.1 else (100.0, "cm") if largest < 1 else (1.0, "m")


def draw(path_png, comparison, start, title):
    t = comparison.t - start
    factor, unit = _metres(np.abs(comparison.position_error).max())
    if comparison.covariance is None:
        return _draw_lengths(path_png, comparison, t, factor, unit, title)
    with_nees = comparison.nees_pose is not None
    figure, axes = style.plt.subplots(4 if with_nees else 3, 2, figsize=(10.5, 7.2 if with_nees else 5.4), sharex=True,
                                      layout="constrained")
    sigma = 3 * np.sqrt(np.maximum(np.einsum("nii->ni", comparison.covariance), 0))
    columns = ((comparison.position_error * factor, sigma[:, 3:] * factor, f"position error [{unit}]"),
               (np.degrees(comparison.rotation_error), np.degrees(sigma[:, :3]), "rotation error [deg]"))
    for column, (error, bound, name) in enumerate(columns):
        for row in range(3):
            axis = axes[row, column]
            x, y = _breaks(t, np.stack([error[:, row], bound[:, row]], axis=1))
            axis.fill_between(x, -y[:, 1], y[:, 1], color=COLOURS[row], alpha=0.13, linewidth=0, label="3σ")
            axis.plot(x, y[:, 0], color=COLOURS[row])
            inside = np.mean(np.abs(error[:, row]) <= bound[:, row])
            axis.set_ylabel("xyz"[row])
            axis.text(0.995, 0.96, f"{100 * inside:.1f} % inside 3σ", transform=axis.transAxes, ha="right", va="top",
                      fontsize=7.5, color=style.GREY)
            reach = 1.25 * max(np.abs(error[:, row]).max(), np.percentile(bound[:, row], 90), 1e-12)
            axis.set_ylim(-reach, reach)
        axes[0, column].set_title(name)
    if with_nees:
        for column, (values, dof, name) in enumerate(((comparison.nees_position, 3, "position"),
                                                      (comparison.nees_pose, 6, "pose"))):
            axis = axes[3, column]
            low, high = chi2.ppf([0.025, 0.975], dof)
            axis.axhspan(low, high, color=style.LIGHT, zorder=0)
            axis.axhline(dof, color=style.GREY, linewidth=0.7, linestyle=":")
            axis.plot(*_breaks(t, values), color=style.VIOLET)
            axis.set_yscale("log")
            axis.set_ylim(0.7 * min(low, max(0.1 * low, np.nanpercentile(values, 5))), 5 * max(high, np.nanmax(values)))
            axis.set_ylabel(f"NEES, {dof} dof")
            axis.text(0.995, 0.96, f"{name}: mean {np.nanmean(values):.2f}; band holds 95 % of one frame's values",
                      transform=axis.transAxes, ha="right", va="top", fontsize=7.5, color=style.GREY)
    for axis in axes[-1]:
        axis.set_xlabel("time [s]")
        axis.set_xlim(t[0], t[-1])
    figure.suptitle(title, x=0.01, ha="left", fontsize=9, color=style.GREY)
    return style.save(figure, path_png)


def _draw_lengths(path_png, comparison, t, factor, unit, title):
    figure, axes = style.plt.subplots(2, 1, figsize=(10.5, 3.8), sharex=True, layout="constrained")
    rows = ((np.linalg.norm(comparison.position_error, axis=1) * factor, f"position error [{unit}]", style.BLUE),
            (np.degrees(np.linalg.norm(comparison.rotation_error, axis=1)), "rotation error [deg]", style.VIOLET))
    for axis, (values, name, colour) in zip(axes, rows):
        axis.plot(*_breaks(t, values), color=colour)
        axis.axhline(np.sqrt(np.mean(values ** 2)), color=colour, linewidth=0.8, linestyle=":")
        axis.set_title(name)
        axis.text(0.995, 0.96, f"RMS {np.sqrt(np.mean(values ** 2)):.3g}, largest {values.max():.3g}",
                  transform=axis.transAxes, ha="right", va="top", fontsize=7.5, color=style.GREY)
        axis.set_ylim(0, 1.2 * max(values.max(), 1e-12))
    axes[-1].set_xlabel("time [s]")
    axes[-1].set_xlim(t[0], t[-1])
    figure.suptitle(title, x=0.01, ha="left", fontsize=9, color=style.GREY)
    return style.save(figure, path_png)
