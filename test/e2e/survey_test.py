"""`soffit analyze` and `soffit recognize` as programs: same bytes on any number of threads, and bad pictures among good
ones end in a clear error within bounds of time and memory."""
import argparse
import json
import os
import random
import shutil
import struct
import subprocess
import sys
import tempfile
import time
import unittest
import zlib
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
BIN = None
MAX_CPU_S = 5.0
MAX_RSS_MIB = 1024


@dataclass
class Run:
    returncode: int
    output: str
    cpu_s: float
    rss_mib: float


def run(program, *arguments, cores=None):
    """Measures the processor's time, as others may use the machine too."""
    with tempfile.TemporaryFile("w+") as output:
        affinity = (lambda: os.sched_setaffinity(0, cores)) if cores else None
        process = subprocess.Popen([str(BIN / program), *map(str, arguments)], stdout=output, stderr=output,
                                   preexec_fn=affinity)
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        output.seek(0)
        return Run(process.returncode, output.read(), used.ru_utime + used.ru_stime, used.ru_maxrss / 1024)


def chunk(kind, data):
    return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))


def png(width, height, depth, color_type, rows, interlaced=False, palette=b"", transparency=b""):
    parts = [chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, depth, color_type, 0, 0, interlaced))]
    parts += [chunk(b"PLTE", palette)] if palette else []
    parts += [chunk(b"tRNS", transparency)] if transparency else []
    parts += [chunk(b"IDAT", zlib.compress(b"".join(b"\0" + row for row in rows))), chunk(b"IEND", b"")]
    return b"\x89PNG\r\n\x1a\n" + b"".join(parts)


def grey_png(bitmap):
    """`bitmap`: rows of bytes, 0 black to 255 white."""
    return png(len(bitmap[0]), len(bitmap), 8, 0, bitmap)


def interlace(bitmap):
    """The rows of the seven pictures of which an interlaced one is made (Adam7)."""
    for x, y, step_x, step_y in ((0, 0, 8, 8), (4, 0, 8, 8), (0, 4, 4, 8), (2, 0, 4, 4), (0, 2, 2, 4), (1, 0, 2, 2),
                                 (0, 1, 1, 2)):
        yield from (row[x::step_x] for row in bitmap[y::step_y])


def pack(row, depth):
    """Samples of `depth` bits, in whole bytes."""
    bits = "".join(format(value >> (8 - depth), f"0{depth}b") for value in row)
    return int(bits.ljust(-(-len(bits) // 8) * 8, "0"), 2).to_bytes(-(-len(bits) // 8), "big")


def variants(bitmap):
    """The same black and white bitmap in all the ways in which a PNG can say it."""
    width, height = len(bitmap[0]), len(bitmap)
    yield "grey", grey_png(bitmap)
    yield "1 bit", png(width, height, 1, 0, [pack(row, 1) for row in bitmap])
    yield "16 bits", png(width, height, 16, 0, [bytes(v for v in row for _ in range(2)) for row in bitmap])
    yield "colour", png(width, height, 8, 2, [bytes(v for v in row for _ in range(3)) for row in bitmap])
    yield "palette", png(width, height, 2, 3, [pack([v & 64 for v in row], 2) for row in bitmap],
                         palette=bytes((0, 0, 0, 255, 255, 255)))
    yield "transparent colour", png(width, height, 2, 3, [pack([v & 64 for v in row], 2) for row in bitmap],
                                    palette=bytes(6), transparency=bytes((255, 0)))
    yield "black on nothing", png(width, height, 8, 4, [bytes(b for v in row for b in (0, 255 - v)) for row in bitmap])
    yield "interlaced", png(width, height, 8, 0, interlace(bitmap), interlaced=True)


def jpeg(width, height, scans=1, is_progressive=False):
    """A JPEG with all headers and hardly any pixels."""
    table = b"\xff\xdb" + struct.pack(">H", 67) + b"\0" + b"\1" * 64
    frame = (b"\xff\xc2" if is_progressive else b"\xff\xc0") + struct.pack(">HBHHB", 11, 8, height, width, 1) + b"\1\x11\0"
    codes = b"".join(b"\xff\xc4" + struct.pack(">H", 20) + bytes([kind << 4, 1]) + bytes(16) for kind in (0, 1))
    scan = b"".join(b"\xff\xda\0\x08\1\1\0" + (bytes((0, 0 if i == 0 else 1, 0)) if is_progressive else b"\0\x3f\0")
                    for i in range(scans))
    return b"\xff\xd8" + table + frame + codes + scan + b"\xff\xd9"


def squares(side, count, size):
    """`count` x `count` black squares on white, no two neighbours of the same size."""
    bitmap = [bytearray(b"\xff" * side) for _ in range(side)]
    pitch = side // count
    for i in range(count * count):
        left, top = i % count * pitch + 4, i // count * pitch + 4
        for row in bitmap[top:top + size - i % 3]:
            row[left:left + size] = bytes(size)
    return [bytes(row) for row in bitmap]


def ell(side):
    """A black L on white."""
    bitmap = [bytearray(b"\xff" * side) for _ in range(side)]
    for y in range(side // 5, side * 4 // 5):
        right = side * 4 // 5 if y > side * 3 // 5 else side * 2 // 5
        bitmap[y][side // 5:right] = bytes(right - side // 5)
    return [bytes(row) for row in bitmap]


class InFolder(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory(prefix="soffit-e2e-")
        self.out = Path(self.folder.name)

    def tearDown(self):
        self.folder.cleanup()

    def write(self, name, content):
        path = self.out / name
        path.write_bytes(content)
        return path

    def assert_within_bounds(self, done):
        self.assertIn(done.returncode, (0, 1), done.output)
        self.assertLess(done.cpu_s, MAX_CPU_S)
        self.assertLess(done.rss_mib, MAX_RSS_MIB)


class Surveys(InFolder):
    @classmethod
    def setUpClass(cls):
        cls.kept = tempfile.TemporaryDirectory(prefix="soffit-e2e-")
        world = (ROOT / "test" / "sim" / "scenarios" / "arch.yaml").read_text()
        small = Path(cls.kept.name) / "world.yaml"
        small.write_text(world.replace("width_px: 1280, height_px: 960, fx_px: 850",
                                       "width_px: 480, height_px: 360, fx_px: 319"))
        cls.survey = Path(cls.kept.name) / "survey"
        done = run("soffit-sim", "survey", small, "--out", cls.survey)
        assert done.returncode == 0, done.output

    @classmethod
    def tearDownClass(cls):
        cls.kept.cleanup()

    def read_result(self, name):
        return {str(file.relative_to(self.out / name)): file.read_bytes()
                for file in sorted((self.out / name).rglob("*")) if file.is_file()}

    def test_same_bytes_on_one_thread_and_on_all(self):
        first_core = {min(os.sched_getaffinity(0))}
        self.assertEqual(run("soffit", "analyze", self.survey, "--out", self.out / "one", cores=first_core).returncode, 0)
        time.sleep(1.1)  # A time of writing that slips into a file shows.
        self.assertEqual(run("soffit", "analyze", self.survey, "--out", self.out / "all").returncode, 0)
        one, all_threads = self.read_result("one"), self.read_result("all")
        self.assertIn("scene.gpkg", one)
        self.assertEqual(one.keys(), all_threads.keys())
        self.assertEqual([name for name in one if one[name] != all_threads[name]], [])

    def analyze_with(self, picture, content):
        """The survey with one picture replaced."""
        survey = self.out / "survey"
        shutil.copytree(self.survey, survey, dirs_exist_ok=True)
        (survey / picture).write_bytes(content)
        coarse = self.write("coarse.yaml", b"scene: {voxel_m: 0.2}")  # It is not the space that is tested.
        return run("soffit", "analyze", survey, "--out", self.out / "result", "--config", coarse)

    def test_a_bad_picture_is_named_and_the_others_are_used(self):
        good = (self.survey / "wall_1.jpg").read_bytes()
        for content, why in ((b"", "empty"), (b"\xff\xd8\xff", "too early"), (good[:len(good) // 2], "too early"),
                             (good[:len(good) // 2] + b"\xff\xd9", "damaged"), (jpeg(60000, 60000), "60000 x 60000"),
                             (jpeg(480, 360, 1000, True), "1000 scans"), (jpeg(480, 0), "no pixels"),
                             (png(60000, 60000, 8, 2, []), "60000 x 60000"), (png(0, 0, 8, 2, []), "no pixels"),
                             (grey_png(ell(100)), "100 x 100"), (b"GIF89a", "neither a JPEG nor a PNG")):
            with self.subTest(why=why, bytes=len(content)):
                done = self.analyze_with("wall_1.jpg", content)
                self.assertEqual(done.returncode, 0, done.output)
                self.assertIn("wall_1.jpg", done.output)
                self.assertIn(why, done.output)
                self.assert_within_bounds(done)
                result = json.loads((self.out / "result" / "result.json").read_text())
                self.assertTrue(any(shown["matched"] for shown in result["objects"]))

    def test_a_bad_reference_is_told_before_anything_is_looked_at(self):
        for content, why in ((grey_png([b"\0" * 200] * 200), "all black"), (grey_png([b"\xff" * 200] * 200), "no black"),
                             (grey_png(squares(2000, 100, 12)), "more than 64 shapes"), (jpeg(60000, 60000), "60000 x 60000")):
            with self.subTest(why=why):
                done = self.analyze_with("reference.png", content)
                self.assertEqual(done.returncode, 1, done.output)
                self.assertIn("reference.png", done.output)
                self.assertIn(why, done.output)
                self.assert_within_bounds(done)

    def test_noise_for_an_overview_is_no_building(self):
        noise = random.Random(1)
        done = self.analyze_with("overview.jpg", png(480, 360, 8, 2, [noise.randbytes(3 * 480) for _ in range(360)]))
        self.assert_within_bounds(done)
        result = json.loads((self.out / "result" / "result.json").read_text())
        truth = json.loads((self.survey / "truth.json").read_text())
        self.assertLessEqual(len(result["objects"]), len(truth["objects"]))


class Bitmaps(InFolder):
    def recognize(self, small, big):
        done = run("soffit", "recognize", self.write("small", small), self.write("big", big), "--out",
                   self.out / "matches.json")
        self.assert_within_bounds(done)
        return done

    def test_the_same_bitmap_is_read_the_same_however_it_is_stored(self):
        answers = set()
        for name, content in variants(ell(203)):
            with self.subTest(name):
                done = self.recognize(content, grey_png(ell(400)))
                self.assertEqual(done.returncode, 0, done.output)
                answers.add((self.out / "matches.json").read_text())
                self.assertEqual(len(json.loads(max(answers))["matches"]), 1)
                self.assertEqual(len(answers), 1)

    def test_maps_without_the_shape_give_no_match(self):
        checkers = [bytes((x // 10 + y // 10) % 2 * 255 for x in range(1000)) for y in range(1000)]
        pixels = random.Random(2)
        sparse = [bytes(pixels.choices((0, 255), (1, 49), k=1000)) for _ in range(1000)]
        for name, big in (("white", [b"\xff" * 500] * 500), ("black", [b"\0" * 500] * 500), ("one pixel", [b"\0"]),
                          ("10,000 specks", squares(2000, 100, 12)), ("checkers", checkers), ("pixels", sparse)):
            with self.subTest(name):
                done = self.recognize(grey_png(ell(200)), grey_png(big))
                self.assertEqual(done.returncode, 0, done.output)
                self.assertEqual(json.loads((self.out / "matches.json").read_text()), {"matches": []})


if __name__ == "__main__":
    parser = argparse.ArgumentParser()
    parser.add_argument("--bin", type=Path, required=True)
    parser.add_argument("tests", nargs="*")
    arguments = parser.parse_args()
    BIN = arguments.bin
    unittest.main(argv=[sys.argv[0], *arguments.tests], verbosity=2)
