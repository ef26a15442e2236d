"""check, boards, keys and bounds; explain: what each knob does, compared with runs."""

import functools
import json
import os
import re

import program
from program import CAMERA_RATES, PRELOADED, SMALL, ProgramTest, run, sets

PRESETS = [
    "fpl2003",
    "fpl2003-no-calibration",
    "fpl2003-line-buffer",
    "fpl2003-qvga",
    "fpl2003-syncburst",
    "fpl2003-triple",
    "four-rows",
    "half-the-modules",
    "two-banks",
    "two-banks-four-rows",
    "eight-banks-four-lanes",
    "seven-banks-130",
    "sdram",
    "wvga-60hz",
    "megapixel-pci64",
]
SHARED = sets("allocation.left_lut=bank0")  # the bank of every second left picture


class Check(ProgramTest):
    def test_accepts_every_preset_and_names_the_device_that_it_needs(self):
        for name in PRESETS:
            device = (r"device xc2v[68]000: fits; the smallest that fits: xc2v[1-8][05]00; "
                      r"\d+ pins(: ff1152 has 824, ff1517 1104)?")
            self.assertRegex(self.succeeds(run("check", name)), rf"\A{name}: ok: [^\n]*\n(?:{device})\n\Z")

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

    def test_names_the_board_in_a_folder_of_results(self):
        self.succeeds(self.run_small("--out", self.out))
        said = f"{self.out}: a folder, not a board file; its board is {self.out}/config.yaml"
        for command, *options in (["check"], ["bounds"], ["explain"], ["run", "--synthetic", "1"],
                                  ["allocate", "--banks", "2", "--out", self.folder / "a.db"]):
            self.refused(run(command, self.out, *options), said)
        self.refused_in_one_line(run("check", "out", cwd=self.folder), "out: a folder",
                                 "its board is out/config.yaml")

    def test_sums_up_the_board_as_set(self):
        text = self.succeeds(run("check", "fpl2003", *SMALL, *sets("matcher.window=5")))
        self.assertEqual(text, "fpl2003: ok: 32x24, window 5x5, 80 disparities, 8 banks, 40 MHz\n"
                         "device xc2v6000: fits; the smallest that fits: xc2v1500; "
                         "548 pins: ff1152 has 824, ff1517 1104\n")

    def test_takes_a_path(self):
        for name in ("", "name: mine\n"):
            path = self.file("mine.yaml", "extends: fpl2003-qvga\n" + name)
            self.assertTrue(self.succeeds(run("check", path)).startswith(f"{path}: ok: 320x240"))

    def test_takes_one_value_with_each_set(self):
        self.succeeds(run("check", "--set=allocation.disparity=[bank0, bank1]", "--set", "matcher.window=5",
                          "fpl2003"))

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
    def test_lists_every_preset_with_what_it_is_for(self):
        text = self.succeeds(run("boards"))
        lines = text.splitlines()
        self.assertLessEqual(max(map(len, lines)), 100)
        self.assertEqual([line.split()[0] for line in lines if not line.startswith(" ")], PRESETS)
        self.assertIn("320x240", text)
        self.assertNotIn("#", text)

    def test_refuses_an_unknown_name_with_the_nearest(self):
        presets = "presets: fpl2003, "
        for name, text in (("fpl2003-trible", "nearest: fpl2003-triple; "), ("bumblebee", "")):
            text = f"--show = {name}: not a preset; {text}{presets}"
            self.refused_in_one_line(run("boards", "--show", name), text)


class Keys(ProgramTest):
    def test_lists_every_key_in_a_hundred_columns(self):
        lines = self.succeeds(run("keys")).splitlines()
        self.assertLessEqual(max(map(len, lines)), 100)
        keys = [line.split()[0] for line in lines if not line.startswith(" ")][1:]
        self.assertEqual(len(keys), len(set(keys)))
        for key in ("extends", "image.width", "ssram.banks.NAME.turnaround_cycles", "matcher.lr_tolerance"):
            self.assertIn(key, keys)
        at = next(i for i, line in enumerate(lines) if line.startswith("image.width "))
        meaning = "image.width pixels width of the images, at most 2048 with a look-up table"
        self.assertEqual(" ".join(lines[at:at + 2]).split(), meaning.split())
        self.assertEqual(lines[at + 2].strip(), "4..8192, a multiple of 4")


class Bounds(ProgramTest):
    def parts(self, *assignments, board="fpl2003"):
        """The lines of `bounds`, and those that --area adds."""
        lines = self.succeeds(run("bounds", board, "--area", *sets(*assignments))).splitlines()
        at = lines.index("area of xc2v6000")
        return lines[:at], lines[at:]

    def groups(self, *assignments, board="fpl2003"):
        """For each group of frames the line above it and {resource: its numbers}; the core bound."""
        lines, _ = self.parts(*assignments, board=board)
        groups = []
        for line in lines[4 : lines.index("the whole computer, with all masters")]:
            if line.startswith("frame"):
                groups.append((line, {}))
            elif not line.split()[0] == "resource":
                *resource, cycles, rate, headroom = line.split()
                groups[-1][1][" ".join(resource)] = (int(cycles), float(rate), float(headroom))
        return groups, lines[1]

    def around_the_board(self, *assignments):
        """What each part of the computer allows, and the steady bound."""
        lines, _ = self.parts(*assignments)
        parts = [line.rsplit(maxsplit=1)
                 for line in lines[lines.index("the whole computer, with all masters") + 2 :]]
        return {name.strip(): float(rate) for name, rate in parts}, lines[0]

    def test_lists_each_resource(self):
        ((head, rows),), last = self.groups()
        buffers = "left_image in bank0, bank1; right_image in bank2, bank3; disparity in bank4, bank5"
        self.assertEqual(head, f"frames 0-1: {buffers}")
        ports = [f"port {name}" for name in ("left_lut", "right_lut", "left_pixel", "right_pixel", "result")]
        banks = ["bank0, bank1", "bank2, bank3", "bank4, bank5", "bank6", "bank7"]
        self.assertEqual(list(rows), ports + banks + ["matcher"])
        self.assertEqual(rows["matcher"], (2151016, 18.596, 0.0))
        self.assertEqual(last, "core bound       18.596 frames/s, limited by the matcher")
        ((_, rows),), _ = self.groups(board="fpl2003-no-calibration")
        self.assertNotIn("port left_lut", rows)

    def test_headroom_is_the_share_of_the_slowest_resources_time_that_a_resource_does_not_need(self):
        ((_, rows),), last = self.groups(*SMALL[1::2])
        most = max(cycles for cycles, _, _ in rows.values())
        for cycles, rate, headroom in rows.values():
            self.assertAlmostEqual(rate, 40e6 / cycles, places=3)
            self.assertAlmostEqual(headroom, 100 * (1 - cycles / most), places=2)
        table = self.succeeds(self.run_small("--frames", "2"))  # reaches the bound
        self.assertEqual(table.splitlines()[1].split()[2], last.split()[2])

    def test_names_the_bank_that_limits_when_two_buffers_share_it(self):
        groups, last = self.groups("allocation.left_lut=bank0")
        (first, shared), (second, alone) = groups
        self.assertEqual(first, "frame 0: left_image in bank0; right_image in bank2; disparity in bank4")
        self.assertEqual(second, "frame 1: left_image in bank1; right_image in bank3; disparity in bank5")
        self.assertEqual(shared["bank0"][2], 0.0)
        self.assertLess(alone["bank1"][0], shared["bank0"][0])
        self.assertTrue(last.endswith("limited by bank0"), last)

    def test_are_of_whole_turns_and_those_of_a_run_of_its_frames(self):
        shared = sets("allocation.left_lut=bank1")  # the bank of the second left picture
        said = r".* ([\d.]+) frames/s over whole turns of 2 frames, limited by bank1"
        of_turn = float(re.fullmatch(said, self.groups(*SMALL[1::2], *shared[1::2])[1])[1])
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

    def test_groups_the_frames_that_differ_in_the_names_of_banks_only(self):
        ((head, rows),), _ = self.groups(board="fpl2003-triple")
        self.assertTrue(head.startswith("frames 0-5: left_image in bank0, bank1, bank8; "), head)
        self.assertIn("bank2, bank3, bank9", rows)
        groups, _ = self.groups("allocation.left_lut=bank0", "allocation.disparity=[bank5, bank5, bank1]")
        frames = [head.split(":")[0] for head, _ in groups]
        self.assertEqual(frames, ["frames 0, 2, 4", "frames 1, 3", "frame 5"])
        self.assertIn("bank5, bank1", groups[0][1])

    def test_has_a_row_for_each_bank_of_a_stripe_and_one_for_lanes_alike(self):
        ((head, rows),), _ = self.groups(board="eight-banks-four-lanes")
        self.assertIn("disparity in bank4, bank5, bank6, bank7", head)
        self.assertEqual([name for name in rows if name.startswith("bank")], [f"bank{n}" for n in range(8)])
        lanes = [f"port {port}.{which}" for port in ("left_lut", "left_pixel", "right_pixel")
                 for which in ("0-2", "3")]
        self.assertEqual([name for name in rows if name.startswith("port")], [*lanes, "port result"])
        self.assertEqual(rows["port left_lut.0-2"][0], 614416)
        self.assertEqual(rows["port left_lut.3"][0], 307216)

    def test_names_the_part_of_the_computer_that_limits(self):
        parts, last = self.around_the_board()
        banks = [f"bank{number}" for number in range(8)]
        self.assertEqual((list(parts), parts["camera"]), (["camera", "pci", "bridge", *banks], 29.97))
        self.assertEqual(last, "steady bound     18.596 frames/s, limited by the matcher")
        limits = {"name=fast": ("camera", "the cameras"), "pci.clock_mhz=1": ("pci", "the PCI bus"),
                  "bridge.local_clock_mhz=1": ("bridge", "the PCI bridge")}
        for key, (part, words) in limits.items():
            parts, last = self.around_the_board("matcher.fetch=line_buffer", key)
            self.assertEqual(last, f"steady bound {parts[part]:10.3f} frames/s, limited by {words}")

    def test_says_like_check_where_words_of_the_local_bus_wait_for_the_edges_of_both_clocks(self):
        waits = "its words wait for edges of two clocks. Beside an FPGA clock of 40 MHz\n  it moves "
        for command, clock, rate in ("check", 39, 76.4), ("bounds", 41, 81.8):
            self.assertNotIn("local bus:", self.succeeds(run(command, "fpl2003")))
            said = self.succeeds(run(command, "fpl2003", *sets(f"bridge.local_clock_mhz={clock}")))
            self.assertIn(f"{waits}at most {rate} MB/s at {clock} MHz, and 146.3 MB/s at 40 MHz\n", said)

    def test_lists_what_the_core_takes_of_its_fpga(self):
        (*_, last, device), lines = self.parts()[0][:4], self.parts()[1]
        pins = lines.index("pins")
        _, head, *items, whole = lines[:pins]
        self.assertEqual(head.split(), "parts count LUTs flip-flops block RAMs multipliers".split())
        numbers = [list(map(int, line.split()[-4:])) for line in items]
        self.assertEqual(whole.split(), ["all", *(str(sum(column)) for column in zip(*numbers))])
        area = "7420 of 33792 slices (21.96 %), 17 of 144 block RAMs, 22 of 144 multipliers"
        self.assertEqual(last, f"area of the core: {area}")
        self.assertEqual(device, "device xc2v6000: fits; the smallest that fits: xc2v1500; "
                         "548 pins: ff1152 has 824, ff1517 1104")
        self.assertLessEqual(max(map(len, lines[1:])), 100)
        _, head, *banks, bus, status = lines[pins:]
        self.assertEqual(head.split(), "bank data control address all".split())
        self.assertEqual([line.split() for line in banks],
                         [[f"bank{number}", "32", "10", "19", "61"] for number in range(8)])
        self.assertEqual((bus.split(), status.split()), (["local", "bus", "48"], ["clocks,", "status", "12"]))
        large = sets("matcher.fetch=line_buffer", "matcher.disparities=254")
        text = self.succeeds(run("bounds", "fpl2003", *large))
        self.assertNotIn("pins\n", text)
        self.assertRegex(text, r"(?m)^area of the core: \d+ of 33792 slices \(1\d\d\.\d\d %\), .*\n"
                               r"device xc2v6000: does not fit; the smallest that fits: none; 548 pins")


def unwrapped(text):
    return re.sub(r"\n  (?=\S)", " ", text)


@functools.cache
def explained(*options):
    """The process that explains the small board with these options."""
    return run("explain", "fpl2003", *SMALL, *options)


class Explain(ProgramTest):
    def explain(self, *options):
        return self.succeeds(explained(*options))

    def test_shows_no_negative_zero(self):
        self.assertNotRegex(self.explain(), r"-0\.0+ ")  # cameras limit the board

    def rows(self, text):
        """(rate, gained, key, to, FPGA %) of the changes."""
        pattern = (r"^ +([\d.]+) +([+-][\d.]+) +[+-][\d.]+ +([+-]?[\d.]+) +[+-]?\d+  (.+?)(?: \*)?: .* -> "
                   r"(.*?)"
                   r"(?:, [+-]\d+ multipliers)?(?:, [+-]\d+ pins)?(?:  does not fit)?"
                   r"(?:  loses (?:no )?pixels)?(?:  ~)?$")
        found = re.findall(pattern, text, re.M)
        return [(rate, gained, key, to, price) for rate, gained, price, key, to in found]

    def rate(self, *options):
        """That of a run with these options."""
        frames = 6 if "preloaded" in options else 42
        command = ["run", "fpl2003", *SMALL, "--timing-only", "--frames", frames, "--out", self.out]
        self.succeeds(run(*command, *options))
        rates = self.stats()["frames_per_second"]
        return rates["core"] if "preloaded" in options else rates["steady"]

    def test_the_limiter_of_the_core_is_that_of_a_run(self):
        text = self.explain(*PRELOADED, *SHARED)
        (bank_more,) = (row for row in self.rows(text) if row[2] == "a bank more")
        self.assertEqual(bank_more[3], "in bank6")
        self.assertEqual(bank_more[0], f"{self.rate(*PRELOADED):.3f}", "as with bank6")
        now = self.rate(*PRELOADED, *SHARED)
        stats = self.stats()
        most = max(stats["blame"], key=lambda row: row["cycles"])
        percent = 100 * most["cycles"] / stats["cycles"]
        wait = f"{most['port']} waits there for {most['by']} in {percent:.2f} % of the cycles"
        bound = f"{stats['bound']['core']:.3f} frames/s"
        limiter = f"limited by waits at {most['bank']}: {wait}; all waits cost"
        self.assertTrue(unwrapped(text).startswith(f"fpl2003, the core alone: {now:.3f} frames/s, {limiter}"))
        self.assertIn(f"\ncore bound {bound}: {most['bank']}; 6 frames simulated\n", text)
        self.assertRegex(text, rf"\n  {most['port']} +on {most['bank']} +for {most['by']} +{percent:.3f}\n")
        self.assertNotIn("cameras.", text)
        self.assertNotIn("pci", text)

    def test_the_resources_of_the_computer_are_those_of_a_run_and_every_knob_is_named(self):
        text = self.explain(*CAMERA_RATES)
        rate = self.rate(*CAMERA_RATES)
        stats = self.stats()
        uncertainty = stats["frames_per_second"]["steady_uncertainty"]
        self.assertTrue(text.startswith(f"fpl2003, the whole computer: {rate:.3f} ± {uncertainty:.3f} "
                                        f"frames/s, "))
        # The headroom is of the time from one frame of the computer to the next, and not only of the core's.
        bounds = json.loads(self.succeeds(run("bounds", "fpl2003", *SMALL, *CAMERA_RATES, "--json")))
        limits = {row["resource"]: row["frames_per_second"] for row in bounds["computer"]}
        limits["matcher"] = stats["bound"]["core"]
        self.assertLess(rate, 0.97 * stats["frames_per_second"]["core"])
        busy = {"pci": stats["pci"]["busy_clocks"] / stats["pci"]["clocks"],
                "bridge": stats["bridge"]["local_busy_clocks"] / stats["bridge"]["local_clocks"],
                "camera": stats["cameras"][0]["captured_frames"] / stats["cameras"][0]["frames"]}
        for resource in ("matcher", "camera", "pci", "bridge", "bank bank0"):
            name = resource.removeprefix("bank ")
            ((headroom, percent),) = re.findall(rf"(?m)^ +([\d.]+) +([\d.]+) +[\d.]+  {name}(?:,.*)?$", text)
            self.assertAlmostEqual(float(headroom), 100 * (1 - rate / limits[resource]), delta=0.006,
                                   msg=resource)
            if resource in busy:
                self.assertAlmostEqual(float(percent), 100 * busy[resource], delta=0.0051)
        self.assertIn("no port waits for another", text)
        text = re.sub(r"\n  (?=\w)", " ", text)
        keys = re.findall(r"(?m)^([a-z_]+\.[a-z_.]+)", self.succeeds(run("keys")))
        self.assertGreater(len(keys), 20)
        no_knobs = {"image.width", "image.height", "fpga.device", "fpga.package", "matcher.lr_tolerance"}
        for key in set(keys) - no_knobs:
            if not key.startswith(("pci.load", "ssram.", "matcher.filter.", "matcher.cost.", "allocation.")):
                self.assertIn(key, text)

    def test_pasted_changes_give_their_rates(self):
        """Each change, pasted into run in place of earlier sets of the same key."""
        cases = [(PRELOADED, SHARED), ([], [*CAMERA_RATES, *sets("allocation.disparity=[bank0, bank5]")])]
        for source, options in cases:
            document = json.loads(self.explain(*source, *options, "--json"))
            changes, now = document["changes"], document["frames_per_second"]
            self.assertGreater(len(changes), 30)
            rows = self.rows(self.explain(*source, *options))
            self.assertGreater(len(rows), 5)
            rates = [float(row[0]) for row in rows]
            self.assertEqual(rates, sorted(rates, reverse=True))
            for rate, gained, key, to, price in rows:
                (change,) = (one for one in changes if (one["key"], one["to"]) == (key, to))
                found = change["frames_per_second"]
                self.assertEqual((rate, gained), (f"{found:.3f}", f"{found - now:+.3f}"), key)
                percent = change["area"]["slices_percent"] - document["area"]["slices_percent"]
                self.assertAlmostEqual(float(price), percent, delta=0.0051, msg=key)
            for change in changes[::4] + [one for one in changes if one["key"].startswith(("allocation",
                                                                                           "a bank"))]:
                keys = [pasted.partition("=")[0] for pasted in change["sets"]]
                earlier = [*SMALL, *options]
                kept = [earlier[i + 1] for i in range(0, len(earlier),
                                                      2) if earlier[i + 1].partition("=")[0] not in keys]
                command = ["run", "fpl2003", *source, "--timing-only", "--frames", document["frames"],
                           "--out", self.out]
                self.succeeds(run(*command, *sets(*kept, *change["sets"])))
                rates = self.stats()["frames_per_second"]
                self.assertEqual(rates["core" if source else "steady"], change["frames_per_second"],
                                 change["sets"])

    def test_a_change_whose_sets_are_not_its_text_has_them_below(self):
        text = self.explain(*PRELOADED, *SHARED)
        self.assertRegex(text, r"a bank more: left_image\[0\] in bank0 -> in bank6, \+61 pins\n"
                         r" {41}--set 'allocation.left_image=\[bank6, bank1\]'\n")
        self.assertRegex(text, r"matcher.fetch: column -> line_buffer\n(?! +--set)")

    def test_the_limiter_is_named_first(self):
        shared = sets("allocation.left_image=[bank0, bank0]")
        small = [*SMALL, *CAMERA_RATES]
        cases = [
            ([*small, *shared], r"waits at bank0: left_pixel waits there for host in [\d.]+ %"),
            (small, r"the captures: the core waits [\d.]+ % of the time"),
            (sets("image={width: 80, height: 60}", "cameras.frame_rate_hz=960",
                  "pci.load={burst_words: 1, interval_us: 0, access_us: 50}"),
             r"the PCI bus: captures lose \d+ pixels while 42 frames are delivered, so pictures are torn"),
            ([*small, *sets("matcher.fetch=line_buffer")],
             "the cameras, at the bound of 1000.000 frames/s"),
        ]
        for options, limiter in cases:
            text = unwrapped(self.succeeds(run("explain", "fpl2003", *options)))
            self.assertRegex(text, rf"^fpl2003, the whole computer: [\d.]+ ± [\d.]+ frames/s"
                                   rf"(?: with pixels lost)?, limited by {limiter}")

    def test_where_pixels_are_lost_it_has_the_bounds_of_bounds_and_names_the_loss_and_the_limit(self):
        board = ["fpl2003", *sets("image={width: 64, height: 48}", "matcher.disparities=24")]
        slow_bus = sets("cameras.frame_rate_hz=800", "bridge.local_clock_mhz=1")
        short_fifo = sets("cameras.frame_rate_hz=1000", "capture.fifo_words=2",
                          "capture.fifo_trigger_words=2", "matcher.fetch=line_buffer")
        lost = r"captures lose (\d+) pixels while 12 frames are delivered, so pictures are torn"
        limited = r"\. With this loss the rate is limited by "
        cases = [
            (slow_bus, rf"the PCI bridge: {lost}; a pair of pictures arrives in 1\.13\d ms, and takes "
                       rf"[\d.]+ ms there{limited}"),
            (short_fifo, rf"the FIFOs of the capture boards, which hold 2 words and request the bus at 2: "
                         rf"{lost}; the PCI bus is busy in [\d.]+ % of its clocks, .*{limited}the cameras, "
                         rf"at the bound of 1000\.000 "),
        ]
        for options, said in cases:
            explained_now = functools.partial(run, "explain", *board, *options, "--frames", 12)
            self.succeeds(run("run", *board, *options, "--timing-only", "--frames", 12, "--out", self.out))
            stats = self.stats()
            document = json.loads(self.succeeds(explained_now("--json")))
            bounds = json.loads(self.succeeds(run("bounds", *board, *options, "--json")))
            shown = {row["resource"]: row for row in document["resources"]}
            for row in bounds["computer"]:
                self.assertEqual(shown[row["resource"]]["frames_per_second"], row["frames_per_second"])
            self.assertEqual(document["bound"]["frames_per_second"], bounds["bound"]["system"])
            self.assertEqual(stats["bound"]["system"], bounds["bound"]["system"])
            dropped = sum(camera["dropped_pixels"] for camera in stats["cameras"])
            self.assertEqual(document["lost_pixels"], dropped)
            for name, row in shown.items():
                if name not in ("pci", "bridge") and not name.startswith("bank "):
                    self.assertGreaterEqual(row["headroom_percent"], 0, name)
            self.assertRegex(document["limited_by"], f"^{said}")
            self.assertEqual(int(re.search(lost, document["limited_by"])[1]), dropped)
        text = unwrapped(self.succeeds(explained_now()))
        head = r"^fpl2003, the whole computer: [\d.]+ ± [\d.]+ frames/s with pixels lost, limited by "
        self.assertEqual(document["limited_by"], re.match(head + "(.*)", text)[1])
        for row in re.findall(r"(?m)^ +[\d.]+ +[+-][\d.]+ .*: .* -> .*$", text):
            self.assertRegex(row, "loses (no )?pixels")
        self.assertLess(shown["pci"]["busy_percent"], 50)

    def test_frames_are_those_of_the_option(self):
        text = self.explain(*CAMERA_RATES, "--frames", 12)
        self.assertIn("; 12 frames simulated\n", text)
        wrong = run("explain", "fpl2003", "--frames", 11)
        self.refused_in_one_line(wrong, "--frames = 11: 12..1000000, so that every board has a steady rate")

    def test_a_result_queue_that_is_too_short_is_named(self):
        rows = sets("matcher.rows=4", "matcher.disparities=4")
        short = [*PRELOADED, *rows, *sets("fpga.result_fifo_words=4")]
        said = "limited by the result queue, which is too short: in"
        text = self.explain(*short)
        rate = self.rate(*short)
        lost = 100 * (1 - rate / self.stats()["bound"]["core"])
        self.assertGreater(lost, 1)
        self.assertIn(f"{said} {lost:.2f} % of the cycles the matcher waits for a place in it "
                      f"(fpga.result_fifo_words)\n",
                      unwrapped(text))
        self.assertLessEqual(max(map(len, text.splitlines())), 100)
        # The step to five rows would need a longer queue. That to the line buffer is one to a single row.
        self.assertIn("\nnot possible here: matcher.rows: 4 -> 5, because fpga.result_fifo_words = 4: at "
                      "least 5", text)
        (fetch,) = (row for row in self.rows(text) if row[2] == "matcher.fetch")
        self.assertEqual(fetch[3], "line_buffer, matcher.rows 1")
        line_buffer = sets("matcher.disparities=4", "matcher.fetch=line_buffer", "fpga.result_fifo_words=4")
        self.assertEqual(fetch[0], f"{self.rate(*PRELOADED, *line_buffer):.3f}")
        text = self.explain(*PRELOADED, *rows)  # with 8 words
        self.assertNotIn(said, unwrapped(text))
        self.assertNotIn("not possible", text)
        # Where a port waits for a bank it cannot be told, even if the matcher limits and waits for the queue.
        for waits in ("allocation.left_lut=bank0", "allocation.disparity=[bank0, bank0]"):
            self.assertNotIn(said, unwrapped(self.explain(*short, *sets(waits))))

    def test_wrong_options_are_refused(self):
        self.refused(run("explain"), "BOARD: missing")
        self.refused_in_one_line(run("explain", "fpl2003", "--source", "x"), "--source = x")
        self.refused_in_one_line(run("explain", "fpl2003", *sets("matcher.window=4")), "matcher.window = 4")
        process = run("explain", "fpl2003", env={**os.environ, "TMPDIR": str(self.left)})
        self.refused_in_one_line(process, f"error: TMPDIR = {self.left}: must be a folder")


if __name__ == "__main__":
    program.main()
