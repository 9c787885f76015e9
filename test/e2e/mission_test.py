"""A scenario has to end as the simulator's ground truth demands."""
import argparse
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "deploy" / "lib"))
from mission import SCENARIOS, Mission, Options  # noqa: E402

parser = argparse.ArgumentParser()
parser.add_argument("--bin", type=Path, required=True)
parser.add_argument("scenario")
arguments = parser.parse_args()

with tempfile.TemporaryDirectory(prefix="soffit-e2e-") as out:
    outcome = Mission(SCENARIOS / f"{arguments.scenario}.yaml", out,
                      Options(bin_dir=arguments.bin, timeout_s=360)).fly()
print(outcome)
sys.exit(0 if outcome.ok else 1)
