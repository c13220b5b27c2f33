"""Draws what bench_grasps measured: grasps_plots.py STEM

Reads STEM_plots.json; writes STEM_ranks.png: how often the grasp of the object at each rank would
succeed, in the order of descending and of ascending GRS.
"""

import json
import pathlib
import sys

import matplotlib.pyplot as plt

from plot_style import EDGE, OTHER, OURS, SMALL_PT, save

PANEL_INCHES = (4.6, 3.4)
MEASURES = (("good", "collision-free, force closure", OURS, "o"),
            ("lifts_free", "and pushes no other part", OTHER, "s"))


def draw_order(axes, name, curve):
    """Success over rank; each rank with the number of piles whose answer is so long."""
    curve = [point for point in curve if point["piles"]]
    ranks = [point["rank"] for point in curve]
    for measure, label, color, marker in MEASURES:
        axes.plot(ranks, [100 * point[measure] for point in curve], color=color, marker=marker,
                  markeredgecolor=EDGE, label=label)
    for point in curve:
        axes.annotate(point["piles"], (point["rank"], 112), ha="center", va="top", fontsize=SMALL_PT,
                      textcoords="offset points", xytext=(0, -3))
    axes.set(title=f"{name} GRS", ylim=(-3, 112), xlabel="rank of the object (above: piles)",
             ylabel="success, %", xticks=ranks, yticks=range(0, 101, 20))


def main(stem):
    orders = json.loads(pathlib.Path(f"{stem}_plots.json").read_text())
    size = (PANEL_INCHES[0] * len(orders), PANEL_INCHES[1])
    figure, axes = plt.subplots(1, len(orders), figsize=size, squeeze=False)
    for panel, name in zip(axes.flat, ("descending", "ascending")):
        draw_order(panel, name, orders[name])
    figure.tight_layout(rect=(0, 0.07, 1, 1))
    lines, labels = axes.flat[0].get_legend_handles_labels()
    figure.legend(lines, labels, loc="lower center", ncols=len(labels))
    save(figure, f"{stem}_ranks.png")


if __name__ == "__main__":
    main(sys.argv[1])
