"""check, boards, keys and bounds; explain: what each knob does, compared with runs."""

import functools
import json
import os
import re

import program
from program import CAMERA_RATES, PRELOADED, SMALL, ProgramTest, run, sets

SHARED = sets("allocation.left_lut=bank0")  # the bank of every second left picture


class Check(ProgramTest):
    def test_explain_takes_the_lanes_of_a_port_as_one(self):
        result_last = "fpga.priority=[left_pixel, right_pixel, left_lut, right_lut, result, host]"
        shared = [*SMALL, *PRELOADED, *sets("allocation.disparity={rows: [bank0, bank5]}", result_last)]
        document = json.loads(self.succeeds(run("explain", "eight-banks-four-lanes", *shared, "--json")))
        waits = {}
        for row in document["blame"]:
            group = (row["port"].split(".")[0], row["bank"], row["by"].split(".")[0])
            lanes = 4 if "." in row["port"] else 1
            waits[group] = waits.get(group, 0) + row["cycles_percent"] / lanes
        text = self.succeeds(run("explain", "eight-banks-four-lanes", *shared))
        found = re.findall(r"(?m)^  (\w+) +on (\w+) +for (\w+) +([\d.]+)$", text)
        self.assertEqual(len(found), min(5, len(waits)))
        self.assertEqual(found[0][0], "result")
        for port, bank, by, percent in found:
            self.assertAlmostEqual(float(percent), waits[port, bank, by], delta=0.02)
        self.assertIn("  port left_lut.0-2, left_pixel.0-2, right_pixel.0-2\n", text)

    def test_explain_says_what_is_simulated_cycle_by_cycle(self):
        rows = "rows of sdram that hold the end of one buffer and the start of another"
        for name, lines in ("two-banks", []), ("sdram", [rows]):
            text = self.succeeds(run("explain", name, *SMALL, *PRELOADED))
            found = re.findall("(?m)^simulated cycle by cycle, which takes longer: (.*)$", text)
            self.assertEqual(found, lines, name)

    def test_presets_of_section_8_give_the_rates_that_they_name(self):
        for name, least in (("eight-banks-four-lanes", 65), ("seven-banks-130", 130), ("sdram", 80)):
            text = self.succeeds(run("run", name, "--source", "preloaded", "--timing-only", "--frames", "2"))
            self.assertGreater(float(text.split()[1]), least, name)
        self.assertTrue(self.succeeds(run("run", "eight-banks-four-lanes", "--source", "preloaded",
                                          "--timing-only")).splitlines()[0].endswith(
                                              "614593 cycles a frame, 1 frame"))
        pins = {name: json.loads(self.succeeds(run("check", name, "--json")))["pins"]
                for name in ("eight-banks-four-lanes", "seven-banks-130", "sdram")}
        self.assertEqual(pins, {"eight-banks-four-lanes": 548, "seven-banks-130": 487, "sdram": 172})

    def test_remarks_on_a_clock_above_the_papers(self):
        remark = "note: fpga.clock_mhz = 41: above the 40 MHz that the paper's core reached"
        for command in ("check", "bounds"):
            self.assertEqual(run(command, "fpl2003").stderr, "")
            self.assertIn(remark, run(command, "fpl2003", *sets("fpga.clock_mhz=41")).stderr)
        small = sets("image.width=32", "image.height=24")
        for command in (["allocate", "--source", "preloaded"],
                        ["optimise", "--maximise", "frames_per_second.core"]):
            words = [command[0], "fpl2003", "--banks", 2, *small, *command[1:]]
            self.assertNotIn("above the 40 MHz", run(*words).stderr)
            self.assertIn(remark, run(*words, *sets("fpga.clock_mhz=41")).stderr)

    def test_names_the_board_in_a_folder_of_results(self):
        self.succeeds(self.run_small("--out", self.out))
        said = f"{self.out}: a folder, not a board file; its board is {self.out}/config.yaml"
        for command, *options in (["check"], ["bounds"], ["explain"], ["run", "--synthetic", "1"],
                                  ["allocate", "--banks", "2", "--out", self.folder / "a.db"]):
            self.refused(run(command, self.out, *options), said)
        self.refused_in_one_line(run("check", "out", cwd=self.folder), "out: a folder",
                                 "its board is out/config.yaml")

    def test_takes_a_path(self):
        for name in ("", "name: mine\n"):
            path = self.file("mine.yaml", "extends: fpl2003-qvga\n" + name)
            self.assertTrue(self.succeeds(run("check", path)).startswith(f"{path}: ok: 320x240"))

    def test_says_everything_that_is_wrong_with_its_place(self):
        path = self.file("mine.yaml", "extends: fpl2003\nimage: {width: 3, hight: 2}\n")
        lines = self.refused(run("check", path, "--set", "matcher.window=4"))
        for line, start in zip(lines, (
            f"{path}:2:16: image.width = 3: ",
            f"{path}:2:19: image.hight = 2: unknown key",
            "--set matcher.window: matcher.window = 4: ",
        ), strict=True):
            self.assertTrue(line.startswith(start), line)

    def test_refuses_boards_and_values_that_cannot_be(self):
        self.all_refused([
            (["check", "fpl2004"], "fpl2004: not a preset", "nearest: fpl2003"),
            (["check", "./none.yaml"], "./none.yaml: cannot be read: No such file"),
            (["check", ""], "BOARD: missing"),
            (["check", "fpl2003", *sets("x")], "--set x: x = (nothing)"),
            (["check", "fpl2003", *sets("[a,b]")], "--set [a,b]: [a,b] = (nothing)"),
            (["bounds", "fpl2003", *sets("image.width=3")], "image.width = 3"),
            (["check", "fpl2003", *sets("matcher.rows=9")],
             "fpga.result_fifo_words = 8: at least 9, a word for each of the rows"),
        ])


class Boards(ProgramTest):
    def test_refuses_an_unknown_name_with_the_nearest(self):
        presets = "presets: fpl2003, "
        for name, text in (("fpl2003-trible", "nearest: fpl2003-triple; "), ("bumblebee", "")):
            text = f"--show = {name}: not a preset; {text}{presets}"
            self.refused_in_one_line(run("boards", "--show", name), text)


class Bounds(ProgramTest):
    def test_are_of_whole_turns_and_those_of_a_run_of_its_frames(self):
        shared = sets("allocation.left_lut=bank1")  # the bank of the second left picture
        said = r".* ([\d.]+) frames/s over whole turns of 2 frames, limited by bank1"
        lines = self.succeeds(run("bounds", "fpl2003", *SMALL, *shared)).splitlines()
        of_turn = float(re.fullmatch(said, lines[1])[1])
        for frames, limited_by in ((1, "matcher"), (2, "bank bank1"), (3, "bank bank1")):
            out = self.folder / str(frames)
            self.succeeds(run("run", "fpl2003", *SMALL, *PRELOADED, *shared, "--timing-only", "--frames",
                              frames, "--out", out))
            bound = self.stats(out)["bound"]
            self.assertLessEqual(self.stats(out)["frames_per_second"]["core"], bound["core"])
            self.assertEqual((bound["core_limited_by"], round(bound["core"], 3) == of_turn),
                             (limited_by, frames == 2))
            self.succeeds(run("diagram", out, "--out", self.folder / "chart.svg"))
            self.assertIn(f"bound {bound['core']:.1f} frames/s,", (self.folder / "chart.svg").read_text())

    def test_names_the_part_of_the_computer_that_limits(self):
        for key, rate, words in (("name=fast", 29.97, "the cameras"),
                                 ("pci.clock_mhz=1", 3.72, "the PCI bus"),
                                 ("bridge.local_clock_mhz=1", 3.968, "the PCI bridge")):
            said = self.succeeds(run("bounds", "fpl2003", *sets("matcher.fetch=line_buffer", key)))
            self.assertEqual(said.splitlines()[0], f"steady bound {rate:10.3f} frames/s, limited by {words}")

    def test_says_like_check_where_words_of_the_local_bus_wait_for_the_edges_of_both_clocks(self):
        waits = "its words wait for edges of two clocks. Beside an FPGA clock of 40 MHz\n  it moves "
        for command, clock, rate in ("check", 39, 76.4), ("bounds", 41, 81.8):
            self.assertNotIn("local bus:", self.succeeds(run(command, "fpl2003")))
            said = self.succeeds(run(command, "fpl2003", *sets(f"bridge.local_clock_mhz={clock}")))
            self.assertIn(f"{waits}at most {rate} MB/s at {clock} MHz, and 146.3 MB/s at 40 MHz\n", said)


def unwrapped(text):
    return re.sub(r"\n  (?=\S)", " ", text)


@functools.cache
def explained(*options):
    """The process that explains the small board with these options."""
    return run("explain", "fpl2003", *SMALL, *options)


class Explain(ProgramTest):
    def explain(self, *options):
        return self.succeeds(explained(*options))

    def test_the_resources_of_the_computer_are_those_of_a_run_and_every_knob_is_named(self):
        document = json.loads(self.explain(*CAMERA_RATES, "--json"))
        self.succeeds(run("run", "fpl2003", *SMALL, *CAMERA_RATES, "--timing-only", "--frames", 42, "--out",
                          self.out))
        stats = self.stats()
        rate = min(stats["frames_per_second"]["steady"], stats["frames_per_second"]["exact_most"])
        self.assertAlmostEqual(document["frames_per_second"], rate)
        self.assertEqual(document["blame"], [])
        self.assertLess(rate, 0.97 * stats["frames_per_second"]["core"])
        busy = {"pci": stats["pci"]["busy_clocks"] / stats["pci"]["clocks"],
                "bridge": stats["bridge"]["local_busy_clocks"] / stats["bridge"]["local_clocks"],
                "camera": stats["cameras"][0]["captured_frames"] / stats["cameras"][0]["frames"]}
        resources = {each["resource"]: each for each in document["resources"]}
        for name in ("matcher", "bank bank0", *busy):
            of = resources[name]  # the time is that from one frame of the computer to the next
            self.assertAlmostEqual(of["headroom_percent"], 100 * (1 - rate / of["frames_per_second"]))
            self.assertAlmostEqual(of["busy_percent"], 100 * busy.get(name, of["busy_percent"] / 100))
        text = unwrapped(self.explain(*CAMERA_RATES))
        keys = re.findall(r"(?m)^([a-z_]+\.[a-z_.]+)", self.succeeds(run("keys")))
        self.assertGreater(len(keys), 20)
        no_knobs = {"image.width", "image.height", "fpga.device", "fpga.package", "matcher.lr_tolerance"}
        for key in set(keys) - no_knobs:
            if not key.startswith(("pci.load", "ssram.", "matcher.filter.", "matcher.cost.", "allocation.")):
                self.assertIn(key, text)

    def test_pasted_changes_give_their_rates(self):
        """A change, pasted into run in place of earlier sets of the same key."""
        cases = [(PRELOADED, SHARED), ([], [*CAMERA_RATES, *sets("allocation.disparity=[bank0, bank5]")])]
        for source, options in cases:
            document = json.loads(self.explain(*source, *options, "--json"))
            changes = document["changes"]
            self.assertGreater(len(changes), 30)
            for change in changes[::4] + [one for one in changes if one["key"].startswith(("allocation",
                                                                                           "a bank"))]:
                keys = [pasted.partition("=")[0] for pasted in change["sets"]]
                kept = [earlier for earlier in [*SMALL, *options][1::2]
                        if earlier.partition("=")[0] not in keys]
                command = ["run", "fpl2003", *source, "--timing-only", "--frames", document["frames"],
                           "--out", self.out]
                self.succeeds(run(*command, *sets(*kept, *change["sets"])))
                rates = self.stats()["frames_per_second"]
                rate = rates["core"] if source else min(rates["steady"], rates["exact_most"])
                self.assertAlmostEqual(rate, change["frames_per_second"], msg=change["sets"])

    def test_the_limiter_is_named_first(self):
        shared = sets("allocation.left_image=[bank0, bank0]")
        small = [*SMALL, *CAMERA_RATES]
        lossy = sets("image={width: 64, height: 48}", "matcher.disparities=24")
        lost = r"captures lose \d+ pixels while 42 frames are delivered, so pictures are torn"
        cases = [
            ([*small, *shared], r"waits at bank0: left_pixel waits there for host in [\d.]+ %"),
            (small, r"the captures: the core waits [\d.]+ % of the time"),
            (sets("image={width: 80, height: 60}", "cameras.frame_rate_hz=960",
                  "pci.load={burst_words: 1, interval_us: 0, access_us: 50}"),
             rf"the PCI bus: {lost}"),
            ([*small, *sets("matcher.fetch=line_buffer")],
             "the cameras, at the bound of 1000.000 frames/s"),
            ([*lossy, *sets("cameras.frame_rate_hz=800", "bridge.local_clock_mhz=1")],
             rf"the PCI bridge: {lost}; a pair of pictures arrives in 1\.13\d ms, and takes [\d.]+ ms there"
             r"\. With this loss the rate is limited by "),
            ([*lossy, *sets("cameras.frame_rate_hz=1000", "capture.fifo_words=2",
                            "capture.fifo_trigger_words=2", "matcher.fetch=line_buffer")],
             rf"the FIFOs of the capture boards, which hold 2 words and request the bus at 2: {lost}; the "
             r"PCI bus is busy in [\d.]+ % of its clocks, .*\. With this loss the rate is limited by the "
             r"cameras, at the bound of 1000\.000 "),
        ]
        for options, limiter in cases:
            text = unwrapped(self.succeeds(run("explain", "fpl2003", *options)))
            self.assertRegex(text, rf"^fpl2003, the whole computer: [\d.]+(?: ± [\d.]+)? frames/s"
                                   rf"(?: with pixels lost)?, limited by {limiter}")

    def test_frames_are_those_of_the_option(self):
        text = self.explain(*CAMERA_RATES, "--frames", 12)
        self.assertIn("; 12 frames simulated\n", text)
        wrong = run("explain", "fpl2003", "--frames", 11)
        self.refused_in_one_line(wrong, "--frames = 11: 12..1000000, so that every board has a steady rate")

    def test_wrong_options_are_refused(self):
        self.refused(run("explain"), "BOARD: missing")
        self.refused_in_one_line(run("explain", "fpl2003", "--source", "x"), "--source = x")
        self.refused_in_one_line(run("explain", "fpl2003", *sets("matcher.window=4")), "matcher.window = 4")


if __name__ == "__main__":
    program.main()
