"""check, boards, keys and bounds."""

import program
from program import SMALL, ProgramTest, run

PRESETS = [
    "fpl2003",
    "fpl2003-no-calibration",
    "fpl2003-line-buffer",
    "fpl2003-qvga",
    "fpl2003-syncburst",
    "fpl2003-triple",
]


class Check(ProgramTest):
    def test_accepts_every_preset_in_one_line(self):
        for name in PRESETS:
            text = self.succeeds(run("check", name))
            self.assertRegex(text, rf"\A{name}: ok: [^\n]*\n\Z")

    def test_sums_up_the_board_as_set(self):
        text = self.succeeds(run("check", "fpl2003", *SMALL, "--set", "matcher.window=5"))
        self.assertEqual(text, "fpl2003: ok: 32x24, window 5x5, 80 disparities, 8 banks, 40 MHz\n")

    def test_takes_a_path(self):
        for name in (b"", b"name: mine\n"):
            path = self.file("mine.yaml", b"extends: fpl2003-qvga\n" + name)
            self.assertTrue(self.succeeds(run("check", path)).startswith(f"{path}: ok: 320x240"))

    def test_says_everything_that_is_wrong_with_its_place(self):
        path = self.file("mine.yaml", b"extends: fpl2003\nimage: {width: 3, hight: 2}\n")
        lines = self.refused(run("check", path, "--set", "matcher.window=4"))
        self.assertEqual(len(lines), 3)
        self.assertTrue(lines[0].startswith(f"{path}:2:16: image.width = 3: "), lines[0])
        self.assertTrue(lines[1].startswith(f"{path}:2:19: image.hight = 2: unknown key"), lines[1])
        self.assertTrue(lines[2].startswith("--set matcher.window: matcher.window = 4: "), lines[2])

    def test_refuses_a_bank_that_is_too_small(self):
        self.refused_in_one_line(
            run("check", "fpl2003", "--set", "ssram.banks.bank6.words=307199"),
            "--set ssram.banks.bank6.words: ssram.banks.bank6.words = 307199: 1 words missing",
        )
        self.succeeds(run("check", "fpl2003", "--set", "ssram.banks.bank6.words=307200"))

    def test_refuses_boards_that_do_not_exist(self):
        self.refused_in_one_line(run("check", "fpl2004"), "fpl2004: not a preset", "nearest: fpl2003")
        self.refused_in_one_line(run("check", "./none.yaml"), "./none.yaml: cannot be read: No such file")
        self.refused_in_one_line(run("check", ""), "(empty): not a preset")

    def test_a_set_takes_one_value_each_time(self):
        self.succeeds(run("check", "--set", "matcher.window=5", "fpl2003"))
        self.succeeds(run("check", "--set=allocation.disparity=[bank0, bank1]", "fpl2003"))
        self.refused_in_one_line(run("check", "fpl2003", "--set", "x"), "--set x: x = (nothing)")
        self.refused_in_one_line(run("check", "fpl2003", "--set", "[a,b]"), "--set [a,b]: [a,b] = (nothing)")


class Boards(ProgramTest):
    def summary(self, board):
        """What check says of it, without its name."""
        return self.succeeds(run("check", board)).removeprefix(f"{board}: ")

    def test_lists_every_preset_with_what_it_is_for(self):
        text = self.succeeds(run("boards"))
        lines = text.splitlines()
        for line in lines:
            self.assertLessEqual(len(line), 100)
        self.assertEqual([line.split()[0] for line in lines if not line.startswith(" ")], PRESETS)
        self.assertIn("320x240", text)
        self.assertNotIn("#", text)

    def test_shows_a_file_that_can_be_run(self):
        for name in PRESETS:
            text = self.succeeds(run("boards", "--show", name))
            self.assertTrue(text.startswith("# "), text)
            copy = self.file("copy.yaml", text.encode())
            self.assertEqual(self.summary(copy), self.summary(name))

    def test_refuses_an_unknown_name_with_the_nearest(self):
        self.refused_in_one_line(run("boards", "--show", "fpl2003-trible"),
                                 "--show = fpl2003-trible: not a preset; nearest: fpl2003-triple; presets: fpl2003, ")
        for name in ("", "bumblebee"):
            self.refused_in_one_line(run("boards", "--show", name), f"--show = {name}: not a preset; presets: fpl2003, ")


class Keys(ProgramTest):
    def test_lists_every_key_in_a_hundred_columns(self):
        text = self.succeeds(run("keys"))
        lines = text.splitlines()
        for line in lines:
            self.assertLessEqual(len(line), 100)
        keys = [line.split()[0] for line in lines if not line.startswith(" ")][1:]
        self.assertEqual(len(keys), len(set(keys)))
        for key in ("extends", "image.width", "ssram.banks.NAME.turnaround_cycles", "matcher.lr_tolerance"):
            self.assertIn(key, keys)
        at = next(i for i, line in enumerate(lines) if line.startswith("image.width "))
        self.assertEqual(lines[at].split(), "image.width pixels width of the images".split())
        self.assertEqual(lines[at + 1].strip(), "4..2048, a multiple of 4")


class Bounds(ProgramTest):
    def parts(self, *arguments):
        """The lines about the frame rate, and those about the FPGA."""
        lines = self.succeeds(run("bounds", *arguments)).splitlines()
        at = lines.index("area of xc2v6000")
        return lines[:at], lines[at:]

    def groups(self, *arguments):
        """For each group of frames the line that heads it and its resources with their numbers; the core's bound."""
        lines, _ = self.parts(*arguments)
        groups = []
        for line in lines[: lines.index("around the board")]:
            if line.startswith("frame"):
                groups.append((line, {}))
            elif not line.split()[0] == "resource":
                *resource, cycles, rate, headroom = line.split()
                groups[-1][1][" ".join(resource)] = (int(cycles), float(rate), float(headroom))
        return groups, lines[-2]

    def around_the_board(self, *arguments):
        """What each part of the computer allows, and the system's bound."""
        lines, _ = self.parts(*arguments)
        parts = [line.split() for line in lines[lines.index("around the board") + 2 : -2]]
        return {name: float(rate) for name, rate in parts}, lines[-1]

    def test_lists_each_resource(self):
        ((head, rows),), last = self.groups("fpl2003")
        self.assertEqual(
            head, "frames 0-1: left_image in bank0, bank1; right_image in bank2, bank3; disparity in bank4, bank5"
        )
        ports = [f"port {name}" for name in ("left_lut", "right_lut", "left_pixel", "right_pixel", "result")]
        banks = ["bank bank0, bank1", "bank bank2, bank3", "bank bank4, bank5", "bank bank6", "bank bank7"]
        self.assertEqual(list(rows), ports + banks + ["matcher"])
        self.assertEqual(rows["matcher"], (2151016, 18.596, 0.0))
        self.assertEqual(last, "bound of the core: 18.596 frames/s, limited by matcher")

    def test_headroom_is_what_the_limiting_resource_takes_longer(self):
        ((_, rows),), _ = self.groups("fpl2003", *SMALL)
        most = max(cycles for cycles, _, _ in rows.values())
        for cycles, rate, headroom in rows.values():
            self.assertAlmostEqual(rate, 40e6 / cycles, places=3)
            self.assertAlmostEqual(headroom, 100 * (1 - cycles / most), places=2)

    def test_names_the_bank_that_limits_when_two_buffers_share_it(self):
        groups, last = self.groups("fpl2003", "--set", "allocation.left_lut=bank0")
        (first, shared), (second, alone) = groups
        self.assertEqual(first, "frame 0: left_image in bank0; right_image in bank2; disparity in bank4")
        self.assertEqual(second, "frame 1: left_image in bank1; right_image in bank3; disparity in bank5")
        self.assertEqual(shared["bank bank0"][2], 0.0)
        self.assertLess(alone["bank bank1"][0], shared["bank bank0"][0])
        self.assertTrue(last.endswith("limited by bank bank0"), last)

    def test_groups_the_frames_that_differ_in_the_names_of_banks_only(self):
        ((head, rows),), _ = self.groups("fpl2003-triple")
        self.assertTrue(head.startswith("frames 0-5: left_image in bank0, bank1, bank8; "), head)
        self.assertIn("bank bank2, bank3, bank9", rows)
        lists = ["--set", "allocation.left_lut=bank0", "--set", "allocation.disparity=[bank5, bank5, bank1]"]
        groups, _ = self.groups("fpl2003", *lists)
        self.assertEqual([head.split(":")[0] for head, _ in groups], ["frames 0, 2, 4", "frames 1, 3", "frame 5"])
        self.assertIn("bank bank5, bank1", groups[0][1])

    def test_lists_no_port_that_does_not_exist(self):
        ((_, rows),), _ = self.groups("fpl2003-no-calibration")
        self.assertNotIn("port left_lut", rows)

    def test_a_run_reaches_the_bound_that_is_printed(self):
        _, last = self.groups("fpl2003", *SMALL)
        table = self.succeeds(self.run_small("--frames", "2"))
        self.assertEqual(table.splitlines()[1].split()[2], last.split()[4])

    def test_lists_the_parts_of_the_computer(self):
        parts, last = self.around_the_board("fpl2003")
        self.assertEqual(list(parts), ["camera", "pci", "bridge"])
        self.assertEqual(parts["camera"], 29.97)
        self.assertEqual(last, "bound of the system: 18.596 frames/s, limited by matcher")

    def test_names_the_part_of_the_computer_that_limits(self):
        fast = ["--set", "matcher.fetch=line_buffer"]
        _, last = self.around_the_board("fpl2003", *fast)
        self.assertEqual(last, "bound of the system: 29.970 frames/s, limited by camera")
        for key, part in (("pci.clock_mhz=1", "pci"), ("bridge.local_clock_mhz=1", "bridge")):
            parts, last = self.around_the_board("fpl2003", *fast, "--set", key)
            self.assertEqual(last, f"bound of the system: {parts[part]:.3f} frames/s, limited by {part}")

    def test_lists_what_the_core_takes_of_its_fpga(self):
        _, (_, head, *items, whole, last) = self.parts("fpl2003")
        self.assertEqual(head.split(), "parts count LUTs flip-flops block RAMs multipliers".split())
        numbers = [list(map(int, line.split()[-4:])) for line in items]
        self.assertEqual(whole.split(), ["all", *(str(sum(column)) for column in zip(*numbers))])
        windows = next(line.split() for line in items if "window modules" in line)
        self.assertEqual(windows[2:], ["80", "2960", "1120", "0", "0"])
        self.assertEqual(
            last,
            "area of the core: 7420 of 33792 slices (21.96 %), 17 of 144 block RAMs, 22 of 144 multipliers",
        )
        for line in (head, *items, whole, last):
            self.assertLessEqual(len(line), 100)

    def test_says_that_a_core_does_not_fit(self):
        large = ["--set", "matcher.fetch=line_buffer", "--set", "matcher.disparities=254"]
        _, lines = self.parts("fpl2003", *large)
        self.assertRegex(lines[-1], r"^area of the core: \d+ of 33792 slices \(1\d\d\.\d\d %\), .*: does not fit$")

    def test_refuses_wrong_boards(self):
        self.refused_in_one_line(run("bounds", "fpl2003", "--set", "image.width=3"), "image.width = 3")


if __name__ == "__main__":
    program.main()
