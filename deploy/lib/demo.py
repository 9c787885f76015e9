"""The demo: one mission with the real programs, and a folder with everything that it left."""
import argparse
import json
import shutil
import signal
import sys
from pathlib import Path

from mission import SCENARIOS, Mission, MissionError, Options


def list_scenarios():
    for path in sorted(SCENARIOS.glob("*.yaml")):
        title = next((line for line in path.read_text().splitlines() if line.startswith("title:")), "")
        print(f"{path.stem:14} {title.removeprefix('title:').strip()}")


def parse_arguments():
    parser = argparse.ArgumentParser(prog="deploy/demo", description="Flies a whole mission in simulation.")
    parser.add_argument("--list", action="store_true", help="list the scenarios and stop")
    parser.add_argument("--scenario", default="arch", metavar="NAME", help="which one to fly (default: arch)")
    parser.add_argument("--world", type=Path, metavar="FILE", help="fly in a world file of your own")
    parser.add_argument("--seed", type=int, metavar="N", help="fly in a random world drawn from this seed")
    parser.add_argument("--out", type=Path, default=Path("soffit-demo"), metavar="DIR", help="default: soffit-demo")
    parser.add_argument("--autopilot", default="ardupilot", metavar="WHAT",
                        help="ardupilot or px4 (simulated), or the link of one that flies elsewhere: "
                             "tcp:127.0.0.1:5760 for a SITL")
    parser.add_argument("--follow", default="", metavar="LINK",
                        help="a second link of that autopilot, where the simulator hears its pose; "
                             "of a SITL on TCP it is known")
    parser.add_argument("--cold-start", action="store_true", help="the simulated autopilot takes 41 s to get ready")
    parser.add_argument("--timeout", type=float, default=900.0, metavar="S", help="give up after this time")
    arguments = parser.parse_args()
    if arguments.autopilot not in ("ardupilot", "px4") and ":" not in arguments.autopilot:
        parser.error(f"--autopilot {arguments.autopilot}: neither ardupilot, px4 nor a link such as tcp:127.0.0.1:5760")
    return arguments


def choose_world(arguments, options, out):
    if arguments.world:
        return arguments.world
    if arguments.seed is not None:
        world = out / "world.yaml"
        Mission(world, out, options).call(options.bin_dir / "soffit-sim", "draw", "--seed", arguments.seed, "--out", world)
        return world
    world = SCENARIOS / f"{arguments.scenario}.yaml"
    if not world.exists():
        raise MissionError(f"no scenario '{arguments.scenario}'; deploy/demo --list shows what there is")
    return world


def write_report(mission, out):
    """Pictures, overlays, models, OctoMap, drawings of the scene, result.json and report.html into the demo's folder."""
    folder = mission.mission_folder
    mission.call(mission.tool("soffit"), "report", folder, "--out", out, "--config", folder / "options.yaml",
                 "--mission", folder / "mission.json",
                 "--truth", out / "truth" / "truth.json", "--track", out / "truth" / "track.csv")


def tell(outcome, mission, out):
    pictures = json.loads((mission.mission_folder / "mission.json").read_text())["pictures"]
    print("\nfrom each picture to the decision that it allowed")
    for picture in pictures:
        if picture.get("decided_s") is not None and picture["decided_s"] >= 0:
            print(f"  {picture['file']:36} {picture['decided_s'] - picture['arrived_s']:6.2f} s")
    print("peak memory: " + ", ".join(f"{name} {mib:.0f} MiB" for name, mib in outcome.peak_mib.items()))
    least = "unknown" if outcome.least_distance_m is None else f"{outcome.least_distance_m:.2f} m"
    print(f"ground truth: must end {outcome.expected}; ended {outcome.outcome} ({outcome.reason}); "
          f"contacts {outcome.contacts}, least distance to any surface {least}")
    print(f"everything is in {out}/ (start with report.html)")
    print("OK" if outcome.ok else f"NOT OK: {outcome.why}")


def main():
    arguments = parse_arguments()
    if arguments.list:
        list_scenarios()
        return 0
    out = arguments.out.resolve()
    if out.exists() and any(out.iterdir()) and not (out / "truth").exists():
        raise MissionError(f"{out} is not empty and not the folder of an earlier demo: give another --out")
    shutil.rmtree(out, ignore_errors=True)
    out.mkdir(parents=True)
    options = Options(seed=arguments.seed or 1, autopilot=arguments.autopilot, follow=arguments.follow,
                      quick_start=not arguments.cold_start, timeout_s=arguments.timeout)
    mission = Mission(choose_world(arguments, options, out), out, options)
    outcome = mission.fly()
    write_report(mission, out)
    tell(outcome, mission, out)
    return 0 if outcome.ok else 1


if __name__ == "__main__":
    for number in (signal.SIGTERM, signal.SIGHUP):
        signal.signal(number, lambda number, _: sys.exit(128 + number))  # On its way out it ends what it started.
    try:
        sys.exit(main())
    except MissionError as error:
        print(f"demo: {error}", file=sys.stderr)
        sys.exit(2)
    except KeyboardInterrupt:
        sys.exit(130)
