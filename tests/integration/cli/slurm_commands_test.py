"""sweep --launcher slurm with commands in place of Slurm's that fail, or whose jobs do."""

import os
import re
import signal

import program
from program import run
from sweep_test import SweepTest

# Each job has state $END as soon as it is submitted. By then it has run $TASK (shards) or $MERGE (merge),
# with the folder of the shards as $FOLDER.
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
JOBS_CONTINUE = "the jobs continue; run the same command to wait for them"
LOST = "has been lost 3 times without a further point"


class SlurmCommands(SweepTest):
    def setUp(self):
        super().setUp()
        self.commands = self.folder / "commands"
        self.shards = self.folder / "points.db.shards"
        self.write("squeue", SQUEUE)
        self.write("sbatch", SBATCH)
        self.write("scancel", '#!/bin/sh\necho "$@" >>"$FAKE/cancelled"\n')
        folders = {"FAKE": str(self.commands), "FOLDER": str(self.shards)}
        path = {"PATH": f"{self.commands}:/usr/bin:/bin"}
        self.environment = {**os.environ, **path, **folders, "END": "FAILED", "TASK": "", "MERGE": ""}

    def write(self, name, text):
        self.file(f"commands/{name}", text).chmod(0o755)

    def command(self, *more, store=None):
        return ["sweep", self.plan, "--out", store or self.store, "--launcher", "slurm", "--shards", 1, *more]

    def launch(self, *more, store=None, **variables):
        return run(*self.command(*more, store=store), env={**self.environment, **variables})

    def submitted(self):
        return (self.commands / "submitted").read_text().splitlines()

    def failed(self, process, text):
        """After something was submitted; the notes before the error."""
        *notes, error = self.ended(process, 1)
        self.assertIn(text, error)
        return [note.replace("stereotlm: note: ", "") for note in notes]


class Options(SlurmCommands):
    def test_options_of_the_launcher_are_checked(self):
        self.refused_in_one_line(self.sweep("--shards", 2), "--shards: goes with --launcher slurm")
        self.refused_in_one_line(self.sweep("--sbatch", "exclusive"), "--sbatch: goes with --launcher slurm")
        for shards in (0, 1001, "x"):
            process = self.sweep("--launcher", "slurm", "--shards", shards)
            self.refused_in_one_line(process, f"--shards = {shards}: must be 1..1000")
        for option, value in (("--jobs", 2), ("--shard", "0/2"), ("--known", "a.db"), ("--progress", "a")):
            self.refused_in_one_line(self.launch(option, value), f"{option}: not with --launcher slurm")

    def test_options_of_sbatch_are_checked_and_passed_on(self):
        long_option = "must be a long option of sbatch without its dashes"
        given = "given by the launcher"
        for rule, *options in ((long_option, "--partition=long", "p long", "=3", "-n"),
                               (given, "array=0-3", "wrap=true", "wait")):
            for option in options:
                self.refused_in_one_line(self.launch(f"--sbatch={option}"), f"--sbatch = {option}: {rule}")
        self.launch("--sbatch", "exclusive", "--sbatch", "comment=a b")
        for line in self.submitted():
            self.assertTrue(line.startswith("--exclusive --comment=a b --job-name=sweep-"), line)


class Commands(SlurmCommands):
    def test_missing_and_strange_commands_are_named(self):
        needed = "not found in PATH; Slurm's commands sbatch, squeue and scancel are needed"
        for name in ("sbatch", "squeue"):
            (self.commands / name).unlink()
            process = self.launch(PATH=str(self.commands))
            self.refused_in_one_line(process, f"error: --launcher slurm: {name}: {needed}")
        self.write("squeue", SQUEUE)
        for name, script, problem in (
            ("sbatch", "echo usage", "no job number in its output: usage"),
            ("squeue", "echo JOBID PARTITION", "unexpected output: JOBID PARTITION"),
            ("squeue", "exit 3", "has ended with status 3"),
        ):
            self.write(name, f"#!/bin/sh\n{script}\n")
            self.refused_in_one_line(self.launch(), f"{name}: {problem}")
        self.assertEqual(list(self.folder.glob("points.db*")), [])

    def test_commands_do_not_see_variables_that_change_what_they_print(self):
        self.write("squeue", '#!/bin/sh\nenv | grep -e ^SQUEUE_ -e ^SBATCH_ >"$FAKE/variables"\nexit 1\n')
        self.launch(SQUEUE_PARTITION="other", SBATCH_PARTITION="long")
        self.assertEqual((self.commands / "variables").read_text(), "SBATCH_PARTITION=long\n")

    def test_a_refused_merge_cancels_the_shards(self):
        refuse = 'printf "sbatch: error: too many jobs\\nsbatch: error: sorry\\n" >&2; exit 1 #'
        self.write("sbatch", SBATCH.replace('echo "$job|N/A', refuse))
        lines = self.refused(self.launch(END="PENDING"),
                             "error: --launcher slurm: sbatch: too many jobs; sorry")
        self.assertEqual(lines[:-1], ["stereotlm: note: job 1: shard 0 of 1"])
        self.assertEqual((self.commands / "cancelled").read_text(), "1\n")
        self.assertFalse(self.shards.exists())

    def test_commands_that_keep_failing_end_the_waiting(self):
        fail = '[ ! -e "$FAKE/queue" ] || { echo "squeue: error: no answer" >&2; exit 1; }\n'
        self.write("squeue", SQUEUE + fail)
        notes = self.failed(self.launch(END="RUNNING"), f"error: squeue: no answer; {JOBS_CONTINUE}")
        self.assertEqual(notes[2], "squeue: no answer: asking again")
        self.assertTrue(self.shards.exists())

    def test_a_failing_scancel_leaves_the_jobs(self):
        self.write("scancel", "#!/bin/sh\necho 'scancel: error: no answer' >&2\nexit 1\n")
        process = self.start(*self.command(), env={**self.environment, "END": "PENDING"})
        for _ in range(2):
            self.assertIn("note: job ", process.stderr.readline())
        process.send_signal(signal.SIGINT)
        self.ends(process, 1, errors=f"stereotlm: error: scancel: no answer; {JOBS_CONTINUE}\n")
        self.assertTrue(self.shards.exists())


class LostWork(SlurmCommands):
    def test_lost_shards_are_submitted_three_times(self):
        process = self.launch(TASK='echo no such thing >>"$FOLDER/shard_0.log"', END="OUT_OF_MEMORY")
        kept = f"finished points are kept in {self.shards}: run the same command to resume"
        log = f"its log {self.shards}/shard_0.log ends with: no such thing"
        notes = self.failed(process, f"error: shard 0 {LOST} (OUT_OF_MEMORY); {log}; {kept}")
        expected = []
        for job in (1, 3, 5):
            expected += [f"job {job}: shard 0 of 1", f"job {job + 1}: the merge "]
            expected += ["lost: shard 0 (OUT_OF_MEMORY); submitting again"] if job < 5 else []
        self.assertEqual([re.sub(r"into .*", "", note) for note in notes], expected)

    def test_a_missing_log_says_what_must_be_shared(self):
        no_log = f"there is no {self.shards}/shard_0.log: the nodes must share"
        self.failed(self.launch(END="COMPLETED"), f"(COMPLETED); {no_log}")

    def test_shards_that_get_further_are_not_given_up(self):
        further = 'echo "ok $job" >"$FOLDER/shard_0.progress"; [ "$job" -le 8 ] || touch "$FOLDER/shard_0.db"'
        copy = 'cp "$FOLDER/../other.db" "$FOLDER/../points.db"'
        done = f'[ "$job" -le 8 ] || {copy}; touch "$FOLDER/merged"'
        self.succeeds(self.sweep(store=self.folder / "other.db"))
        process = self.launch(TASK=further, MERGE=done)
        self.assertIn("12 points: 9 ok", process.stdout)
        self.assertEqual(process.stderr.count("submitting again"), 4)
        self.assertFalse(self.shards.exists())

    def test_a_lost_merge_is_submitted_again(self):
        process = self.launch(TASK='touch "$FOLDER/shard_0.db"', MERGE='echo disk full >"$FOLDER/merge.log"')
        log = f"its log {self.shards}/merge.log ends with: disk full;"
        notes = self.failed(process, f"error: the merge {LOST} (FAILED); {log}")
        self.assertEqual([note.split()[1] for note in notes], ["1:", "2:", "3:", "4:"])
        self.assertEqual([line.count("--array") for line in self.submitted()], [1, 0, 0, 0])


class Folders(SlurmCommands):
    def test_folders_of_others_and_impossible_ones_are_refused(self):
        self.file("points.db.shards/mine")
        loop, none = self.folder / "loop.db", self.folder / "none" / "a.db"
        loop.symlink_to(loop.name)
        text = self.file("text.db", "x" * 5000)
        with self.unchanged(self.folder):
            for store, problem in (
                (self.store, f"{self.shards}: exists, and is not a folder of shards"),
                (none, f"{none}.shards: cannot be made: No such file or directory"),
                (loop, f"--out {loop}: cannot be opened: Too many levels of symbolic links"),
                (text, f"--out {text}: not a database"),
            ):
                self.refused_in_one_line(self.launch(store=store), problem)


if __name__ == "__main__":
    program.main(program.AtOnce)
