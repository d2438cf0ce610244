#!/usr/bin/env python3
"""Changes what `glowworm convert --resume` goes on from, and looks whether it notices.

    resume.py GLOWWORM

Scans are changed in place (same size, same time), touched, added and taken away, and an option is changed: after each
stage and on a finished output. SIGTERM comes in each phase; temporary folder and output lie on different file systems.
What comes out must be the bytes of a fresh run. Ends with 1 where anything was not as promised.
"""
import os
import shutil
import signal
import subprocess
import sys
import tempfile

from faults import Bench

IDENTITY = "[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]"
STAGES = ["ingest", "register", "merge", "surface", "build"]
PHASES = ["look", "read", "register", "merge", "surface", "build", "links", "write"]


def content(path):
    with open(path, "rb") as file:
        return file.read()


class Resume:
    def __init__(self, program):
        self.bench = Bench(program, True)
        self.scans = [*self.bench.scans, self.bench.write_scan("scan2.ply", 2)]
        with open(os.path.join(self.bench.folder, "poses.json"), "w") as file:
            file.write('{"scans":[%s]}' % ",".join('{"file":"scan%d.ply","T_world_scan":%s}' % (i, IDENTITY)
                                                   for i in range(3)))
        self.checks, self.failures, self.outputs = 0, 0, 0

    def new(self, folder=None):
        """A name for another output."""
        self.outputs += 1
        return os.path.join(folder or self.bench.folder, f"cave{self.outputs}.svo")

    def command(self, scans, output, *more):
        self.bench.output = output
        words = self.bench.command(more)
        first = words.index(self.bench.scans[0])
        return [*words[:first], *scans, *words[first + len(self.bench.scans):]]

    def run(self, scans, output, *more):
        return subprocess.run(self.command(scans, output, *more), capture_output=True, timeout=300).returncode

    def fresh(self, scans):
        output = self.new()
        assert self.run(scans, output) == 0
        return content(output)

    def check(self, what, code, wanted, output=None, expected=None):
        self.checks += 1
        right = code == wanted and (output is None or content(output) == expected and
                                    not os.path.exists(output + ".work"))
        if not right:
            self.failures += 1
            print(f"NOT AS PROMISED: {what}: ended with {code}", flush=True)

    def write_in_place(self, data):
        """Other bytes in the first scan, of the same size and time."""
        before = os.stat(self.scans[0])
        with open(self.scans[0], "r+b") as file:
            file.write(data)
        os.utime(self.scans[0], ns=(before.st_atime_ns, before.st_mtime_ns))

    def changes(self):
        scans, two = self.scans, self.scans[:2]
        kept = content(scans[0])
        digit = kept.index(b"end_header\n") + 13
        other = kept[:digit] + (b"2" if kept[digit:digit + 1] == b"1" else b"1") + kept[digit + 1:]
        of_two, of_three = self.fresh(two), self.fresh(scans)
        self.write_in_place(other)
        changed = self.fresh(two)
        self.write_in_place(kept)
        for stage in STAGES:
            for what, before, after, expected in [("added", two, scans, of_three), ("taken away", scans, two, of_two)]:
                output = self.new()
                self.run(before, output, "--until", stage)
                self.check(f"a scan {what} after {stage}", self.run(after, output, "--resume"), 0, output, expected)
            output = self.new()
            self.run(two, output, "--until", stage, "--neighbours", "20")
            self.check(f"an option after {stage}", self.run(two, output, "--resume"), 0, output, of_two)
            output = self.new()
            self.run(two, output, "--until", stage)
            self.write_in_place(other)
            self.check(f"bytes after {stage}", self.run(two, output, "--resume"), 0, output, changed)
            self.write_in_place(kept)

        output = self.new()
        self.run(two, output)
        os.utime(scans[0])
        self.check("a scan only touched", self.run(two, output, "--resume"), 0, output, of_two)
        words = self.command(two, output, "--resume")
        words[words.index("--threads") + 1] = "2"
        self.check("other --threads", subprocess.run(words, capture_output=True).returncode, 0, output, of_two)
        self.check("a scan more, finished", self.run(scans, output, "--resume"), 7, output, of_two)
        self.check("an option, finished", self.run(two, output, "--resume", "--neighbours", "20"), 7, output, of_two)
        self.write_in_place(other)
        self.check("bytes, finished", self.run(two, output, "--resume"), 7, output, of_two)
        self.check("bytes, --force", self.run(two, output, "--resume", "--force"), 0, output, changed)
        self.write_in_place(kept)

    def stops(self):
        expected = self.fresh(self.scans)
        for phase in PHASES:
            output = self.new()
            words = self.command(self.scans, output, "--progress", "json")
            run = subprocess.Popen(words, stderr=subprocess.PIPE, text=True)
            sent = False
            for line in run.stderr:
                if not sent and f'"phase":"{phase}"' in line:
                    run.send_signal(signal.SIGTERM)
                    sent = True
            self.check(f"SIGTERM in {phase}", run.wait(), 8)
            self.check(f"after SIGTERM in {phase}", self.run(self.scans, output, "--resume"), 0, output, expected)

    def places(self):
        expected = self.fresh(self.scans)
        with tempfile.TemporaryDirectory(dir="/dev/shm") as elsewhere:
            output = self.new()
            self.check("a temporary folder elsewhere", self.run(self.scans, output, "--temp-dir", elsewhere), 0, output,
                       expected)
            self.check("which is left empty", len(os.listdir(elsewhere)), 0)
            output = self.new(elsewhere)
            self.check("an output elsewhere", self.run(self.scans, output, "--temp-dir", self.bench.folder), 0, output,
                       expected)
        self.check("no temporary folder", self.run(self.scans, self.new(), "--temp-dir", elsewhere), 3)


def main():
    resume = Resume(sys.argv[1])
    try:
        resume.changes()
        resume.stops()
        resume.places()
    finally:
        shutil.rmtree(resume.bench.folder, ignore_errors=True)
    print(f"{resume.checks} checks, {resume.failures} not as promised")
    sys.exit(1 if resume.failures else 0)


if __name__ == "__main__":
    main()
