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
EXPECTED_OUTCOMES = {  # what the simulator's truth demands -> how the mission may end
    "flown": {"flown"},
    "not-flown": {"blocked", "insufficient data"},
    "no-match": {"no match"},
}


class MissionError(Exception):
    """Something kept the mission from being flown at all; the message says what and where."""


@dataclass
class Options:
    bin_dir: Path = ROOT / "build" / "release" / "bin"
    seed: int = 1
    timeout_s: float = 900.0
    autopilot: str = "ardupilot"      # ardupilot, px4: simulated; or the link of one that flies elsewhere
    follow: str = ""                  # a second link of that one, where the simulator hears its pose
    quick_start: bool = True
    verbose: bool = True              # live progress on the terminal

    @property
    def is_elsewhere(self):
        return ":" in self.autopilot


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


def second_link(link):
    """Another link of the autopilot behind `link`: a SITL at tcp:HOST:5760 (+ 10 for each instance) also listens on
    ports 5762 and 5763."""
    scheme, _, port = link.partition(":")[0], *link.rpartition(":")[1:]
    step = {"0": 2, "2": 1, "3": -1}.get(port[-1:])
    if scheme != "tcp" or not port.isdigit() or step is None:
        raise MissionError(f"the simulator needs a link of its own to the autopilot on {link}: give --follow, too")
    return link[:-len(port)] + str(int(port) + step)


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


def spawn(command, **streams):
    """A program that ends with the thread that starts it, even when that is killed; Ctrl-C does not reach it."""
    return subprocess.Popen(["setpriv", "--pdeathsig", "TERM", *map(str, command)], stdin=subprocess.DEVNULL,
                            start_new_session=True, **streams)


class Process:
    """A program with its log; ended by its process id."""

    def __init__(self, name, command, log):
        self.name, self.log = name, Path(log)
        self.peak_mib = 0.0
        with open(log, "w") as output:
            self.child = spawn(command, stdout=output, stderr=output)

    def read_json_line(self, timeout_s):
        """The line of JSON that the program prints when it is ready."""
        until = time.monotonic() + timeout_s
        while time.monotonic() < until and self.alive():
            for line in self.log.read_text().splitlines(keepends=True):
                if line.startswith("{") and line.endswith("\n"):
                    return json.loads(line)
            time.sleep(0.05)
        raise MissionError(f"{self.name} did not get ready: {self.last_words()}")

    def last_words(self):
        lines = self.log.read_text(errors="replace").strip().splitlines()
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


class Mission:
    """One mission in one folder. `fly` starts the programs, follows the mission to its end and stops them again."""

    def __init__(self, world, out, options):
        self.world, self.out, self.options = Path(world).resolve(), Path(out).resolve(), options
        self.processes = []

    def fly(self):
        self.prepare()
        started = time.monotonic()
        with dds_domain() as radio, dds_domain() as local:
            try:
                self.start_programs(radio, local)
                self.run_mission()
            finally:
                self.stop_programs()
        outcome = self.judge()
        outcome.duration_s = time.monotonic() - started
        outcome.peak_mib = {p.name: p.peak_mib for p in self.processes}
        return outcome

    def tool(self, name):
        path = self.options.bin_dir / name
        if not path.exists():
            raise MissionError(f"{path} is not there; run deploy/build first")
        return path

    def call(self, *command):
        done = subprocess.run([str(c) for c in command], text=True, capture_output=True)
        if done.returncode != 0:
            raise MissionError(f"{' '.join(str(c) for c in command)}: {done.stderr.strip() or done.stdout.strip()}")
        return done.stdout

    def prepare(self):
        for folder in ("config", "log", "truth", "data"):
            shutil.rmtree(self.out / folder, ignore_errors=True)
            (self.out / folder).mkdir(parents=True)
        self.setting = json.loads(self.call(self.tool("soffit-sim"), "describe", self.world))
        self.reference = self.out / "reference.png"
        self.call(self.tool("soffit-sim"), "reference", self.world, "--out", self.reference)
        self.expected = json.loads(self.call(self.tool("soffit-sim"), "truth", self.world))

    def start_programs(self, radio, local):
        options = self.options
        if options.is_elsewhere:
            link, flying = options.autopilot, ["--autopilot", "none", "--mavlink",
                                               options.follow or second_link(options.autopilot)]
        else:
            port = free_udp_port()
            link, flying = f"udpin:127.0.0.1:{port}", ["--autopilot", options.autopilot, "--mavlink",
                                                       f"udpout:127.0.0.1:{port}"]
            flying += ["--quick-start"] if options.quick_start else []
        simulator = self.start("soffit-sim", "run", self.world, "--out", self.out / "truth", "--seed", options.seed, *flying)
        cameras = simulator.read_json_line(60)["camera_port"]
        self.start("soffitd", "--config", self.write_config("soffitd", self.service_config(radio, local)))
        self.start("soffit-agent", "--config", self.write_config("agent", self.agent_config(radio, link, cameras)))

    def place(self, program):
        """What to put before the command of a program to run it elsewhere."""
        return []

    def start(self, name, *arguments):
        process = Process(name, [*self.place(name), self.tool(name), *arguments], self.out / "log" / f"{name}.log")
        self.processes.append(process)
        return process

    def write_config(self, name, config):
        path = self.out / "config" / f"{name}.yaml"
        path.write_text(json.dumps(config, indent=1) + "\n")  # JSON is YAML
        return path

    def service_config(self, radio, local):
        return {"radio": {"domain_id": radio}, "local": {"domain_id": local}, "data_folder": str(self.out / "data"),
                "pipeline": {"viewpoint": {"overview_altitude_m": self.setting["mission"]["overview_altitude_m"]}}}

    def agent_config(self, radio, link, camera_port):
        camera = self.setting["camera"]
        highest_m = self.setting["mission"]["overview_altitude_m"]
        # A SITL's battery lasts as long as a small one in the air, whatever was flown with it before.
        least_battery = 0.1 if self.options.is_elsewhere else 0.25
        source = f"souphttpsrc location=http://127.0.0.1:{camera_port}/%s.jpg"
        return {
            "vehicle": {"id": VEHICLE_ID, "name": "demo", **self.setting["vehicle"]},
            "mavlink": link,
            "radio": {"domain_id": radio},
            "autopilot": self.setting["pose_noise"],
            "guard": {"ceiling_m": max(60.0, 1.6 * highest_m), "max_distance_m": max(200.0, 4.0 * highest_m),
                      "min_battery_ratio": least_battery},
            "cameras": {"forward": {"pipeline": source % "forward", **camera},
                        "down": {"pipeline": source % "down", "mount": {"pitch_deg": -90.0}, **camera}},
        }

    def run_mission(self):
        """Starts the mission over DDS, as an operator does, and follows it to its end."""
        command = [*self.place("soffit"), self.tool("soffit"), "mission", "start", "--config", self.out / "config" / "soffitd.yaml",
                   "--vehicle", VEHICLE_ID, "--reference", self.reference, "--watch",
                   "--area", *self.setting["mission"]["area_center"]]
        with open(self.out / "log" / "mission.log", "w") as log:
            self.follow(command, log)

    def follow(self, command, log):
        client = spawn(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        os.set_blocking(client.stdout.fileno(), False)
        until = time.monotonic() + self.options.timeout_s
        try:
            while client.poll() is None:
                self.pass_on(client, log)
                dead = [p for p in self.processes if not p.alive()]
                if dead:
                    raise MissionError(f"{dead[0].name} died: {dead[0].last_words()}")
                if time.monotonic() > until:
                    raise MissionError(f"the mission did not end within {self.options.timeout_s:.0f} s: "
                                       f"{self.processes[-1].last_words()} (see {self.out}/log)")
                time.sleep(0.05)
            self.pass_on(client, log)
        finally:
            client.terminate()
            client.wait()
            client.stdout.close()

    def pass_on(self, client, log):
        text = (client.stdout.read() or b"").decode(errors="replace")
        log.write(text)
        if self.options.verbose and text:
            sys.stdout.write(text)
            sys.stdout.flush()

    def stop_programs(self):
        for process in self.processes:
            if process.alive():
                process.note_peak()
        for process in reversed(self.processes):
            process.end()

    @property
    def mission_folder(self):
        folders = sorted((self.out / "data").glob("mission-*"))
        if not folders:
            raise MissionError(f"the service kept no mission: {self.processes[1].last_words()}")
        return folders[-1]

    def judge(self):
        """What the simulator's ground truth says of how the mission ended."""
        truth = json.loads((self.out / "truth" / "truth.json").read_text())
        mission = json.loads((self.mission_folder / "mission.json").read_text())
        outcome = Outcome(ok=False, why="", expected=self.expected["expected"], outcome=mission["outcome"],
                          reason=mission.get("message", ""), contacts=len(truth["contacts"]),
                          least_distance_m=truth["least_distance_m"], passage_flown=truth["passage_flown"])
        wrongs = []
        if outcome.contacts:
            wrongs.append(f"touched {truth['contacts'][0]['with']}")
        if any(not flight["passable"] for flight in truth["flights_under"]):
            wrongs.append("flew under what is not passable")
        if not truth["on_ground"]:
            wrongs.append("did not land")
        if outcome.outcome not in EXPECTED_OUTCOMES[outcome.expected]:
            wrongs.append(f"the truth is {outcome.expected}, the mission ended {outcome.outcome}: {outcome.reason}")
        elif (outcome.expected == "flown") != outcome.passage_flown:
            wrongs.append("the passage was " + ("not " if not outcome.passage_flown else "") + "flown")
        outcome.ok, outcome.why = not wrongs, "; ".join(wrongs)
        return outcome
