"""A worker's memory over the frames it has planned: memory_plot.py CSV PNG"""

import csv
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt

TARGET_MB = 250


def main(csv_path, png_path):
    with open(csv_path, newline="") as file:
        rows = list(csv.DictReader(file))
    figure, axes = plt.subplots(figsize=(8, 4))
    axes.plot([int(row["frame"]) for row in rows], [float(row["rss_mb"]) for row in rows],
              color="#0072b2", label="worker with six parts loaded")
    axes.axhline(TARGET_MB, color="#d55e00", linestyle="--", label=f"target: {TARGET_MB} MB")
    axes.set(xlabel="frames planned", ylabel="resident memory, MB", ylim=(0, None), xlim=(0, None))
    axes.grid(True, alpha=0.3)
    axes.legend(loc="lower right")
    figure.tight_layout()
    figure.savefig(png_path, dpi=110)
    print(f"picture: {png_path}")


if __name__ == "__main__":
    main(*sys.argv[1:])
