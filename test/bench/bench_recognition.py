#!/usr/bin/python3
"""How right `soffit recognize` and `soffit compare` are on drawn bitmaps whose truth is known. Prints figures.

  bench_recognition.py pairs --count N          random shapes and groups, some absent, mirrored or nearly alike
  bench_recognition.py town FILE.geojson        3, 5 and 8 neighbours of a real town, and lone box houses
  bench_recognition.py silhouettes              1,400 silhouettes of 70 classes (as MPEG-7 CE-Shape-1, part B),
                                                beside complex Fourier descriptors; 70 turned and scaled (part A)

Needs Debian's python3-numpy, python3-opencv and python3-shapely. The same seed draws the same bitmaps.
"""
import argparse
import csv
import json
import math
import subprocess
import tempfile
from pathlib import Path

import cv2
import numpy as np
from shapely import affinity
from shapely.geometry import Polygon, shape as read_shape
from shapely.ops import unary_union

BIN = Path(__file__).resolve().parents[2] / "build" / "release" / "bin" / "soffit"
FINE = 8  # Pixels are drawn from this many squared.
PAPER = 255
MOST_ALIKE = 0.93  # Overlap of shapes that have to be told apart.


def draw(polygons, px_per_m, margin_px=12):
    """Black on white, north up. Gives the bitmap and the function from metres to its pixels."""
    low = np.min([p.bounds[:2] for p in polygons], axis=0)
    high = np.max([p.bounds[2:] for p in polygons], axis=0)
    width, height = (np.ceil((high - low) * px_per_m) + 2 * margin_px).astype(int)

    def to_pixel(points):
        points = np.asarray(points)
        return np.stack([(points[:, 0] - low[0]) * px_per_m + margin_px - 0.5,
                         (high[1] - points[:, 1]) * px_per_m + margin_px - 0.5], axis=1)

    fine = np.full((height * FINE, width * FINE), PAPER, np.uint8)
    for polygon in polygons:
        rings = [polygon.exterior, *polygon.interiors]
        corners = [np.round((to_pixel(ring.coords) + 0.5) * FINE - 0.5).astype(np.int32) for ring in rings]
        cv2.fillPoly(fine, corners, 0)
    mean = cv2.resize(fine, (int(width), int(height)), interpolation=cv2.INTER_AREA)
    return np.where(mean < 128, 0, PAPER).astype(np.uint8), to_pixel


def roughen(bitmap, random, share):
    """Turns pixels along the edges over."""
    edge = cv2.morphologyEx(bitmap, cv2.MORPH_GRADIENT, np.ones((3, 3), np.uint8)) > 0
    flipped = edge & (random.random(bitmap.shape) < share)
    return np.where(flipped, PAPER - bitmap, bitmap).astype(np.uint8)


def turn(polygons, clockwise_deg, scale):
    turned = [affinity.rotate(p, -clockwise_deg, origin=(0, 0)) for p in polygons]
    return [affinity.scale(p, scale, scale, origin=(0, 0)) for p in turned]


def recognize(folder, small, big):
    """The matches, best first, each as a list of entries of its shapes."""
    cv2.imwrite(str(folder / "small.png"), small)
    cv2.imwrite(str(folder / "big.png"), big)
    subprocess.run([BIN, "recognize", folder / "small.png", folder / "big.png", "--out", folder / "found.json"],
                   check=True, capture_output=True)
    matches = {}
    for entry in json.loads((folder / "found.json").read_text())["matches"]:
        matches.setdefault(entry["match"], []).append(entry)
    return [matches[i] for i in sorted(matches)]


def centroids(polygons, to_pixel):
    return to_pixel([[p.centroid.x, p.centroid.y] for p in polygons])


def lies_at(match, wanted_px, tolerance_px):
    """Whether a match has one shape at each of the places."""
    if len(match) != len(wanted_px):
        return False
    found = np.array([entry["shape_centroid_px"] for entry in match])
    distance = np.linalg.norm(found[:, None] - wanted_px[None], axis=2)
    return bool((distance.min(axis=0) < tolerance_px).all())


# --- random pairs

def random_building(random):
    """A rectangle with corners cut out, no two alike, not symmetric."""
    while True:
        width, depth = random.uniform(8, 22), random.uniform(7, 14)
        building = Polygon([(0, 0), (width, 0), (width, depth), (0, depth)])
        for corner in random.permutation(4)[:random.integers(1, 4)]:
            cut_x, cut_y = random.uniform(0.2, 0.45) * width, random.uniform(0.2, 0.45) * depth
            x, y = (0, width - cut_x)[corner % 2], (0, depth - cut_y)[corner // 2]
            building = building.difference(Polygon([(x, y), (x + cut_x, y), (x + cut_x, y + cut_y), (x, y + cut_y)]))
        if building.geom_type == "Polygon" and building.area > 0.45 * width * depth:
            return affinity.translate(building, -building.centroid.x, -building.centroid.y)


def nearly(building, random):
    """The same with what lies beyond a line moved away."""
    width = building.bounds[2] - building.bounds[0]
    at = building.bounds[0] + random.uniform(0.3, 0.7) * width
    moved = random.uniform(0.15, 0.3) * width
    return Polygon([(x + (moved if x > at else 0.0), y) for x, y in building.exterior.coords])


def overlap(a, b):
    """Intersection over union of shapes laid on each other as well as rotations by whole degrees allow."""
    size = math.sqrt(a.area / b.area)
    b = affinity.scale(b, size, size, origin="centroid")
    b = affinity.translate(b, a.centroid.x - b.centroid.x, a.centroid.y - b.centroid.y)
    common = max(a.intersection(affinity.rotate(b, turned, origin="centroid")).area for turned in range(360))
    return common / (2 * a.area - common)


def random_town(random, count):
    town = []
    for i in range(count):
        place = np.array([i % 4, i // 4]) * 34.0 + random.uniform(-4, 4, 2)
        town.append(affinity.translate(affinity.rotate(random_building(random), random.uniform(0, 360)), *place))
    return town


def add_decoy(town, wanted, kind, random):
    """In the place of the last building, if it is truly another shape."""
    place = town[-1].centroid
    decoy = affinity.scale(wanted, -1, 1) if kind == "mirrored" else nearly(wanted, random)
    decoy = affinity.rotate(decoy, random.uniform(0, 360), origin="centroid")
    if decoy.is_valid and overlap(wanted, decoy) < MOST_ALIKE:
        town[-1] = affinity.translate(decoy, place.x - decoy.centroid.x, place.y - decoy.centroid.y)


def score_pair(folder, random, kind):
    town = random_town(random, 12)
    at = int(random.integers(0, 7))
    chosen = [at, at + 1, at + 4] if kind == "group" else [at]
    wanted = [town[i] for i in chosen]
    if len(wanted) == 1:  # Others that happen to look like it make no truth.
        town = [b for b in town if b is wanted[0] or overlap(wanted[0], b) < MOST_ALIKE]
        at = town.index(wanted[0])
    if kind in ("mirrored", "near twin"):
        add_decoy(town, wanted[0], kind, random)
    if kind == "absent":
        add_decoy(town, wanted[0], kind, random)
        town.pop(at)
    clockwise_deg, scale = random.uniform(0, 360), random.uniform(1.0, 2.5)
    px_per_m = random.uniform(3.5, 8.0)
    big, to_pixel = draw(town, px_per_m)
    small, _ = draw(turn(wanted, -clockwise_deg, 1.0), px_per_m * scale)
    if random.random() < 0.5:
        big, small = roughen(big, random, 0.25), roughen(small, random, 0.25)
    matches = recognize(folder, small, big)
    if kind == "absent":
        return {"false": len(matches)}
    place = centroids(wanted, to_pixel)
    right = [m for m in matches if lies_at(m, place, 3.0)]
    result = {"wanted": 1, "found": len(right) > 0, "false": len(matches) - len(right)}
    if right:
        best = right[0]
        found = np.array([entry["shape_centroid_px"] for entry in best])
        off = np.linalg.norm(found[:, None] - place[None], axis=2).min(axis=0).mean()
        turned = abs((best[0]["rotation_cw_deg"] - clockwise_deg + 180) % 360 - 180)
        result["errors"] = (off, 100 * abs(best[0]["scale"] * scale - 1), turned)
    return result


def bench_pairs(arguments, folder):
    kinds = ["plain", "mirrored", "near twin", "group", "absent"]
    results = []
    for i in range(arguments.count):
        random = np.random.default_rng([arguments.seed, i])
        results.append(score_pair(folder, random, kinds[i % len(kinds)]))
        if results[-1]["false"] or not results[-1].get("found", True):
            print(f"pair {i} ({kinds[i % len(kinds)]}): {results[-1]}")
    wanted = sum(r.get("wanted", 0) for r in results)
    found = sum(r.get("found", False) for r in results)
    false = sum(r["false"] for r in results)
    errors = np.median([r["errors"] for r in results if "errors" in r], axis=0)
    print(f"{len(results)} pairs: precision {found / max(1, found + false):.3f}, recall {found / wanted:.3f}; medians: "
          f"centroid {errors[0]:.2f} px, scale {errors[1]:.2f} %, rotation {errors[2]:.2f} deg")


# --- a real town

def read_town(file):
    """Buildings in metres; what touches is one."""
    geometry = [read_shape(f["geometry"]) for f in json.loads(Path(file).read_text())["features"]]
    east_m = 111320 * math.cos(math.radians(geometry[0].centroid.y))
    metres = [affinity.affine_transform(g, [east_m, 0, 0, 110540, 0, 0]) for g in geometry]
    blocks = unary_union([g.buffer(0.6, join_style=2) for g in metres]).buffer(-0.6, join_style=2)
    blocks = [b for b in getattr(blocks, "geoms", [blocks]) if b.area > 40]
    west, south = np.min([b.bounds[:2] for b in blocks], axis=0)
    return [affinity.translate(b, -west, -south) for b in blocks]


def is_box(block):
    return not block.interiors and block.area > 0.97 * block.minimum_rotated_rectangle.area


def bench_town(arguments, folder):
    town = read_town(arguments.file)
    px_per_m = 2.0
    big, to_pixel = draw(town, px_per_m)
    places = centroids(town, to_pixel)
    print(f"{len(town)} blocks, {big.shape[1]} x {big.shape[0]} pixels")

    def look(chosen, random):
        wanted = turn([town[i] for i in chosen], -random.uniform(0, 360), 1.0)
        small, _ = draw(wanted, px_per_m * random.uniform(0.8, 1.5))
        return recognize(folder, small, big)

    for size in (3, 5, 8):
        found = sure = 0
        for i in range(arguments.count):
            random = np.random.default_rng([arguments.seed, size, i])
            at = random.integers(len(town))
            chosen = np.argsort([town[at].distance(other) for other in town], kind="stable")[:size]
            matches = look(chosen, random)
            is_found = len(matches) > 0 and lies_at(matches[0], places[chosen], 6.0)
            found += is_found
            sure += is_found and not matches[0][0]["ambiguous"]
        print(f"{size} buildings: {found} of {arguments.count} found, {sure} of them without doubt")
    boxes = [i for i, block in enumerate(town) if is_box(block)]
    guessed = 0
    for i in boxes:
        matches = look([i], np.random.default_rng([arguments.seed, 1, i]))
        guessed += len(matches) > 0 and not matches[0][0]["ambiguous"]
    print(f"{len(boxes)} lone boxes: {guessed} not marked ambiguous")


# --- silhouettes

def random_class(random):
    """A smooth blob with limbs: radius by angle, and how it may bend."""
    angle = np.linspace(0, 2 * np.pi, 400, endpoint=False)
    radius = np.ones_like(angle)
    for k in range(2, 6):
        radius += random.normal(0, 0.22 / k) * np.cos(k * angle + random.uniform(0, 2 * np.pi))
    for _ in range(random.integers(0, 6)):
        at, width, height = random.uniform(0, 2 * np.pi), random.uniform(0.06, 0.35), random.uniform(-0.45, 1.0)
        off = np.abs((angle - at + np.pi) % (2 * np.pi) - np.pi)
        radius += height * np.exp(-(off / width) ** 4)
    stretch = random.uniform(0.5, 1.0)
    return np.stack([radius.clip(0.2) * np.cos(angle), stretch * radius.clip(0.2) * np.sin(angle)], axis=1)


def silhouette(points, random, deforms, clockwise_deg, size_px):
    points = points.copy()
    if deforms:
        angle = np.arctan2(points[:, 1], points[:, 0])
        for k in (1, 2, 3, 4):
            points *= (1 + random.normal(0, 0.02) * np.cos(k * angle + random.uniform(0, 2 * np.pi)))[:, None]
        bend = random.normal(0, 0.06)
        points[:, 1] += bend * points[:, 0] ** 2
        points = points @ (np.eye(2) + random.normal(0, 0.03, (2, 2)))
        if random.random() < 0.5:
            points[:, 0] *= -1
    a = math.radians(clockwise_deg)
    points = points @ np.array([[math.cos(a), math.sin(a)], [-math.sin(a), math.cos(a)]])
    points -= points.min(axis=0)
    points = points / points.max() * size_px + 10
    bitmap = np.zeros((size_px + 21, size_px + 21), np.uint8)
    cv2.fillPoly(bitmap, [np.round(points).astype(np.int32)], 255)
    return roughen(bitmap, random, 0.3) if deforms else bitmap


def fourier_descriptor(bitmap):
    """Of the complex outline, magnitudes only: of position, size, rotation and start nothing is left."""
    contours, _ = cv2.findContours(bitmap, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    contour = max(contours, key=cv2.contourArea)[:, 0].astype(float)
    step = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(contour, axis=0, append=contour[:1]), axis=1))])
    at = np.linspace(0, step[-1], 256, endpoint=False)
    closed = np.vstack([contour, contour[:1]])
    z = np.interp(at, step, closed[:, 0]) + 1j * np.interp(at, step, closed[:, 1])
    spectrum = np.abs(np.fft.fft(z))
    return np.concatenate([spectrum[2:22], spectrum[-20:]]) / spectrum[[1, -1]].max()


def bullseye(distance, per_class):
    nearest = np.argsort(distance, axis=1, kind="stable")[:, :2 * per_class]
    label = np.arange(len(distance)) // per_class
    return (label[nearest] == label[:, None]).sum() / (len(distance) * per_class)


def compare(folder):
    subprocess.run([BIN, "compare", folder, "--out", folder.parent / "distances.csv"], check=True, capture_output=True)
    with open(folder.parent / "distances.csv") as file:
        return np.array([[float(x) for x in row[1:]] for row in list(csv.reader(file))[1:]])


def bench_silhouettes(arguments, folder):
    random = np.random.default_rng(arguments.seed)
    classes = [random_class(random) for _ in range(70)]
    part_b, part_a = folder / "b", folder / "a"
    part_b.mkdir()
    part_a.mkdir()
    descriptors = []
    for i, points in enumerate(classes):
        for k in range(20):
            bitmap = silhouette(points, random, True, random.uniform(0, 360), int(random.integers(80, 250)))
            cv2.imwrite(str(part_b / f"{i:02}-{k:02}.png"), bitmap)
            descriptors.append(fourier_descriptor(bitmap))
        for k, (turned, size) in enumerate([(0, 200), (9, 200), (36, 200), (45, 200), (90, 200), (150, 200),
                                            (0, 400), (0, 60), (0, 50), (0, 40), (0, 20)]):
            cv2.imwrite(str(part_a / f"{i:02}-{k:02}.png"), silhouette(points, random, False, turned, size))
    descriptors = np.array(descriptors)
    by_fourier = np.linalg.norm(descriptors[:, None] - descriptors[None], axis=2)
    print(f"bull's eye: {100 * bullseye(compare(part_b), 20):.1f} %, complex Fourier descriptors "
          f"{100 * bullseye(by_fourier, 20):.1f} %")
    distance = compare(part_a)
    for name, members in (("rotation", range(0, 6)), ("scale", (0, 6, 7, 8, 9, 10))):
        index = np.array([11 * i + k for i in range(70) for k in members])
        count = len(members)
        nearest = np.argsort(distance[np.ix_(index, index)], axis=1, kind="stable")[:, :count]
        label = np.arange(len(index)) // count
        print(f"part A, {name}: {100 * (label[nearest] == label[:, None]).mean():.2f} %")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--keep", type=Path, help="folder for the bitmaps (else they are thrown away)")
    modes = parser.add_subparsers(dest="mode", required=True)
    modes.add_parser("pairs").add_argument("--count", type=int, default=200)
    town = modes.add_parser("town")
    town.add_argument("file")
    town.add_argument("--count", type=int, default=100)
    modes.add_parser("silhouettes")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory(prefix="soffit-bench-") as temporary:
        folder = arguments.keep or Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        {"pairs": bench_pairs, "town": bench_town, "silhouettes": bench_silhouettes}[arguments.mode](arguments, folder)


if __name__ == "__main__":
    main()
