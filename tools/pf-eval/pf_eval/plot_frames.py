"""What each frame took and gave: matches, size of the state, milliseconds, innovations."""

import numpy as np
from scipy.stats import chi2

from . import style

WINDOW = 15  # frames over which innovations are averaged


def shade(axes, t, states):
    """Behind the lines: when the camera was not tracked."""
    edges = np.append(t, t[-1] + (np.median(np.diff(t)) if len(t) > 1 else 0.03))
    for i, state in enumerate(states):
        if state in style.SHADE:
            for axis in axes:
                axis.axvspan(edges[i], edges[i + 1], color=style.SHADE[state], linewidth=0, zorder=0)


def legend(axis, handles):
    """On the line of the title, at the right."""
    axis.legend(handles=handles, loc="lower right", bbox_to_anchor=(1.0, 0.97), ncols=len(handles))


def draw(path_png, table, title):
    """table: columns of frames.csv."""
    t = table["t_s"] - table["t_s"][0]
    figure, axes = style.plt.subplots(4, 1, figsize=(10.5, 7.0), sharex=True, layout="constrained")
    matches, size, cost, nis = axes

    for name, colour, width in (("attempts", style.LIGHT, 1.3), ("matches", style.GREY, 1.0), ("inliers", style.GREEN, 1.4)):
        if name == "attempts":
            matches.fill_between(t, table[name], color=colour, linewidth=0, label="looked for")
        else:
            matches.plot(t, table[name], color=colour, linewidth=width, label="found" if name == "matches" else "inliers")
    matches.axhline(8, color=style.RED, linewidth=0.7, linestyle=":")
    matches.set_title("Features measured")
    matches.set_ylim(bottom=0)

    size.plot(t, table["state_dim"], color=style.BLUE, label="numbers in the state")
    size.plot(t, table["features"], color=style.GREEN, label="features in the map")
    if "folded" in table:
        size.plot(t, table["folded"] + table["fixed"], color=style.VIOLET, label="of these, folded")
        size.plot(t, table["rows_points_only"], color=style.BLUE, linewidth=0.8, linestyle=":", label="numbers without planes")
    size.set_title("Size of the map")
    size.set_ylim(bottom=0)
    legend(size, size.get_legend_handles_labels()[0])

    cost.plot(t, table["ms"], color=style.ORANGE, linewidth=0.9)
    median, p95 = np.percentile(table["ms"], [50, 95])
    cost.axhline(median, color=style.ORANGE, linewidth=0.8, linestyle=":")
    cost.set_title("Milliseconds per frame")
    cost.set_ylim(0, 1.25 * max(np.percentile(table["ms"], 99), 1e-9))
    cost.text(0.995, 0.96, f"median {median:.2f}, 95th percentile {p95:.2f}, largest {table['ms'].max():.2f}",
              transform=cost.transAxes, ha="right", va="top", fontsize=7.5, color=style.GREY)

    used = table["nis_dof"] > 0
    if used.any():
        value, dof, when = table["nis"][used], table["nis_dof"][used], t[used]
        nis.plot(when, value / dof, ".", color=style.VIOLET, markersize=2.5, alpha=0.5)
        if used.sum() > WINDOW:
            ones = np.ones(WINDOW)
            total, total_dof = np.convolve(value, ones, "valid"), np.convolve(dof, ones, "valid")
            middle = when[WINDOW // 2:WINDOW // 2 + len(total)]
            nis.fill_between(middle, chi2.ppf(0.025, total_dof) / total_dof, chi2.ppf(0.975, total_dof) / total_dof,
                             color=style.LIGHT, linewidth=0, zorder=0.5)
            nis.plot(middle, total / total_dof, color=style.VIOLET)
        nis.axhline(1, color=style.GREY, linewidth=0.7, linestyle=":")
        nis.set_ylim(0, max(2.0, 1.2 * np.percentile(value / dof, 98)))
        nis.text(0.995, 0.96, f"mean {value.sum() / dof.sum():.2f} (1 is honest); band: 95 % of a mean over {WINDOW} frames",
                 transform=nis.transAxes, ha="right", va="top", fontsize=7.5, color=style.GREY)
    nis.set_title("Innovations squared per degree of freedom")
    nis.set_xlabel("time [s]")

    shade(axes, t, table["state"])
    axes[0].set_xlim(t[0], t[-1] if t[-1] > t[0] else t[0] + 1)
    legend(matches, matches.get_legend_handles_labels()[0]
           + [style.plt.Rectangle((0, 0), 1, 1, color=colour, label=name) for name, colour in style.SHADE.items()
              if (table["state"] == name).any()])
    figure.suptitle(title, x=0.01, ha="left", fontsize=9, color=style.GREY)
    return style.save(figure, path_png)
