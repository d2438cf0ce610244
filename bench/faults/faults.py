#!/usr/bin/env python3
"""Breaks `glowworm convert` in every way that a disk, a clock or a neighbour can, and looks at what is left.

    faults.py GLOWWORM [--small] [CASE...]

After each fault the same command runs again undisturbed, with --resume: its output must be the bytes of a run that was
never disturbed, and no other file may be left. Full size: every call is broken; --small: a sample of them (a ctest).
Cases: kill, full, unreadable, cancel, tiny-disk, file-limit, memory, race, finished, stages. Those that this machine does not allow (no
strace, no tmpfs) are skipped with a sentence. Ends with 1 where anything was not as promised.
"""
import argparse
import collections
import os
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time

NAMES = ["cave.svo", "cave.svo.poses.json"]
CANNOT_LOAD = 127  # the loader itself had no memory: nothing of ours ran


class Bench:
    def __init__(self, program, small):
        self.program, self.small = os.path.abspath(program), small
        self.folder = tempfile.mkdtemp(prefix="glowworm-faults-")
        self.scans = [self.write_scan(f"scan{i}.ply", i) for i in range(2)]
        self.counts = collections.Counter()
        self.failures = []
        self.output = self.fresh()
        run = self.convert([])
        if run.returncode != 0:
            sys.exit("the undisturbed run failed: " + run.stderr.decode())
        self.good = self.content()

    def write_scan(self, name, shift):
        """A box seen from inside, some hundred points."""
        random.seed(shift)
        points = []
        for _ in range(400):
            p = [random.uniform(-1, 1) for _ in range(3)]
            axis = random.randrange(3)
            p[axis] = random.choice([-1.0, 1.0])
            points.append("%.5f %.5f %.5f" % (3 * p[0], 2 * p[1], p[2]))
        path = os.path.join(self.folder, name)
        with open(path, "w") as file:
            file.write("ply\nformat ascii 1.0\nelement vertex %d\nproperty float x\nproperty float y\n"
                       "property float z\nend_header\n%s\n" % (len(points), "\n".join(points)))
        poses = os.path.join(self.folder, "poses.json")
        one = "[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]"
        with open(poses, "w") as file:
            file.write('{"scans":[%s]}' % ",".join('{"file":"scan%d.ply","T_world_scan":%s}' % (i, one) for i in range(2)))
        return path

    def fresh(self):
        """An empty folder for the next output."""
        out = os.path.join(self.folder, "out")
        shutil.rmtree(out, ignore_errors=True)
        os.mkdir(out)
        return os.path.join(out, "cave.svo")

    def command(self, more=()):
        return [self.program, "convert", *self.scans, "-o", self.output, "--threads", "1", "--depth", "5", "--links", "4",
                "--poses", os.path.join(self.folder, "poses.json"), "--poses", "trust", *more]

    def convert(self, more=(), before=(), **how):
        return subprocess.run([*before, *self.command(more)], capture_output=True, timeout=300, **how)

    def content(self):
        folder = os.path.dirname(self.output)
        return [open(os.path.join(folder, name), "rb").read() for name in NAMES]

    def fail(self, what):
        self.failures.append(what)
        print("NOT AS PROMISED:", what, flush=True)

    def must_recover(self, what):
        run = self.convert(["--resume"])
        folder = os.path.dirname(self.output)
        if run.returncode != 0:
            return self.fail(f"{what}: --resume ended with {run.returncode}: {run.stderr.decode().strip()}")
        if sorted(os.listdir(folder)) != NAMES:
            return self.fail(f"{what}: left {sorted(os.listdir(folder))}")
        if self.content() != self.good:
            self.fail(f"{what}: --resume gave other bytes")

    def must_be_whole(self, what):
        """Under the final name there is the whole octree or nothing."""
        if os.path.exists(self.output) and open(self.output, "rb").read() != self.good[0]:
            self.fail(f"{what}: a damaged file has the final name")

    def must_say(self, run, codes, what):
        sentence = run.stderr.decode(errors="replace").strip()
        if run.returncode not in codes:
            return self.fail(f"{what}: ended with {run.returncode}: {sentence}")
        if run.returncode != 0 and "glowworm:" not in sentence:
            self.fail(f"{what}: said nothing, ended with {run.returncode}")

    def injected(self, call, fault, n, only=None):
        path = ["-P", only] if only else []
        log = os.path.join(self.folder, "strace.log")
        return ["strace", "-f", "-qq", "-o", log, *path, "-e", f"trace={call}", "-e", f"inject={call}:{fault}:when={n}"]

    def steps(self, call, only=None):
        """Which of the calls of an undisturbed run to break: all, or a sample of them."""
        self.output = self.fresh()
        self.convert(before=self.injected(call, "delay_enter=0", 1, only))
        with open(os.path.join(self.folder, "strace.log")) as log:
            calls = sum(1 for line in log if f"{call}(" in line)
        step = max(1, calls // 3) if self.small else 1
        return range(1, calls + 1, step)

    # The cases.

    def kill(self):
        for call in ["pwrite64", "write", "fsync", "rename", "unlink", "close"]:
            for n in self.steps(call):
                self.output = self.fresh()
                run = self.convert(before=self.injected(call, "signal=SIGKILL", n))
                self.counts["SIGKILL at " + call] += 1
                what = f"SIGKILL at {call} {n}"
                if run.returncode not in (-signal.SIGKILL, 128 + signal.SIGKILL, 0):
                    self.fail(f"{what}: ended with {run.returncode}")
                self.must_be_whole(what)
                self.must_recover(what)

    def full(self):
        for call, fault in [("pwrite64", "error=ENOSPC"), ("fsync", "error=EIO"), ("rename", "error=EACCES")]:
            for n in self.steps(call):
                self.output = self.fresh()
                run = self.convert(before=self.injected(call, fault, f"{n}+"))
                self.counts[f"{fault[6:]} at {call}"] += 1
                what = f"{fault} at {call} {n} and after"
                self.must_say(run, [6] if call == "pwrite64" else [3] if call == "rename" else [0, 3], what)
                self.must_be_whole(what)
                self.must_recover(what)

    def unreadable(self):
        for call in ["read", "pread64", "openat"]:
            for n in self.steps(call, self.scans[1]):
                self.output = self.fresh()
                run = self.convert(before=self.injected(call, "error=EIO", n, self.scans[1]))
                self.counts["EIO at " + call] += 1
                what = f"EIO at {call} {n} of a scan"
                self.must_say(run, [0, 3], what)
                self.must_be_whole(what)
                self.must_recover(what)

    def tiny_disk(self):
        disk = os.path.join(self.folder, "disk")
        os.mkdir(disk)
        if subprocess.run(["mount", "-t", "tmpfs", "-o", "size=64k", "tmpfs", disk], capture_output=True).returncode:
            return print("skipped: a 64 KB disk needs the right to mount one")
        try:
            self.output = self.fresh()
            run = self.convert(["--temp-dir", disk])
            self.counts["64 KB temporary folder"] += 1
            self.must_say(run, [6], "a 64 KB temporary folder")
            self.must_be_whole("a 64 KB temporary folder")
            self.must_recover("a 64 KB temporary folder")
        finally:
            subprocess.run(["umount", disk], check=True)

    def file_limit(self):
        """A file that may not grow beyond the user's limit is a full disk, not a signal."""
        for size in [4096, 20000] if self.small else range(1000, 200000, 8000):
            self.output = self.fresh()
            run = self.convert(preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (size, size)))
            self.counts["ulimit -f"] += 1
            self.must_say(run, [0, 6], f"ulimit -f of {size} bytes")
            self.must_be_whole(f"ulimit -f of {size} bytes")
            self.must_recover(f"ulimit -f of {size} bytes")

    def memory(self):
        sizes = [1000, 400, 250, 200, 150, 120] if self.small else [1000, 600, *range(400, 90, -10)]
        for megabytes in sizes:
            limit = megabytes << 20
            self.output = self.fresh()
            run = self.convert(preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (limit, limit)))
            self.counts["ulimit -v"] += 1
            what = f"ulimit -v of {megabytes} MiB"
            if run.returncode != CANNOT_LOAD:
                self.must_say(run, [0, 6], what)
            self.must_be_whole(what)
            self.must_recover(what)

    def race(self):
        for _ in range(3 if self.small else 30):
            self.output = self.fresh()
            both = [subprocess.Popen(self.command(["--resume"]), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
                    for _ in range(2)]
            said = [run.communicate()[1].decode() for run in both]
            codes = sorted(run.returncode for run in both)
            self.counts["two runs on one output"] += 1
            if codes not in ([0, 0], [0, 7]):
                self.fail(f"two runs on one output: ended with {codes}: {said}")
            self.must_recover("two runs on one output")

    def cancel(self):
        for name in ["SIGINT", "SIGTERM"]:
            for n in self.steps("pwrite64"):
                self.output = self.fresh()
                run = self.convert(before=self.injected("pwrite64", "signal=" + name, n))
                self.counts[name] += 1
                what = f"{name} at write {n}"
                self.must_say(run, [0, 8], what)
                self.must_be_whole(what)
                self.must_recover(what)

    def finished(self):
        """A finished run is left alone, and a changed scan is seen."""
        self.output = self.fresh()
        self.convert()
        before = os.stat(self.output)
        if self.convert().returncode != 7:
            self.fail("a finished output was overwritten without --force")
        run = self.convert(["--resume"])
        if run.returncode != 0 or os.stat(self.output).st_mtime_ns != before.st_mtime_ns:
            self.fail("--resume worked on a finished output again")
        kept = open(self.scans[0], "rb").read()
        with open(self.scans[0], "ab") as file:
            file.write(b"\n")
        if self.convert(["--resume"]).returncode != 7:
            self.fail("--resume took an output for finished although a scan changed")
        with open(self.scans[0], "wb") as file:
            file.write(kept)
        self.counts["finished runs"] += 3

    def stages(self):
        """The same for each stage as a command of its own."""
        folder = os.path.dirname(self.fresh())
        at = lambda name: os.path.join(folder, name)
        poses = os.path.join(self.folder, "poses.json")
        cells = [f"r{octant}" for octant in range(8)]
        commands = [
            ["register", *self.scans, "--poses", poses, "--poses", "trust", "-o", at("poses.json")],
            ["merge", *self.scans, "--poses", at("poses.json"), "-o", at("cloud.ply")],
            ["surface", at("cloud.ply"), "-o", at("surfels.ply")],
            ["build", at("surfels.ply"), "--depth", "5", "-o", at("whole.svo")],
            *(["build", at("surfels.ply"), "--grid", at("whole.svo"), "--tile", cell, "-o", at(cell + ".svo")]
              for cell in cells),
            ["join", *(at(cell + ".svo") for cell in cells), "-o", at("joined.svo")]]
        run = lambda words, *more: subprocess.run([self.program, *words, *more], capture_output=True, timeout=300)
        for words in commands:
            what = words[0] + " -o " + os.path.basename(words[-1])
            if run(words).returncode != 0:
                self.fail(f"{what} ended with {run(words, '--force').returncode}")
                continue
            before = os.stat(words[-1])
            if run(words).returncode != 7:
                self.fail(f"{what}: a finished output was overwritten without --force")
            again = run(words, "--resume")
            if again.returncode != 0 or os.stat(words[-1]).st_mtime_ns != before.st_mtime_ns:
                self.fail(f"{what}: --resume worked on a finished output again: {again.stderr.decode().strip()}")
            if run(words, "--resume", "--no-crc" if words[0] != "join" else "--verbose").returncode != \
                    (7 if words[0] != "join" else 0):
                self.fail(f"{what}: --resume did not tell other flags apart")
            self.counts["finished stages"] += 3
        with open(at("whole.svo"), "rb") as whole, open(at("joined.svo"), "rb") as joined:
            if whole.read() != joined.read():
                self.fail("tiles joined to other bytes")
        with open(at("surfels.ply"), "ab") as file:
            file.write(b"\n")
        if run(commands[3], "--resume").returncode != 7:
            self.fail("build --resume took an output for finished although its input changed")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--small", action="store_true")
    parser.add_argument("cases", nargs="*")
    arguments = parser.parse_intermixed_args()
    bench = Bench(arguments.program, arguments.small)
    traced = {"kill": bench.kill, "full": bench.full, "unreadable": bench.unreadable, "cancel": bench.cancel}
    others = {"tiny-disk": bench.tiny_disk, "file-limit": bench.file_limit, "memory": bench.memory, "race": bench.race,
              "finished": bench.finished, "stages": bench.stages}
    traceable = shutil.which("strace") and subprocess.run(["strace", "-o", "/dev/null", "true"],
                                                         capture_output=True).returncode == 0
    try:
        for name, case in {**traced, **others}.items():
            if arguments.cases and name not in arguments.cases:
                continue
            if name in traced and not traceable:
                print(f"skipped: {name} needs strace and the right to trace")
                continue
            start = time.monotonic()
            case()
            print(f"{name}: {time.monotonic() - start:.0f} s", flush=True)
    finally:
        shutil.rmtree(bench.folder, ignore_errors=True)
    for what, count in sorted(bench.counts.items()):
        print(f"{count:5d}  {what}")
    print(f"{sum(bench.counts.values())} faults, {len(bench.failures)} not as promised")
    sys.exit(1 if bench.failures else 0)


if __name__ == "__main__":
    main()
