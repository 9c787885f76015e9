"""Asks one question of each kind with the command line; the scene is that of test/support/arch_scene.h.

usage: command_line.py SOFFIT DOMAIN
"""
import subprocess
import sys

SMALL = "--radius 0.1 --height 0.1 --margin 0.05"
ANSWERS = [
    ("point 2 0.75 0.7", "free"),
    ("point -1 -1 0", "unknown"),
    ("box 1.8 0 0.5 2.2 0.4 0.9 --resolution 0.1", "free"),
    ("ray 2 0.75 0.7 2 0.75 10", "out of range after 0.80 m"),
    ("nearest 2 0.75 0.7", "surface of a model: 0.70 m"),
    ("column 2 0.75", "height: 2.30 m"),
    ("object 1", "building 1: red"),
    ("objects --near 7 3 --range 1", "building 2: blue"),
    ("clearance 1", "side 0: CLEAR"),
    (f"way 2 -1 0.7 2 2 0.7 {SMALL}", "CLEAR"),
    (f"path 2 -1 0.7 2 2 0.7 {SMALL}", "CLEAR"),
    ("changes", "model 1: added"),
    ("revisions", "revision 7"),
    ("object 99", "not found"),
    ("point nan 0 0", "bad request"),
    ("point 0 0 0 --revision 3", "no such revision"),
    ("point 0 0 0 --vehicle 9", "no scene"),
]


def main():
    program, domain = sys.argv[1:]
    failures = 0
    for question, answer in ANSWERS:
        asked = subprocess.run([program, "query", *question.split(), "--domain", domain], capture_output=True, text=True,
                               timeout=30)
        said = asked.stdout.partition("\n")[2] if asked.returncode == 0 else asked.stderr
        is_well = answer in said
        failures += not is_well
        print("ok    " if is_well else f"FAILED, not '{answer}':", question, "->", said.strip())
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
