"""run --source camera: the whole computer around a small board."""

import json
import os
import re
import signal

import program
from interrupt_test import PROGRESS, Terminal
from program import CAMERA_RATES, HEIGHT, RESULT_FILES, SMALL, WIDTH, ProgramTest, read_png, run

SYSTEM = [*SMALL, *CAMERA_RATES]


class CameraTest(ProgramTest):
    def camera(self, *more, board="fpl2003"):
        return run(*self.camera_arguments(*more, board=board))

    def camera_arguments(self, *more, board="fpl2003"):
        pair = [] if "--sequence" in more or "--synthetic" in more else ["--left", self.left, "--right", self.right]
        return ["run", board, *SYSTEM, *pair, *more]


class Results(CameraTest):
    def test_are_those_of_the_board_alone_on_one_pair(self):
        self.succeeds(self.camera("--source", "camera", "--frames", "3", "--out", self.out))
        alone = self.folder / "alone"
        self.succeeds(self.run_small("--out", alone))
        ours, theirs = self.result(), self.result(alone)
        self.assertEqual(sorted(ours), RESULT_FILES)
        for name in ("disparity.png", "disparity.pfm", "disparity_color.png"):
            self.assertEqual(ours[name], theirs[name], name)

    def test_are_the_default_source(self):
        self.succeeds(self.camera("--out", self.out))
        self.assertEqual(json.loads((self.out / "run.json").read_text())["source"], "camera")

    def test_are_the_same_again(self):
        self.succeeds(self.camera("--frames", "5", "--out", self.out))
        again = self.folder / "again"
        self.succeeds(self.camera("--frames", "5", "--out", again))
        self.assertEqual(self.result(), self.result(again))

    def test_are_numbered_by_camera_frame(self):
        sequence = self.sequence(4)
        self.succeeds(self.camera("--sequence", sequence, "--frames", "6", "--save-frames", "--out", self.out))
        numbers = sorted(int(name.split(".")[0]) for name in os.listdir(self.out / "frames"))
        self.assertEqual(len(numbers), 6)
        self.assertGreater(numbers[-1] - numbers[0], 5)  # some were dropped
        for number in numbers:
            pair = ["--left", sequence / f"left_{number % 4:03}.png", "--right", sequence / f"right_{number % 4:03}.png"]
            alone = self.folder / f"alone{number}"
            self.succeeds(self.run_with(*pair, "--out", alone))
            self.assertEqual(read_png(self.out / f"frames/{number:06}.png"), read_png(alone / "disparity.png"), number)
        self.assertEqual(read_png(self.out / "disparity.png"), read_png(self.out / f"frames/{numbers[-1]:06}.png"))

    def test_of_a_sequence_are_as_many_as_its_pairs(self):
        self.succeeds(self.camera("--sequence", self.sequence(3), "--out", self.out))
        self.assertEqual(self.stats()["frames"], 3)


class Figures(CameraTest):
    def test_have_the_keys_of_a_computer(self):
        self.succeeds(self.camera("--frames", "20", "--out", self.out))
        stats = self.stats()
        self.assertNotIn("failed", stats)
        self.assertEqual(list(stats["frames_per_second"]), ["core", "system", "steady"])
        self.assertEqual(list(stats["bound"]), ["core", "core_limited_by", "system", "system_limited_by"])
        self.assertLess(stats["frames_per_second"]["system"], stats["bound"]["system"])
        self.assertEqual([master["name"] for master in stats["pci"]["masters"]],
                         ["host", "left_capture", "right_capture", "bridge"])
        words = WIDTH * HEIGHT // 4
        tables = 2 * WIDTH * HEIGHT
        self.assertEqual(stats["bridge"]["dma_words"], 20 * words + tables)
        self.assertGreaterEqual(stats["bridge"]["posted_words"], 2 * 20 * words)
        for camera in stats["cameras"]:
            self.assertEqual(camera["frames"], camera["captured_frames"] + camera["dropped_frames"])
        latency = stats["latency_ms"]["capture_to_host"]
        self.assertEqual(list(latency), ["min", "p50", "p95", "p99", "max"])
        self.assertEqual(sorted(latency.values()), list(latency.values()))
        self.assertEqual(stats["ports"][-1]["name"], "host")
        self.assertGreater(stats["ports"][-1]["grants"], 0)

    def test_of_one_frame_have_no_steady_rate(self):
        self.succeeds(self.camera("--out", self.out))
        self.assertEqual(list(self.stats()["frames_per_second"]), ["core", "system"])

    def test_are_absent_where_there_is_no_computer(self):
        self.succeeds(self.run_small("--frames", "2", "--out", self.out))
        stats = self.stats()
        self.assertEqual(list(stats["frames_per_second"]), ["core"])
        for key in ("pci", "bridge", "cameras", "latency_ms"):
            self.assertNotIn(key, stats)

    def test_blame_the_host_on_a_bank_that_the_core_uses(self):
        shared = ["--set", "allocation.left_image=[bank0, bank0]"]
        self.succeeds(self.camera(*shared, "--frames", "6", "--out", self.out))
        rows = [row for row in self.stats()["blame"] if row["by"] == "host"]
        self.assertEqual([(row["port"], row["bank"]) for row in rows], [("left_pixel", "bank0")])
        self.assertGreater(rows[0]["cycles"], 0)

    def test_are_in_the_table(self):
        table = self.succeeds(self.camera("--frames", "3"))
        for pattern in (r"^system +[\d.]+ frames/s   steady", r"^left_capture +\d+ +\d+", r"^pci bus +busy",
                        r"^local bus +busy", r"^left +\d+ +\d+ +\d+ +\d+ +0 +0 +0$",
                        r"^latency +capture to host, ms: min"):
            self.assertRegex(table, re.compile(pattern, re.MULTILINE))
        for line in table.splitlines():
            self.assertLessEqual(len(line), 100, line)

    def test_stay_below_their_bound_where_pixels_are_dropped(self):
        # A bus that takes few of the words of a picture is no limit for the rate of pictures.
        slow = ["pci.clock_mhz=1", "pci.bridge_wait_clocks=63", "pci.memory_wait_clocks=0"]
        options = [word for each in slow for word in ("--set", each)]
        options += ["--set", "capture.fifo_words=2", "--set", "capture.fifo_trigger_words=1"]
        self.succeeds(self.camera(*options, "--frames", "6", "--out", self.out))
        stats = self.stats()
        self.assertGreater(stats["cameras"][0]["dropped_pixels"], 0)
        lines = self.succeeds(run("bounds", "fpl2003", *SYSTEM[:-2], *options)).splitlines()
        without_drops = float(next(line.split()[1] for line in lines if line.startswith("  pci ")))
        self.assertGreater(stats["frames_per_second"]["system"], without_drops)

    def test_follow_the_keys_of_the_board(self):
        rates = []
        for sets in ([], ["capture.destination=host_memory"],
                     ["allocation.left_image=bank0", "allocation.right_image=bank2"]):
            options = [word for each in sets for word in ("--set", each)]
            self.succeeds(self.camera(*options, "--frames", "30", "--out", self.out))
            rates.append(self.stats()["frames_per_second"]["steady"])
        self.assertEqual(sorted(rates), [rates[2], rates[0], rates[1]])

    def test_of_cameras_on_demand_drop_nothing(self):
        self.succeeds(self.camera("--set", "cameras.trigger=on_demand", "--frames", "6", "--out", self.out))
        for camera in self.stats()["cameras"]:
            self.assertEqual(camera["dropped_frames"], 0)


class Truth(CameraTest):
    def test_goes_with_one_pair(self):
        self.succeeds(self.camera("--truth", self.left, "--out", self.out))
        self.assertIn("accuracy", self.stats())

    def test_does_not_go_with_several_pairs(self):
        self.refused_in_one_line(
            self.camera("--sequence", self.sequence(3), "--truth", self.left),
            "--truth: goes with one pair if it comes from cameras, which drop frames: of 3 pairs nobody knows",
        )

    def test_of_the_synthetic_scene_is_that_of_the_camera_frame(self):
        table = self.succeeds(self.camera("--synthetic", "1", "--set", "matcher.lr_tolerance=1", "--frames", "4"))
        self.assertRegex(table, "accuracy     off by more than 1: ")


class Interrupted(CameraTest):
    def test_has_the_result_of_a_whole_run_of_the_frames_that_it_delivered(self):
        sequence = self.sequence(7)
        options = ["--sequence", sequence, "--save-frames"]
        terminal = Terminal(self.camera_arguments(*options, "--frames", "1000000", "--out", self.out))
        terminal.read_until(PROGRESS)
        terminal.process.send_signal(signal.SIGINT)
        status, _ = terminal.finish()
        self.assertEqual(status, 130)
        frames = self.stats()["frames"]
        self.assertIn(f"interrupted after {frames} of 1000000 frames", terminal.text)
        whole = self.folder / "whole"
        self.succeeds(self.camera(*options, "--frames", frames, "--out", whole))
        self.assertEqual(self.result(), self.result(whole))


# Figures of the plain loop over events (tests/support/plain_computer.h) for computers at which a simulation of the whole
# computer has gone wrong before.
SLOW_BUS = [
    "cameras.trigger=on_demand", "bridge.local_clock_mhz=10", "bridge.posted_words=2", "allocation.left_lut=none",
    "allocation.right_lut=none",
]
FULL_FIFO = [
    *SLOW_BUS, "matcher={window: 3, disparities: 1, filter: none, fetch: column, lr_tolerance: 253}",
    "image={width: 32, height: 4}", "cameras.frame_rate_hz=777.7", "allocation.left_image=[bank1, bank1, bank2]",
    "allocation.right_image=[bank0, bank1, bank2]",
]
FIFO = "host_frames: 3, fifo_words: 3, fifo_trigger_words: 3"
PCI = "clock_mhz: 1, latency_timer_clocks: 64, memory_wait_clocks: 8"


class Figures(ProgramTest):
    def stats_of(self, frames, *sets):
        options = [argument for assignment in sets for argument in ("--set", assignment)]
        self.succeeds(run("run", "fpl2003", "--timing-only", "--frames", frames, "--out", self.out, *options))
        return self.stats()

    def test_an_interrupt_that_the_last_access_has_cleared_is_not_polled_again(self):
        stats = self.stats_of("10", "capture.destination=host_memory")
        self.assertEqual(stats["pci"]["masters"][0]["transactions"], 387)

    def test_pixels_are_dropped_one_by_one_to_the_end_of_the_run(self):
        for destination, bridge_wait_clocks, dropped in (
            ("host_memory", 0, [100, 100]),
            ("host_memory", 8, [110, 110]),  # of the line that is under way at the end, half has come
            ("board", 0, [0, 2]),
        ):
            with self.subTest(destination=destination, bridge_wait_clocks=bridge_wait_clocks):
                stats = self.stats_of("1", *FULL_FIFO, f"capture={{destination: {destination}, {FIFO}}}",
                                      f"pci={{{PCI}, bridge_wait_clocks: {bridge_wait_clocks}}}")
                self.assertEqual([camera["dropped_pixels"] for camera in stats["cameras"]], dropped)

    def test_clocks_are_the_decimal_numbers_that_are_written(self):
        stats = self.stats_of("40", *SLOW_BUS, "image={width: 4, height: 1}", "cameras.frame_rate_hz=0.17",
                              "pci.clock_mhz=13.7047")
        self.assertEqual(stats["latency_ms"]["capture_to_host"]["min"], 3309.549205746)


if __name__ == "__main__":
    program.main()
