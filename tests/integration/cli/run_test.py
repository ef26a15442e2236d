"""Runs that succeed: what they print and write."""

import hashlib
import json
import os
import unittest

import program
from program import HEIGHT, PRELOADED, RESULT_FILES, SMALL, WIDTH, ProgramTest, noise, pgm, read_pfm, read_png, run


class ResultFiles(ProgramTest):
    def test_are_all_there_and_agree(self):
        self.succeeds(self.run_small("--out", self.out, "--frames", "3", "--set", "matcher.disparities=8"))
        self.assertEqual(sorted(os.listdir(self.out)), RESULT_FILES)
        width, height, channels, rows = read_png(self.out / "disparity.png")
        self.assertEqual((width, height, channels), (WIDTH, HEIGHT, 1))
        floats = read_pfm(self.out / "disparity.pfm")
        self.assertEqual(floats[:2], (WIDTH, HEIGHT))
        as_floats = [[float("inf") if d == 255 else float(d) for d in row] for row in rows]
        self.assertEqual(floats[2], as_floats)
        self.assertTrue(any(d != 255 for row in rows for d in row))
        self.assertTrue(all(d == 255 or d < 8 for row in rows for d in row))
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
        self.assertEqual([port["name"] for port in stats["ports"]][-1], "host")
        for port in stats["ports"]:
            self.assertEqual(sum(v for k, v in port.items() if k != "name"), stats["cycles"])
        self.assertEqual([bank["name"] for bank in stats["banks"]], [f"bank{i}" for i in range(8)])
        self.assertEqual(
            sum(bank["reads"] + bank["writes"] for bank in stats["banks"]),
            sum(port["grants"] for port in stats["ports"]),
        )
        self.assertNotIn("failed", stats)
        self.assertNotIn("accuracy", stats)

    def test_area_is_that_of_the_board(self):
        self.succeeds(self.run_small("--out", self.out))
        area = self.stats()["area"]
        self.assertEqual(
            list(area),
            "slices slices_percent luts flip_flops block_rams block_rams_percent multipliers multipliers_percent".split(),
        )
        self.assertEqual(area["slices_percent"], 100 * area["slices"] / 33792)
        bounds = self.succeeds(run("bounds", "fpl2003", *SMALL)).splitlines()[-1]
        self.assertTrue(bounds.startswith(f"area of the core: {area['slices']} of 33792 slices"), bounds)
        self.assertIn(f", {area['block_rams']} of 144 block RAMs, ", bounds)

    def test_frames_take_the_banks_of_a_list_in_turn(self):
        self.succeeds(self.run_small("--out", self.out, "--frames", "3"))
        banks = {bank["name"]: bank for bank in self.stats()["banks"]}
        words = WIDTH * HEIGHT // 4
        self.assertEqual([banks[f"bank{i}"]["writes"] for i in range(8)], [0, 0, 0, 0, 2 * words, words, 0, 0])
        for first, second in (("bank0", "bank1"), ("bank2", "bank3")):
            self.assertEqual(banks[first]["reads"], 2 * banks[second]["reads"])

    def test_frames_do_not_change_the_disparities(self):
        self.succeeds(self.run_small("--out", self.out))
        self.succeeds(self.run_small("--out", self.folder / "three", "--frames", "3"))
        for name in ("disparity.png", "disparity.pfm", "disparity_color.png"):
            self.assertEqual((self.out / name).read_bytes(), (self.folder / "three" / name).read_bytes())

    def test_are_byte_identical_when_run_again(self):
        options = ["--out", self.out, "--frames", "2", "--truth", self.left, "--truth-scale", "4"]
        self.succeeds(self.run_small(*options))
        first = self.result()
        again = self.run_small(*options)
        self.succeeds(again)
        self.assertEqual(self.result(), first)

    def test_config_loads_back(self):
        self.succeeds(self.run_small("--out", self.out, "--set", "matcher.lr_tolerance=off"))
        config = self.out / "config.yaml"
        small = self.succeeds(run("check", "fpl2003", *SMALL))
        self.assertEqual(self.succeeds(run("check", config)), small.replace("fpl2003", str(config)))
        self.assertIn("lr_tolerance: \"off\"", config.read_text())
        pair = ["--left", self.left, "--right", self.right]
        self.succeeds(run("run", config, *PRELOADED, *pair, "--out", self.folder / "again"))
        self.assertEqual(self.result(self.folder / "again"), self.result())

    def test_run_json_has_the_options_and_what_was_read(self):
        options = ["--frames", "2", "--truth", self.right, "--truth-scale", "0.5"]
        self.succeeds(run(*self.run_arguments("--out", "out", *options, left="left.pgm"), cwd=self.folder))
        run_json = json.loads((self.out / "run.json").read_text())
        self.assertEqual((run_json["source"], run_json["fidelity"], run_json["frames"]), ("preloaded", "fast", 2))
        for name, path in (("left", self.left), ("right", self.right), ("truth", self.right)):
            self.assertEqual(os.path.realpath(run_json[name]["path"]), os.path.realpath(path))
            self.assertTrue(os.path.isabs(run_json[name]["path"]))
            self.assertEqual(run_json[name]["sha256"], hashlib.sha256(path.read_bytes()).hexdigest())
        self.assertEqual(run_json["truth_scale"], 0.5)
        self.assertEqual("stereotlm " + run_json["version"], self.succeeds(run("--version")).strip())

    def test_replace_an_earlier_result_whole(self):
        self.out.mkdir()
        for name in ("run.json", "depth.ply"):
            (self.out / name).write_text("old")
        self.succeeds(self.run_small("--out", self.out))
        self.assertEqual(sorted(os.listdir(self.out)), RESULT_FILES)

    def test_without_out_nothing_is_written(self):
        before = sorted(os.listdir(self.folder))
        self.succeeds(run(*self.run_arguments(), cwd=self.folder))
        self.assertEqual(sorted(os.listdir(self.folder)), before)


class Matching(ProgramTest):
    def test_finds_the_shift_of_a_picture(self):
        shift = 3
        scene = noise(WIDTH + shift, HEIGHT, 5)
        rows = [scene[y * (WIDTH + shift) :] for y in range(HEIGHT)]
        right = self.file("r.pgm", pgm(WIDTH, HEIGHT, b"".join(row[shift : shift + WIDTH] for row in rows)))
        left = self.file("l.pgm", pgm(WIDTH, HEIGHT, b"".join(row[:WIDTH] for row in rows)))
        truth = self.file("t.pgm", pgm(WIDTH, HEIGHT, bytes([2 * shift]) * (WIDTH * HEIGHT)))
        small = ["--set", "matcher.disparities=8", "--set", "matcher.filter=none"]
        table = self.succeeds(
            self.run_small(*small, "--truth", truth, "--truth-scale", "2", "--out", self.out, left=left, right=right)
        )
        answered = {d for row in read_png(self.out / "disparity.png")[3] for d in row if d != 255}
        self.assertEqual(answered, {shift})
        accuracy = self.stats()["accuracy"]
        self.assertEqual((accuracy["bad_1_percent"], accuracy["bad_2_percent"]), (0, 0))
        self.assertGreater(accuracy["answered_percent"], 40)
        self.assertIn("off by more than 1: 0.00 %", table)

    def test_converts_colour_and_says_so(self):
        grey = noise(WIDTH, HEIGHT, 1)
        colour = b"P6\n%d %d\n255\n" % (WIDTH, HEIGHT) + b"".join(bytes([v, v, v]) for v in grey)
        left = self.file("colour.ppm", colour)
        process = self.run_small("--out", self.out, left=left)
        self.succeeds(process)
        self.assertEqual(process.stderr, f"stereotlm: note: --left '{left}': colour, converted to grey\n")
        self.succeeds(self.run_small("--out", self.folder / "grey"))
        self.assertEqual(
            (self.out / "disparity.png").read_bytes(), (self.folder / "grey" / "disparity.png").read_bytes()
        )


class Output(ProgramTest):
    def test_is_a_table_and_nothing_on_standard_error(self):
        process = self.run_small()
        text = self.succeeds(process)
        for word in ("core", "bound", "bank7", "worst stall"):
            self.assertIn(word, text)
        self.assertEqual(process.stderr, "")
        self.assertNotIn("SystemC", text)

    def test_a_closed_pipe_does_not_cost_the_results(self):
        read_end, write_end = os.pipe()
        os.close(read_end)
        command = [program.PROGRAM] + [str(a) for a in self.run_arguments("--out", self.out)]
        process = program.subprocess.run(command, stdout=write_end, stderr=-1, timeout=60, check=False)
        os.close(write_end)
        self.assertEqual((process.returncode, process.stderr), (0, b""))
        self.assertEqual(sorted(os.listdir(self.out)), RESULT_FILES)

    @unittest.skipUnless(os.path.exists("/dev/full"), "no /dev/full here")
    def test_a_full_disk_behind_standard_output_is_an_error(self):
        with open("/dev/full", "w") as full:
            command = [program.PROGRAM, "keys"]
            process = program.subprocess.run(command, stdout=full, stderr=-1, text=True, timeout=60, check=False)
        self.assertEqual(process.returncode, 1)
        self.assertEqual(process.stderr, "stereotlm: error: standard output: No space left on device\n")

    def test_closed_standard_streams_do_not_get_into_the_results(self):
        command = [program.PROGRAM] + [str(a) for a in self.run_arguments("--out", self.out)]
        shell = ["sh", "-c", 'exec "$@" <&- >&- 2>&-', "sh"]
        process = program.subprocess.run(shell + command, timeout=60, check=False)
        self.assertEqual(process.returncode, 1, "the table cannot be printed")
        closed = self.result()
        self.succeeds(self.run_small("--out", self.out))
        self.assertEqual(self.result(), closed)


if __name__ == "__main__":
    program.main()
