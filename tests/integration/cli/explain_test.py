"""explain: what limits a board, and what each knob does, compared with runs."""

import os
import re

import program
from program import CAMERA_RATES, HEIGHT, WIDTH, ProgramTest, run

SMALL = ["--set", f"image.width={WIDTH}", "--set", f"image.height={HEIGHT}"]
# The left table in the bank of every second left picture.
SHARED = ["--set", "allocation.left_lut=bank0"]


class Explain(ProgramTest):
    def rows(self, text):
        """(rate, gained, knob, from, to) of the steps."""
        pattern = r"^ +([\d.]+) +([+-][\d.]+) +[+-][\d.]+  (.+?)(?: \*)?: (.*) -> (.*?)(?:  loses pixels)?$"
        return [re.match(pattern, line).groups() for line in text.splitlines() if re.match(pattern, line)]

    def rate(self, *sets, source="preloaded"):
        frames = 2 if source == "preloaded" else 13
        self.succeeds(run("run", "fpl2003", "--source", source, "--timing-only", "--frames", frames, "--out", self.out, *SMALL, *sets))
        rates = self.stats()["frames_per_second"]
        return rates["core"] if source == "preloaded" else rates["steady"]

    def compare(self, text, sets, source):
        """What the steps of plain keys are said to give with what they give."""
        now = self.rate(*sets, source=source)
        compared = 0
        rows = self.rows(text)
        for rate, gained, knob, _, to in rows:
            if not re.fullmatch(r"[a-z_]+\.[a-z_]+", knob) or knob in ("fpga.priority", "allocation.disparity") or f"{knob}=" in "".join(sets):
                continue
            found = self.rate(*sets, "--set", f"{knob}={to}", source=source)
            self.assertEqual(rate, f"{found:.3f}", knob)
            self.assertEqual(gained, f"{found - now:+.3f}", knob)
            compared += 1
        self.assertEqual([float(row[0]) for row in rows], sorted((float(row[0]) for row in rows), reverse=True))
        return compared

    def test_of_the_core(self):
        text = self.succeeds(run("explain", "fpl2003", "--source", "preloaded", *SMALL, *SHARED))
        now = self.rate(*SHARED)
        stats = self.stats()
        self.assertIn(
            f"fpl2003, the core alone: {now:.3f} frames/s (2 frames); bound {stats['bound']['core']:.3f}, limited by {stats['bound']['core_limited_by']}\n", text
        )
        self.assertGreater(self.compare(text, SHARED, "preloaded"), 5)
        bank_more = [row for row in self.rows(text) if row[2] == "a bank more"]
        self.assertEqual([row[4] for row in bank_more], ["in one of its own"])
        self.assertEqual(bank_more[0][0], f"{self.rate():.3f}", "as with bank6")
        stalls = {(row["port"], row["bank"], row["by"]): row["cycles"] for row in stats["blame"]}
        (port, bank, by), cycles = max(stalls.items(), key=lambda item: item[1])
        self.assertRegex(text, rf"\n  {port} +on {bank} +for {by} +{100 * cycles / stats['cycles']:.3f}\n")
        self.assertNotIn("cameras.", text)
        self.assertNotIn("pci", text)

    def test_names_every_resource_with_its_headroom(self):
        text = self.succeeds(run("explain", "fpl2003", "--source", "preloaded", *SMALL, *SHARED))
        bounds = self.succeeds(run("bounds", "fpl2003", *SMALL, *SHARED))
        found = {}
        headrooms = []
        for headroom, rate, names in re.findall(r"^ +([\d.]+) +([\d.]+)  ((?:port|bank|matcher).*)$", text, re.M):
            names = re.sub(r", in frame \d of 2", "", names)
            kind = names.split(" ")[0]
            headrooms.append(float(headroom))
            for name in names[len(kind) :].split(","):
                found[f"{kind} {name.strip()}".strip()] = rate
        for bank in (0, 1, 2, 3, 4, 5, 7):
            self.assertIn(f"bank bank{bank}", found)
        for port in ("left_lut", "right_lut", "left_pixel", "right_pixel", "result"):
            self.assertIn(f"port {port}", found)
            self.assertRegex(bounds, rf"\n  port {port} +\d+ +{found[f'port {port}']}")
        self.assertIn("matcher", found)
        self.assertEqual(headrooms, sorted(headrooms))
        # bank0 and all ports but result have the least in the even frames, the others in the odd ones.
        self.rate(*SHARED)
        even, odd = self.stats()["frame_cycles"]
        self.assertAlmostEqual(headrooms[0], min(100 * (frame / 40e6 * float(found[name]) - 1) for frame, name in ((even, "bank bank0"), (odd, "matcher"))), delta=0.01)

    def test_of_the_computer(self):
        text = self.succeeds(run("explain", "fpl2003", *SMALL, *CAMERA_RATES))
        self.assertIn(f"the whole computer: {self.rate(*CAMERA_RATES, source='camera'):.3f} frames/s between the first and the last delivery (13 frames)", text)
        self.assertGreater(self.compare(text, CAMERA_RATES, "camera"), 5)
        for resource in ("camera", "pci", "bridge"):
            self.assertRegex(text, rf"(?m)^ +[\d.]+ +[\d.]+  {resource}$")
        self.assertIn("no port waits for another", text)

    def test_every_knob_is_somewhere(self):
        text = self.succeeds(run("explain", "fpl2003", *SMALL, *CAMERA_RATES))
        text = re.sub(r"\n  (?=\w)", " ", text)
        keys = re.findall(r"(?m)^([a-z_]+\.[a-z_.]+)", self.succeeds(run("keys")))
        self.assertGreater(len(keys), 20)
        left_out = {"image.width", "image.height", "fpga.device", "matcher.lr_tolerance"}
        for key in keys:
            if key in left_out or key.startswith(("pci.load", "ssram.", "matcher.filter.", "allocation.")):
                continue
            else:
                self.assertIn(key, text)

    def test_wrong_usage(self):
        self.refused(run("explain"), "BOARD: missing")
        self.refused_in_one_line(run("explain", "fpl2003", "--source", "x"), "--source = x")
        self.refused_in_one_line(run("explain", "fpl2003", "--set", "matcher.window=4"), "matcher.window = 4")

    def test_no_place_for_temporary_files(self):
        place = {**os.environ, "TMPDIR": str(self.left)}
        self.refused_in_one_line(run("explain", "fpl2003", env=place), f"error: TMPDIR = {self.left}: must be a folder")


if __name__ == "__main__":
    program.main()
