"""Reads an .svo with the standard library alone, written from octree/FORMAT.md and nothing else: what a stranger's reader
looks like. Checksums are left to `glowworm check`."""
import math
import struct

HEADER = {"version": (8, "<I"), "depth": (12, "<I"), "file_bytes": (16, "<Q"), "origin": (24, "<3d"),
          "cube_min": (48, "<3f"), "cube_edge": (60, "<f"), "bounds_min": (64, "<3f"), "bounds_max": (76, "<3f"),
          "samples": (88, "<Q"), "dropped": (96, "<Q"), "links_per_lobe": (104, "<I"), "sections": (108, "<I")}
KINDS = ["levels", "nodes", "attributes", "lobes", "chunks", "points", "stations", "area_lights", "names", "provenance",
         "links"]


class Svo:
    def __init__(self, path):
        with open(path, "rb") as file:
            self.bytes = file.read()
        if self.bytes[:8] != b"GLOWSVO\n":
            raise ValueError("not an .svo")
        self.header = {}
        for name, (offset, form) in HEADER.items():
            value = struct.unpack_from(form, self.bytes, offset)
            self.header[name] = value if len(value) > 1 else value[0]
        if self.header["file_bytes"] != len(self.bytes):
            raise ValueError("truncated")
        self.sections = {}
        for i in range(self.header["sections"]):
            kind, record, offset, count, _ = struct.unpack_from("<IIQQQ", self.bytes, 112 + 32 * i)
            if kind <= len(KINDS):
                self.sections[KINDS[kind - 1]] = (record, offset, count)

    def records(self, section, form):
        record, offset, count = self.sections[section]
        if struct.calcsize(form) != record:
            raise ValueError("records of %s have %d bytes" % (section, record))
        return [struct.unpack_from(form, self.bytes, offset + record * i) for i in range(count)]

    def text(self, section):
        _, offset, count = self.sections[section]
        return self.bytes[offset:offset + count].decode()

    def cells(self):
        """[level][cell] integer coordinates, in the order of the nodes."""
        levels, nodes = self.records("levels", "<2I"), self.records("nodes", "<2I")
        found = [[(0, 0, 0)]]
        for first, count in levels[:-1]:
            below = []
            for (x, y, z), (mask, child) in zip(found[-1], nodes[first:first + count]):
                assert child == levels[len(found)][0] + len(below), "children follow each other"
                below += [(2 * x + (o & 1), 2 * y + (o >> 1 & 1), 2 * z + (o >> 2)) for o in range(8) if mask >> o & 1]
            found.append(below)
        return found

    def points(self):
        """Each point: position (relative to the origin), normal, radius, sRGB bytes, Toksvig length, station, light."""
        packed = self.records("points", "<5I")
        for x, y, z, edge, first, count, spacing, radius in self.records("chunks", "<3ff2I2f"):
            for point in packed[first:first + count]:
                yield decode_point((x, y, z), edge, point)


def snorm16(bits):
    return max(-1.0, struct.unpack("<h", struct.pack("<H", bits))[0] / 32767)


def octahedral(bits):
    x, y = snorm16(bits & 0xffff), snorm16(bits >> 16)
    z = 1 - abs(x) - abs(y)
    if z < 0:
        x, y = (1 - abs(y)) * (-1 if x < 0 else 1), (1 - abs(x)) * (-1 if y < 0 else 1)
    length = math.sqrt(x * x + y * y + z * z)
    return x / length, y / length, z / length


def decode_point(corner, edge, words):
    quantised = words[0] & 0xffff, words[0] >> 16, words[1] & 0xffff
    return {"position": tuple(c + (q + 0.5) / 65536 * edge for c, q in zip(corner, quantised)),
            "radius": struct.unpack("<e", struct.pack("<H", words[1] >> 16))[0],
            "normal": octahedral(words[2]),
            "colour": (words[3] & 255, words[3] >> 8 & 255, words[3] >> 16 & 255),
            "ndf": (words[3] >> 24) / 255,
            "station": words[4] & 0xffff,
            "light": words[4] >> 16}
