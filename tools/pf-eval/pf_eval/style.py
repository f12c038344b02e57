"""The look of the plots."""

import sys

import matplotlib

if "IPython" not in sys.modules:  # a notebook has chosen how it shows pictures
    matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

INK, GREY, LIGHT = "#22262b", "#8a929c", "#e6e9ed"
BLUE, ORANGE, GREEN, RED, VIOLET = "#1f6fd0", "#e07b1a", "#2a9d5c", "#cf3f3f", "#7f52c4"
# Of planes, as pf-capture colours them where gravity is known (kPlaneClasses).
PLANE_CLASSES = {"#856bff": "wall", "#e69900": "floor, table", "#57b5e8": "ceiling", "#f7ed73": "slanted plane", "#9e9e9e": "plane"}
SHADE = {"starting": "#f3efe2", "coasting": "#fbe6cf", "lost": "#f7d4d4"}

plt.rcParams.update({
    "figure.dpi": 150, "savefig.dpi": 150, "savefig.facecolor": "white", "font.size": 9, "font.family": "DejaVu Sans",
    "axes.edgecolor": GREY, "axes.labelcolor": INK, "text.color": INK, "axes.linewidth": 0.7,
    "axes.spines.top": False, "axes.spines.right": False, "axes.grid": True, "axes.axisbelow": True,
    "axes.titlesize": 9.5, "axes.titleweight": "bold", "axes.titlelocation": "left",
    "grid.color": LIGHT, "grid.linewidth": 0.7, "xtick.color": GREY, "ytick.color": GREY,
    "xtick.labelcolor": INK, "ytick.labelcolor": INK, "xtick.major.width": 0.7, "ytick.major.width": 0.7,
    "legend.frameon": False, "legend.fontsize": 8, "lines.linewidth": 1.3, "lines.solid_capstyle": "round",
})


def save(figure, path):
    figure.savefig(path, bbox_inches="tight", pad_inches=0.08)
    plt.close(figure)
    return path
