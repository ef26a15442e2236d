"""Runs that succeed: what they print and write."""

import os
import subprocess
import unittest

import program
from pictures import noise, pgm, ppm, read_pfm, read_png
from program import HEIGHT, PRELOADED, RESULT_FILES, SMALL, WIDTH, ProgramTest, run, sets, sha256

DISPARITY_FILES = ("disparity.png", "disparity.pfm", "disparity_color.png")


class ResultFiles(ProgramTest):
    def test_are_all_there_and_agree(self):
        self.succeeds(self.run_small("--out", self.out, "--frames", "3", *sets("matcher.disparities=8")))
        self.is_in(self.out, *RESULT_FILES)
        width, height, channels, rows = read_png(self.out / "disparity.png")
        self.assertEqual((width, height, channels), (WIDTH, HEIGHT, 1))
        self.assertTrue(any(d != 255 for row in rows for d in row))
        self.assertTrue(all(d == 255 or d < 8 for row in rows for d in row))
        as_floats = [[float("inf") if d == 255 else float(d) for d in row] for row in rows]
        self.assertEqual(read_pfm(self.out / "disparity.pfm"), (WIDTH, HEIGHT, as_floats))
        width, height, channels, colours = read_png(self.out / "disparity_color.png")
        self.assertEqual((width, height, channels), (WIDTH, HEIGHT, 3))
        for row, colour_row in zip(rows, colours):
            for x, d in enumerate(row):
                self.assertEqual(colour_row[3 * x : 3 * x + 3] == bytes(3), d == 255)

    def test_stats_add_up(self):
        self.succeeds(self.run_small("--out", self.out, "--frames", "3"))
        stats = self.stats()
        self.assertEqual((stats["schema"], stats["board"], stats["fidelity"]), (1, "fpl2003", "fast"))
        self.assertEqual((stats["frames"], len(stats["frame_cycles"])), (3, 3))
        self.assertEqual(stats["cycles"], sum(stats["frame_cycles"]) - 3 * 16)
        self.assertEqual(stats["frames_per_second"]["core"], 40e6 * 3 / sum(stats["frame_cycles"]))
        self.assertLessEqual(stats["frames_per_second"]["core"], stats["bound"]["core"])
        self.assertEqual(stats["ports"][-1]["name"], "host")
        for port in stats["ports"]:
            self.assertEqual(sum(v for k, v in port.items() if k != "name"), stats["cycles"])
        banks = {bank["name"]: bank for bank in stats["banks"]}
        self.assertEqual(list(banks), [f"bank{i}" for i in range(8)])
        accesses = sum(bank["reads"] + bank["writes"] for bank in stats["banks"])
        self.assertEqual(accesses, sum(port["grants"] for port in stats["ports"]))
        self.assertNotIn("failed", stats)
        self.assertNotIn("accuracy", stats)
        # Frames take the banks of a list in turn.
        words = WIDTH * HEIGHT // 4
        writes = [bank["writes"] for bank in stats["banks"]]
        self.assertEqual(writes, [0, 0, 0, 0, 2 * words, words, 0, 0])
        for first, second in (("bank0", "bank1"), ("bank2", "bank3")):
            self.assertEqual(banks[first]["reads"], 2 * banks[second]["reads"])

    def test_area_is_that_of_the_board(self):
        self.succeeds(self.run_small("--out", self.out))
        area = self.stats()["area"]
        shares = [f"{part}{percent}" for part in ("block_rams", "multipliers") for percent in ("", "_percent")]
        self.assertEqual(list(area), ["slices", "slices_percent", "luts", "flip_flops", *shares])
        self.assertEqual(area["slices_percent"], 100 * area["slices"] / 33792)
        bounds = self.succeeds(run("bounds", "fpl2003", *SMALL)).splitlines()[-1]
        self.assertTrue(bounds.startswith(f"area of the core: {area['slices']} of 33792 slices"), bounds)
        self.assertIn(f", {area['block_rams']} of 144 block RAMs, ", bounds)

    def test_are_byte_identical_again_and_disparities_for_any_number_of_frames(self):
        options = ["--out", self.out, "--truth", self.left, "--truth-scale", "4"]
        self.succeeds(self.run_small(*options))
        with self.unchanged(self.out):
            self.succeeds(self.run_small(*options))
        one = self.result()
        self.succeeds(self.run_small("--out", self.out, "--frames", "3"))
        for name in DISPARITY_FILES:
            self.assertEqual((self.out / name).read_bytes(), one[name])

    def test_config_loads_back(self):
        self.succeeds(self.run_small("--out", self.out, *sets("matcher.lr_tolerance=off")))
        config = self.out / "config.yaml"
        small = self.succeeds(run("check", "fpl2003", *SMALL))
        self.assertEqual(self.succeeds(run("check", config)), small.replace("fpl2003", str(config)))
        self.assertIn("lr_tolerance: \"off\"", config.read_text())
        again = self.folder / "again"
        self.succeeds(run("run", config, *PRELOADED, *self.pair, "--out", again))
        self.assertEqual(self.result(again), self.result())

    def test_run_json_has_the_options_and_what_was_read(self):
        options = ["--frames", "2", "--truth", self.right, "--truth-scale", "0.5"]
        self.succeeds(run(*self.run_arguments("--out", "out", *options, left="left.pgm"), cwd=self.folder))
        said = self.run_json()
        self.assertEqual((said["source"], said["fidelity"], said["frames"]), ("preloaded", "fast", 2))
        for name, path in (("left", self.left), ("right", self.right), ("truth", self.right)):
            self.assertEqual(os.path.realpath(said[name]["path"]), os.path.realpath(path))
            self.assertTrue(os.path.isabs(said[name]["path"]))
            self.assertEqual(said[name]["sha256"], sha256(path))
        self.assertEqual(said["truth_scale"], 0.5)
        self.assertEqual("stereotlm " + said["version"], self.succeeds(run("--version")).strip())

    def test_replace_an_earlier_result_whole(self):
        for name in ("run.json", "depth.ply"):
            self.file(f"out/{name}", "old")
        self.succeeds(self.run_small("--out", self.out))
        self.is_in(self.out, *RESULT_FILES)

    def test_are_not_written_without_out(self):
        with self.unchanged(self.folder):
            self.succeeds(run(*self.run_arguments(), cwd=self.folder))


class Matching(ProgramTest):
    def test_finds_the_shift_of_a_picture(self):
        shift = 3
        scene = noise(WIDTH + shift, HEIGHT, 5)
        rows = [scene[y * (WIDTH + shift) :] for y in range(HEIGHT)]
        right = self.file("r.pgm", pgm(WIDTH, HEIGHT, b"".join(row[shift : shift + WIDTH] for row in rows)))
        left = self.file("l.pgm", pgm(WIDTH, HEIGHT, b"".join(row[:WIDTH] for row in rows)))
        truth = self.file("t.pgm", pgm(WIDTH, HEIGHT, bytes([2 * shift]) * (WIDTH * HEIGHT)))
        options = [*sets("matcher.disparities=8", "matcher.filter=none"), "--out", self.out]
        known = ["--truth", truth, "--truth-scale", "2"]
        table = self.succeeds(self.run_small(*options, *known, left=left, right=right))
        answered = {d for row in read_png(self.out / "disparity.png")[3] for d in row if d != 255}
        self.assertEqual(answered, {shift})
        accuracy = self.stats()["accuracy"]
        self.assertEqual((accuracy["bad_1_percent"], accuracy["bad_2_percent"]), (0, 0))
        self.assertGreater(accuracy["answered_percent"], 40)
        self.assertIn("off by more than 1: 0.00 %", table)

    def test_converts_colour_and_says_so(self):
        grey = noise(WIDTH, HEIGHT, 1)
        left = self.file("colour.ppm", ppm(WIDTH, HEIGHT, b"".join(bytes([v, v, v]) for v in grey)))
        process = self.run_small("--out", self.out, left=left)
        self.succeeds(process)
        self.assertEqual(process.stderr, f"stereotlm: note: --left '{left}': colour, converted to grey\n")
        colour = (self.out / "disparity.png").read_bytes()
        self.succeeds(self.run_small("--out", self.out))
        self.assertEqual((self.out / "disparity.png").read_bytes(), colour)


class Output(ProgramTest):
    def test_is_a_table_and_nothing_on_standard_error(self):
        process = self.run_small()
        text = self.succeeds(process)
        for word in ("core", "bound", "bank7", "worst stall"):
            self.assertIn(word, text)
        self.assertNotIn("SystemC", text)
        self.assertEqual(process.stderr, "")

    def test_to_a_closed_pipe_does_not_cost_the_results(self):
        read_end, write_end = os.pipe()
        os.close(read_end)
        process = self.start(*self.run_arguments("--out", self.out), stdout=write_end)
        os.close(write_end)
        self.ends(process, 0, out=None)
        self.is_in(self.out, *RESULT_FILES)

    @unittest.skipUnless(os.path.exists("/dev/full"), "no /dev/full here")
    def test_to_a_full_disk_is_an_error(self):
        with open("/dev/full", "w") as full:
            process = self.start("keys", stdout=full)
        self.ends(process, 1, out=None, errors="stereotlm: error: standard output: No space left on device\n")

    def test_to_closed_standard_streams_does_not_get_into_the_results(self):
        command = program.words(self.run_arguments("--out", self.out))
        shell = ["sh", "-c", 'exec "$@" <&- >&- 2>&-', "sh"]
        process = subprocess.run(shell + command, timeout=60, check=False)
        self.assertEqual(process.returncode, 1, "the table cannot be printed")
        with self.unchanged(self.out):
            self.succeeds(self.run_small("--out", self.out))


if __name__ == "__main__":
    program.main()
