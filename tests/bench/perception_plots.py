"""Draws what `./run bench perception` measured: perception_plots.py FOLDER

perception.png: time against recall for each method; perception_growth.png: time of a plan over the
number of parts.
"""

import csv
import statistics
import sys
from collections import defaultdict

import matplotlib.pyplot as plt
from matplotlib.ticker import LogLocator

from plot_style import FAINT, OTHER, OURS, save

TITLES = {
    "poses": "Parts found with their pose (MSSD < 0.1 diameters)",
    "segmentation": "Parts found as a segment (IoU ≥ 0.5)",
}
# The names of what other libraries do; Euclidean clustering and region growing are PCL's.
THEIRS = ("pcl", "opencv", "open3d", "euclidean", "region")


def read(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def by_method(rows):
    """{task: {method: [row, …]}}"""
    runs = defaultdict(lambda: defaultdict(list))
    for row in rows:
        runs[row["task"]][row["method"]].append(row)
    return runs


def draw(axes, methods):
    markers = iter("os^vD<>Pp*XhH8")
    median_ms = {name: statistics.median(float(row["ms"]) for row in rows)
                 for name, rows in methods.items()}
    for name in sorted(methods, key=median_ms.get):
        found, objects = (sum(int(row[key]) for row in methods[name]) for key in ("found", "objects"))
        is_theirs = name.startswith(THEIRS)
        axes.plot(median_ms[name], 100 * found / max(1, objects), next(markers), markersize=9,
                  color=OTHER if is_theirs else OURS, markeredgecolor="white",
                  label=f"{name.replace('_', ' ')}: {median_ms[name]:,.1f} ms")


def draw_methods(rows, png_path):
    figure, panels = plt.subplots(1, 2, figsize=(12, 5), sharey=True)
    for axes, (task, methods) in zip(panels, sorted(by_method(rows).items())):
        draw(axes, methods)
        axes.set(title=TITLES[task], xscale="log", xlabel="median time of a frame, ms", ylim=(-3, 105))
        axes.grid(True, which="both", alpha=0.3)
        axes.margins(x=0.1)
        axes.xaxis.set_major_formatter("{x:g}")
        axes.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        axes.xaxis.set_minor_formatter("")
        axes.legend(loc="upper right" if task == "segmentation" else "center left")
    panels[0].set_ylabel("recall, %")
    figure.suptitle("graspd in blue; PCL, OpenCV and Open3D in orange")
    figure.tight_layout()
    save(figure, png_path)


def draw_growth(rows, png_path):
    runs = defaultdict(list)
    for row in rows:
        runs[int(row["parts_dropped"])].append((int(row["parts"]), float(row["ms"])))
    medians = [tuple(map(statistics.median, zip(*runs[number]))) for number in sorted(runs)]
    figure, axes = plt.subplots(figsize=(7, 4.5))
    axes.plot(*zip(*(run for number in runs.values() for run in number)), ".", color=FAINT,
              label="one frame")
    axes.plot(*zip(*medians), "o-", color=OURS, label="median")
    first_parts, first_ms = medians[0]
    last_parts = medians[-1][0]
    axes.plot([0, last_parts], [0, last_parts * first_ms / first_parts], "--", color=OTHER,
              label="linear, from the first")
    axes.set(xlabel="tees in the bin", ylabel="frame to grasps on one core, ms", xlim=(0, None),
             ylim=(0, None))
    axes.legend(loc="upper left")
    figure.tight_layout()
    save(figure, png_path)


def main(folder):
    for name, draw_png in (("perception", draw_methods), ("perception_growth", draw_growth)):
        draw_png(read(f"{folder}/{name}.csv"), f"{folder}/{name}.png")


if __name__ == "__main__":
    main(*sys.argv[1:])
