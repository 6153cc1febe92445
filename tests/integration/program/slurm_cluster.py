"""A Slurm cluster of one computer on loopback: munged, slurmctld and slurmd as root, without systemd and cgroups. Everything stands
in one folder, and the daemons are ended by their pid files."""
import contextlib
import os
import pathlib
import random
import shutil
import signal
import socket
import subprocess
import time

PROGRAMS = ("munged", "slurmctld", "slurmd", "sbatch", "squeue", "sinfo", "scontrol", "scancel")
CONFIGURATION = """ClusterName=vbar_test
SlurmctldHost={host}(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/munge/socket
CredType=cred/munge
SlurmctldPort={port}
CommunicationParameters=NoInAddrAny,NoCtldInAddrAny
StateSaveLocation={folder}/state
SlurmctldPidFile={folder}/slurmctld.pid
SlurmctldLogFile={folder}/log/slurmctld
SlurmdSpoolDir={folder}/spool/%n
SlurmdPidFile={folder}/slurmd.%n.pid
SlurmdLogFile={folder}/log/slurmd.%n
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerType=sched/backfill
SchedulerParameters=sched_interval=1,bf_interval=1,batch_sched_delay=0,sched_min_interval=0
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
MaxArraySize={max_array_size}
MinJobAge=300
ReturnToService=2
KillWait=5
MailProg=/bin/true
SlurmdTimeout=30
"""


def why_not():
    """Why there can be no cluster here, or None."""
    for program in PROGRAMS:
        if shutil.which(program) is None:
            return f"{program} is not installed (ci/install.sh peers)"
    return None if os.geteuid() == 0 else "Slurm's daemons need root"


class Cluster:
    """Environment: of programs that are to find this cluster."""

    def __init__(self, folder, nodes, processors, max_array_size=10001):
        self.folder = folder
        self.nodes = [f"node{k}" for k in range(1, nodes + 1)]
        for inner in ("state", "log", "munge", *(f"spool/{node}" for node in self.nodes)):
            (folder / inner).mkdir(parents=True)
        (folder / "munge").chmod(0o700)
        key = folder / "munge/key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o600)
        host = socket.gethostname().split(".")[0]
        port = random.randrange(20000, 40000)
        lines = [CONFIGURATION.format(host=host, folder=folder, port=port, max_array_size=max_array_size)]
        lines += [f"NodeName={node} NodeHostname={host} NodeAddr=127.0.0.1 Port={port + k} CPUs={processors} State=UNKNOWN\n"
                  for k, node in enumerate(self.nodes, 1)]
        lines += ["PartitionName=all Nodes=ALL Default=YES MaxTime=INFINITE State=UP\n"]
        (folder / "slurm.conf").write_text("".join(lines))
        self.environment = os.environ | {"SLURM_CONF": str(folder / "slurm.conf")}

    def start_daemon(self, *command):
        subprocess.run(command, env=self.environment, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                       stderr=(self.folder / "log/start").open("a"), timeout=60, check=True)

    def start_node(self, node):
        self.start_daemon("slurmd", "-N", node)

    def start(self):
        munge = self.folder / "munge"
        self.start_daemon("munged", "--force", f"--socket={munge}/socket", f"--key-file={munge}/key", f"--pid-file={munge}/pid",
                          f"--log-file={self.folder}/log/munged", f"--seed-file={munge}/seed")
        self.start_daemon("slurmctld")
        for node in self.nodes:
            self.start_node(node)
        deadline = time.monotonic() + 60.0
        while self.ask("sinfo", "--noheader", "--states=idle", "--format=%D") != str(len(self.nodes)):
            if time.monotonic() > deadline:
                raise RuntimeError(f"no idle nodes after a minute: {self.folder}/log")
            time.sleep(0.05)

    def ask(self, *command):
        result = subprocess.run(command, env=self.environment, capture_output=True, text=True, timeout=30)
        return result.stdout.strip()

    def pid_of(self, name):
        """Of slurmctld, slurmd.node1, munge/pid; None if it does not run."""
        with contextlib.suppress(FileNotFoundError, ValueError):
            return int((self.folder / name).read_text())
        return None

    def stop(self):
        subprocess.run(["scancel", "--signal=KILL", "--user=root"], env=self.environment, capture_output=True, timeout=30)
        pids = [self.pid_of(name) for name in ("slurmctld.pid", *(f"slurmd.{node}.pid" for node in self.nodes), "munge/pid")]
        for pid in filter(None, pids):
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGTERM)
        deadline = time.monotonic() + 10.0
        for pid in filter(None, pids):
            while pathlib.Path(f"/proc/{pid}").exists() and time.monotonic() < deadline:
                time.sleep(0.02)
            with contextlib.suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)


@contextlib.contextmanager
def cluster(folder, nodes=1, processors=2, **keywords):
    one = Cluster(pathlib.Path(folder), nodes, processors, **keywords)
    try:
        one.start()
        yield one
    finally:
        one.stop()
