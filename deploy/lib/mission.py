"""Flies one mission with the real programs: soffit-sim, soffitd and soffit-agent as processes on loopback.

Used by deploy/demo, by the end-to-end tests and by bench_missions. Everything that a mission leaves is in one folder.
"""
import contextlib
import fcntl
import json
import os
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SCENARIOS = ROOT / "test" / "sim" / "scenarios"
VEHICLE_ID = 1


class MissionError(Exception):
    """Something kept the mission from being flown at all; the message says what and where."""


@dataclass
class Options:
    bin_dir: Path = ROOT / "build" / "release" / "bin"
    seed: int = 1
    timeout_s: float = 900.0
    autopilot: str = "ardupilot"      # ardupilot, px4: simulated; or the URL of a real one
    follow_url: str = ""              # with a real autopilot: where the simulator hears its pose
    quick_start: bool = True
    verbose: bool = True              # live progress on the terminal


@dataclass
class Outcome:
    ok: bool
    why: str
    expected: str = ""
    outcome: str = ""
    reason: str = ""
    contacts: int = 0
    least_distance_m: float = float("nan")
    passage_flown: bool = False
    duration_s: float = 0.0
    peak_mib: dict = field(default_factory=dict)


def free_udp_port():
    with contextlib.closing(socket.socket(socket.AF_INET, socket.SOCK_DGRAM)) as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


@contextlib.contextmanager
def dds_domain():
    """A DDS domain that no other mission on this machine uses."""
    folder = Path(tempfile.gettempdir()) / "soffit-domains"
    folder.mkdir(mode=0o1777, exist_ok=True)
    for domain in range(20, 200):
        lock = open(folder / str(domain), "w")
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            lock.close()
            continue
        try:
            yield domain
        finally:
            lock.close()
        return
    raise MissionError("no free DDS domain from 20 to 199: are other missions running?")


class Process:
    """A program with its log; ended by its process id."""

    def __init__(self, name, command, log):
        self.name, self.log = name, log
        self.peak_mib = 0.0
        self.child = subprocess.Popen([str(c) for c in command], stdout=subprocess.PIPE, stderr=open(log, "w"),
                                      stdin=subprocess.DEVNULL, text=True)

    def read_json_line(self, timeout_s):
        """The line of JSON that the program prints when it is ready."""
        os.set_blocking(self.child.stdout.fileno(), False)
        until, text = time.monotonic() + timeout_s, ""
        while time.monotonic() < until:
            text += self.child.stdout.read() or ""
            for line in text.splitlines():
                if line.startswith("{"):
                    return json.loads(line)
            if self.child.poll() is not None:
                break
            time.sleep(0.02)
        raise MissionError(f"{self.name} did not get ready: {self.last_words()}")

    def last_words(self):
        lines = Path(self.log).read_text(errors="replace").strip().splitlines()
        return lines[-1] if lines else f"it said nothing, see {self.log}"

    def alive(self):
        return self.child.poll() is None

    def end(self, timeout_s=10):
        if self.alive():
            self.note_peak()
            self.child.send_signal(signal.SIGTERM)
            try:
                self.child.wait(timeout_s)
            except subprocess.TimeoutExpired:
                self.child.kill()
        self.child.wait()
        return self.child.returncode

    def note_peak(self):
        with contextlib.suppress(OSError):
            for line in Path(f"/proc/{self.child.pid}/status").read_text().splitlines():
                if line.startswith("VmHWM:"):
                    self.peak_mib = int(line.split()[1]) / 1024
