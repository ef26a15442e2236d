"""--save-frames: the disparities of every frame in the folder of results."""

import re
import resource
import signal

import program
from pictures import pgm, read_png
from program import HEIGHT, PRELOADED, RESULT_FILES, SMALL, WIDTH, ProgramTest, run, wait_until


def names(count):
    return [f"{frame:06}.png" for frame in range(count)]


class SaveFrames(ProgramTest):
    def save(self, *more):
        self.succeeds(self.run_small("--save-frames", "--out", self.out, *more))

    def test_writes_the_disparities_of_each_frame(self):
        self.save("--frames", "100")
        self.is_in(self.out, *RESULT_FILES, "frames")
        self.is_in(self.out / "frames", *names(100))
        last = (self.out / "disparity.png").read_bytes()
        self.assertEqual(set(self.result(self.out / "frames").values()), {last})
        self.assertEqual(read_png(self.out / "disparity.png")[:3], (WIDTH, HEIGHT, 1))

    def test_replaces_frames_with_the_result(self):
        self.save("--frames", "5")
        self.save("--frames", "2")
        self.is_in(self.out / "frames", *names(2))
        self.succeeds(self.run_small("--out", self.out))
        self.is_in(self.out, *RESULT_FILES)

    def test_refuses_a_folder_of_frames_with_a_file_of_someone_else(self):
        self.save()
        self.file("out/frames/notes.txt", "years of work")
        with self.unchanged(self.out):
            self.refused_in_one_line(self.run_small("--out", self.out), "holds 'frames/notes.txt'")

    def test_on_a_full_disk_is_an_error_that_keeps_the_earlier_result(self):
        self.succeeds(self.run_small("--out", self.out))
        limit = lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100))
        with self.unchanged(self.out):
            command = self.run_arguments("--save-frames", "--frames", "3", "--out", self.out)
            process = run(*command, preexec_fn=limit)
            self.fails(process, "'frames/000000.png' cannot be written: File too large")


class Meanwhile(ProgramTest):
    """What happens to a run of many frames once it has saved some aside."""

    def begin(self, *source):
        command = ["run", "fpl2003", *SMALL, *PRELOADED, *source, "--save-frames", "--out", self.out]
        process = self.start(*command)
        some = self.out / ".partial" / "new" / "frames" / "000010.png"
        wait_until(lambda: some.exists() or process.poll() is not None)
        return process

    def interrupt(self, process):
        """What it says."""
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=60)
        self.assertEqual(process.returncode, 130, errors)
        return errors

    def test_an_interrupt_keeps_the_frames_that_are_finished(self):
        self.succeeds(self.run_small("--frames", "2", "--save-frames", "--out", self.out))
        earlier = self.result()
        process = self.begin(*self.pair, "--frames", "1000000000")
        now = self.result()
        self.assertEqual({name: now.get(name) for name in earlier}, earlier)  # until the run ends
        done = int(re.search(r"interrupted after (\d+) of", self.interrupt(process))[1])
        self.is_in(self.out / "frames", *names(done))
        self.assertEqual(self.stats()["frames"], done)
        with self.unchanged(self.out):
            self.succeeds(self.run_small("--frames", done, "--save-frames", "--out", self.out))

    def test_an_interrupt_leaves_out_the_truth_of_a_pair_that_was_not_reached(self):
        errors = self.interrupt(self.begin("--sequence", self.sequence(1000), "--truth", self.left))
        note = "note: --truth is of the pair of frame 999, which was not reached: no accuracy\n"
        self.assertIn(note, errors)
        self.assertNotIn("accuracy", self.stats())
        self.assertNotIn("truth", self.run_json())

    def test_a_picture_that_changes_is_an_error(self):
        sequence = self.sequence(10)
        process = self.begin("--sequence", sequence, "--frames", "1000000000")
        changed = sequence / "left_007.png"
        self.file("other.pgm", pgm(WIDTH, HEIGHT, bytes(WIDTH * HEIGHT))).rename(changed)
        rule = "changed: a picture must not change during a run"
        self.ends(process, 1, errors=f"stereotlm: error: --sequence '{changed}': {rule}\n")
        self.assertFalse(self.out.exists())


if __name__ == "__main__":
    program.main()
