"""sweep --launcher slurm, with a Slurm of its own."""

import os
import pathlib
import signal
import subprocess

import program
from program import Terminal, run, wait_until
from slurm_cluster import Cluster
from sweep_test import MORE, SweepTest

# Long enough to do something while it runs.
SLOW = """
board: fpl2003
run: {source: preloaded, frames: 20000}
vary:
  matcher.window: [5, 7]
  matcher.disparities: {from: 10, to: 19, step: 1}
"""
SLOW_POINTS = 20
ALL_DONE = f"{SLOW_POINTS} points: {SLOW_POINTS} ok, 0 impossible"

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
        self.slow = self.file("slow.yaml", SLOW)
        self.addCleanup(self.end_jobs)

    def end_jobs(self):
        cluster.say("scancel", f"--user={os.getuid()}")
        wait_until(lambda: not cluster.jobs())
        wait_until(lambda: not self.programs(""))  # workers can outlive their job for a moment

    def command(self, *more, plan=None):
        shards = [] if "--shards" in more else ["--shards", 3]
        return ["sweep", plan or self.plan, "--out", self.store, "--launcher", "slurm", *shards, *more]

    def launch(self, *more, plan=None, environment=None):
        """The finished command."""
        return run(*self.command(*more, plan=plan), env=environment or cluster.environment)

    def begin(self, *more, plan=None):
        """The command, under way in a session of its own."""
        command = self.command(*more, plan=plan or self.slow)
        return self.start(*command, env=cluster.environment, start_new_session=True)

    def begin_points(self, *more, shard=0):
        """The slow sweep, once a shard has a point."""
        process = self.begin(*more)
        wait_until(lambda: self.points(self.shards / f"shard_{shard}.work") > 0)
        return process

    def finishes(self, process):
        """(standard output, standard error)."""
        out, errors = process.communicate(timeout=120)
        self.assertEqual(process.returncode, 0, errors)
        return out, errors

    def running(self):
        """The running tasks, {shard: job}."""
        return {shard: job for job, shard, state in cluster.jobs() if state == "RUNNING" and shard != "N/A"}

    def programs(self, pattern):
        """The processes of the tasks whose command line has this behind the plan."""
        command = ["pgrep", "--full", f"{self.shards}/plan.yaml.*{pattern}"]
        return [int(pid) for pid in subprocess.run(command, capture_output=True, text=True).stdout.split()]

    def local(self, plan):
        """The bytes of a sweep on this machine alone."""
        text = plan.read_bytes()
        if text not in self.local_stores:
            store = self.folder / "local.db"
            self.succeeds(self.sweep(plan=plan, store=store))
            self.local_stores[text] = store.read_bytes()
        return self.local_stores[text]

    def assert_whole(self, plan=None):
        """The database is that of a local sweep."""
        self.assertTrue(self.store.read_bytes() == self.local(plan or self.slow))
        self.assertFalse(self.shards.exists())


class Results(SlurmTest):
    def test_results_are_those_of_a_local_sweep(self):
        process = self.launch()
        said = self.succeeds(process)
        local = self.succeeds(self.sweep(store=self.folder / "local.db"))
        self.assertEqual(said, local.replace("local.db", "points.db"))
        job = r"stereotlm: note: job \d+: "
        self.assertRegex(process.stderr, rf"^{job}shards 0-2 of 3\n{job}the merge into \S+/points.db\n$")
        self.assert_whole(self.plan)
        more = self.file("more.yaml", MORE)  # is added, in more shards than there are points
        process = self.launch("--shards", 50, plan=more)
        self.assertIn("8 points: 2 ok, 2 impossible, 0 failed, 4 there already\n", self.succeeds(process))
        self.assertIn("shards 0-7 of 8\n", process.stderr)
        self.succeeds(self.sweep(plan=more, store=self.folder / "local.db"))
        self.assertTrue(self.store.read_bytes() == (self.folder / "local.db").read_bytes())

    def test_plan_board_and_tables_count_as_they_were_submitted(self):
        rig = self.copy_of_rig()
        board = self.file("board.yaml", "extends: fpl2003\nfpga: {clock_mhz: 50}\n")
        text = f"board: {board}\nrun: {{calibration: {rig}}}\nvary: {{matcher.disparities: [10, 19]}}\n"
        plan = self.file("mine.yaml", text)
        expected = self.local(plan)
        process = self.begin("--sbatch", "hold", plan=plan)
        wait_until(lambda: len({job for job, _, _ in cluster.jobs()}) == 2)
        for path in (plan, board, rig, self.folder / "rig_left.lut"):
            path.write_text("nonsense")
        for job in {job for job, _, _ in cluster.jobs()}:
            cluster.say("scontrol", "release", job)
        self.finishes(process)
        self.assertTrue(self.store.read_bytes() == expected)
        self.assertFalse(self.shards.exists())


class Progress(SlurmTest):
    def test_progress_is_shown(self):
        terminal = Terminal(self.command(plan=self.slow), columns=120, env=cluster.environment)
        terminal.read_until(r"/20 points.*, 2 running, 1 waiting \(\w+\)")
        terminal.read_until(r"[1-9]\d*/20 points, \d+:\d\d left, \d running")
        status, out = terminal.finish()
        self.assertEqual(status, 0)
        self.assertIn(ALL_DONE, out)
        self.assert_whole()

    def test_workers_use_the_processors_of_their_job(self):
        process = self.begin_points("--sbatch", "cpus-per-task=2")
        self.assertEqual(len(self.running()), 1)  # of two processors
        self.assertGreaterEqual(len(self.programs(" --jobs 2 ")), 3)  # the program and two workers
        self.close(process)


class LostShards(SlurmTest):
    def test_killed_shards_are_submitted_again(self):
        process = self.begin_points(shard=1)
        os.kill(min(self.programs("--shard 1/3")), signal.SIGKILL)
        _, errors = self.finishes(process)
        job = r"stereotlm: note: job \d+: "
        lost = r"note: lost: shard 1 \(FAILED\); submitting again\n"
        self.assertRegex(errors, rf"{lost}{job}shard 1 of 3\n{job}the merge into")
        self.assert_whole()


class Interrupted(SlurmTest):
    def test_an_interrupt_cancels_the_jobs_and_keeps_their_points(self):
        process = self.begin_points()
        os.killpg(process.pid, signal.SIGINT)
        out, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130, errors)
        self.assertRegex(out, r"20 points: [1-9]\d* ok, 0 impossible, 0 failed, \d+ not begun\n")
        note = "note: interrupted: run the same command to resume\n"
        self.assertTrue(errors.endswith(note), errors)
        self.assertEqual(cluster.jobs(), [])
        self.assertFalse(self.shards.exists())
        kept = self.points()
        self.assertGreater(kept, 0)
        self.assertIn(f"{kept} there already", self.succeeds(self.launch(plan=self.slow)))
        self.assert_whole()

    def test_more_shards_than_a_job_array_has_name_the_limit(self):
        many = self.file("many.yaml", SLOW.replace("to: 19", "to: 60"))  # 102 points
        self.refused_in_one_line(self.launch("--shards", 102, plan=many),
                                 "needs fewer --shards: each index is below MaxArraySize")

    def test_a_killed_command_given_again_waits_for_its_jobs(self):
        process = self.begin_points()
        self.refused_in_one_line(self.launch(plan=self.slow), "points.db.shards: another process waits")
        self.close(process)
        texts = ("points.db: jobs of another plan,", "scancel --name=sweep-")
        self.refused_in_one_line(self.launch(), *texts)
        before = {job for job, _, _ in cluster.jobs()}
        said = self.launch(plan=self.slow)
        self.assertIn(ALL_DONE, self.succeeds(said))
        jobs = ", ".join(sorted(before))
        self.assertTrue(said.stderr.startswith(f"stereotlm: note: the jobs are there already: {jobs}\n"))
        self.assert_whole()

    def test_the_jobs_of_a_killed_command_do_it_all(self):
        self.close(self.begin_points())
        wait_until(lambda: not cluster.jobs())
        self.assertTrue(self.store.read_bytes() == self.local(self.slow))
        said = self.launch(plan=self.slow)
        self.assertIn(ALL_DONE, self.succeeds(said))
        self.assertEqual(said.stderr, "")
        self.assert_whole()

    def test_another_plan_keeps_the_points_of_killed_jobs(self):
        self.close(self.begin_points())
        self.end_jobs()
        self.assertFalse(self.store.exists())
        one = self.file("one.yaml", SLOW.replace("[5, 7]", "[5]").replace("to: 19", "to: 10"))
        self.assertRegex(self.succeeds(self.launch(plan=one)), "1 points: .* 1 there already")
        self.assertGreaterEqual(self.points(), 1)


if __name__ == "__main__":
    program.main()
