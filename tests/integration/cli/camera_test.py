"""run --source camera: the whole computer around a small board."""

import os
import signal

import program
from pictures import read_png
from program import CAMERA_FILES, CAMERA_RATES, PROGRESS, SMALL
from program import ProgramTest, Terminal, run, sets


class CameraTest(ProgramTest):
    def arguments(self, *more):
        """A run of the small computer; of one pair unless there are other pictures."""
        pair = [] if "--sequence" in more or "--synthetic" in more else self.pair
        return ["run", "fpl2003", *SMALL, *CAMERA_RATES, *pair, *more]

    def camera(self, *more, out=None):
        """What such a run that succeeds prints."""
        return self.succeeds(run(*self.arguments(*more, "--out", out or self.out)))


class Results(CameraTest):
    def test_the_same_run_gives_the_same_bytes_and_cameras_are_the_default(self):
        self.camera("--frames", "5")
        self.is_in(self.out, *CAMERA_FILES)
        self.assertEqual(self.run_json()["source"], "camera")
        with self.unchanged(self.out):
            self.camera("--frames", "5")

    def test_frames_are_numbered_by_camera_frame(self):
        sequence = self.sequence(4)
        self.camera("--source", "camera", "--sequence", sequence, "--frames", "6", "--save-frames")
        numbers = sorted(int(name.split(".")[0]) for name in os.listdir(self.out / "frames"))
        self.assertEqual(len(numbers), 6)
        self.assertGreater(numbers[-1] - numbers[0], 5)  # some were dropped
        frames = {number: read_png(self.out / f"frames/{number:06}.png") for number in numbers}
        alone = self.folder / "alone"
        self.succeeds(self.run_with("--sequence", sequence, "--save-frames", "--out", alone))
        for number, frame in frames.items():
            self.assertEqual(frame, read_png(alone / f"frames/{number % 4:06}.png"), number)
        self.assertEqual(read_png(self.out / "disparity.png"), frames[numbers[-1]])

    def test_an_interrupted_run_equals_a_whole_one_of_the_frames_delivered(self):
        options = ["--sequence", self.sequence(7), "--save-frames", "--record"]
        terminal = Terminal(self.arguments(*options, "--frames", "1000000", "--out", self.out))
        status, _ = terminal.interrupt(PROGRESS, signal.SIGINT)
        self.assertEqual(status, 130)
        frames = self.stats()["frames"]
        self.assertIn(f"interrupted after {frames} of 1000000 frames", terminal.text)
        whole = self.folder / "whole"
        self.camera(*options, "--frames", frames, out=whole)
        self.assertEqual(self.result(), self.result(whole))


class Recording(CameraTest):
    """timeline.csv and latency.csv of a run with --record."""

    def test_it_is_the_same_at_both_fidelities(self):
        for destination in ("board", "host_memory"):
            options = ["--frames", "12", "--record", *sets(f"capture.destination={destination}")]
            cycle = self.folder / f"cycle {destination}"
            self.camera(*options, "--fidelity", "cycle", out=cycle)
            self.camera(*options)
            for name in ("timeline.csv", "latency.csv"):
                self.assertEqual((self.out / name).read_bytes(), (cycle / name).read_bytes())
            self.assertNotIn("failed", self.stats())


class Figures(CameraTest):

    def test_torn_pictures_are_warned_of_wherever_a_computer_runs(self):
        torn = sets("capture.fifo_words=4", "capture.fifo_trigger_words=2",
                    "pci.load={burst_words: 1, interval_us: 0, access_us: 50}")
        process = run(*self.arguments(*torn, "--frames", "3", "--out", self.out))
        self.succeeds(process)
        lost = sum(camera["dropped_pixels"] for camera in self.stats()["cameras"])
        self.assertGreater(lost, 0)
        said = f"captures lose {lost} pixels: pictures are torn, and disparities are wrong there"
        self.assertEqual(process.stderr, f"stereotlm: warning: {said}\n")
        page = ["report", self.out, "--quick", "--out", self.folder / "page.html"]
        self.assertEqual(run(*page).stderr, f"stereotlm: warning: '{self.out}': {said}\n")
        _, *others = self.arguments(*torn, "--frames", "3")
        self.assertEqual(run("conflicts", *others).stderr, f"stereotlm: warning: {said}\n")
        self.assertEqual(run(*self.arguments("--frames", "3")).stderr, "")

    @program.slow
    def test_a_picture_of_more_than_4_mib_reaches_the_board_and_comes_back(self):
        size = sets("image.width=2056", "image.height=2048", "ssram.default.words=4194304",
                    "matcher.fetch=line_buffer", "matcher.disparities=8", "cameras.frame_rate_hz=1")
        for destination in ("board", "host_memory"):
            process = run("run", "fpl2003-no-calibration", *size, *sets(f"capture.destination={destination}"),
                          "--synthetic", "1", "--out", self.out)
            table = self.succeeds(process)
            self.assertEqual([camera["dropped_pixels"] for camera in self.stats()["cameras"]], [0, 0])
            self.assertRegex(table, r"answered: 9\d\.\d\d %")

    def test_cameras_on_demand_drop_no_frame(self):
        self.camera(*sets("cameras.trigger=on_demand"), "--frames", "6")
        self.assertEqual([camera["dropped_frames"] for camera in self.stats()["cameras"]], [0, 0])


class Truth(CameraTest):
    def test_a_truth_goes_with_one_pair_only(self):
        self.camera("--truth", self.left)
        self.assertIn("accuracy", self.stats())
        self.assertEqual(list(self.stats()["frames_per_second"]), ["core", "system"])  # one frame: no steady
        rule = "cameras drop frames: which of 3 pairs the last frame shows is not known before the run"
        process = run(*self.arguments("--sequence", self.sequence(3), "--truth", self.left))
        self.refused_in_one_line(process, f"--truth: {rule}")

    def test_the_synthetic_scene_has_the_truth_of_the_camera_frame(self):
        table = self.camera("--synthetic", "1", *sets("matcher.lr_tolerance=1"), "--frames", "4")
        self.assertRegex(table, "accuracy     off by more than 1: ")


if __name__ == "__main__":
    program.main()
