"""How many frames a second servers plan: the model of server/service/CAPACITY.md.

    load_model.py load_parameters.json    prints that page's tables

A frame costs CPU time in the worker, in the front (decryption, copies) and, where it is on the same
machine, in the load tool. A worker computes one frame at a time, cores are shared, a link carries so
many bits: the least of these decides.
"""

import dataclasses
import json
import math
import pathlib
import sys

# TCP, IP and Ethernet headers in packets of 1,500 bytes.
HEADERS = 1.05
# Up to here p99 stays below twice the median; beyond, queues grow.
LOAD_SHARE = 0.7
DAY_S = 86400


@dataclasses.dataclass
class Parameters:
    """Measured, each by a run of its own. Times are of one frame."""
    cores: int
    plan_ms: float       # worker: decode and all stages, one frame at a time
    crowd_factor: float  # how much longer when every core computes
    service_ms: float    # front and worker around it: CPU, with CURVE
    tool_ms: float       # load tool: CPU, with CURVE
    frame_bytes: dict    # by encoding
    rvl_ms: float        # what RVL costs the worker more than raw


@dataclasses.dataclass
class Setup:
    """What is loaded."""
    name: str
    servers: int
    workers: int         # of each server
    sleep_ms: float = 0  # workers that sleep so long instead of planning
    link_mbit: float = 0  # of all servers together; 0: loopback
    encoding: str = "raw"
    strangers: int = 0   # processes beside it that compute


def capacity_fps(parameters, setup, others=0):
    """The least of what workers, cores and link can do. Of the cores' time others take so much."""
    plan_ms = parameters.plan_ms + (parameters.rvl_ms if setup.encoding == "rvl" else 0)
    workers = setup.servers * setup.workers
    if workers > 1:
        plan_ms *= parameters.crowd_factor
    wait_ms = setup.sleep_ms or plan_ms
    cpu_ms = (0 if setup.sleep_ms else plan_ms) + parameters.service_ms + parameters.tool_ms
    limits = [1000 * workers / (wait_ms + parameters.service_ms), 1000 * (parameters.cores - others) / cpu_ms]
    if setup.link_mbit:
        bits = 8 * HEADERS * parameters.frame_bytes[setup.encoding]
        limits.append(1e6 * setup.link_mbit / bits)
    return min(limits)


def fleet(parameters, cells, cycle_s, cores, encoding="raw"):
    """Servers of so many cores for cells that ask once in a pick cycle."""
    plan_ms = parameters.plan_ms + (parameters.rvl_ms if encoding == "rvl" else 0)
    server_fps = LOAD_SHARE * 1000 * cores / (parameters.crowd_factor * plan_ms
                                              + parameters.service_ms)
    fps = cells / cycle_s
    needed = math.ceil(fps / server_fps)
    spare = max(1, math.ceil(0.1 * needed))
    bits = 8 * HEADERS * parameters.frame_bytes[encoding]
    return {"fps": fps, "servers": needed, "spare": spare,
            "cells_per_server": cells / needed, "cells_per_core": server_fps * cycle_s / cores,
            "server_mbit": fps / needed * bits / 1e6, "all_gbit": fps * bits / 1e9}


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|---" + "|---:" * (len(header) - 1) + "|"]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def cells_per_core_table(parameters):
    rows = []
    for cycle_s in (2, 5, 8, 15):
        raw = fleet(parameters, 1, cycle_s, parameters.cores)
        rows.append([f"{cycle_s}", f"{raw['cells_per_core']:.0f}"]
                    + [f"{1e6 * mbit * cycle_s / (8 * HEADERS * parameters.frame_bytes[encoding]):.0f}"
                       for mbit in (100, 1000) for encoding in ("raw", "rvl")])
    return table(["pick cycle s", "cells a core", "100 Mb/s, raw", "100 Mb/s, RVL", "1 Gb/s, raw",
                  "1 Gb/s, RVL"], rows)


def fleet_table(parameters, cores=16):
    rows = []
    for cells in (1000, 100_000):
        for encoding in ("raw", "rvl"):
            plan = fleet(parameters, cells, 8, cores, encoding)
            rows.append([f"{cells:,}", encoding, f"{plan['fps']:,.0f}",
                         f"{plan['servers']} + {plan['spare']}", f"{plan['cells_per_server']:.0f}",
                         f"{plan['server_mbit']:.0f}", f"{plan['all_gbit']:.2f}"])
    return table(["cells", "encoding", "frames/s", f"servers of {cores} cores + spare",
                  "cells a server", "Mb/s a server", "Gb/s in all"], rows)


def main(path):
    parameters = Parameters(**json.loads(pathlib.Path(path).read_text()))
    print(cells_per_core_table(parameters), fleet_table(parameters), sep="\n\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
