"""Draws what bench_accuracy measured: accuracy_plots.py STEM

Reads STEM_plots.json; writes STEM_curves.png (precision over recall) and STEM_visibility.png
(recall by visibility), one panel for each part.
"""

import json
import math
import pathlib
import sys

import matplotlib.pyplot as plt

from plot_style import EDGE, SMALL_PT, save

COLUMNS_MAX = 3
PANEL_INCHES = (4.0, 3.4)


def panels(parts):
    """A figure with one axes for each part, axes in percent."""
    columns = min(COLUMNS_MAX, len(parts))
    rows = math.ceil(len(parts) / columns)
    size = (PANEL_INCHES[0] * columns, PANEL_INCHES[1] * rows)
    figure, grid = plt.subplots(rows, columns, figsize=size, squeeze=False)
    for axes in grid.flat[len(parts):]:
        axes.set_visible(False)
    return figure, list(zip(grid.flat, parts))


def color_of(part):
    return tuple(value / 255 for value in part["color_rgb"])


def draw_curve(axes, part):
    """Precision over recall, from the best score down; the area beneath is the AP."""
    recall = [0] + [100 * point["recall"] for point in part["curve"]]
    precision = [100 * point["precision"] for point in part["curve"]]
    precision = precision[:1] + precision
    if precision:
        axes.fill_between(recall, precision, step="pre", color=color_of(part), alpha=0.8, lw=0)
        axes.step(recall, precision, where="pre", color=EDGE, lw=1)
    axes.set(title=f"{part['part']}: AP {part['ap']:.3f}", xlim=(0, 102), ylim=(0, 105),
             xlabel="recall, %", ylabel="precision, %")


def draw_visibility(axes, part):
    """Recall of the objects in each bin, with how many there are."""
    for place, part_bin in enumerate(part["visibility"]):
        objects, found = part_bin["objects"], part_bin["found"]
        recall = 100 * found / objects if objects else 0
        axes.bar(place, recall, width=0.8, color=color_of(part), edgecolor=EDGE)
        axes.annotate(f"{found}\nof {objects}", (place, recall), ha="center", va="bottom",
                      fontsize=SMALL_PT, textcoords="offset points", xytext=(0, 2))
    ticks = [f"{100 * b['from']:.0f}–{100 * b['to']:.0f}" for b in part["visibility"]]
    axes.set(title=part["part"], ylim=(0, 125), yticks=range(0, 101, 20),
             xlabel="visible, %", ylabel="recall, %")
    axes.set_xticks(range(len(ticks)), ticks)


def main(stem):
    parts = json.loads(pathlib.Path(f"{stem}_plots.json").read_text())
    for name, draw in (("curves", draw_curve), ("visibility", draw_visibility)):
        figure, pairs = panels(parts)
        for axes, part in pairs:
            draw(axes, part)
        figure.tight_layout()
        save(figure, f"{stem}_{name}.png")


if __name__ == "__main__":
    main(sys.argv[1])
