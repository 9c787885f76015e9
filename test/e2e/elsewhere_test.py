"""The autopilot flies elsewhere, as a SITL does: it listens on TCP, its home is anywhere on Earth, and soffit-sim is only
the camera, which follows the pose that the autopilot reports on a second link."""
import argparse
import json
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "deploy" / "lib"))
from mission import SCENARIOS, Mission, Options, Process  # noqa: E402

FAR_AWAY = "geodetic_origin: {latitude_deg: -35.363262, longitude_deg: 149.165237, altitude_amsl_m: 584}\n"


def compare(flown, followed):
    """What the autopilot's own truth says against the camera's, which knows only what was reported."""
    problems = [f"{name}: {flown[name]} there, {followed[name]} here"
                for name in ("passage_flown", "contacts", "on_ground") if flown[name] != followed[name]]
    if abs(flown["least_distance_m"] - followed["least_distance_m"]) > 0.1:
        problems.append(f"least distance: {flown['least_distance_m']} there, {followed['least_distance_m']} here")
    return problems


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--bin", type=Path, required=True)
    parser.add_argument("scenario")
    arguments = parser.parse_args()
    world = SCENARIOS / f"{arguments.scenario}.yaml"
    with tempfile.TemporaryDirectory(prefix="soffit-e2e-") as folder:
        folder = Path(folder)
        there = folder / "there.yaml"
        there.write_text(world.read_text() + FAR_AWAY)
        autopilot = Process("autopilot", [arguments.bin / "soffit-sim", "run", there, "--quick-start", "--out",
                                          folder / "there", "--mavlink", "tcpin:127.0.0.1:0",
                                          "--mavlink", "tcpin:127.0.0.1:0"], folder / "there.log")
        try:
            first, second = (url.replace("tcpin:", "tcp:") for url in autopilot.read_json_line(60)["mavlink"])
            outcome = Mission(world, folder / "here", Options(bin_dir=arguments.bin, timeout_s=360,
                                                              autopilot=first, follow=second)).fly()
        finally:
            autopilot.end()
        flown, followed = (json.loads(path.read_text()) for path in (
            folder / "there" / "truth.json", folder / "here" / "truth" / "truth.json"))
    print(outcome)
    problems = compare(flown, followed)
    print("\n".join(problems))
    return 0 if outcome.ok and not problems else 1


if __name__ == "__main__":
    sys.exit(main())
