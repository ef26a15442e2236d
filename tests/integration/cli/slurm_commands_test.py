"""sweep --launcher slurm where Slurm's commands fail, or what they submit does: with commands made for that."""

import os
import re
import signal
import subprocess

import program
from program import run
from sweep_test import SweepTest

# A job has come to its $END as soon as it is submitted, with what the commands $TASK or $MERGE do in $FOLDER, that of the
# shards.
SBATCH = """#!/bin/sh
echo "$@" >>"$FAKE/submitted"
job=$(wc -l <"$FAKE/submitted")
case "$*" in
*--array=*) echo "$job|0|$END|None" >>"$FAKE/queue"; eval "$TASK" ;;
*) echo "$job|N/A|$END|None" >>"$FAKE/queue"; eval "$MERGE" ;;
esac
echo "$job;cluster"
"""
SQUEUE = """#!/bin/sh
[ ! -e "$FAKE/queue" ] || cat "$FAKE/queue"
"""


class SlurmCommands(SweepTest):
    def setUp(self):
        super().setUp()
        self.commands = self.folder / "commands"
        self.commands.mkdir()
        self.write("squeue", SQUEUE)
        self.write("sbatch", SBATCH)
        self.write("scancel", '#!/bin/sh\necho "$@" >>"$FAKE/cancelled"\n')
        self.shards = self.folder / "points.db.shards"
        self.environment = dict(os.environ, PATH=f"{self.commands}:/usr/bin:/bin", FAKE=str(self.commands),
                                FOLDER=str(self.shards), END="FAILED", TASK="", MERGE="")

    def write(self, name, text):
        path = self.commands / name
        path.write_text(text)
        path.chmod(0o755)

    def launch(self, *more, **variables):
        return run("sweep", self.plan, "--out", self.store, "--launcher", "slurm", "--shards", 1, *more,
                   env=dict(self.environment, **variables))

    def submitted(self):
        return (self.commands / "submitted").read_text().splitlines()

    def failed(self, process, text):
        """After something was submitted; the notes before the error."""
        self.assertEqual(process.returncode, 1, process.stderr)
        *notes, error = process.stderr.splitlines()
        self.assertIn(text, error)
        return [note.replace("stereotlm: note: ", "") for note in notes]


class Options(SlurmCommands):
    def test_of_the_launcher(self):
        self.refused_in_one_line(self.sweep("--shards", 2), "--shards: goes with --launcher slurm")
        self.refused_in_one_line(self.sweep("--sbatch", "exclusive"), "--sbatch: goes with --launcher slurm")
        for shards in (0, 1001, "x", ""):
            self.refused_in_one_line(self.sweep("--launcher", "slurm", "--shards", shards),
                                     f"--shards = {shards}: must be 1..1000")
        for option, value in (("--jobs", 2), ("--shard", "0/2"), ("--known", "a.db"), ("--progress", "a")):
            self.refused_in_one_line(self.launch(option, value), f"{option}: not with --launcher slurm")

    def test_of_sbatch(self):
        for option in ("--partition=long", "p long", "", "=3", "-n"):
            self.refused_in_one_line(self.launch("--sbatch", option),
                                     f"--sbatch = {option}: must be a long option of sbatch without its dashes")
        for option in ("array=0-3", "wrap=true", "wait"):
            self.refused_in_one_line(self.launch("--sbatch", option), f"--sbatch = {option}: given by the launcher")
        self.launch("--sbatch", "exclusive", "--sbatch", "comment=a b")
        for line in self.submitted():
            self.assertTrue(line.startswith("--exclusive --comment=a b --job-name=sweep-"), line)


class Commands(SlurmCommands):
    def test_that_are_missing_are_named(self):
        for name in ("sbatch", "squeue"):
            (self.commands / name).unlink()
            self.refused_in_one_line(self.launch(PATH=str(self.commands)),
                                     f"error: --launcher slurm: {name}: not found in PATH; Slurm's commands sbatch, squeue "
                                     "and scancel are needed")
            self.assertEqual(list(self.folder.glob("points.db*")), [])

    def test_that_say_something_else(self):
        self.write("sbatch", "#!/bin/sh\necho usage\n")
        self.refused_in_one_line(self.launch(), "sbatch: no job number in its output: usage")
        self.write("squeue", "#!/bin/sh\necho JOBID PARTITION\n")
        self.refused_in_one_line(self.launch(), "squeue: unexpected output: JOBID PARTITION")
        self.write("squeue", "#!/bin/sh\nexit 3\n")
        self.refused_in_one_line(self.launch(), "squeue: has ended with status 3")
        self.assertEqual(list(self.folder.glob("points.db*")), [])

    def test_do_not_see_what_is_for_the_eyes(self):
        self.write("squeue", '#!/bin/sh\nenv | grep -e ^SQUEUE_ -e ^SBATCH_ >"$FAKE/variables"\nexit 1\n')
        self.launch(SQUEUE_PARTITION="other", SBATCH_PARTITION="long")
        self.assertEqual((self.commands / "variables").read_text(), "SBATCH_PARTITION=long\n")

    def test_a_merge_that_is_refused_takes_the_shards_along(self):
        self.write("sbatch", SBATCH.replace('echo "$job|N/A', 'echo "sbatch: error: too many jobs" >&2; exit 1 #'))
        lines = self.refused(self.launch(END="PENDING"), "error: --launcher slurm: sbatch: too many jobs")
        self.assertEqual(lines[:-1], ["stereotlm: note: job 1: shard 0 of 1"])
        self.assertEqual((self.commands / "cancelled").read_text(), "1\n")
        self.assertFalse(self.shards.exists())

    def test_that_keep_failing_end_the_waiting(self):
        self.write("squeue", SQUEUE + '[ ! -e "$FAKE/queue" ] || { echo "squeue: error: no answer" >&2; exit 1; }\n')
        notes = self.failed(self.launch(END="RUNNING"),
                            "error: squeue: no answer; the jobs continue; run the same command to wait for them")
        self.assertEqual(notes[2:], ["squeue: no answer: asking again"])
        self.assertTrue(self.shards.exists())


    def test_that_cannot_cancel_leave_the_jobs(self):
        self.write("scancel", "#!/bin/sh\necho 'scancel: error: no answer' >&2\nexit 1\n")
        command = [program.PROGRAM, "sweep", self.plan, "--out", self.store, "--launcher", "slurm"]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                   env=dict(self.environment, END="PENDING"))
        for _ in range(2):
            self.assertIn("note: job ", process.stderr.readline())
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=60)
        self.assertEqual(errors, "stereotlm: error: scancel: no answer; the jobs continue; run the same command to wait for them\n")
        self.assertEqual(process.returncode, 1)
        self.assertTrue(self.shards.exists())


class LostWork(SlurmCommands):
    def test_is_submitted_three_times(self):
        notes = self.failed(self.launch(TASK='echo no such thing >>"$FOLDER/shard_0.log"', END="OUT_OF_MEMORY"),
                            "error: shard 0 has been lost 3 times without a further point (OUT_OF_MEMORY); its log "
                            f"{self.shards}/shard_0.log ends with: no such thing; finished points are kept in {self.shards}: "
                            "run the same command to resume")
        self.assertEqual([re.sub(r"into .*", "", note) for note in notes], [
            "job 1: shard 0 of 1", "job 2: the merge ", "lost: shard 0 (OUT_OF_MEMORY); submitting again",
            "job 3: shard 0 of 1", "job 4: the merge ", "lost: shard 0 (OUT_OF_MEMORY); submitting again",
            "job 5: shard 0 of 1", "job 6: the merge ", "lost: shard 0 (OUT_OF_MEMORY); submitting no more"])

    def test_without_a_log_says_what_must_be_shared(self):
        self.failed(self.launch(END="COMPLETED"), f"(COMPLETED); there is no {self.shards}/shard_0.log: the nodes must share")

    def test_that_gets_further_is_not_given_up(self):
        further = 'echo "ok $job" >"$FOLDER/shard_0.progress"; [ "$job" -le 8 ] || touch "$FOLDER/shard_0.db"'
        done = '[ "$job" -le 8 ] || cp "$FOLDER/../other.db" "$FOLDER/../points.db"; touch "$FOLDER/merged"'
        self.succeeds(self.sweep(store=self.folder / "other.db"))
        process = self.launch(TASK=further, MERGE=done)
        self.assertIn("12 points: 9 ok", process.stdout)
        self.assertEqual(process.stderr.count("submitting again"), 4)
        self.assertFalse(self.shards.exists())

    def test_may_be_the_merge(self):
        done = 'touch "$FOLDER/shard_0.db"'
        notes = self.failed(self.launch(TASK=done, MERGE='echo disk full >"$FOLDER/merge.log"'),
                            "error: the merge has been lost 3 times without a further point (FAILED); its log "
                            f"{self.shards}/merge.log ends with: disk full;")
        self.assertEqual([note.split()[1] for note in notes], ["1:", "2:", "3:", "4:"])
        self.assertEqual([line.count("--array") for line in self.submitted()], [1, 0, 0, 0])


class Folders(SlurmCommands):
    def test_that_are_not_of_a_sweep_are_left_alone(self):
        self.shards.mkdir()
        (self.shards / "mine").touch()
        self.refused_in_one_line(self.launch(), f"{self.shards}: exists, and is not a folder of shards")
        self.assertEqual([path.name for path in self.shards.iterdir()], ["mine"])

    def test_that_cannot_be_made(self):
        self.refused_in_one_line(
            run("sweep", self.plan, "--out", self.folder / "none" / "a.db", "--launcher", "slurm", env=self.environment),
            f"{self.folder}/none/a.db.shards: cannot be made: No such file or directory")
        loop = self.folder / "loop.db"
        loop.symlink_to(loop.name)
        self.refused_in_one_line(
            run("sweep", self.plan, "--out", loop, "--launcher", "slurm", env=self.environment),
            f"--out {loop}: cannot be opened: Too many levels of symbolic links")

    def test_beside_what_is_no_database(self):
        self.store.write_bytes(b"x" * 5000)
        self.refused_in_one_line(self.launch(), f"--out {self.store}: not a database")
        self.assertFalse(self.shards.exists())


if __name__ == "__main__":
    program.main()
