"""Whose CPU time it is: servers under load, the load tool, or others on this machine."""

import contextlib
import os
import pathlib
import subprocess
import time


def cpu_s(pid):
    fields = pathlib.Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def family(process):
    """A server and its workers."""
    children = pathlib.Path(f"/proc/{process.pid}/task/{process.pid}/children")
    return [process.pid, *children.read_text().split()]


def busy_s():
    """CPU time of the machine: all but idle and waiting for disks."""
    times = [int(word) for word in pathlib.Path("/proc/stat").read_text().split("\n")[0].split()[1:9]]
    return (sum(times) - times[3] - times[4]) / os.sysconf("SC_CLK_TCK")


@contextlib.contextmanager
def strangers(count):
    """Processes that compute, as somebody else's would."""
    processes = [subprocess.Popen(["sh", "-c", "while :; do :; done"]) for _ in range(count)]
    try:
        yield
    finally:
        for process in processes:
            process.kill()
            process.wait()


class Others:
    """How many cores' time goes to processes that are neither servers nor the load tool."""

    def __init__(self, servers):
        self.pids = sum(map(family, servers), [])
        self.begin_s, self.begin = time.monotonic(), self.not_ours_s()

    def not_ours_s(self):
        ended = os.times()
        return busy_s() - sum(map(cpu_s, self.pids)) - ended.children_user - ended.children_system

    def cores(self):
        return max(0.0, (self.not_ours_s() - self.begin) / (time.monotonic() - self.begin_s))
