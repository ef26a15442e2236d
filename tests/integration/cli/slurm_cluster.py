"""A Slurm of one node for tests: munged, slurmctld and slurmd with files, a key and ports of their own.

They run as the user who runs the tests. Services of the machine are neither needed nor touched.
"""

import os
import pathlib
import pwd
import secrets
import shutil
import signal
import socket
import subprocess
import tempfile
import time

CPUS = 2  # that the node has for Slurm, however many the machine has

CONFIG = """\
ClusterName=test
SlurmctldHost=localhost
SlurmctldPort={controller_port}
SlurmdPort={node_port}
SlurmUser={user}
SlurmdUser={user}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=batch_sched_delay=0,sched_interval=1
ReturnToService=2
KillWait=2
MessageTimeout=2
MaxArraySize=101
NodeName=localhost CPUs={cpus} State=UNKNOWN
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
"""


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    try:
        for each in sockets:
            each.bind(("127.0.0.1", 0))
        return [each.getsockname()[1] for each in sockets]
    finally:
        for each in sockets:
            each.close()


class Cluster:
    """start() starts its daemons, stop() ends them. Slurm's commands reach it through `environment`."""

    def __init__(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="slurm_"))
        self.folder.chmod(0o755)  # munged refuses a socket that others could not reach
        self.environment = dict(os.environ, SLURM_CONF=str(self.folder / "slurm.conf"))
        self.daemons = []

    def start(self):
        try:
            self._write_files()
            self._start_munge()
            self.start_controller()
            self._spawn("slurmd", "-D", "-N", "localhost")
            self._wait_for("a node", lambda: self.say("sinfo", "--noheader", "--format=%T").strip() == "idle")
        except BaseException:
            self.stop()
            raise

    def stop(self):
        for daemon in reversed(self.daemons):
            self.end(daemon)
        shutil.rmtree(self.folder, ignore_errors=True)

    def start_controller(self):
        return self._spawn("slurmctld", "-D")

    def end(self, daemon):
        """With all processes that it has started."""
        self.daemons.remove(daemon)
        daemon.send_signal(signal.SIGTERM)
        try:
            daemon.wait(timeout=20)
        except subprocess.TimeoutExpired:
            daemon.kill()
            daemon.wait()

    def say(self, *command):
        """What a command of Slurm prints; empty if it fails."""
        pipes = {"capture_output": True, "text": True, "timeout": 60}
        return subprocess.run(command, env=self.environment, **pipes).stdout

    def jobs(self):
        """[job, index in its array, state] of each that has not come to its end."""
        text = self.say("squeue", "--noheader", "--array", "--format=%F %K %T")
        return [line.split() for line in text.splitlines()]

    def _write_files(self):
        for name in ("state", "spool"):
            (self.folder / name).mkdir()
        controller_port, node_port = free_ports(2)
        (self.folder / "slurm.conf").write_text(CONFIG.format(
            folder=self.folder, controller_port=controller_port, node_port=node_port,
            user=pwd.getpwuid(os.getuid()).pw_name, cpus=CPUS))
        key = self.folder / "munge.key"
        key.write_bytes(secrets.token_bytes(128))
        key.chmod(0o600)

    def _start_munge(self):
        names = {name: f"munge.{name}" for name in ("key", "socket", "pid", "log", "seed")}
        options = [f"--{name}-file={self.folder / path}" for name, path in names.items() if name != "socket"]
        options.append(f"--socket={self.folder / names['socket']}")
        # --force: the folders above are not checked for who else may write there.
        self._spawn("munged", "--foreground", "--force", *options)
        self._wait_for("munged", lambda: (self.folder / "munge.socket").exists())

    def _spawn(self, *command):
        path = shutil.which(command[0], path=f"{os.environ.get('PATH', '')}:/usr/sbin:/sbin")
        assert path, f"{command[0]}: not found; ./setup installs it"
        with open(self.folder / f"{command[0]}.out", "ab") as out:
            pipes = {"stdin": subprocess.DEVNULL, "stdout": out, "stderr": out}
            command = [path, *command[1:]]
            daemon = subprocess.Popen(command, env=self.environment, start_new_session=True, **pipes)
        self.daemons.append(daemon)
        return daemon

    def _wait_for(self, what, is_there, seconds=60):
        end = time.monotonic() + seconds
        while not is_there():
            if time.monotonic() > end or any(daemon.poll() is not None for daemon in self.daemons):
                logs = [f"{path.name}:\n{path.read_text(errors='replace')[-2000:]}" for path in
                        sorted(self.folder.glob("*.log")) + sorted(self.folder.glob("*.out"))]
                raise AssertionError(f"Slurm: no sign of {what}\n" + "\n".join(logs))
            time.sleep(0.05)
