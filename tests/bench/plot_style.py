"""How every plot of the benches looks: one font, one grid, Okabe and Ito's colours, one way to save."""

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

# What is ours, or first; what it is held against; the line around what a part's own colour fills.
OURS = "#0072b2"
OTHER = "#d55e00"
EDGE = "#222222"
FAINT = "#999999"
SMALL_PT = 8

plt.rcParams.update({
    "figure.dpi": 110,
    "savefig.dpi": 110,
    "font.family": "DejaVu Sans",
    "font.size": 10,
    "axes.titlesize": 11,
    "figure.titlesize": 10,
    "axes.grid": True,
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "grid.alpha": 0.3,
    "legend.fontsize": SMALL_PT,
    "legend.edgecolor": "none",
})


def save(figure, path):
    figure.savefig(path)
    print(f"picture: {path}")
