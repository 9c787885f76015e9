"""Agent and service on the two ends of a radio link that loses, delays and fails: what vehicle_agent/README.md promises.

A short version is a test; --long measures everything (target bench_link).
"""
import argparse
import json
import re
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "deploy" / "lib"))
from mission import SCENARIOS, Mission, MissionError, Options, Process, dds_domain  # noqa: E402
from radio_link import GROUND, VEHICLE, Conditions, NoLink, RadioLink  # noqa: E402

SKIPPED = 77
COMMAND_P99_S = 0.25
MAX_LATE_RATIO = 0.005
OUTAGE_S = 20.0
GOES_ON_S = 3.0  # Judged by bench_link alone, where nothing else runs.
GIVES_UP_S = 60.0
GOES_ON = re.compile(r"accepted|arrived|\) done|info (in transit|looking|in corridor): command")
SNOW = "videotestsrc num-buffers=1 pattern=snow ! video/x-raw,width=1280,height=960 ! jpegenc quality=90"  # about 1 MB


def percentile(values, share):
    ordered = sorted(values)
    return ordered[min(int(share * len(ordered)), len(ordered) - 1)]


class LinkedMission(Mission):
    """A mission with the vehicle on one end of a link and all else on the other."""

    def __init__(self, world, out, options, link):
        super().__init__(world, out, options)
        self.link = link

    def place(self, program):
        return self.link.vehicle if program in ("soffit-sim", "soffit-agent") else self.link.ground

    def agent_config(self, radio, link, camera_port):
        config = super().agent_config(radio, link, camera_port)
        config["radio"]["peers"] = [GROUND]
        return config


def measure(options, conditions, pictures, folder):
    """One megabyte after another, and 20 commands a second meanwhile."""
    with dds_domain() as radio, RadioLink(conditions) as link:
        mission = LinkedMission(SCENARIOS / "arch.yaml", folder, options, link)
        mission.prepare()
        try:
            mission.start("soffit-sim", "run", mission.world, "--quick-start", "--out", folder / "truth",
                          "--mavlink", "udpout:127.0.0.1:14550").read_json_line(60)
            config = mission.agent_config(radio, "udpin:127.0.0.1:14550", 0)
            for camera in config["cameras"].values():
                camera.update(pipeline=SNOW, width_px=1280, height_px=960)
            mission.start("soffit-agent", "--config", mission.write_config("agent", config))
            probe = subprocess.run([*link.ground, options.bin_dir.parent / "test" / "link_probe", "--domain", str(radio),
                                    "--peer", VEHICLE, "--pictures", str(pictures)],
                                   capture_output=True, text=True, timeout=60 + 30 * pictures)
        finally:
            mission.stop_programs()
        if link.late_ratio > MAX_LATE_RATIO:
            raise NoLink(f"this machine is too busy to play a link: {100 * link.late_ratio:.0f} % of the packets were late")
    log = (folder / "log" / "soffit-agent.log").read_text()
    if probe.returncode != 0:
        raise MissionError(probe.stderr.strip() or "link_probe failed")
    fragments = [[int(n) for n in found] for found in re.findall(r"(\d+) of (\d+) fragments sent again", log)]
    return {**json.loads(probe.stdout), "fragments": fragments}


def judge_measured(name, conditions, report):
    problems = []
    for number, picture in enumerate(report["pictures"], 1):
        if picture["status"] != "done" or picture["arrived"] < 1 or not picture["whole"]:
            problems.append(f"{name}: picture {number}: {picture}")
    lost = sum(there is None for there, _ in report["commands_s"])
    if lost:
        problems.append(f"{name}: {lost} commands were never answered")
    there, back = ([trip[i] for trip in report["commands_s"] if trip[0] is not None] for i in (0, 1))
    if percentile(there, 0.99) > COMMAND_P99_S:
        problems.append(f"{name}: a command takes {percentile(there, 0.99):.3f} s (p99)")
    again, sent = (sum(counts) for counts in zip(*report["fragments"]))
    if len(report["fragments"]) < len(report["pictures"]) or not 0 < again < sent / 2:
        problems.append(f"{name}: delivery reports tell of {again} of {sent} fragments sent again")
    took = [picture["took_s"] for picture in report["pictures"]]
    print(f"{name}: {len(took)} pictures of {report['pictures'][0].get('bytes', 0) / 1e6:.2f} MB, look to done "
          f"{percentile(took, 0.5):.2f} s, worst {max(took):.2f} s; {len(there)} commands until answered "
          f"{percentile(there, 0.5) * 1e3:.0f} ms, p99 {percentile(there, 0.99) * 1e3:.0f} ms, answer back p99 "
          f"{percentile(back, 0.99) * 1e3:.0f} ms; {100 * again / sent:.0f} % of the fragments sent again", flush=True)
    return problems


class Cutter(threading.Thread):
    """Cuts the link when the agent tells of a phase, once for each, and notes how the mission goes on."""

    def __init__(self, link, log, phases):
        super().__init__(daemon=True)
        self.link, self.log, self.phases = link, Path(log), list(phases)
        self.goes_on_s = {}

    def lines(self):
        return self.log.read_text(errors="replace").splitlines() if self.log.exists() else []

    def run(self):
        known = 0
        while self.phases:
            lines = self.lines()
            phase = next((p for p in self.phases if any(f"info {p}: command" in line for line in lines[known:])), None)
            known = len(lines)
            if phase is None:
                time.sleep(0.05)
                continue
            self.phases.remove(phase)
            self.cut(phase)
            time.sleep(10.0)  # Well on its way again.
            known = len(self.lines())

    def cut(self, phase):
        self.link.cut()
        time.sleep(OUTAGE_S)
        before = len(self.lines())
        self.link.restore()
        restored = time.monotonic()
        while not any(GOES_ON.search(line) for line in self.lines()[before:]):
            if time.monotonic() - restored > GIVES_UP_S:
                break
            time.sleep(0.02)
        self.goes_on_s[phase] = time.monotonic() - restored


def fly(options, conditions, phases, folder):
    with RadioLink(conditions) as link:
        mission = LinkedMission(SCENARIOS / "arch.yaml", folder, options, link)
        cutter = Cutter(link, folder / "log" / "soffit-agent.log", phases)
        cutter.start()
        return mission.fly(), cutter


def judge_flown(name, outcome, cutter, goes_on_s):
    # What is decided of the building is for mission_test.
    is_safe = outcome.contacts == 0 and outcome.outcome not in ("failed", "aborted")
    problems = [] if is_safe else [f"{name}: {outcome.why}"]
    problems += [f"{name}: never was {phase}" for phase in cutter.phases]
    for phase, took_s in cutter.goes_on_s.items():
        print(f"{name}: cut for {OUTAGE_S:.0f} s while {phase}: goes on {took_s:.2f} s after the return", flush=True)
        if took_s > goes_on_s:
            problems.append(f"{name}: after an outage while {phase} it went on only after {took_s:.1f} s")
    print(f"{name}: {outcome}", flush=True)
    return problems


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--bin", type=Path, required=True)
    parser.add_argument("--long", action="store_true")
    parser.add_argument("--measure", action="store_true", help="the pictures and commands")
    parser.add_argument("--outage", nargs="*", default=[], help="phases in which the link fails")
    arguments = parser.parse_args()
    options = Options(bin_dir=arguments.bin.resolve(), timeout_s=360, verbose=False)
    measured = [("5 %", Conditions(loss_ratio=0.05)), ("10 %", Conditions(loss_ratio=0.1)),
                ("10 %, 50 ms each way", Conditions(loss_ratio=0.1, delay_s=0.05)),
                ("5 % in bursts of 5", Conditions(loss_ratio=0.05, burst_packets=5.0))]
    phases = arguments.outage
    pictures = 20
    if arguments.long:
        phases = ["in transit", "looking", "in corridor"]
    elif arguments.measure:
        measured, pictures = measured[1:2], 8
    else:
        measured = []
    problems = []
    with tempfile.TemporaryDirectory(prefix="soffit-e2e-") as folder:
        folder = Path(folder)
        try:
            for number, (name, conditions) in enumerate(measured):
                problems += judge_measured(name, conditions, measure(options, conditions, pictures, folder / f"m{number}"))
            limit_s = GOES_ON_S if arguments.long else GIVES_UP_S
            for number, phase in enumerate(phases):
                flown = fly(options, Conditions(loss_ratio=0.05), [phase], folder / f"f{number}")
                problems += judge_flown(f"5 %, {phase}", *flown, limit_s)
        except NoLink as problem:
            print(f"skipped: {problem}")
            return SKIPPED
    print("\n".join(problems))
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
