"""sweep --launcher slurm, with a Slurm of its own."""

import os
import pathlib
import re
import signal
import socket
import sqlite3
import subprocess
import time

import program
from interrupt_test import Terminal
from program import run
from slurm_cluster import Cluster
from sweep_test import PLAN, POINTS, SweepTest

SHARDS = 3
# Long enough to do something while it runs.
SLOW = """
board: fpl2003
run: {source: preloaded, frames: 20000}
vary:
  matcher.window: [5, 7]
  matcher.disparities: {from: 10, to: 19, step: 1}
"""
SLOW_POINTS = 20

cluster = Cluster()


def setUpModule():
    cluster.start()


def tearDownModule():
    cluster.stop()


class SlurmTest(SweepTest):
    local_stores = {}  # bytes by plan

    def setUp(self):
        super().setUp()
        self.shards = pathlib.Path(f"{self.store}.shards")
        self.slow = self.file("slow.yaml", SLOW.encode())
        self.addCleanup(self.end_jobs)

    def end_jobs(self):
        cluster.say("scancel", "--state=PENDING", "--state=RUNNING", f"--user={os.getuid()}")
        self.wait_until(lambda: not cluster.jobs())

    def wait_until(self, is_so, seconds=60):
        end = time.monotonic() + seconds
        while not is_so():
            self.assertLess(time.monotonic(), end, "not in time")
            time.sleep(0.05)

    def command(self, *more, plan=None):
        shards = [] if "--shards" in more else ["--shards", SHARDS]
        return ["sweep", plan or self.plan, "--out", self.store, "--launcher", "slurm", *shards, *more]

    def launch(self, *more, plan=None, environment=None):
        """The finished command."""
        return run(*self.command(*more, plan=plan), env=environment or cluster.environment)

    def start(self, *more, plan=None):
        """The command, under way in a session of its own."""
        command = [program.PROGRAM] + [str(word) for word in self.command(*more, plan=plan)]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                   env=cluster.environment, start_new_session=True)
        self.addCleanup(self.close, process)
        return process

    @staticmethod
    def close(process):
        process.kill()
        process.communicate()

    def finishes(self, process):
        """(standard output, standard error)."""
        out, errors = process.communicate(timeout=120)
        self.assertEqual(process.returncode, 0, errors)
        return out, errors

    def running(self):
        """The running tasks, {shard: job}."""
        return {shard: job for job, shard, state in cluster.jobs() if state == "RUNNING" and shard != "N/A"}

    def wait_for_points(self, shard=0):
        """Until a shard has a point."""
        def has_points():
            try:
                return self.query("SELECT count(*) FROM points", self.shards / f"shard_{shard}.work")[0][0] > 0
            except sqlite3.OperationalError:
                return False  # not there yet
        self.wait_until(has_points)

    def local(self, plan):
        """The bytes of a sweep on this machine alone."""
        text = plan.read_bytes()
        if text not in self.local_stores:
            store = self.folder / "local.db"
            self.succeeds(self.sweep(plan=plan, store=store))
            self.local_stores[text] = store.read_bytes()
        return self.local_stores[text]

    def assert_whole(self, plan):
        self.assertEqual(self.store.read_bytes(), self.local(plan))
        self.assertFalse(self.shards.exists())


class Results(SlurmTest):
    def test_are_those_of_a_local_sweep(self):
        process = self.launch()
        said = self.succeeds(process)
        self.assertEqual(said, self.succeeds(self.sweep(store=self.folder / "local.db")).replace("local.db", "points.db"))
        self.assertRegex(process.stderr, r"^stereotlm: note: job \d+: shards 0-2 of 3\n"
                                         r"stereotlm: note: job \d+: the merge into \S+/points.db\n$")
        self.assert_whole(self.plan)

    def test_are_added_to_a_database(self):
        self.succeeds(self.sweep())
        more = self.file("more.yaml", PLAN.replace("[3, 5, 7]", "[3, 5, 7, 9]").encode())
        said = self.succeeds(self.launch(plan=more))
        self.assertIn(f"16 points: 2 ok, 2 impossible, 0 failed, {POINTS} there already\n", said)
        self.assert_whole(more)

    def test_of_fewer_points_than_shards(self):
        few = self.file("few.yaml", PLAN.replace("[3, 5, 7]", "[3]").encode())
        self.assertIn("shards 0-3 of 4\n", self.launch("--shards", 50, plan=few).stderr)
        self.assert_whole(few)

    def test_are_of_what_was_submitted(self):
        board = self.file("board.yaml", b"extends: fpl2003\nfpga: {clock_mhz: 50}\n")
        text = SLOW.replace("board: fpl2003", f"board: {board}")
        plan = self.file("mine.yaml", text.encode())
        process = self.start(plan=plan)
        self.wait_until(lambda: cluster.jobs())
        board.write_text("extends: fpl2003\nfpga: {clock_mhz: 60}\n")
        plan.write_text("nonsense")
        out, _ = self.finishes(process)
        self.assertIn(f"{SLOW_POINTS} points: {SLOW_POINTS} ok", out)
        self.assertEqual(self.query('SELECT DISTINCT "fpga.clock_mhz" FROM points'), [(50,)])
        board.write_text("extends: fpl2003\nfpga: {clock_mhz: 50}\n")
        plan.write_text(text)
        self.assert_whole(plan)

    def test_are_of_a_calibration_as_it_was_submitted(self):
        rig = self.folder / "rig.yaml"
        self.succeeds(run("calibrate", "--synthetic", 3, "--grid", "9x6", "--square-mm", 25, "--out", rig))
        text = f"board: fpl2003\nrun: {{calibration: {rig}}}\nvary: {{matcher.disparities: {{from: 10, to: 19, step: 1}}}}\n"
        plan = self.file("rig_plan.yaml", text.encode())
        expected = self.local(plan)
        process = self.start(plan=plan)
        self.wait_until(lambda: cluster.jobs())
        table = self.folder / "rig_left.lut"
        before = table.read_bytes()
        table.write_bytes(b"damaged")
        self.finishes(process)
        self.assertEqual(self.store.read_bytes(), expected)
        self.assertFalse(self.shards.exists())
        table.write_bytes(before)

    def test_use_the_processors_of_their_jobs(self):
        process = self.start("--sbatch", "cpus-per-task=2", plan=self.slow)
        self.wait_for_points()
        (shard,) = self.running()  # of two processors
        workers = subprocess.run(["pgrep", "--full", f"{self.shards}/plan.yaml.* --jobs 2 "], capture_output=True, text=True)
        self.assertGreaterEqual(len(workers.stdout.split()), 3)  # shell or not: the program and two workers
        self.finishes(process)
        self.assert_whole(self.slow)


class Progress(SlurmTest):
    def test_is_shown(self):
        terminal = Terminal(self.command(plan=self.slow), columns=120, env=cluster.environment)
        terminal.read_until(re.compile(r"/20 points   .* left   2 running, 1 waiting \(\w+\)"), seconds=60)
        terminal.read_until(re.compile(r"[1-9]\d*/20 points   \d+\.\d %   \d+\.\d points/s   \d+:\d\d left   \d running"),
                            seconds=60)
        status, out = terminal.finish()
        self.assertEqual(status, 0)
        self.assertIn("20 points: 20 ok, 0 impossible", out)


class LostShards(SlurmTest):
    def submitted_again(self, process, shard, end):
        _, errors = self.finishes(process)
        self.assertRegex(errors, rf"note: lost: shard {shard} \({end}\); submitting again\n"
                                 rf"stereotlm: note: job \d+: shard {shard} of 3\n"
                                 r"stereotlm: note: job \d+: the merge into")
        self.assert_whole(self.slow)

    def test_cancelled(self):
        process = self.start(plan=self.slow)
        self.wait_for_points(shard=0)
        cluster.say("scancel", f"{self.running()['0']}_0")
        self.submitted_again(process, 0, "CANCELLED")

    def test_killed(self):
        process = self.start(plan=self.slow)
        self.wait_for_points(shard=1)
        found = subprocess.run(["pgrep", "--full", "--oldest", f"sweep {self.shards}/plan.yaml .*--shard 1/3"],
                               capture_output=True, text=True)
        os.kill(int(found.stdout), signal.SIGKILL)
        self.submitted_again(process, 1, "FAILED")


class Refusals(SlurmTest):
    def refused_and_left_nothing(self, process, *texts):
        self.refused_in_one_line(process, *texts)
        self.assertEqual([path.name for path in self.folder.glob("points.db*")], [])
        self.assertEqual(cluster.jobs(), [])

    def test_in_the_words_of_slurm(self):
        self.refused_and_left_nothing(
            self.launch("--sbatch", "partition=nope"),
            "error: --launcher slurm: sbatch: invalid partition specified: nope; Batch job submission failed: Invalid "
            "partition name specified")
        many = self.file("many.yaml", PLAN.replace("[3, 5, 7]", "[3]\n  matcher.disparities: {from: 1, to: 50, step: 1}").encode())
        self.refused_and_left_nothing(self.launch("--shards", 200, plan=many), "sbatch: ", "Invalid job array specification")

    def test_keep_the_database(self):
        self.succeeds(self.sweep())
        before = self.store.read_bytes()
        self.refused(self.launch("--sbatch", "partition=nope"), "nope")
        self.assertEqual(self.store.read_bytes(), before)
        self.assertFalse(self.shards.exists())

    def test_without_a_controller(self):
        with socket.socket() as unused:
            unused.bind(("127.0.0.1", 0))
            text = re.sub("SlurmctldPort=.*", f"SlurmctldPort={unused.getsockname()[1]}",
                          (cluster.folder / "slurm.conf").read_text())
            config = self.file("slurm.conf", text.encode())
            self.refused_and_left_nothing(self.launch(environment=dict(cluster.environment, SLURM_CONF=str(config))),
                                          "squeue: ", "Unable to contact slurm controller")


class Interrupted(SlurmTest):
    def test_by_the_keyboard_it_cancels_and_goes_on_later(self):
        process = self.start(plan=self.slow)
        self.wait_for_points()
        os.killpg(process.pid, signal.SIGINT)
        out, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130, errors)
        self.assertRegex(out, r"20 points: [1-9]\d* ok, 0 impossible, 0 failed, \d+ not begun\n")
        self.assertTrue(errors.endswith("note: interrupted: run the same command to resume\n"), errors)
        self.assertEqual(cluster.jobs(), [])
        self.assertFalse(self.shards.exists())
        kept = self.query("SELECT count(*) FROM points")[0][0]
        self.assertGreater(kept, 0)
        self.assertIn(f"{kept} there already", self.succeeds(self.launch(plan=self.slow)))
        self.assert_whole(self.slow)

    def test_when_killed_the_same_command_waits_for_the_jobs(self):
        process = self.start(plan=self.slow)
        self.wait_for_points()
        self.refused_in_one_line(self.launch(plan=self.slow), "points.db.shards: another process waits")
        self.close(process)
        self.refused_in_one_line(self.launch(), "points.db: jobs of another plan,", "scancel --name=sweep-")
        before = {job for job, _, _ in cluster.jobs()}
        said = self.launch(plan=self.slow)
        self.assertIn("20 points: 20 ok, 0 impossible", self.succeeds(said))
        self.assertEqual(said.stderr, f"stereotlm: note: the jobs are there already: {', '.join(sorted(before))}\n")
        self.assert_whole(self.slow)

    def test_when_killed_the_jobs_do_it_all(self):
        process = self.start(plan=self.slow)
        self.wait_for_points()
        self.close(process)
        self.wait_until(lambda: not cluster.jobs())
        self.assertEqual(self.store.read_bytes(), self.local(self.slow))
        said = self.launch(plan=self.slow)
        self.assertIn("20 points: 20 ok, 0 impossible", self.succeeds(said))
        self.assertEqual(said.stderr, "")
        self.assert_whole(self.slow)

    def test_when_all_is_killed_another_plan_keeps_the_points(self):
        process = self.start(plan=self.slow)
        self.wait_for_points()
        self.close(process)
        self.end_jobs()
        self.assertFalse(self.store.exists())
        other = self.file("other.yaml", SLOW.replace("[5, 7]", "[5]").encode())
        self.assertRegex(self.succeeds(self.launch(plan=other)), r"10 points: \d+ ok, .*, [1-9]\d* there already")
        self.assertIn("20 points", self.succeeds(self.launch(plan=self.slow)))
        self.assert_whole(self.slow)

    def test_a_restart_of_the_controller_is_waited_for(self):
        process = self.start(plan=self.slow)
        self.wait_for_points()
        cluster.end(cluster.daemons[1])
        self.assertEqual(process.stderr.readline()[:20], "stereotlm: note: job")
        self.assertEqual(process.stderr.readline()[:20], "stereotlm: note: job")
        self.assertRegex(process.stderr.readline(), "note: squeue: .*: asking again")
        cluster.start_controller()
        self.finishes(process)
        self.assert_whole(self.slow)


if __name__ == "__main__":
    program.main()
