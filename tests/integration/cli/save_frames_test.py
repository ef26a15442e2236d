"""--save-frames: the disparities of every frame in the folder of results."""

import os
import re
import resource
import signal
import subprocess
import time

import program
from program import HEIGHT, RESULT_FILES, WIDTH, ProgramTest, pgm, read_png, run


class SaveFrames(ProgramTest):
    def saved(self):
        return sorted(os.listdir(self.out / "frames"))

    def test_are_the_disparities_of_each_frame(self):
        self.succeeds(self.run_small("--frames", "3", "--save-frames", "--out", self.out))
        self.assertEqual(sorted(os.listdir(self.out)), sorted([*RESULT_FILES, "frames"]))
        self.assertEqual(self.saved(), ["000000.png", "000001.png", "000002.png"])
        last = (self.out / "disparity.png").read_bytes()
        for name in self.saved():
            self.assertEqual((self.out / "frames" / name).read_bytes(), last)
        self.assertEqual(read_png(self.out / "frames" / "000001.png")[:3], (WIDTH, HEIGHT, 1))

    def test_are_all_there_however_many_end_at_once(self):
        self.succeeds(self.run_small("--frames", "100", "--save-frames", "--out", self.out))
        self.assertEqual(self.saved(), [f"{frame:06}.png" for frame in range(100)])

    def test_without_it_there_are_none(self):
        self.succeeds(self.run_small("--frames", "3", "--out", self.out))
        self.assertEqual(sorted(os.listdir(self.out)), RESULT_FILES)

    def test_are_replaced_with_the_result(self):
        self.succeeds(self.run_small("--frames", "5", "--save-frames", "--out", self.out))
        self.succeeds(self.run_small("--frames", "2", "--save-frames", "--out", self.out))
        self.assertEqual(self.saved(), ["000000.png", "000001.png"])
        self.succeeds(self.run_small("--out", self.out))
        self.assertEqual(sorted(os.listdir(self.out)), RESULT_FILES)

    def test_a_file_of_someone_else_among_them_keeps_the_folder(self):
        self.succeeds(self.run_small("--save-frames", "--out", self.out))
        (self.out / "frames" / "notes.txt").write_text("years of work")
        earlier = self.result()
        self.refused_in_one_line(self.run_small("--out", self.out), "holds 'frames/notes.txt'")
        self.assertEqual(self.result(), earlier)

    def test_the_earlier_result_stays_until_the_run_ends(self):
        self.succeeds(self.run_small("--frames", "2", "--save-frames", "--out", self.out))
        earlier = self.result()
        process = self.start_endless()
        self.wait_for_frames(process)
        self.assertEqual({name: data for name, data in self.result().items() if ".partial" not in name}, earlier)
        process.kill()
        process.communicate()

    def start(self, *source):
        """A process that saves frames, without waiting for it."""
        command = ["run", "fpl2003", *program.SMALL, *program.PRELOADED, *source, "--save-frames", "--out", self.out]
        command = [program.PROGRAM] + [str(word) for word in command]
        return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def start_endless(self):
        return self.start("--left", self.left, "--right", self.right, "--frames", "1000000000")

    def wait_for_frames(self, process):
        """Until some are there, aside."""
        path = self.out / ".partial" / "new" / "frames" / "000010.png"
        end = time.monotonic() + 30
        while not path.exists():
            self.assertIsNone(process.poll())
            self.assertLess(time.monotonic(), end)
            time.sleep(0.01)

    def test_an_interrupted_run_keeps_those_of_its_finished_frames(self):
        process = self.start_endless()
        self.wait_for_frames(process)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130)
        done = int(re.search(r"interrupted after (\d+) of", errors)[1])
        self.assertEqual(self.saved(), [f"{frame:06}.png" for frame in range(done)])
        self.assertEqual(self.stats()["frames"], done)
        whole = self.folder / "whole"
        self.succeeds(self.run_small("--frames", done, "--save-frames", "--out", whole))
        self.assertEqual(self.result(whole), self.result())

    def test_an_interrupted_run_leaves_out_the_truth_of_a_pair_that_it_did_not_reach(self):
        process = self.start("--sequence", self.sequence(1000), "--truth", self.left)
        self.wait_for_frames(process)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130, errors)
        self.assertIn("note: --truth is of the pair of frame 999, which was not reached: no accuracy\n", errors)
        self.assertNotIn("accuracy", self.stats())
        self.assertNotIn("truth", (self.out / "run.json").read_text())

    def test_a_full_disk_is_an_error_that_keeps_the_earlier_result(self):
        self.succeeds(self.run_small("--out", self.out))
        earlier = self.result()
        process = run(
            *self.run_arguments("--save-frames", "--frames", "3", "--out", self.out),
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100)),
        )
        self.assertEqual((process.returncode, process.stdout), (1, ""))
        self.assertIn("'frames/000000.png' cannot be written: File too large", process.stderr)
        self.assertEqual(len(process.stderr.splitlines()), 1)
        self.assertEqual(self.result(), earlier)

    def test_a_picture_that_changes_during_the_run_is_an_error(self):
        sequence = self.sequence(10)
        process = self.start("--sequence", sequence, "--frames", "1000000000")
        self.wait_for_frames(process)
        changed = sequence / "left_007.png"
        other = self.file("other.pgm", pgm(WIDTH, HEIGHT, bytes(WIDTH * HEIGHT)))
        other.rename(changed)
        _, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 1)
        self.assertEqual(
            errors,
            f"stereotlm: error: --sequence '{changed}': changed: a picture must not change during a run\n",
        )
        self.assertFalse(self.out.exists())


if __name__ == "__main__":
    program.main()
