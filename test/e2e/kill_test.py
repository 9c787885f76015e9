"""soffitd is killed again and again while it leads a mission: nothing that anyone heard of is missing afterwards, the
same scene is there again at once, and the mission ends as the simulator's ground truth demands."""
import argparse
import contextlib
import random
import re
import shutil
import sqlite3
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "deploy" / "lib"))
from mission import SCENARIOS, VEHICLE_ID, Mission, MissionError, Options, Process, spawn  # noqa: E402


class SceneWatcher:
    """What a client on the bus heard of the scene, and when."""

    def __init__(self, command):
        self.heard = []  # (time, revision)
        self.child = spawn(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        threading.Thread(target=self.listen, daemon=True).start()

    def listen(self):
        for line in self.child.stdout:
            match = re.match(r"vehicle \d+, revision (\d+):", line)
            if match:
                self.heard.append((time.monotonic(), int(match[1])))

    def newest(self):
        return max((revision for _, revision in self.heard), default=0)

    def delay_s(self, since, revision):
        """From `since` until this revision, or a newer one, was heard again; None: it was not."""
        return next((when - since for when, heard in list(self.heard) if when >= since and heard >= revision), None)

    def end(self):
        self.child.terminate()
        self.child.wait()


class KilledMission(Mission):
    def __init__(self, world, out, options, kills, seed):
        super().__init__(world, out, options)
        self.kills, self.random = kills, random.Random(seed)
        self.killed, self.delays_s = 0, []

    def run_mission(self):
        config = ["--config", self.out / "config" / "soffitd.yaml"]
        self.watcher = SceneWatcher([self.tool("soffit"), "scene", "watch", *config])
        try:
            self.call(self.tool("soffit"), "mission", "start", *config, "--vehicle", VEHICLE_ID,
                      "--reference", self.reference, "--area", *self.setting["mission"]["area_center"])
            self.check_store()
            until = time.monotonic() + self.options.timeout_s
            while self.state() != "ended":
                if time.monotonic() > until:
                    raise MissionError(f"the mission did not end within {self.options.timeout_s:.0f} s, "
                                       f"killed {self.killed} times: {self.row('message')}")
                if self.killed < self.kills:
                    time.sleep(self.random.uniform(0.1, 10.0))
                    self.kill_and_restart()
                else:
                    time.sleep(0.5)
            time.sleep(1.0)  # What is written for people follows what is kept.
        finally:
            self.watcher.end()

    def kill_and_restart(self):
        old = next(p for p in self.processes if p.name == "soffitd")
        if not old.alive():
            raise MissionError(f"soffitd died by itself: {old.last_words()}")
        old.child.kill()
        old.child.wait()
        self.processes.remove(old)
        self.killed += 1
        time.sleep(0.05)  # What the dead one had sent arrives.
        revision = self.watcher.newest()
        self.check_store()
        began = time.monotonic()
        self.processes.append(Process("soffitd", [self.tool("soffitd"), "--config", self.out / "config" / "soffitd.yaml"],
                                      self.out / "log" / f"soffitd-{self.killed}.log"))
        if revision == 0:
            return
        while (delay_s := self.watcher.delay_s(began, revision)) is None:
            if time.monotonic() > began + 30:
                raise MissionError(f"revision {revision} was not heard again: {self.processes[-1].last_words()}")
            time.sleep(0.02)
        self.delays_s.append(delay_s)

    def select(self, sql):
        """From the store: beside the service while it lives, else by a copy, so that nothing is mended for it."""
        if any(p.name == "soffitd" and p.alive() for p in self.processes):
            for _ in range(100):
                with contextlib.suppress(sqlite3.OperationalError):  # Not opened yet, or busy.
                    return self.read(f"file:{self.out}/data/soffit.gpkg?mode=ro", sql)
                time.sleep(0.05)
            raise MissionError("the store cannot be read beside the service")
        with tempfile.TemporaryDirectory(prefix="soffit-e2e-") as copy:
            for file in (self.out / "data").glob("soffit.gpkg*"):
                shutil.copy(file, copy)
            return self.read(f"file:{copy}/soffit.gpkg", sql)

    @staticmethod
    def read(uri, sql):
        with contextlib.closing(sqlite3.connect(uri, uri=True)) as store:
            return store.execute(sql).fetchall()

    def row(self, column):
        rows = self.select(f"SELECT {column} FROM missions")
        return rows[0][0] if rows else None

    def state(self):
        return self.row("state")

    def check_store(self):
        if self.state() is None:
            raise MissionError("the service said that the mission has begun, and does not know of it any more")
        known = {int(text.split()[0]) for (text,) in self.select("SELECT text FROM journal WHERE kind = 'command'")}
        log = (self.out / "log" / "soffit-agent.log").read_text(errors="replace")
        taken = {int(number) for number in re.findall(r"command (\d+) \([^)]*\) accepted", log)}
        if not taken <= known:
            raise MissionError(f"the agent took commands that are not in the journal: {sorted(taken - known)}")
        kept = max((revision for (revision,) in self.select("SELECT scene_revision FROM scenes")), default=0)
        if self.watcher.newest() > kept:
            raise MissionError(f"revision {self.watcher.newest()} was published, revision {kept} is kept")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--bin", type=Path, required=True)
    parser.add_argument("--kills", type=int, default=30)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--timeout", type=float, default=900)
    parser.add_argument("--within", type=float, default=30.0, help="seconds until the scene has to be there again")
    parser.add_argument("scenario")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="soffit-e2e-") as out:
        mission = KilledMission(SCENARIOS / f"{arguments.scenario}.yaml", out,
                                Options(bin_dir=arguments.bin, timeout_s=arguments.timeout), arguments.kills,
                                arguments.seed)
        outcome = mission.fly()
    slowest_s = max(mission.delays_s, default=0.0)
    print(outcome)
    print(f"killed {mission.killed} times; the same scene was there again within {slowest_s:.2f} s "
          f"({len(mission.delays_s)} times)")
    return outcome.ok and mission.killed == arguments.kills and slowest_s <= arguments.within


if __name__ == "__main__":
    sys.exit(0 if main() else 1)
