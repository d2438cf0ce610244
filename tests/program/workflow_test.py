#!/usr/bin/env python3
"""The Snakemake workflow makes the bytes of `glowworm convert`, goes on without a scan that cannot be read where it may,
and goes on after its controller was killed.

    workflow_test.py GLOWWORM RUN.SH
"""
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

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


def main():
    program, run = map(os.path.abspath, sys.argv[1:3])
    if not shutil.which("snakemake"):
        print("skipped: the workflow needs snakemake")
        sys.exit(SKIPPED)
    folder = tempfile.mkdtemp(prefix="glowworm-workflow-")
    os.chdir(folder)
    os.mkdir("scans")
    for i in (1, 2, 10):
        write_box(f"scans/scan{i}.ply", i)
    pose = "[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]"
    with open("poses.json", "w") as file:
        entries = ",".join('{"file":"scan%d.ply","T_world_scan":%s}' % (i, pose) for i in (1, 2, 10))
        file.write('{"scans":[%s]}' % entries)
    flags = FLAGS + ["--poses", "poses.json"]

    def convert(output, scans):
        subprocess.run([program, "convert", *scans, "-o", output, *flags], check=True, capture_output=True)

    def workflow(output, cores, *config):
        return [run, f"-j{cores}", "--quiet", "--config", "scans=scans", f"output={output}", f"glowworm={program}",
                "flags=" + " ".join(flags), *config]

    def same(made, expected, what):
        assert content(made) == content(expected), f"{what}: other bytes than `glowworm convert`"
        assert content(made + ".poses.json") == content(expected + ".poses.json"), f"{what}: other poses"
        assert not os.path.exists(made + ".work"), f"{what}: the work folder is left"

    try:
        convert("whole.svo", ["scans"])
        killed = subprocess.Popen(workflow("killed.svo", 2), start_new_session=True)
        while killed.poll() is None and not os.path.exists("killed.svo.stages/ingest/00000.json"):
            time.sleep(0.05)
        os.killpg(killed.pid, signal.SIGKILL)
        killed.wait()
        # What the controller had started may live a moment longer; the workflow then says to wait.
        for _ in range(40):
            code = subprocess.run(workflow("killed.svo", 2)).returncode
            if code != 7:
                break
            time.sleep(0.5)
        assert code == 0, f"after the controller was killed: exit code {code}"
        same("killed.svo", "whole.svo", "after the controller was killed")

        with open("scans/scan2.ply", "w") as file:
            file.write("ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
                       "end_header\n1 2 3\n")
        subprocess.run(workflow("missing.svo", 1, "allow_missing=true"), check=True)
        flags.append("--allow-missing-scans")
        convert("two.svo", ["scans/scan1.ply", "scans/scan10.ply"])
        same("missing.svo", "two.svo", "without the damaged scan")
    finally:
        os.chdir("/")
        shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    main()
