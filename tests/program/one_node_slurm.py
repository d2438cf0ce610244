"""A Slurm of one node on loopback, with its own keys, ports and folders: for tests, as root, where Debian's packages munge,
slurmctld and slurmd are installed."""
import os
import shutil
import socket
import subprocess
import time

PROGRAMS = ["munged", "slurmctld", "slurmd", "sbatch", "sinfo"]


def why_not():
    """Why it cannot be started here; None where it can."""
    missing = [name for name in PROGRAMS if not shutil.which(name)]
    if missing:
        return "it needs " + ", ".join(missing) + " (packages munge, slurmctld, slurmd, slurm-client)"
    if os.geteuid() != 0:
        return "only root may start slurmd"
    return None


def free_port():
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return one.getsockname()[1]


class OneNodeSlurm:
    """Runs from entering to leaving; `environment` is what leads sbatch to it."""

    def __init__(self, folder):
        self.folder = folder
        self.children = []

    def path(self, name):
        return os.path.join(self.folder, name)

    def __enter__(self):
        os.makedirs(self.folder, mode=0o755)
        os.chmod(self.folder, 0o755)
        for name in ("state", "spool"):
            os.mkdir(self.path(name))
        with open(self.path("munge.key"), "wb") as key:
            key.write(os.urandom(1024))
        os.chmod(self.path("munge.key"), 0o400)
        host = socket.gethostname().split(".")[0]
        with open(self.path("slurm.conf"), "w") as conf:
            conf.write("\n".join([
                "ClusterName=one", f"SlurmctldHost={host}(127.0.0.1)", "SlurmUser=root", "AuthType=auth/munge",
                f"AuthInfo=socket={self.path('munge.socket')}", f"StateSaveLocation={self.path('state')}",
                f"SlurmdSpoolDir={self.path('spool')}", f"SlurmctldPort={free_port()}", f"SlurmdPort={free_port()}",
                f"SlurmctldPidFile={self.path('slurmctld.pid')}", f"SlurmdPidFile={self.path('slurmd.pid')}",
                "ProctrackType=proctrack/pgid", "TaskPlugin=task/none", "MpiDefault=none", "ReturnToService=2",
                "SelectType=select/cons_tres", "SelectTypeParameters=CR_CPU", "SlurmdParameters=config_overrides",
                "MailProg=/bin/true", f"NodeName={host} NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN",
                f"PartitionName=all Nodes={host} Default=YES State=UP", ""]))
        self.environment = dict(os.environ, SLURM_CONF=self.path("slurm.conf"))
        self.start("munged", "--foreground", "--force", "--num-threads=2", "--key-file=" + self.path("munge.key"),
                   "--socket=" + self.path("munge.socket"), "--pid-file=" + self.path("munged.pid"),
                   "--log-file=" + self.path("munged.log"), "--seed-file=" + self.path("munge.seed"))
        self.wait(lambda: os.path.exists(self.path("munge.socket")), "munged")
        self.start("slurmctld", "-D", "-f", self.path("slurm.conf"), "-L", self.path("slurmctld.log"))
        self.start("slurmd", "-D", "-f", self.path("slurm.conf"), "-N", host, "-L", self.path("slurmd.log"))
        self.wait(lambda: b"idle" in subprocess.run(["sinfo", "-h", "-o", "%T"], env=self.environment,
                                                    capture_output=True).stdout, "slurmctld or slurmd")
        return self

    def start(self, *words):
        log = open(self.path(words[0] + ".out"), "wb")
        self.children.append(subprocess.Popen(words, stdout=log, stderr=log, env=self.environment))

    def wait(self, ready, who):
        for _ in range(240):
            if ready():
                return
            time.sleep(0.5)
        self.__exit__()
        raise RuntimeError(f"{who} did not start; see its log in {self.folder}")

    def __exit__(self, *_):
        for child in reversed(self.children):
            child.terminate()
            try:
                child.wait(30)
            except subprocess.TimeoutExpired:
                child.kill()
                child.wait()
        self.children = []
