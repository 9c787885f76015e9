"""What deploy/demo promises besides the mission: its options, its exit codes, and that it leaves no program behind."""
import argparse
import signal
import subprocess
import sys
import tempfile
import time
import unittest
from pathlib import Path

LIB = Path(__file__).resolve().parents[2] / "deploy" / "lib"
sys.path.insert(0, str(LIB))
from mission import MissionError, second_link  # noqa: E402


def demo(*arguments):
    return subprocess.run([sys.executable, str(LIB / "demo.py"), *arguments], capture_output=True, text=True, timeout=60)


def is_alive(pid):
    try:
        return "\nState:\tZ" not in Path(f"/proc/{pid}/status").read_text()
    except (FileNotFoundError, ProcessLookupError):
        return False


class Demo(unittest.TestCase):
    def test_lists_the_scenarios(self):
        done = demo("--list")
        self.assertEqual(done.returncode, 0)
        for scenario in ("arch", "low-arch", "narrow-arch", "recess", "pole", "look-alikes", "group", "round-arch",
                         "table", "l-passage", "tall", "gusty"):
            self.assertRegex(done.stdout, rf"(?m)^{scenario} ")

    def test_says_what_cannot_be_flown(self):
        with tempfile.TemporaryDirectory() as folder:
            for arguments, words in (
                    (["--scenario", "castle"], "castle"),
                    (["--autopilot", "pigeon"], "pigeon"),
                    (["--out", str(LIB)], "not empty")):
                done = demo("--out", f"{folder}/out", *arguments)
                self.assertEqual(done.returncode, 2, done.stderr)
                self.assertIn(words, done.stderr)

    def test_knows_the_second_port_of_a_sitl_and_asks_for_other_links(self):
        self.assertEqual(second_link("tcp:127.0.0.1:5760"), "tcp:127.0.0.1:5762")
        self.assertEqual(second_link("tcp:10.0.0.7:5772"), "tcp:10.0.0.7:5773")
        for link in ("udpin:127.0.0.1:14550", "tcp:127.0.0.1:4444", "serial:/dev/ttyACM0:57600"):
            with self.assertRaisesRegex(MissionError, "--follow"):
                second_link(link)

    def test_programs_end_with_the_one_that_started_them(self):
        parent = subprocess.Popen([sys.executable, "-c", "import mission, time\n"
                                   "print(mission.spawn(['sleep', '60']).pid, flush=True)\ntime.sleep(60)"],
                                  cwd=LIB, stdout=subprocess.PIPE, text=True)
        child = int(parent.stdout.readline())
        time.sleep(0.5)
        self.assertTrue(is_alive(child))
        parent.send_signal(signal.SIGKILL)
        parent.wait()
        parent.stdout.close()
        until = time.monotonic() + 5
        while is_alive(child) and time.monotonic() < until:
            time.sleep(0.05)
        self.assertFalse(is_alive(child))


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--bin", type=Path, required=True)
    parser.parse_args()
    unittest.main(argv=[sys.argv[0]], verbosity=2)
