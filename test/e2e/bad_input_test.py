"""Bad input ends in a clear error at the terminal or in the status, with the rest still running."""
import argparse
import json
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "deploy" / "lib"))
from mission import SCENARIOS, Mission, Options, dds_domain  # noqa: E402

BIN = None


def run(program, *arguments, timeout_s=30):
    return subprocess.run([str(BIN / program), *map(str, arguments)], capture_output=True, text=True, timeout=timeout_s)


class BadInput(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="soffit-e2e-")
        self.out = Path(self.folder.name)

    def tearDown(self):
        self.folder.cleanup()

    def write(self, name, text):
        path = self.out / name
        path.write_text(text)
        return path

    def assert_refused(self, done, *words):
        self.assertNotEqual(done.returncode, 0)
        self.assertGreaterEqual(done.returncode, 0, "it crashed")
        for word in words:
            self.assertIn(word, done.stdout + done.stderr)

    def test_configurations_are_refused_with_file_and_key(self):
        for program in ("soffitd", "soffit-agent"):
            unknown = self.write("unknown.yaml", "radio: {domain_id: 1, colour: blue}\n")
            self.assert_refused(run(program, "--config", unknown), "unknown.yaml:1", "colour")
            not_a_number = self.write("nan.yaml", "radio:\n  flow_bytes_per_ms: .nan\n")
            self.assert_refused(run(program, "--config", not_a_number), "nan.yaml:2", "flow_bytes_per_ms")
            out_of_range = self.write("range.yaml", "radio:\n  domain_id: 900\n")
            self.assert_refused(run(program, "--config", out_of_range), "range.yaml:2", "domain_id", "230")
            malformed = self.write("malformed.yaml", "radio: [\n")
            self.assert_refused(run(program, "--config", malformed), "malformed.yaml")
            self.assert_refused(run(program, "--config", self.out / "missing.yaml"), "missing.yaml")

    def test_worlds_are_refused_with_file_line_and_key(self):
        world = self.write("world.yaml", (SCENARIOS / "arch.yaml").read_text() + "colour: red\n")
        self.assert_refused(run("soffit-sim", "truth", world), "world.yaml", "colour")
        self.assert_refused(run("soffit-sim", "truth", self.write("empty.yaml", "")), "empty.yaml")

    def test_the_service_refuses_references_and_lives_on(self):
        with dds_domain() as radio, dds_domain() as local:
            config = self.write("soffitd.yaml", json.dumps({"radio": {"domain_id": radio}, "local": {"domain_id": local},
                                                            "data_folder": str(self.out / "data")}))
            mission = Mission(SCENARIOS / "arch.yaml", self.out, Options(bin_dir=BIN))
            (self.out / "log").mkdir()
            service = mission.start("soffitd", "--config", config)
            try:
                text = self.write("text.png", "this is no picture")
                self.assert_refused(run("soffit", "mission", "start", "--config", config, "--vehicle", 1,
                                        "--reference", text), "text.png")
                self.assert_refused(run("soffit", "mission", "start", "--config", config, "--vehicle", 1,
                                        "--reference", self.out / "none.png"), "none.png")
                status = run("soffit", "mission", "status", "--config", config)
                self.assertEqual(status.returncode, 0, status.stderr)
                self.assertTrue(service.alive())
            finally:
                self.assertEqual(service.end(), 0)

    def test_an_agent_without_autopilot_or_camera_says_so_and_lives_on(self):
        with dds_domain() as radio:
            config = self.write("agent.yaml", json.dumps({
                "radio": {"domain_id": radio}, "mavlink": "tcp:127.0.0.1:9",
                "cameras": {"forward": {"pipeline": "souphttpsrc location=http://127.0.0.1:9/forward.jpg"},
                            "down": {"folder": str(self.out), "mount": {"pitch_deg": -90.0}}}}))
            mission = Mission(SCENARIOS / "arch.yaml", self.out, Options(bin_dir=BIN))
            (self.out / "log").mkdir()
            agent = mission.start("soffit-agent", "--config", config)
            try:
                said, until = "", time.monotonic() + 20
                while time.monotonic() < until and not ("autopilot" in said and "camera" in said):
                    time.sleep(0.2)
                    said = agent.log.read_text()
                self.assertIn("autopilot", said)
                self.assertIn("camera", said)
                self.assertTrue(agent.alive())
            finally:
                agent.end()


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--bin", type=Path, required=True)
    BIN = parser.parse_args().bin
    unittest.main(argv=[sys.argv[0]], verbosity=2)
