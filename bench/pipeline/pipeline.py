#!/usr/bin/env python3
"""Measures whole conversions: a line for each, beside what `--dry-run` said or beside the goal.

    pipeline.py prediction GLOWWORM DATA [SET...]   predicted and real depth, leaves, memory, disk and time
    pipeline.py throughput GLOWWORM SCANS [FLAG...] points a second, share of time and CPU use of each stage
    pipeline.py memory GLOWWORM MEGABYTES [COMMAND...]  the peak of each command under a limit of a fifth of its input

DATA is the folder of real scans that the tests take from GLOWWORM_DATA; SCANS is what simulate_cave wrote.
"""
import array
import json
import math
import os
import random
import shutil
import struct
import subprocess
import sys
import tempfile
import time

STAGES = ["ingest", "register", "merge", "surface", "build", "links"]


class Ran:
    """A program that ended: its code, its output, and what it took of the machine."""

    def __init__(self, words):
        start = time.monotonic()
        with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
            child = subprocess.Popen([str(word) for word in words], stdout=out, stderr=err)
            _, status, usage = os.wait4(child.pid, 0)
            child.returncode = self.code = os.waitstatus_to_exitcode(status)
            out.seek(0)
            err.seek(0)
            self.out, self.err = out.read().decode(), err.read().decode(errors="replace")
        self.wall = time.monotonic() - start
        self.cpu = usage.ru_utime + usage.ru_stime
        self.peak = usage.ru_maxrss * 1024


def remove(output):
    for path in (output, output + ".poses.json"):
        if os.path.exists(path):
            os.remove(path)
    shutil.rmtree(output + ".work", ignore_errors=True)


def bytes_in(folder):
    if not os.path.isdir(folder):
        return 0
    return sum(entry.stat().st_size for entry in os.scandir(folder))


def points_of_mesh(path, count):
    """A PLY of points spread evenly over a triangle mesh's surface."""
    with open(path, "rb") as file:
        data = file.read()
    head, body = data.split(b"end_header\n", 1)
    vertices = int(head.split(b"element vertex ")[1].split()[0])
    faces = int(head.split(b"element face ")[1].split()[0])
    xyz = [struct.unpack_from("<3f", body, 12 * i) for i in range(vertices)]
    triangles = [struct.unpack_from("<3i", body, 12 * vertices + 13 * i + 1) for i in range(faces)]
    sub = lambda a, b: [a[k] - b[k] for k in range(3)]
    areas = []
    for a, b, c in triangles:
        u, v = sub(xyz[b], xyz[a]), sub(xyz[c], xyz[a])
        n = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
        areas.append(sum(x * x for x in n) ** 0.5)
    rng = random.Random(1)
    rows = bytearray()
    for a, b, c in rng.choices(triangles, areas, k=count):
        s, t = rng.random(), rng.random()
        if s + t > 1:
            s, t = 1 - s, 1 - t
        u, v = sub(xyz[b], xyz[a]), sub(xyz[c], xyz[a])
        rows += struct.pack("<3f", *(xyz[a][k] + s * u[k] + t * v[k] for k in range(3)))
    out = os.path.join(tempfile.gettempdir(), os.path.basename(path).replace(".ply", "_points.ply"))
    with open(out, "wb") as file:
        file.write(b"ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty float x\n"
                   b"property float y\nproperty float z\nend_header\n" % count + rows)
    return out


def data_sets(data):
    bunny = [f"{data}/stanford_bunny/bun{a}.ply" for a in ("000", "045", "090", "315")]
    demo = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../demo/scans")
    return {
        "demo": [demo],
        "D_cavern": [f"{data}/scans/D_cavern"],
        "obs_eq_tls": [f"{data}/obs_eq_tls/scan00{i}.pcd" for i in range(4)],
        "small_gicp": [f"{data}/small_gicp/source.ply", f"{data}/small_gicp/target.ply"],
        "bunny": bunny,
        "room_scan1": [f"{data}/pcl_data/room_scan1.pcd"],
        "region_growing": [f"{data}/pcl_data/region_growing_tutorial.pcd"],
        "mine_pcr": [f"{data}/mine_pcr/2025-04-21-11-04-46.pcd"],
        "lion": [f"{data}/perf/lion_342k.ply"],
        "gi sphere": [f"{data}/gi/A_sphere_c05/points.ply"],
        "gi box": [f"{data}/gi/B_box/points.ply"],
        "gi dogleg": [f"{data}/gi/C_dogleg/points.ply"],
        "gi cavern": [f"{data}/gi/D_cavern/points.ply"],
        "indoor.laz": [f"{data}/formats/loaders.gl/modules/las/test/data/indoor.laz"],
        "edgar mine": lambda: [points_of_mesh(f"{data}/mine_meshes/edgar_mine.ply", 300000)],
        "pittsburgh mine": lambda: [points_of_mesh(f"{data}/mine_meshes/pittsburgh_mine.ply", 300000)],
    }


def prediction(program, data, *names):
    print("| set | depth | leaves | memory, MB | disk, MB | while working, MB | processor s | dry run, s |")
    print("|---|---|---|---|---|---|---|---|")
    for name, files in data_sets(data).items():
        if names and name not in names:
            continue
        files = files() if callable(files) else files
        with tempfile.TemporaryDirectory() as folder:
            output = os.path.join(folder, "cave.svo")
            convert = [program, "convert", *files, "-o", output, "--allow-missing-scans", "--json"]
            plan = Ran(convert + ["--dry-run"])
            if plan.code != 0:
                print(f"| {name} | dry run ended with {plan.code}: {plan.err.strip()} |")
                continue
            said = json.loads(plan.out)
            built = Ran(convert + ["--until", "build"])
            working = bytes_in(output + ".work")
            remove(output)
            real = Ran(convert)
            if real.code != 0 or built.code != 0:
                print(f"| {name} | conversion ended with {real.code}: {real.err.strip()[-200:]} |")
                continue
            made = json.loads(real.out)

            def cell(predicted, found, form="{:.0f}"):
                off = 100.0 * (predicted - found) / found
                return (form + " for " + form + " ({:+.0f} %)").format(predicted, found, off)

            print("|", " | ".join([
                name, f"{said['depth']} for {made['depth']}", cell(said["leaves"], made["leaves"]),
                cell(said["memory"] / 1e6, real.peak / 1e6), cell(said["disk"] / 1e6, made["bytes"] / 1e6, "{:.1f}"),
                cell(said["work_disk"] / 1e6, working / 1e6, "{:.1f}"),
                cell(said["processor_seconds"], real.cpu, "{:.1f}"), f"{plan.cpu:.1f}"]), "|", flush=True)


def throughput(program, scans, *flags):
    with tempfile.TemporaryDirectory() as folder:
        output = os.path.join(folder, "cave.svo")
        convert = [program, "convert", scans, "-o", output, "--json", *flags]
        rows = []
        for stage in STAGES:
            load = os.getloadavg()[0]
            run = Ran(convert + ["--until", stage])
            if run.code != 0:
                sys.exit(f"{stage} ended with {run.code}: {run.err.strip()[-400:]}")
            rows.append((stage, run, load))
            points = json.loads(run.out)["points"]
        total = sum(run.cpu for _, run, _ in rows)
        print("| stage | points a processor second | share | processor s | wall s | CPU use | peak, MB | load before |")
        print("|---|---|---|---|---|---|---|---|")
        for stage, run, load in rows:
            print(f"| {stage} | {points / run.cpu:.0f} | {100 * run.cpu / total:.0f} % | {run.cpu:.1f} | {run.wall:.1f} "
                  f"| {run.cpu / run.wall / os.cpu_count():.0%} | {run.peak / 1e6:.0f} | {load:.1f} |")
        remove(output)
        whole = Ran(convert)
        print(f"whole: {points} points, {whole.cpu:.1f} processor s, {whole.wall:.1f} s of wall time, CPU use "
              f"{whole.cpu / whole.wall / os.cpu_count():.0%}, {points / whole.cpu:.0f} points a processor second, "
              f"peak {whole.peak / 1e6:.0f} MB")
        again = Ran(convert + ["--resume"])
        print(f"finished, --resume: {again.cpu:.2f} processor s, {again.wall:.2f} s")


def rolling_ground(path, count):
    """A PLY of about `count` points with normals and radii on ground of 3 mm noise, 28 bytes a point."""
    rng = random.Random(2)
    side, block = 20.0, 40000
    tiles = max(1, round((count / block) ** 0.5))
    x, y = ([side * rng.random() for _ in range(block)] for _ in range(2))
    z = [0.3 * math.sin(0.6 * x[i]) + rng.gauss(0, 0.003) for i in range(block)]
    rows = array.array("f", [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.05] * block)
    rows[2::7] = array.array("f", z)
    with open(path, "wb") as file:
        file.write(b"ply\nformat binary_little_endian 1.0\nelement vertex %d\nproperty float x\nproperty float y\n"
                   b"property float z\nproperty float nx\nproperty float ny\nproperty float nz\n"
                   b"property float radius\nend_header\n" % (tiles * tiles * block))
        for i in range(tiles):
            rows[0::7] = array.array("f", [side * i + value for value in x])
            for j in range(tiles):
                rows[1::7] = array.array("f", [side * j + value for value in y])
                file.write(rows.tobytes())


def memory(program, megabytes, *names):
    """Each command, or those named, on an input of five times the limit: under it, or refused at once."""
    limit = int(megabytes) * 1000000
    identity = "[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]"
    with tempfile.TemporaryDirectory() as folder:
        at = lambda name: os.path.join(folder, name)
        cloud, tree = at("cloud.ply"), at("tree.svo")
        rolling_ground(cloud, 5 * limit // 28)
        os.mkdir(at("scans"))
        for name in ("a", "b"):
            rolling_ground(at(f"scans/{name}.ply"), 5 * limit // 56)
        with open(at("p.json"), "w") as file:
            file.write('{"scans":[%s]}' % ",".join('{"file":"%s.ply","T_world_scan":%s}' % (name, identity)
                                                   for name in ("a", "b")))
        poses = ["--poses", at("p.json")]
        steps = [("build", ["build", cloud, "-o", tree]),
                 ("info SVO", ["info", tree, "--json"]), ("check", ["check", tree]), ("diff", ["diff", tree, tree]),
                 ("extract --level", ["extract", tree, "--level", "6", "-o", at("level.ply")]),
                 ("extract --box", ["extract", tree, "--box", "0", "0", "-1", "20", "20", "1", "-o", at("box.svo")]),
                 ("join", ["join", tree, "-o", at("joined.svo")]),
                 ("info scan", ["info", cloud, "--json"]),
                 ("ingest", ["ingest", cloud, "-o", at("ingest.svo")]),
                 ("register", ["register", at("scans"), *poses, "-o", at("poses.json")]),
                 ("merge", ["merge", at("scans"), *poses, "-o", at("merged.ply")]),
                 ("surface", ["surface", cloud, "-o", at("surfels.ply")]),
                 ("convert --dry-run", ["convert", at("scans"), *poses, "-o", at("cave.svo"), "--dry-run"]),
                 ("convert --links 4", ["convert", at("scans"), *poses, "--links", "4", "-o", at("cave.svo")])]
        print(f"input {os.path.getsize(cloud) / 1e6:.0f} MB, limit {limit / 1e6:.0f} MB")
        print("| command | ended with | peak, MB | of the limit | processor s | wall s | said |")
        print("|---|---|---|---|---|---|---|")
        for name, words in steps:
            if names and words[0] not in names:
                continue
            run = Ran([program, *words, "--memory-limit", limit, "--temp-dir", folder])
            said = run.err.strip().split("\n")[-1][:160] if run.code else ""
            print(f"| {name} | {run.code} | {run.peak / 1e6:.0f} | {run.peak / limit:.0%} | {run.cpu:.1f} "
                  f"| {run.wall:.1f} | {said} |", flush=True)


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    {"prediction": prediction, "throughput": throughput, "memory": memory}[sys.argv[1]](*sys.argv[2:])
