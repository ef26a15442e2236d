"""explain: what limits a board, and what each knob does, compared with runs."""

import os
import re

import program
from program import CAMERA_RATES, PRELOADED, SMALL, ProgramTest, run, sets

SHARED = sets("allocation.left_lut=bank0")  # the bank of every second left picture
LISTS = ("fpga.priority", "allocation.disparity")


class Explain(ProgramTest):
    def explain(self, *options):
        return self.succeeds(run("explain", "fpl2003", *SMALL, *options))

    def rows(self, text):
        """(rate, gained, knob, to) of the steps."""
        pattern = r"^ +([\d.]+) +([+-][\d.]+) +[+-][\d.]+  (.+?)(?: \*)?: .* -> (.*?)(?:  loses pixels)?$"
        return re.findall(pattern, text, re.M)

    def rate(self, *options):
        """That of a run with these options."""
        frames = 2 if "preloaded" in options else 13
        command = ["run", "fpl2003", *SMALL, "--timing-only", "--frames", frames, "--out", self.out]
        self.succeeds(run(*command, *options))
        rates = self.stats()["frames_per_second"]
        return rates["core"] if "preloaded" in options else rates["steady"]

    def compare(self, text, *options):
        """What the steps of plain keys are said to give is what they give."""
        now = self.rate(*options)
        compared = 0
        rows = self.rows(text)
        for rate, gained, knob, to in rows:
            if not re.fullmatch(r"[a-z_]+\.[a-z_]+", knob) or knob in LISTS or f"{knob}=" in "".join(options):
                continue
            found = self.rate(*options, *sets(f"{knob}={to}"))
            self.assertEqual(rate, f"{found:.3f}", knob)
            self.assertEqual(gained, f"{found - now:+.3f}", knob)
            compared += 1
        self.assertGreater(compared, 5)
        rates = [float(row[0]) for row in rows]
        self.assertEqual(rates, sorted(rates, reverse=True))

    def test_of_the_core(self):
        text = self.explain(*PRELOADED, *SHARED)
        self.compare(text, *PRELOADED, *SHARED)
        (bank_more,) = (row for row in self.rows(text) if row[2] == "a bank more")
        self.assertEqual(bank_more[3], "in one of its own")
        self.assertEqual(bank_more[0], f"{self.rate(*PRELOADED):.3f}", "as with bank6")
        now = self.rate(*PRELOADED, *SHARED)
        stats = self.stats()
        bound = f"bound {stats['bound']['core']:.3f}, limited by {stats['bound']['core_limited_by']}"
        self.assertIn(f"fpl2003, the core alone: {now:.3f} frames/s (2 frames); {bound}\n", text)
        most = max(stats["blame"], key=lambda row: row["cycles"])
        percent = f"{100 * most['cycles'] / stats['cycles']:.3f}"
        self.assertRegex(text, rf"\n  {most['port']} +on {most['bank']} +for {most['by']} +{percent}\n")
        self.assertNotIn("cameras.", text)
        self.assertNotIn("pci", text)

    def test_names_every_resource_with_its_headroom(self):
        text = self.explain(*PRELOADED, *SHARED)
        bounds = self.succeeds(run("bounds", "fpl2003", *SMALL, *SHARED))
        found = {}
        headrooms = []
        for headroom, rate, names in re.findall(r"^ +([\d.]+) +([\d.]+)  ((?:port|bank|matcher).*)$", text, re.M):
            kind, _, names = re.sub(r", in frame \d of 2", "", names).partition(" ")
            headrooms.append(float(headroom))
            found.update({f"{kind} {name}".strip(): rate for name in names.split(", ")})
        ports = [f"port {port}" for port in ("left_lut", "right_lut", "left_pixel", "right_pixel", "result")]
        for port in ports:
            self.assertRegex(bounds, rf"\n  {port} +\d+ +{found[port]}")
        self.assertLessEqual({"matcher", *(f"bank bank{bank}" for bank in (0, 1, 2, 3, 4, 5, 7))}, set(found))
        self.assertEqual(headrooms, sorted(headrooms))
        # bank0 and all ports but result have the least in the even frames, the others in the odd ones.
        self.rate(*PRELOADED, *SHARED)
        limits = zip(self.stats()["frame_cycles"], ("bank bank0", "matcher"))
        least = min(100 * (cycles / 40e6 * float(found[name]) - 1) for cycles, name in limits)
        self.assertAlmostEqual(headrooms[0], least, delta=0.01)

    def test_of_the_computer_names_its_parts_and_every_knob(self):
        text = self.explain(*CAMERA_RATES)
        rate = f"{self.rate(*CAMERA_RATES):.3f} frames/s between the first and the last delivery (13 frames)"
        self.assertIn(f"the whole computer: {rate}", text)
        self.compare(text, *CAMERA_RATES)
        for resource in ("camera", "pci", "bridge"):
            self.assertRegex(text, rf"(?m)^ +[\d.]+ +[\d.]+  {resource}$")
        self.assertIn("no port waits for another", text)
        text = re.sub(r"\n  (?=\w)", " ", text)
        keys = re.findall(r"(?m)^([a-z_]+\.[a-z_.]+)", self.succeeds(run("keys")))
        self.assertGreater(len(keys), 20)
        no_knobs = {"image.width", "image.height", "fpga.device", "matcher.lr_tolerance"}
        for key in set(keys) - no_knobs:
            if not key.startswith(("pci.load", "ssram.", "matcher.filter.", "allocation.")):
                self.assertIn(key, text)

    def test_wrong_usage(self):
        self.refused(run("explain"), "BOARD: missing")
        self.refused_in_one_line(run("explain", "fpl2003", "--source", "x"), "--source = x")
        self.refused_in_one_line(run("explain", "fpl2003", *sets("matcher.window=4")), "matcher.window = 4")
        process = run("explain", "fpl2003", env={**os.environ, "TMPDIR": str(self.left)})
        self.refused_in_one_line(process, f"error: TMPDIR = {self.left}: must be a folder")


if __name__ == "__main__":
    program.main()
