#!/usr/bin/env python3
"""A sweep as Slurm jobs on two nodes of one machine, of which one is killed, and a renderer too: in the end everything is as a
single process makes it. Munge and Slurm run on loopback, in a folder of their own. Full level only."""

import json
import os
import pathlib
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

sys.path.append(str(pathlib.Path(__file__).resolve().parent.parent / "faults"))
import tiny

PROGRAMS = ["munged", "slurmctld", "slurmd", "sbatch", "squeue", "scontrol"]
EXPERIMENT = dict(tiny.EXPERIMENT, budget={"spp": 20000}, replicates=4, sweep={"max_depth": [2, 3]},
                  reference=dict(tiny.EXPERIMENT["reference"], budget={"spp": 20000}, part={"spp": 5000}))

CONFIGURATION = """
ClusterName=ulam
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller}
AuthType=auth/munge
AuthInfo=socket={folder}/munge.socket
SlurmUser=root
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool-%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd-%n.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd-%n.log
ProctrackType=proctrack/pgid
TaskPlugin=task/none
MpiDefault=none
SwitchType=switch/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SchedulerParameters=sched_interval=1,batch_sched_delay=0
SlurmdParameters=config_overrides
SlurmdTimeout=10
KillWait=5
ReturnToService=2
NodeName=n1 NodeHostname={host} NodeAddr=127.0.0.1 Port={n1} CPUs=2
NodeName=n2 NodeHostname={host} NodeAddr=127.0.0.1 Port={n2} CPUs=2
PartitionName=all Nodes=n1,n2 Default=YES MaxTime=60 State=UP
"""


def why_not():
    """Why the test cannot run here; nothing: it can."""
    if not tiny.FULL:
        return "Slurm is not tried: it is at the full level only"
    missing = [name for name in PROGRAMS if not shutil.which(name, path=os.environ["PATH"] + ":/usr/sbin")]
    if missing:
        return f"Slurm is not tried: no {', '.join(missing)} here (packages slurm-wlm and munge)"
    if os.geteuid() != 0:
        return "Slurm is not tried: its controller is started by root only"
    return None


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for s in sockets:
        s.bind(("127.0.0.1", 0))
    ports = [s.getsockname()[1] for s in sockets]
    for s in sockets:
        s.close()
    return ports


def environment_of(place):
    try:
        return set((place / "environ").read_bytes().split(b"\0"))
    except OSError:  # it has ended
        return set()


def parent_of(process):
    try:
        return int(pathlib.Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[1])
    except OSError:
        return None


def name_of(process):
    try:
        return pathlib.Path(f"/proc/{process}/comm").read_text().strip()
    except OSError:
        return None


def kill(process):
    try:
        os.kill(process, signal.SIGKILL)
    except ProcessLookupError:
        pass


class Cluster:
    """Daemons in the foreground, children of this process."""

    def __init__(self, folder):
        self.folder, self.daemons = folder, []
        (folder / "state").mkdir()
        (folder / "munge.key").write_bytes(os.urandom(128))
        (folder / "munge.key").chmod(0o600)
        controller, n1, n2 = free_ports(3)
        configuration = CONFIGURATION.format(host=socket.gethostname().split(".")[0], folder=folder, controller=controller, n1=n1, n2=n2)
        (folder / "slurm.conf").write_text(configuration)
        self.environment = dict(os.environ, SLURM_CONF=str(folder / "slurm.conf"), PATH=os.environ["PATH"] + ":/usr/sbin")
        self.start("munged", "--foreground", "--force", f"--key-file={folder}/munge.key", f"--socket={folder}/munge.socket",
                   f"--pid-file={folder}/munge.pid", f"--log-file={folder}/munge.log", f"--seed-file={folder}/munge.seed")
        self.wait_for(lambda: (folder / "munge.socket").exists())
        self.start("slurmctld", "-D")
        self.nodes = {}
        for node in ("n1", "n2"):
            self.start_node(node)

    def start(self, *command):
        with open(self.folder / f"{command[0]}-{len(self.daemons)}.log", "w") as log:
            process = subprocess.Popen(command, env=self.environment, stdout=log, stderr=log, start_new_session=True)
        self.daemons.append(process)
        return process

    def start_node(self, node):
        self.nodes[node] = self.start("slurmd", "-D", "-N", node)

    def kill_node(self, node):
        """A node that fails takes with it what runs there; here it is one machine with the other."""
        self.nodes[node].kill()
        self.nodes[node].wait()
        mine = {f"SLURM_CONF={self.folder}/slurm.conf".encode(), f"SLURMD_NODENAME={node}".encode()}
        jobs = [int(place.name) for place in pathlib.Path("/proc").iterdir() if place.name.isdigit() and mine <= environment_of(place)]
        # First those who would report the others' end.
        watchers = {parent_of(job) for job in jobs} - set(jobs) - {None}
        for process in [*(w for w in watchers if name_of(w) == "slurmstepd"), *jobs]:
            kill(process)

    def call(self, *command):
        return subprocess.run(command, env=self.environment, capture_output=True, text=True, check=False).stdout

    def wait_for(self, condition, seconds=120):
        end = time.monotonic() + seconds
        while not condition():
            if time.monotonic() > end:
                logs = "\n".join(f"{log.name}: {log.read_text(errors='replace')[-1500:]}" for log in self.folder.glob("*.log"))
                raise AssertionError(f"waited in vain\n{self.call('squeue', '--array')}{self.call('sinfo')}{logs}")
            time.sleep(0.2)

    def idle_nodes(self):
        return self.call("sinfo", "--noheader", "--Node", "--states=idle", "--format=%N").split()

    def stop(self):
        self.call("scancel", "--me", "--signal=KILL", "--full")
        self.call("scancel", "--me")
        for process in reversed(self.daemons):
            if process.poll() is None:
                process.terminate()
                try:
                    process.wait(10)
                except subprocess.TimeoutExpired:
                    process.kill()
                    process.wait()


class Slurm(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory(prefix="ulam-slurm-", ignore_cleanup_errors=True)
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name).resolve()
        (self.folder / "slurm").mkdir()
        self.cluster = Cluster(self.folder / "slurm")
        self.addCleanup(self.cluster.stop)
        self.cluster.wait_for(lambda: len(self.cluster.idle_nodes()) == 2)

    def ulam(self, *arguments, expect=0):
        process = tiny.call(arguments, self.folder, {key: self.cluster.environment[key] for key in ("SLURM_CONF", "PATH")})
        self.assertEqual(process.returncode, expect, f"{arguments}\n{process.out}\n{process.err}")
        return process

    def submit(self, *more, jobs="slurm:task-minutes=0.02"):
        return json.loads(self.ulam("run", "tiny.json", "-o", "run", "--threads", 1, "--quiet", "--lease", 10, "--jobs", jobs, "--json", *more).out)

    def status(self):
        return json.loads(self.ulam("status", "run", "--json").out)

    def queue(self):
        return self.cluster.call("squeue", "--noheader", "--array", "--format=%F_%K %T %N").splitlines()

    def jobs(self):
        """The states of all tasks, by kind of array, and what could not be asked."""
        slurm = self.status()["slurm"]
        return {array["kind"]: {(group["state"], group["reason"]): group["tasks"] for group in array["states"]}
                for array in slurm["arrays"]}, slurm["trouble"]

    def renderers(self):
        """Processes that have a lease."""
        found = []
        for lease in self.folder.glob("run/**/lease-*"):
            try:
                found.append(json.loads(lease.read_text())["process"])
            except (OSError, ValueError):  # released, or just made
                pass
        return found

    def test_a_sweep_survives_a_node_and_a_renderer(self):
        tiny.write_inputs(self.folder, EXPERIMENT)
        self.ulam("run", "tiny.json", "-o", "alone", "--threads", 1, "--quiet")
        shutil.rmtree(self.folder / "cache")

        arrays = self.submit()
        self.assertEqual([array["kind"] for array in arrays], ["references", "cells"])
        self.assertEqual([array["replicates"] for array in arrays], [8, 16])
        self.assertGreater(arrays[1]["tasks"], 1)
        # What waits in the queue is not submitted again.
        self.assertEqual(self.submit("--resume"), [])

        # A renderer is killed, and then a node with what runs on it.
        self.cluster.wait_for(self.renderers)
        kill(self.renderers()[0])
        self.cluster.wait_for(lambda: any("RUNNING n2" in line for line in self.queue()))
        self.cluster.kill_node("n2")
        self.cluster.wait_for(lambda: "down" in self.cluster.call("sinfo", "--noheader", "--Node", "--nodes=n2", "--format=%T"))
        # The queue empties: on the other node, and on this one when it is back.
        self.cluster.start_node("n2")
        self.cluster.wait_for(lambda: not self.queue(), seconds=900)

        # What is missing in spite of all is submitted again, and only that.
        missing = 16 - self.status()["totals"]["done"]
        again = self.submit("--resume")
        self.assertEqual(sum(array["replicates"] for array in again if array["kind"] == "cells"), missing)
        self.cluster.wait_for(lambda: not self.queue(), seconds=900)
        self.assertEqual(self.status()["totals"]["done"], 16, self.status())

        self.ulam(*tiny.run_arguments("--resume"))
        alone, run = tiny.files(self.folder / "alone"), tiny.files(self.folder / "run")
        self.assertEqual(sorted(alone), sorted(name for name in run if not name.startswith("jobs/")))
        for name, data in alone.items():
            if name.endswith(".exr"):
                self.assertEqual(run[name], data, name)
        summaries = [tiny.without_times(json.loads(files["summary.json"])) for files in (alone, run)]
        self.assertEqual(*summaries)

    def test_status_asks_the_queue_and_until_adds_to_it(self):
        experiment = dict(tiny.EXPERIMENT, replicates=4, snapshots=0, samplers={"path": {"type": "path"}, "again": {"type": "path"}},
                          until={"relative_ci": 0.001, "max_replicates": 8}, reference=dict(tiny.EXPERIMENT["reference"], budget={"spp": 4096}))
        tiny.write_inputs(self.folder, experiment)
        (held, _) = self.submit(jobs="slurm:hold")
        states, trouble = self.jobs()
        self.assertEqual(states, {"references": {("PENDING", "JobHeldUser"): [0]}, "cells": {("PENDING", "JobHeldUser"): [0]}})
        self.assertEqual(trouble, [])
        self.assertEqual(self.submit("--resume"), [])
        for array in self.status()["slurm"]["arrays"]:
            self.cluster.call("scontrol", "release", array["job"])
        self.cluster.wait_for(lambda: not self.queue())
        self.assertEqual(self.jobs()[0], {kind: {("COMPLETED", ""): [0]} for kind in ("references", "cells")})

        # A look is due. The task of what it adds fails once, for it does not find what it should do.
        (more,) = self.submit("--resume", jobs="slurm:hold")
        self.assertEqual((more["kind"], more["replicates"]), ("cells", 8))
        share = self.folder / "run/jobs/003/tasks.json"
        hidden = share.rename(self.folder / "tasks.json")
        self.cluster.call("scontrol", "release", more["job"])
        self.cluster.wait_for(lambda: not self.queue())
        hidden.rename(share)
        self.assertEqual(self.status()["slurm"]["arrays"][2]["states"], [{"state": "FAILED", "reason": "NonZeroExitCode", "tasks": [0]}])
        self.submit("--resume")
        self.cluster.wait_for(lambda: not self.queue())
        self.assertEqual(self.status()["totals"]["done"], 16)
        self.assertEqual(self.submit("--resume"), [])

        # The controller does not answer any more, and there is no accounting.
        self.cluster.daemons[1].terminate()
        self.cluster.daemons[1].wait()
        process = self.ulam("status", "run")
        self.assertIn("16 replicates: 16 done\n", process.out)
        self.assertIn(f"UNKNOWN: {held['job']}_[0]\n", process.out)
        self.assertIn("\nsqueue does not tell what becomes of the jobs: ", process.out)
        self.assertIn("\nsacct does not tell what becomes of the jobs: ", process.out)

    def test_timed_cells_get_their_nodes_for_themselves(self):
        experiment = dict(tiny.EXPERIMENT, budget={"time": 0.2}, reference={"image": "lit.exr", "variance": "lit.exr"})
        tiny.write_inputs(self.folder, experiment)
        self.ulam("render", "scene.json", "--sampler", "path", "--spp", 16, "-o", "lit.exr", "--quiet")
        self.submit(jobs="slurm:hold,comment=two words")
        (job,) = self.folder.glob("run/jobs/*/job.json")
        number = json.loads(job.read_text())["job"]
        shown = self.cluster.call("scontrol", "show", "job", number)
        self.assertIn("OverSubscribe=NO", shown)
        self.assertIn("Comment=two words", shown)
        self.cluster.call("scontrol", "release", number)
        self.cluster.wait_for(lambda: not self.queue())
        self.assertEqual(self.status()["totals"]["done"], 4)
        result = json.loads((self.folder / "run/cells/wall-path/r000/result.json").read_text())
        self.assertEqual((result["host"], result["threads"]), (socket.gethostname(), 2))

    def test_what_sbatch_refuses_is_told(self):
        tiny.write_inputs(self.folder)
        err = self.ulam("run", "tiny.json", "-o", "run", "--threads", 1, "--quiet", "--jobs", "slurm:partition=none", expect=2).err
        self.assertIn("sbatch refuses the job", err)
        self.assertIn("invalid partition", err)


if __name__ == "__main__":
    reason = why_not()
    if reason:
        print(reason)
        sys.exit(0)
    unittest.main()
