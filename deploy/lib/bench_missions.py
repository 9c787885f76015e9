"""Flies missions over random worlds and prints a table: how many ended as the ground truth demands, and how the others
failed. Usage: bench_missions.py [--worlds 50] [--first-seed 1] [--jobs 2] [--out DIR]"""
import argparse
import os
import shutil
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from mission import Mission, MissionError, Options, Outcome


def fly(seed, out, bin_dir):
    folder = out / f"seed-{seed}"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    options = Options(bin_dir=bin_dir, seed=seed, verbose=False)
    try:
        world = folder / "world.yaml"
        mission = Mission(world, folder, options)
        mission.call(mission.tool("soffit-sim"), "draw", "--seed", seed, "--out", world)
        return mission.fly()
    except MissionError as error:
        return Outcome(ok=False, why=str(error))


def row(seed, outcome):
    least = "-" if outcome.least_distance_m is None else f"{outcome.least_distance_m:.2f}"
    return (f"{seed:5} {'ok' if outcome.ok else 'FAIL':4} {outcome.expected:10} {outcome.outcome:18} "
            f"{outcome.contacts:8} {least:>7} {outcome.duration_s:6.0f}  {outcome.why or outcome.reason}")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--worlds", type=int, default=50)
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=2, help="missions at the same time")
    parser.add_argument("--bin", type=Path, default=Options.bin_dir, help="folder of the programs")
    parser.add_argument("--out", type=Path, default=Path("soffit-bench"))
    arguments = parser.parse_args()
    seeds = range(arguments.first_seed, arguments.first_seed + arguments.worlds)
    print(f"{'seed':>5} {'':4} {'expected':10} {'ended':18} {'contacts':>8} {'least m':>7} {'time s':>6}  why", flush=True)
    outcomes = []
    with ThreadPoolExecutor(arguments.jobs) as pool:
        try:
            for seed, outcome in zip(seeds, pool.map(lambda s: fly(s, arguments.out.resolve(), arguments.bin), seeds)):
                print(row(seed, outcome), flush=True)
                outcomes.append(outcome)
        except KeyboardInterrupt:
            os._exit(130)  # The programs of the missions under way end with this one.
    right, contacts = sum(o.ok for o in outcomes), sum(o.contacts > 0 for o in outcomes)
    wrong_flights = sum("not passable" in o.why for o in outcomes)
    print(f"\n{right} of {len(outcomes)} as the truth demands; with contact: {contacts}; "
          f"flown under what is not passable: {wrong_flights}")
    return 0 if contacts == 0 and wrong_flights == 0 and right >= 0.96 * len(outcomes) else 1


if __name__ == "__main__":
    sys.exit(main())
