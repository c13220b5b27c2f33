"""A worker's memory over the frames it has planned: memory_plot.py CSV PNG"""

import csv
import sys

import matplotlib.pyplot as plt

from plot_style import OTHER, OURS, save

TARGET_MB = 250


def main(csv_path, png_path):
    with open(csv_path, newline="") as file:
        rows = list(csv.DictReader(file))
    figure, axes = plt.subplots(figsize=(8, 4))
    axes.plot([int(row["frame"]) for row in rows], [float(row["rss_mb"]) for row in rows],
              color=OURS, label="worker with six parts loaded")
    axes.axhline(TARGET_MB, color=OTHER, linestyle="--", label=f"target: {TARGET_MB} MB")
    axes.set(xlabel="frames planned", ylabel="resident memory, MB", ylim=(0, None), xlim=(0, None))
    axes.legend(loc="lower right")
    figure.tight_layout()
    save(figure, png_path)


if __name__ == "__main__":
    main(*sys.argv[1:])
