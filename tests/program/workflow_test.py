#!/usr/bin/env python3
"""The Snakemake workflow makes the bytes of `glowworm convert`, in any number of jobs; goes on without a scan that cannot be
read and without a job of pairs that fails where it may; and goes on after its controller was killed.

    workflow_test.py GLOWWORM RUN.SH            at its smallest
    workflow_test.py GLOWWORM RUN.SH --full     1 and 64 jobs of tiles, -j1 and -j2 as well
    workflow_test.py GLOWWORM RUN.SH --slurm    on a Slurm of one node that it starts
"""
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

from one_node_slurm import OneNodeSlurm, why_not

SKIPPED = 77
FLAGS = ["--links", "4", "--depth", "5", "--poses", "trust"]


def write_box(path, seed):
    """A box seen from inside."""
    random.seed(seed)
    lines = []
    for _ in range(400):
        p = [random.uniform(-1, 1) for _ in range(3)]
        p[random.randrange(3)] = random.choice([-1.0, 1.0])
        lines.append("%.5f %.5f %.5f" % (3 * p[0], 2 * p[1], p[2]))
    with open(path, "w") as file:
        file.write("ply\nformat ascii 1.0\nelement vertex 400\nproperty float x\nproperty float y\nproperty float z\n"
                   "end_header\n" + "\n".join(lines) + "\n")


def content(path):
    with open(path, "rb") as file:
        return file.read()


class Bench:
    def __init__(self, program, run):
        self.program, self.run = os.path.abspath(program), os.path.abspath(run)
        self.folder = tempfile.mkdtemp(prefix="glowworm-workflow-")
        os.chdir(self.folder)
        os.mkdir("scans")
        for i in (1, 2, 10):
            write_box(f"scans/scan{i}.ply", i)
        pose = "[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]"
        with open("poses.json", "w") as file:
            entries = ",".join('{"file":"scan%d.ply","T_world_scan":%s}' % (i, pose) for i in (1, 2, 10))
            file.write('{"scans":[%s]}' % entries)
        self.flags = FLAGS + ["--poses", "poses.json"]

    def convert(self, output, scans):
        subprocess.run([self.program, "convert", *scans, "-o", output, *self.flags], check=True, capture_output=True)

    def workflow(self, output, cores, *config, program=None, more=()):
        return [self.run, f"-j{cores}", "--quiet", *more, "--config", "scans=scans", f"output={output}",
                f"glowworm={program or self.program}", "flags=" + " ".join(self.flags), *config]

    def same(self, made, expected, what):
        assert content(made) == content(expected), f"{what}: other bytes than `glowworm convert`"
        assert content(made + ".poses.json") == content(expected + ".poses.json"), f"{what}: other poses"
        assert not os.path.exists(made + ".work"), f"{what}: the work folder is left"

    def killed_controller(self):
        config = ["tile_jobs=3", "pair_jobs=2"]
        killed = subprocess.Popen(self.workflow("killed.svo", 2, *config), start_new_session=True)
        while killed.poll() is None and not os.path.exists("killed.svo.stages/ingest/00000.json"):
            time.sleep(0.05)
        os.killpg(killed.pid, signal.SIGKILL)
        killed.wait()
        # What the controller had started may live a moment longer; the workflow then says to wait.
        for _ in range(40):
            code = subprocess.run(self.workflow("killed.svo", 2, *config)).returncode
            if code != 7:
                break
            time.sleep(0.5)
        assert code == 0, f"after the controller was killed: exit code {code}"
        self.same("killed.svo", "whole.svo", "after the controller was killed")

    def failures(self):
        """A scan that cannot be read, and a job of pairs that dies."""
        with open("scans/scan2.ply", "w") as file:
            file.write("ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
                       "end_header\n1 2 3\n")
        with open("failing", "w") as file:
            file.write(f'#!/bin/sh\ncase "$1 $*" in pairs*--part*) echo "no pairs today" >&2; exit 1;; esac\n'
                       f'exec {self.program} "$@"\n')
        os.chmod("failing", 0o755)
        program = os.path.abspath("failing")
        subprocess.run(self.workflow("missing.svo", 1, "allow_missing=true", program=program), check=True)
        self.flags.append("--allow-missing-scans")
        self.convert("two.svo", ["scans/scan1.ply", "scans/scan10.ply"])
        self.same("missing.svo", "two.svo", "without the damaged scan")

    def any_number_of_jobs(self):
        for cores, tiles in [(1, 1), (2, 1), (1, 64), (2, 64)]:
            output = f"jobs{cores}-{tiles}.svo"
            subprocess.run(self.workflow(output, cores, f"tile_jobs={tiles}"), check=True)
            self.same(output, "whole.svo", f"-j{cores} in {tiles} jobs of tiles")

    def on_slurm(self):
        profile = os.path.join(os.path.dirname(self.run), "slurm")
        with OneNodeSlurm(os.path.join(self.folder, "slurm")) as slurm:
            words = self.workflow("slurm.svo", 4, "tile_jobs=2", "pair_jobs=2",
                                  more=["--profile", profile, "--max-threads", "2"])
            subprocess.run(words, check=True, env=slurm.environment)
        self.same("slurm.svo", "whole.svo", "on Slurm")


def main():
    how = sys.argv[3] if len(sys.argv) > 3 else ""
    if not shutil.which("snakemake"):
        print("skipped: the workflow needs snakemake")
        sys.exit(SKIPPED)
    if how == "--slurm" and why_not():
        print("skipped: a Slurm of one node cannot be started here, " + why_not())
        sys.exit(SKIPPED)
    bench = Bench(*sys.argv[1:3])
    try:
        bench.convert("whole.svo", ["scans"])
        if how == "--slurm":
            bench.on_slurm()
            return
        if how == "--full":
            bench.any_number_of_jobs()
        bench.killed_controller()
        bench.failures()
    finally:
        os.chdir("/")
        shutil.rmtree(bench.folder, ignore_errors=True)


if __name__ == "__main__":
    main()
