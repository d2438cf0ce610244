#!/usr/bin/env python3
"""Registration by the commands of the contract: exit codes, places and errors against known poses.

usage: commands.py GLOWWORM DATA_FOLDER [--only WORD] [--keep FOLDER] [--no-convert]

Each case is run with `register` and with `convert`; a line per run. Cases with random rigid starts
move every scan at random first: their poses, moved back, must agree within a millimetre with those
of the scans as they are. Fails (exit code 1) where a case does not hold.
"""
import argparse
import array
import json
import math
import os
import pathlib
import random
import resource
import subprocess
import sys
import tempfile
import time

DEGREES = 180.0 / math.pi


# --- rigid motions, as 4x4 rows ------------------------------------------------------------------
def multiply(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(4)) for j in range(4)] for i in range(4)]


def inverse(t):
    r = [[t[j][i] for j in range(3)] for i in range(3)]
    p = [-sum(r[i][k] * t[k][3] for k in range(3)) for i in range(3)]
    return [r[i] + [p[i]] for i in range(3)] + [[0, 0, 0, 1]]


def rows(numbers):
    return [list(numbers[4 * i:4 * i + 4]) for i in range(4)]


def from_quaternion(x, y, z, w, place):
    n = math.sqrt(x * x + y * y + z * z + w * w)
    x, y, z, w = x / n, y / n, z / n, w / n
    return [[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), place[0]],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), place[1]],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), place[2]],
            [0, 0, 0, 1]]


def angle(t):
    # By the sine as well: the cosine of a small angle says nothing.
    s = math.hypot(t[2][1] - t[1][2], t[0][2] - t[2][0], t[1][0] - t[0][1]) / 2
    return math.atan2(s, (t[0][0] + t[1][1] + t[2][2] - 1) / 2) * DEGREES


def shift(t):
    return math.hypot(t[0][3], t[1][3], t[2][3])


def random_motion(rng, reach):
    return from_quaternion(*(rng.gauss(0, 1) for _ in range(4)),
                           [rng.uniform(-reach, reach) for _ in range(3)])


# --- scans ----------------------------------------------------------------------------------------
def read_points(path):
    """x y z of an ascii PCD, an ascii PLY or a binary PLY whose first three fields are floats."""
    data = path.read_bytes()
    if path.suffix == ".pcd":
        data = data.replace(b"\r\n", b"\n")
    if data.startswith(b"ply"):
        end = data.index(b"end_header\n") + len(b"end_header\n")
        header = data[:end].decode("latin-1").splitlines()
        sizes = {"float": 4, "float32": 4, "uchar": 1, "uint8": 1, "double": 8, "int": 4}
        count, stride, vertex = 0, 0, False
        for line in header:
            words = line.split()
            if words[0] == "element":
                vertex = words[1] == "vertex"
                count = int(words[2]) if vertex else count
            elif words[0] == "property" and vertex:
                stride += sizes[words[1]]
        if "binary" in header[1]:
            body = memoryview(data)[end:end + count * stride]
            floats = array.array("f")
            for i in range(count):
                floats.frombytes(body[i * stride:i * stride + 12])
            return floats
        lines = data[end:].splitlines()[:count]
    else:
        lines = data[data.index(b"DATA ascii\n") + len(b"DATA ascii\n"):].splitlines()
    return array.array("f", (float(w) for line in lines for w in line.split()[:3]))


def write_points(path, points):
    header = (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points) // 3}\n"
              "property float x\nproperty float y\nproperty float z\nend_header\n")
    path.write_bytes(header.encode() + points.tobytes())


def moved(points, t):
    (a, b, c, x), (d, e, f, y), (g, h, i, z) = t[:3]
    out = array.array("f", bytes(4 * len(points)))
    xs, ys, zs = points[0::3], points[1::3], points[2::3]
    out[0::3] = array.array("f", [a * u + b * v + c * w + x for u, v, w in zip(xs, ys, zs)])
    out[1::3] = array.array("f", [d * u + e * v + f * w + y for u, v, w in zip(xs, ys, zs)])
    out[2::3] = array.array("f", [g * u + h * v + i * w + z for u, v, w in zip(xs, ys, zs)])
    return out


# --- known poses ----------------------------------------------------------------------------------
def known_sets(data):
    """name -> (files, T_world_scan, goal in degrees, goal in mm)"""
    cave = data / "scans/D_cavern"
    poses = json.loads((cave / "poses.json").read_text())["scans"]
    sets = {"nine scans": ([cave / p["file"] for p in poses],
                           [rows(p["T_world_scan"]) for p in poses], 0.05, 5.0)}
    site = data / "obs_eq_tls"
    files, truth = [], []
    for line in (site / "reference_poses.txt").read_text().splitlines():
        words = line.split()
        if words and words[0].startswith("scan"):
            files.append(site / (words[0] + ".pcd"))
            truth.append(rows([float(w) for w in words[1:17]]))
    sets["terrestrial"] = (files, truth, 0.3, 30.0)
    pair = data / "small_gicp"
    numbers = [float(w) for w in (pair / "T_target_source.txt").read_text().split()[:16]]
    identity = rows([1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1])
    sets["real pair"] = ([pair / "target.ply", pair / "source.ply"], [identity, rows(numbers)],
                         0.5, 50.0)
    bunny = data / "stanford_bunny"
    files, truth = [], []
    for line in (bunny / "bun.conf").read_text().splitlines():
        words = line.split()
        if words and words[0] == "bmesh" and (bunny / words[1]).exists():
            t, q = [float(w) for w in words[2:5]], [float(w) for w in words[5:9]]
            files.append(bunny / words[1])
            truth.append(from_quaternion(-q[0], -q[1], -q[2], q[3], t))
    sets["bunny"] = (files, truth, 1.0, 1.5)
    return sets


# --- runs -----------------------------------------------------------------------------------------
class Bench:
    def __init__(self, glowworm, scratch, convert):
        self.glowworm, self.scratch, self.failed = glowworm, scratch, 0
        self.commands = ["register", "convert"] if convert else ["register"]

    def run(self, command, files, *flags):
        """exit code, poses.json or None, wall and processor seconds, MB, what was said last"""
        folder = pathlib.Path(tempfile.mkdtemp(dir=self.scratch))
        name = "poses.json" if command == "register" else "cave.svo"
        arguments = [self.glowworm, command, *map(str, files), "-o", str(folder / name),
                     "--progress", "none", *flags]
        start = time.time()
        process = subprocess.Popen(arguments, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        errors = []
        process.stdout.read()
        errors = process.stderr.read().decode().strip().splitlines()
        _, status, usage = os.wait4(process.pid, 0)
        wall = time.time() - start
        process.returncode = os.waitstatus_to_exitcode(status)
        written = sorted(folder.glob("*poses*.json"))
        poses = json.loads(written[0].read_text()) if written else None
        return (process.returncode, poses, wall, usage.ru_utime + usage.ru_stime,
                usage.ru_maxrss / 1024, errors[-1] if errors else "")

    def line(self, case, command, code, placed, error, seconds, good, said=""):
        self.failed += not good
        print(f"| {case} | {command} | {code} | {placed} | {error} | {seconds} | "
              f"{'yes' if good else 'NO: ' + said} |", flush=True)

    def known(self, name, files, truth, degrees, millimetres, *flags):
        found = None
        for command in self.commands:
            code, poses, wall, cpu, mb, said = self.run(command, files, *flags)
            seconds = f"{wall:.1f} s, {cpu:.1f} s cpu, {mb:.0f} MB"
            if poses is None:
                self.line(name, command, code, "-", "-", seconds, False, said)
                continue
            scans = poses["scans"]
            placed = [s["status"] != "unregistered" for s in scans]
            places = [rows(s["T_world_scan"]) for s in scans]
            errors = [multiply(inverse(multiply(inverse(truth[0]), truth[i])),
                               multiply(inverse(places[0]), places[i]))
                      for i in range(len(scans)) if placed[i]]
            worst_deg = max(map(angle, errors))
            worst_mm = 1000 * max(map(shift, errors))
            self.line(name, command, code, f"{sum(placed)}/{len(scans)}",
                      f"{worst_deg:.4f} deg, {worst_mm:.2f} mm", seconds,
                      code == 0 and all(placed) and worst_deg <= degrees
                      and worst_mm <= millimetres, said)
            found = found or places
        return found

    def starts(self, name, files, count, reach, rng, reference):
        """Scans moved at random, one and two threads in turn: apart from the first by at most 1 mm."""
        points = [read_points(f) for f in files]
        for k in range(count):
            folder = pathlib.Path(tempfile.mkdtemp(dir=self.scratch))
            motions = [random_motion(rng, reach) for _ in files]
            for f, p, t in zip(files, points, motions):
                write_points(folder / (f.stem + ".ply"), moved(p, t))
            turned = [folder / (f.stem + ".ply") for f in files]
            threads = 1 + k % 2
            code, poses, wall, cpu, mb, said = self.run("register", turned, "--threads",
                                                        str(threads))
            seconds = f"{wall:.1f} s, {cpu:.1f} s cpu, {mb:.0f} MB"
            placed = [s["status"] != "unregistered" for s in poses["scans"]]
            # Where a scan's own points came to lie.
            places = [multiply(rows(s["T_world_scan"]), t)
                      for s, t in zip(poses["scans"], motions)]
            reference = reference or places
            apart = [multiply(inverse(multiply(inverse(reference[0]), reference[i])),
                              multiply(inverse(places[0]), places[i])) for i in range(len(files))]
            worst = 1000 * max(map(shift, apart))
            self.line(f"{name}, start {k + 1}, {threads} threads", "register", code,
                      f"{sum(placed)}/{len(files)}",
                      f"{max(map(angle, apart)):.4f} deg, {worst:.3f} mm apart", seconds,
                      code == 0 and all(placed) and worst <= 1.0, said)

    def refused(self, name, files, placed_at_most, *flags):
        for command in self.commands:
            code, poses, wall, cpu, mb, said = self.run(command, files, *flags)
            seconds = f"{wall:.1f} s, {cpu:.1f} s cpu, {mb:.0f} MB"
            if poses is None:
                self.line(name, command, code, "-", "-", seconds, False, said)
                continue
            placed = sum(s["status"] != "unregistered" for s in poses["scans"])
            self.line(name, command, code, f"{placed}/{len(files)}", said.split(": ")[-1][:90],
                      seconds, code == 5 and placed <= placed_at_most, said)


def tunnel(rng, range_noise=0.003, points=40000, reach=10.0):
    """A bare tube along X, 3 m wide, the scanner on its axis."""
    out = array.array("f")
    while len(out) < 3 * points:
        d = [rng.gauss(0, 1) for _ in range(3)]
        r = 1.5 / math.hypot(d[1], d[2])
        if abs(r * d[0]) > reach:
            continue
        n = math.hypot(*d)
        k = r + rng.gauss(0, range_noise) / n
        out.extend([k * v for v in d])
    return out


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("glowworm")
    parser.add_argument("data", type=pathlib.Path)
    parser.add_argument("--only", default="", help="cases whose name holds this word")
    parser.add_argument("--no-convert", action="store_true")
    parser.add_argument("--starts", type=int, default=5)
    options = parser.parse_args()
    scratch = tempfile.TemporaryDirectory(prefix="registration-")
    made = pathlib.Path(scratch.name)
    bench = Bench(options.glowworm, scratch.name, not options.no_convert)
    rng = random.Random(7)
    wanted = lambda name: options.only in name

    print("| case | command | exit | placed | error or word | cost | holds |")
    print("|---|---|---|---|---|---|---|")
    sets = known_sets(options.data)
    reference = None
    for name, (files, truth, degrees, millimetres) in sets.items():
        if wanted(name):
            found = bench.known(name, files, truth, degrees, millimetres)
            reference = reference or (found if name == "nine scans" else None)

    cave, truth = sets["nine scans"][:2]
    if wanted("turned"):
        bench.starts("nine scans turned", cave, options.starts, 0.0, rng, reference)
    if wanted("moved"):
        bench.starts("nine scans moved 20 m", cave, options.starts, 20.0, rng, None)
    if wanted("poses given at random"):
        given = {"scans": [{"file": f.name, "T_world_scan": sum(random_motion(rng, 10.0), [])}
                           for f in cave]}
        (made / "given.json").write_text(json.dumps(given))
        bench.known("poses given at random", cave, truth, 0.05, 5.0,
                    "--poses", str(made / "given.json"))

    if wanted("no overlap"):
        # Two caves' scans; and the two stations of one that see least in common.
        gap = max(((i, j) for i in range(9) for j in range(i)),
                  key=lambda p: shift(multiply(inverse(truth[p[0]]), truth[p[1]])))
        half = [read_points(cave[i]) for i in gap]
        # What lies on the other's side of the middle is cut away: nothing is left in common.
        for which, other in ((0, 1), (1, 0)):
            t = multiply(inverse(truth[gap[which]]), truth[gap[other]])
            axis = [t[k][3] for k in range(3)]
            most = 0.4 * sum(a * a for a in axis)
            p = half[which]
            kept = array.array("f")
            for k in range(0, len(p), 3):
                if sum(a * v for a, v in zip(axis, p[k:k + 3])) < most:
                    kept.extend(p[k:k + 3])
            write_points(made / f"half{which}.ply", kept)
        bench.refused("no overlap", [made / "half0.ply", made / "half1.ply"], 1)
    if wanted("other site"):
        points = read_points(sets["terrestrial"][0][0])
        write_points(made / "foreign.ply", array.array("f", [0.25 * v for v in points]))
        bench.refused("other site mixed in", [*cave[:3], made / "foreign.ply"], 3)
    if wanted("tunnel"):
        for k in (0, 1):
            write_points(made / f"tunnel{k}.ply", tunnel(rng))
        bench.refused("bare tunnel", [made / "tunnel0.ply", made / "tunnel1.ply"], 2)
    if wanted("mirrored"):
        points = read_points(cave[1])
        points[0::3] = array.array("f", [-v for v in points[0::3]])
        write_points(made / "mirrored.ply", points)
        bench.refused("mirrored", [cave[0], made / "mirrored.ply"], 1)
    if wanted("same twice"):
        write_points(made / "copy.ply", read_points(cave[0]))
        identity = truth[0]
        bench.known("same twice", [cave[0], made / "copy.ply"], [identity, identity], 0.001, 0.01)
    return 1 if bench.failed else 0


if __name__ == "__main__":
    sys.exit(main())
