#!/usr/bin/env python3
"""A reader written from FORMAT.md finds in a file what went into it, what `info` says of it and what `extract` takes out.

    read_svo_test.py GLOWWORM
"""
import json
import math
import os
import random
import struct
import subprocess
import sys
import tempfile

from read_svo import Svo

COUNT = 3000
RADIUS = 0.04  # m, of every surfel
SCENE = {"lights": [{"type": "area", "name": "lamp", "radiance": [5, 4, 3],
                     "corners": [[99.8, 49.8, 11.5], [99.8, 50.2, 11.5], [100.2, 50.2, 11.5], [100.2, 49.8, 11.5]]}],
         "cameras": []}


def write_sphere(path):
    """Surfels of a sphere of 2 m around (100, 50, 10), seen from inside; returns them."""
    random.seed(3)
    surfels = []
    for i in range(COUNT):
        z = 1 - 2 * (i + 0.5) / COUNT
        angle = i * math.pi * (3 - math.sqrt(5))
        d = (math.sqrt(1 - z * z) * math.cos(angle), math.sqrt(1 - z * z) * math.sin(angle), z)
        surfels.append(([100 + 2 * d[0], 50 + 2 * d[1], 10 + 2 * d[2]], [-c for c in d],
                        [random.randrange(256) for _ in range(3)], random.uniform(0.3, 1)))
    with open(path, "wb") as file:
        names = "".join("property float %s\n" % n for n in ("x", "y", "z", "nx", "ny", "nz", "radius", "ndf"))
        names += "".join("property uchar %s\n" % n for n in ("red", "green", "blue"))
        file.write(("ply\nformat binary_little_endian 1.0\nelement vertex %d\n%send_header\n" % (COUNT, names)).encode())
        for p, n, colour, ndf in surfels:
            file.write(struct.pack("<8f3B", *p, *n, RADIUS, ndf, *colour))
    return surfels


def read_ply(path):
    """[n] dicts of a binary PLY of scalars."""
    forms = {"float": "f", "double": "d", "uchar": "B", "ushort": "H", "uint": "I", "int": "i"}
    with open(path, "rb") as file:
        header, form, names, count, origin = b"", "<", [], 0, [0.0] * 3
        while header.strip() != b"end_header":
            header = file.readline()
            words = header.decode().split()
            if words[:2] == ["element", "vertex"]:
                count = int(words[2])
            elif words[0] == "property":
                form += forms[words[1]]
                names.append(words[2])
            elif words[:2] == ["comment", "origin"]:
                origin = [float(w) for w in words[2:5]]
        size = struct.calcsize(form)
        return [dict(zip(names, struct.unpack(form, file.read(size)))) for _ in range(count)], origin


def near(a, b, tolerance, what):
    assert abs(a - b) <= tolerance, "%s: %.9g instead of %.9g" % (what, a, b)


def check_points(svo, surfels):
    origin = svo.header["origin"]
    points = [p for p in svo.points() if p["light"] == 0]
    assert len(points) == COUNT
    # Each surfel's own point, by nearest cell of a hash grid as wide as their distance.
    width, grid = 0.05, {}
    for p in points:
        p["world"] = [c + o for c, o in zip(p["position"], origin)]
        grid.setdefault(tuple(int(c // width) for c in p["world"]), []).append(p)
    worst = 0.0
    for position, normal, colour, ndf in surfels:
        x, y, z = (int(c // width) for c in position)
        near_by = [p for i in range(27) for p in grid.get((x + i % 3 - 1, y + i // 3 % 3 - 1, z + i // 9 - 1), [])]
        found = min(near_by, key=lambda p: math.dist(p["world"], position))
        worst = max(worst, math.dist(found["world"], position))
        assert sum(a * b for a, b in zip(found["normal"], normal)) > 1 - 1e-7
        assert all(abs(a - b) <= 1 for a, b in zip(found["colour"], colour)), (found["colour"], colour)
        near(found["ndf"], ndf, 0.5 / 255 + 1e-6, "Toksvig length")
        near(found["radius"], RADIUS, RADIUS / 2048, "radius")
        assert found["station"] == 0
    spacing = math.sqrt(4 * math.pi * 4 / COUNT)
    print("worst position error %.2g m, points %.2g m apart" % (worst, spacing))
    assert worst <= spacing / 16


def check_info(svo, info):
    header, levels = svo.header, svo.records("levels", "<2I")
    assert info["depth"] == header["depth"] and info["samples"] == header["samples"]
    near(info["voxel_size"], header["cube_edge"] / 2 ** header["depth"], 1e-7, "voxel size")
    assert info["nodes"] == svo.sections["nodes"][2] and info["leaves"] == levels[-1][1]
    attributes = svo.records("attributes", "<2f3f3f")
    total = attributes[0][1]
    for said, (first, count) in zip(info["levels"], levels):
        here = attributes[first:first + count]
        assert said["nodes"] == count
        near(said["mean_opacity"], sum(a[0] for a in here) / count, 1e-5, "opacity")
        near(said["mean_ndf_length"], sum(math.hypot(*a[2:5]) for a in here) / count, 1e-5, "NDF length")
        near(sum(a[1] for a in here) / total, 1, 1e-6, "area of level %d" % said["level"])
    lamp = next(s for s in svo.records("area_lights", "<12d3f3I"))
    assert [round(c, 6) for c in lamp[:12]] == sum(SCENE["lights"][0]["corners"], []) and lamp[12:15] == (5, 4, 3)
    name = svo.text("names").encode()[lamp[15]:lamp[15] + lamp[16]].decode()
    assert name == "lamp" and info["area_lights"] == [name]
    assert json.loads(svo.text("provenance")) == info["provenance"]


def check_lobes(svo):
    """Lobes lie inside their leaves, add up to what the leaves say, and one shines as the lamp does."""
    cells, levels = svo.cells(), svo.records("levels", "<2I")
    nodes, attributes = svo.records("nodes", "<2I"), svo.records("attributes", "<2f3f3f")
    lobes = svo.records("lobes", "<3ff3ff3fIIIIf")
    edge, seen, shines = svo.header["cube_edge"] / 2 ** svo.header["depth"], 0, set()
    for i, cell in enumerate(cells[-1]):
        mask, first = nodes[levels[-1][0] + i]
        assert first == seen and 1 <= mask >> 8 <= 3
        seen += mask >> 8
        own = lobes[first:seen]
        for lobe in own:
            for axis in range(3):
                inside = (lobe[axis] - svo.header["cube_min"][axis]) / edge - cell[axis]
                low, high = lobe[12] >> 8 * axis & 255, lobe[13] >> 8 * axis & 255
                assert low / 255 - 1e-3 <= inside <= high / 255 + 1e-3
            if lobe[11] > 0:
                exponent = 2.0 ** ((lobe[14] >> 27) - 24)
                shines.add(tuple((lobe[14] >> 9 * c & 511) * exponent for c in range(3)))
        near(sum(lobe[3] for lobe in own) / attributes[levels[-1][0] + i][1], 1, 1e-6, "area of a leaf")
    assert seen == len(lobes) and shines == {(5.0, 4.0, 3.0)}


def check_extract(svo, path, level):
    voxels, origin = read_ply(path)
    first, count = svo.records("levels", "<2I")[level]
    edge = svo.header["cube_edge"] / 2 ** level
    attributes = svo.records("attributes", "<2f3f3f")[first:first + count]
    assert len(voxels) == count
    for voxel, cell, a in zip(voxels, svo.cells()[level], attributes):
        for axis, name in enumerate("xyz"):
            centre = svo.header["origin"][axis] + svo.header["cube_min"][axis] + (cell[axis] + 0.5) * edge
            near(voxel[name] + origin[axis], centre, 1e-4, "centre")
        near(voxel["ndf"], max(1e-3, math.hypot(*a[2:5])), 1e-5, "NDF length")


def check_links(svo):
    """As many as there should be, each to a lobe, to nothing or into a back."""
    lobes = svo.sections["lobes"][2]
    links = [link for link, in svo.records("links", "<I")]
    assert len(links) == lobes * svo.header["links_per_lobe"]
    assert all(link < lobes or link in (0xffffffff, 0xfffffffe) for link in links)
    # Inside a closed sphere nearly every ray meets a lobe.
    assert sum(link < lobes for link in links) > 0.95 * len(links)


def main():
    program = os.path.abspath(sys.argv[1])
    with tempfile.TemporaryDirectory() as folder:
        def run(*arguments):
            done = subprocess.run([program, *arguments, "-q"], cwd=folder, capture_output=True, text=True)
            assert done.returncode == 0, done.stderr
            return done.stdout

        surfels = write_sphere(os.path.join(folder, "sphere.ply"))
        with open(os.path.join(folder, "scene.json"), "w") as file:
            json.dump(SCENE, file)
        run("build", "sphere.ply", "-o", "sphere.svo", "--lights", "scene.json", "--depth", "5", "--links", "8")
        info = json.loads(run("info", "sphere.svo", "--json"))
        run("extract", "sphere.svo", "--level", "4", "-o", "level.ply")
        svo = Svo(os.path.join(folder, "sphere.svo"))
        check_points(svo, surfels)
        check_info(svo, info)
        check_lobes(svo)
        check_links(svo)
        check_extract(svo, os.path.join(folder, "level.ply"), 4)
    print("a reader written from the page finds all that is in the file")


if __name__ == "__main__":
    main()
