"""Each sentence about random computers agrees with the counters of their runs, and with all others."""

import concurrent.futures
import html
import json
import os
import random
import re
import shlex
import tempfile
import types
import unittest

import program
from browser import Browser
from program import run, sets, shared_folder
from report_data import data_of

COMPUTERS = int(os.environ.get("STEREOTLM_RANDOM_SENTENCES", 12))
LARGEST = (64, 48) if COMPUTERS > 12 else (40, 32)  # of the images
TIMES = ["--timing-only", "--frames", 42]  # as many frames as explain simulates
BANKS = [f"bank{number}" for number in range(4)]
PAIRS = [f"[{first}, {second}]" for first in BANKS for second in BANKS]
CHOICES = {
    "image.width": range(32, LARGEST[0] + 1, 4), "image.height": range(24, LARGEST[1] + 1),
    "matcher.disparities": range(4, 33),
    "cameras.frame_rate_hz": range(100, 1000), "fpga.arbitration": ("fixed_priority", "round_robin", "age"),
    "pci.clock_mhz": (1, 1.5, 2, 3, 12), "pci.load": ("none", "none", "{burst_words: 16, interval_us: 9}"),
    "capture.fifo_trigger_words": range(1, 5), "capture.fifo_words": (4, 6, 20, 140),
    "capture.destination": ("board", "board", "host_memory"), "allocation.left_image": PAIRS,
    "allocation.right_image": PAIRS, "allocation.disparity": PAIRS, "allocation.left_lut": BANKS,
    "allocation.right_lut": BANKS,
    "ssram.banks": ["{bank0: {}, bank1: {}, bank2: {}, bank3: {}}"],
    "ssram.default": [f"{{words: 8192, kind: {kind}}}" for kind in ("zbt_pipelined", "qdr")]}
MULTIPLES = {"fpga.clock_mhz": (4, 8), "bridge.local_clock_mhz": (1, 2, 4, 8, 16)}
NO_MULTIPLES = {"fpga.clock_mhz": (5, 7, 9, 11), "bridge.local_clock_mhz": (2, 4, 6, 8, 13)}


def said(*arguments):
    process = run(*arguments)
    assert process.returncode == 0, (arguments, process.stderr)
    return process.stdout


def stats_of(*board):
    stats = json.loads(said("run", *board, *TIMES, "--json"))
    return stats, sum(camera["dropped_pixels"] for camera in stats["cameras"])


def computer_of(seed):
    """A computer and what is said of it. Half of all lose pixels; the clocks of a third are no multiples."""
    draw, lost = random.Random(seed), None
    while lost is None or (lost > 0) != (seed % 2 == 0):
        choices = {**CHOICES, **(MULTIPLES if seed % 3 else NO_MULTIPLES)}
        options = sets(*(f"{key}={draw.choice(values)}" for key, values in choices.items()))
        stats, lost = stats_of("fpl2003", *options)
    out, page, quick = (shared_folder() / f"{seed}{ending}" for ending in ("", ".html", "quick.html"))
    texts = {"bounds": said("bounds", "fpl2003", *options)}
    texts["run"] = said("run", "fpl2003", *options, *TIMES, "--out", out)
    said("report", out, "--out", page)
    said("report", out, "--quick", "--out", quick)
    bounds = json.loads(said("bounds", "fpl2003", *options, "--json"))
    # The page holds the text of explain, for browsers without scripts, and its document.
    texts["explain"] = html.unescape(re.search("<noscript><pre>(.*?)</pre>", page.read_text(), re.S)[1])
    explained = data_of(page)["run"]["knobs"]
    busy = {bank["name"]: bank["utilization"] for bank in stats["banks"]}
    busy["pci"] = stats["pci"]["busy_clocks"] / stats["pci"]["clocks"]
    busy["bridge"] = stats["bridge"]["local_busy_clocks"] / stats["bridge"]["local_clocks"]
    rate, bound, left = stats["frames_per_second"]["steady"], bounds["bound"]["system"], stats["cameras"][0]
    rates = [(change["frames_per_second"], change["loses_pixels"]) for change in explained["changes"]]
    rates += [(rate, lost > 0), (stats["frames_per_second"]["system"], lost > 0)]
    core, free = stats["frames_per_second"]["core"], stats.get("waitless_frames_per_second", 0)
    rates += [(each, False) for each in (core, free, free - core, bounds["bound"]["core"], bound)]
    alone = {each["resource"].split()[-1]: each["frames_per_second"] for each in bounds["computer"]}
    return types.SimpleNamespace(**locals())


def shown(text, value):
    """Whether a printed number is this value, rounded."""
    return abs(float(text.replace(",", "")) - value) <= 0.500001 * 10 ** -len(text.partition(".")[2])


def is_rate(c, text, rate):
    """Whether it is a rate or a bound of the computer, and beside the loss if pixels are lost at it."""
    loses = {loses for each, loses in c.rates if shown(rate, each)}
    if any(shown(rate, each) for each in c.alone.values()) and (not loses or "bound" in text):
        return True
    return bool(loses) and (loses != {True} or re.search(r"\blos(?:e|es|ing|s|t)\b", text))


def resource_in(text):
    found = re.search(r"(PCI bus)|(bridge|local bus)|(cameras)|(matcher)|(bank\d)", text, re.I)
    return found and ("pci", "bridge", "camera", "matcher", found[0].lower())[found.lastindex - 1]


# What a sentence says, and whether that is true of the computer c: all that depends on the wording.
SENTENCES = (
    (r"(\d[\d,]*\.?\d*)(?: ± [\d.]+)? frames/s", is_rate),
    (r"^ +([\d.]+) +[-+][\d.]+ +[-+][\d.]+ .* -> ", is_rate),
    (r"(?:captures lose|with) ([\d,]+) pixels", lambda c, text, pixels: shown(pixels, c.lost)),
    (r"hold ([\d,]+) words and", lambda c, text, its: f"capture.fifo_words={its}" in c.options),
    (r"all waits cost ([\d.]+) %", lambda c, text, its: shown(its, c.explained["time_percent"]["waits"])),
    (r"(PCI bus|bridge|local bus|bank\d)((?!bus|bridge|bank).)*busy (?:in )?([\d.]+) % of",
     lambda c, text, name, _, busy: shown(busy, 100 * c.busy[resource_in(name)])),
    (r"([\d.]+) % of the bound", lambda c, text, share: shown(share, 100 * c.rate / c.bound)),
    (r"of the bound (?:of )?([\d,]+\.?\d*)", lambda c, text, bound: shown(bound, c.bound)),
    (r"of the bound", lambda c, text: c.rate <= c.bound or re.search("uncertain|los", text)),
    (r"([\d,]+) of [\d,]+ frames? of the left", lambda c, text, its: shown(its, c.left["dropped_frames"])),
    (r"of ([\d,]+) frames? of the left", lambda c, text, its: shown(its, c.left["frames"])),
    (r"(\d[\d,]*) because its capture board", lambda c, text, its: shown(its, c.left["dropped_not_armed"])),
    (r"takes ([\d,]+) slices", lambda c, text, its: shown(its, c.explained["area"]["slices"])),
    (r"(\w+) waits in ([\d.]+) % of all cycles", lambda c, text, port, share: shown(share, 100 * sum(
        row["cycles"] for row in c.stats["blame"] if row["port"] == port) / c.stats["cycles"])),
    (r"(\w+) waits there for [\w -]+ in ([\d.]+) %", lambda c, text, port, share: any(
        shown(share, row["cycles_percent"]) for row in c.explained["blame"] if row["port"] == port)))
ANSWERS = "return [...document.querySelectorAll('h1, .answers dd')].map(each => each.textContent)"


class Sentences(unittest.TestCase):
    def test_agree(self):
        browser = Browser(self.enterContext(tempfile.TemporaryDirectory()))
        self.addCleanup(browser.quit)
        with concurrent.futures.ThreadPoolExecutor(2) as threads:
            for c in threads.map(computer_of, range(COMPUTERS)):
                for page in (c.page, c.quick):
                    browser.driver.get(page.as_uri())
                    program.wait_until(lambda: browser.all("footer"))
                    c.texts[page.stem] = "\n".join(browser.run(ANSWERS)).replace("\u00a0", " ")
                    self.assertNotRegex(browser.text("main"), "undefined|NaN")
                with self.subTest(shlex.join(c.options)):
                    wrong = [*self.wrong_sentences(c), *self.contradictions(c)]
                    self.assertTrue(not wrong, "\n" + "\n".join(wrong))

    def wrong_sentences(self, c):
        for source, text in c.texts.items():
            for line in re.sub(r"\n  (?=[a-z]|\d\d?\.\d\d %)", " ", text).splitlines():
                yield from (f"{source}: {line}" for pattern, is_true in SENTENCES for found in
                            re.finditer(pattern, line, re.I) if not is_true(c, line, *found.groups()))

    def contradictions(self, c):
        its = {(each["system"], each["system_limited_by"]) for each in (c.bounds["bound"], c.stats["bound"])}
        if its != {tuple(c.explained["bound"].values())}:
            yield f"bounds: {its}, explain: {c.explained['bound']}"
        for each in c.explained["resources"]:
            rate = each["frames_per_second"]
            is_whole = not c.lost or not re.match("pci|bridge|bank", each["resource"])
            if (rate != c.alone.setdefault(each["resource"].split()[-1], rate)
                    or (each["headroom_percent"] < 0 and (is_whole or c.rate <= rate))):
                yield f"explain: {each}, bounds: {c.alone}"
        limiter = resource_in(c.explained["limited_by"].partition(":")[0])
        # A bus that carries what cameras deliver loses no pixels: their FIFOs are too small for its waits.
        is_slow = c.alone.get(limiter, 0) < 1.1 * c.alone["camera"] or c.busy.get(limiter, 0) > 0.5
        waits = limiter in [row["bank"] for row in c.explained["blame"]]
        if limiter and c.rate < 0.995 * c.alone[limiter] and not waits and not (c.lost and is_slow):
            yield f"limited by {c.explained['limited_by']}: {c.rate} frames/s, its bound {c.alone[limiter]}"
        for first in re.findall("To try it: (.*)[.]$", c.texts[c.page.stem], re.M):
            after, lost = stats_of(c.out / "config.yaml", *shlex.split(first))
            least = sum(each["frames_per_second"]["steady_uncertainty"] for each in (c.stats, after))
            gained = after["frames_per_second"]["steady"] - c.rate
            if gained <= least and (lost or not c.lost):
                yield f"first change {first}: {gained} frames/s, within the uncertainty of {least}"


if __name__ == "__main__":
    program.main()
