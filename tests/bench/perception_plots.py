"""Time against recall for each method of `./run bench perception`: perception_plots.py CSV PNG"""

import csv
import statistics
import sys
from collections import defaultdict

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

TITLES = {
    "poses": "Parts found with their pose (MSSD < 0.1 diameters)",
    "segmentation": "Parts found as a segment (IoU ≥ 0.5)",
}
# The names of what other libraries do; Euclidean clustering and region growing are PCL's.
THEIRS = ("pcl", "opencv", "open3d", "euclidean", "region")


def read(path):
    """{task: {method: [row, …]}}"""
    runs = defaultdict(lambda: defaultdict(list))
    with open(path, newline="") as file:
        for row in csv.DictReader(file):
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
                  color="#d55e00" if is_theirs else "#0072b2", markeredgecolor="white",
                  label=f"{name.replace('_', ' ')}: {median_ms[name]:,.1f} ms")


def main(csv_path, png_path):
    figure, panels = plt.subplots(1, 2, figsize=(12, 5), sharey=True)
    for axes, (task, methods) in zip(panels, sorted(read(csv_path).items())):
        draw(axes, methods)
        axes.set(title=TITLES[task], xscale="log", xlabel="median time of a frame, ms", ylim=(-3, 105))
        axes.grid(True, which="both", alpha=0.3)
        axes.margins(x=0.1)
        axes.xaxis.set_major_formatter("{x:g}")
        axes.xaxis.set_minor_formatter("{x:g}" if task == "segmentation" else "")
        axes.legend(fontsize=8, loc="upper right" if task == "segmentation" else "center left")
    panels[0].set_ylabel("recall, %")
    figure.suptitle("graspd in blue; PCL, OpenCV and Open3D in orange", fontsize=10)
    figure.tight_layout()
    figure.savefig(png_path, dpi=110)


if __name__ == "__main__":
    main(*sys.argv[1:])
