"""Loads real servers with `grasp load` and compares with the model: ./run bench load

Needs root for network namespaces; without, the runs in them are left out and named.
"""

import argparse
import concurrent.futures
import contextlib
import dataclasses
import json
import os
import pathlib
import re
import shutil
import statistics
import subprocess
import tempfile

from load_cores import Others, cpu_s, family, strangers
from load_model import Parameters, Setup, capacity_fps, table

CELLS = 16
PARTS = ("tee", "elbow", "flanged_ring", "hex_bolt", "l_bracket", "straight_pipe")
SETUPS = (
    Setup("1 server, 2 workers", 1, 2),
    Setup("the same, beside a process that computes", 1, 2, strangers=1),
    Setup("1 server, 1 worker", 1, 1),
    Setup("2 servers, 1 worker each", 2, 1),
    Setup("3 servers, 1 worker each", 3, 1),
    Setup("1 server, 2 workers, link of 20 Mb/s", 1, 2, link_mbit=20),
    Setup("the same, RVL", 1, 2, link_mbit=20, encoding="rvl"),
    Setup("1 server, 2 workers that sleep 20 ms", 1, 2, sleep_ms=20),
    Setup("3 servers, 2 workers each that sleep 20 ms", 3, 2, sleep_ms=20),
)
QUIET_CORES = 0.1
ONE, THREE = SETUPS[-2], SETUPS[-1]
RUNS = ("--warm-up-s", "1", "--window-s", "5", "--max-windows", "3")


class Bench:
    def __init__(self, arguments, folder):
        self.bin = pathlib.Path(arguments.bin)
        self.out = pathlib.Path(arguments.out)
        self.folder = pathlib.Path(folder)
        self.config = self.folder / "server.yaml"
        # One thread each, as the model has it.
        self.config.write_text(f"parts: {pathlib.Path('deploy/parts').resolve()}\n"
                               "worker_threads_n: 1\n")
        self.piles = [self.pile(part) for part in PARTS]
        self.make_keys()

    def run(self, *words, **more):
        return subprocess.run([str(word) for word in words], check=True, text=True, **more)

    def pile(self, part):
        folder = self.out / "load_piles" / part
        if not folder.exists():
            part_folder = folder.with_suffix(".part")
            shutil.rmtree(part_folder, ignore_errors=True)
            self.run(self.bin / "robot_agent", "--log-level", "warning", "simulate", "--part",
                     f"{part}=45", "--frames", "4", "--out", part_folder,
                     stdout=subprocess.DEVNULL)
            part_folder.rename(folder)
        return folder

    def make_keys(self):
        self.keys = self.folder / "keys"
        for cell in ["server"] + [f"load_{n + 1}" for n in range(CELLS)]:
            self.run(self.bin / "grasp", "keys", "new", cell, "--out", self.keys,
                     stdout=subprocess.DEVNULL)
            if cell != "server":
                self.run(self.bin / "grasp", "keys", "allow", self.keys / f"{cell}.pub", "--list",
                         self.keys / "allowed_cells", stdout=subprocess.DEVNULL)

    @contextlib.contextmanager
    def server(self, workers, scripted=False, host="127.0.0.1", namespace=None, keys=True):
        words = ["ip", "netns", "exec", namespace] if namespace else []
        words += [self.bin / ("scripted_server" if scripted else "grasp_server"), "serve",
                  "--workers", workers, "--log-level", "error", "--endpoint", f"tcp://{host}:0",
                  "--control-endpoint", f"tcp://{host}:0"]
        words += [] if scripted else ["--config", self.config]
        words += (["--key", self.keys / "server.key", "--allowed-cells",
                   self.keys / "allowed_cells"] if keys else ["--insecure"])
        process = subprocess.Popen([str(word) for word in words], stdout=subprocess.PIPE, text=True)
        try:
            ready = process.stdout.readline()
            if not ready:
                raise RuntimeError("a server did not start")
            yield process, re.search(r"data ([^,\s]+)", ready)[1]
        finally:
            process.terminate()
            process.wait()

    @contextlib.contextmanager
    def namespace(self, number, link_mbit):
        """A machine of its own, with a cable. Yields its name and address."""
        name, cable = f"graspd_{os.getpid()}_{number}", f"graspd{number}"
        self.run("ip", "netns", "add", name)
        try:
            for command in (f"ip link add {cable} type veth peer name eth0 netns {name}",
                            f"ip addr add 10.79.{number}.1/24 dev {cable}",
                            f"ip link set {cable} up",
                            f"ip -n {name} addr add 10.79.{number}.2/24 dev eth0",
                            f"ip -n {name} link set eth0 up", f"ip -n {name} link set lo up"):
                self.run(*command.split())
            if link_mbit:
                self.run(*f"tc qdisc add dev {cable} root tbf rate {link_mbit}mbit burst 64kb "
                          "latency 400ms".split())
            yield name, f"10.79.{number}.2"
        finally:
            # A namespace goes with its cable, but some time later.
            subprocess.run(["ip", "link", "del", cable], check=False)
            self.run("ip", "netns", "del", name)

    def load(self, endpoints, *options, parts=None, cells=CELLS, keys=True, name="load"):
        """`grasp load`; returns its load.json."""
        recordings = [f"{pile}={part}" for pile, part in
                      zip(self.piles, [parts] * len(PARTS) if parts else PARTS)]
        out = self.out / f"load_{name}"
        words = [self.bin / "grasp", "load", *recordings, "--cells", cells, "--out", out, *options]
        for endpoint in endpoints:
            words += ["--server", endpoint]
        if keys:
            words += ["--server-key", self.keys / "server.pub", "--keys", self.keys]
        out.mkdir(exist_ok=True)
        with (out / "report.txt").open("w") as report:
            self.run(*words, stdout=report)
        return json.loads((out / "load.json").read_text())

    def capacity(self):
        """16 cells with mixed parts and keys: how much, how late, how fair."""
        with self.server(2) as (process, endpoint):
            others = Others([process])
            found = self.load([endpoint], "--find-capacity", *RUNS, name="capacity")
            capacity = found["capacity_fps"]
            overload = self.load([endpoint], "--rate", 1.3 * capacity, *RUNS,
                                 name="overload")["runs"][0]
            others_cores = others.cores()
        if others_cores > QUIET_CORES:
            print(f"others took {others_cores:.2f} cores meanwhile: capacity and latency are worse "
                  "than servers alone have them")
        below = [run["latency_ms"]["p99"] / run["latency_ms"]["p50"] for run in found["runs"]
                 if run["is_open"] and run["rate_fps"] <= 0.801 * capacity]
        return {"capacity_fps": capacity, "peak_fps": found["runs"][0]["goodput_fps"],
                "p99_over_median_at_80": max(below), "jain": overload["jain"],
                "others_cores": others_cores}

    def echo(self, keys, *options, name):
        """100 frames a second to a worker that answers at once; and the server's CPU time of one."""
        with self.server(1, scripted=True, keys=keys) as (process, endpoint):
            pids = family(process)
            before_s = sum(map(cpu_s, pids))
            loaded = self.load([endpoint], "--rate", "100", *RUNS, *options, parts="echo", keys=keys,
                               name=name)
            taken_s = sum(map(cpu_s, pids)) - before_s
        # The warm-up was work, too.
        return loaded, 10 * taken_s / (loaded["runs"][0]["length_s"] + float(RUNS[1]))

    def eval_all(self):
        """Plans every pile on one core without a network; a list of median times."""
        times_ms = []
        for pile, part in zip(self.piles, PARTS):
            words = [self.bin / "grasp_server", "eval", pile, "--parts", "deploy/parts", "--part", part]
            text = self.run(*words, stdout=subprocess.PIPE).stdout
            times_ms.append(float(re.search(r"median time: ([0-9.]+) ms", text)[1]))
        return times_ms

    def parameters(self):
        """What the model knows: nothing of it is a run that it predicts."""
        plain, _ = self.echo(False, name="plain")
        curve, service_ms = self.echo(True, name="curve")
        rvl, _ = self.echo(True, "--encoding", "rvl", name="rvl")
        cores = len(os.sched_getaffinity(0))
        alone_ms = self.eval_all()
        with concurrent.futures.ThreadPoolExecutor() as pool:
            crowd_ms = sum(pool.map(lambda _: self.eval_all(), range(cores)), [])
        raw_run, rvl_run = curve["runs"][0], rvl["runs"][0]
        decode_ms = raw_run["mean_ms"]["decode"]
        parameters = Parameters(
            cores=cores, plan_ms=statistics.mean(alone_ms) + decode_ms,
            crowd_factor=statistics.mean(crowd_ms) / statistics.mean(alone_ms),
            service_ms=service_ms - decode_ms,
            tool_ms=1000 * raw_run["tool_cpu_share"] / raw_run["asked_fps"],
            frame_bytes={"raw": curve["frame_bytes"], "rvl": rvl["frame_bytes"]},
            rvl_ms=rvl_run["mean_ms"]["decode"] - decode_ms)
        self.save("load_parameters.json", dataclasses.asdict(parameters))
        return {"load_tool_cpu_share": raw_run["tool_cpu_share"],
                "load_tool_cpu_share_plain": plain["runs"][0]["tool_cpu_share"],
                "load_tool_cpu_share_rvl": rvl_run["tool_cpu_share"],
                "clock_error_p50_ms": raw_run["clock_error_ms"]["p50"],
                "clock_error_p99_ms": raw_run["clock_error_ms"]["p99"]}

    def saturated(self, setup):
        """Frames a second where every worker always has one waiting, and the cores of others."""
        scripted = setup.sleep_ms > 0
        with contextlib.ExitStack() as stack:
            servers, endpoints = [], []
            for number in range(1, setup.servers + 1):
                where = {}
                if setup.servers > 1 or setup.link_mbit:
                    name, host = stack.enter_context(self.namespace(number, setup.link_mbit))
                    where = {"namespace": name, "host": host}
                server, endpoint = stack.enter_context(
                    self.server(setup.workers, scripted, **where))
                servers.append(server)
                endpoints.append(endpoint)
            stack.enter_context(strangers(setup.strangers))
            # No more on a slow link than it carries within a request's budget.
            in_flight = 1 if setup.link_mbit else 2
            others = Others(servers)
            run = self.load(endpoints, "--in-flight", in_flight, "--encoding", setup.encoding,
                            *RUNS, parts=f"sleep_{setup.sleep_ms:.0f}" if scripted else None,
                            cells=4 if setup.link_mbit else CELLS, name="saturated")["runs"][0]
            return run["goodput_fps"], others.cores()

    def compare(self):
        """The model beside measured runs."""
        path = self.out / "load_parameters.json"
        parameters = Parameters(**json.loads(path.read_text()))
        can_isolate = os.geteuid() == 0 and shutil.which("ip") is not None
        rows, errors, measured = [], [], {}
        for setup in SETUPS:
            if (setup.servers > 1 or setup.link_mbit) and not can_isolate:
                print(f"left out: {setup.name}: network namespaces need root and iproute2")
                continue
            measured[setup.name], others = self.saturated(setup)
            predicted = capacity_fps(parameters, setup, others)
            errors.append(abs(predicted / measured[setup.name] - 1))
            rows.append([setup.name, f"{others:.2f}", f"{measured[setup.name]:.1f}",
                         f"{predicted:.1f}", f"{100 * (predicted / measured[setup.name] - 1):+.1f}"])
        print("\n" + table(["what is loaded", "others' cores", "measured frames/s", "model",
                            "error %"], rows))
        figures = {"model_error_max": max(errors)}
        if THREE.name in measured:
            figures["three_servers_gain"] = measured[THREE.name] / measured[ONE.name]
        return figures

    def fleet(self):
        """What `./run bench fleet` has found, where it has been run."""
        path = self.out / "fleet.json"
        found = json.loads(path.read_text()) if path.exists() else {}
        return {name: found[name] for name in ("slurm_failed", "haproxy_failed") if name in found}

    def save(self, name, figures):
        """Beside what is there already: the steps can be run one by one."""
        path = self.out / name
        before = json.loads(path.read_text()) if path.exists() else {}
        path.write_text(json.dumps({**before, **figures}, indent=2) + "\n")


def main():
    steps = ("capacity", "parameters", "compare")
    parser = argparse.ArgumentParser(prog="./run bench load")
    parser.add_argument("--bin", required=True)
    parser.add_argument("--out", required=True)
    parser.add_argument("steps", nargs="*", default=steps, metavar="|".join(steps))
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(arguments, folder)
        for step in arguments.steps:
            if step not in steps:
                parser.error(f"no step '{step}'; known: {', '.join(steps)}")
            print(f"\n{step}", flush=True)
            figures = getattr(bench, step)()
            for name, value in figures.items():
                print(f"{name:<28} {value:>10.4f}")
            bench.save("load.json", figures)
        bench.save("load.json", bench.fleet())


if __name__ == "__main__":
    main()
