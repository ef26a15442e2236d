"""diagram: the memory chart of boards and of runs."""

import pathlib
import re
import xml.etree.ElementTree as ElementTree

import program
from boards_test import PRESETS
from program import PRELOADED, SMALL, ProgramTest, run, sets

ROOT = pathlib.Path(__file__).resolve().parents[3]
SVG = "{http://www.w3.org/2000/svg}"


def groups(svg, kind):
    """The groups of a class of the chart, by id."""
    found = [group for group in svg.iter(SVG + "g") if kind in group.get("class").split()]
    by_id = {group.get("id"): group for group in found}
    assert len(by_id) == len(found), "an id is there twice"
    return by_id


def texts(element):
    return [text.text for text in element.iter(SVG + "text")]


class Diagram(ProgramTest):
    def setUp(self):
        super().setUp()
        self.svg = self.folder / "chart.svg"

    def chart(self, *arguments):
        self.succeeds(run("diagram", *arguments, "--out", self.svg))
        return ElementTree.parse(self.svg).getroot()

    def test_draws_every_preset(self):
        for name in PRESETS:
            for source in ("camera", "preloaded"):
                with self.subTest(name=name, source=source):
                    svg = self.chart(name, "--source", source)
                    self.assertEqual(svg.find(SVG + "title").text, f"Memory chart of {name}")
                    self.assertEqual("part-pci" in groups(svg, "block"), source == "camera")

    def test_has_the_traffic_of_a_run(self):
        load = "pci.load={burst_words: 16, interval_us: 5}"
        for board, *options in (
            ("fpl2003", *PRELOADED, "--frames", 3, *sets("allocation.left_lut=bank0")),
            ("two-banks", *PRELOADED, "--frames", 2),
            ("fpl2003", "--frames", 5),
            ("two-banks", "--frames", 4),
            ("fpl2003-triple", "--frames", 4, *sets("capture.destination=host_memory", load, "pci.width_bits=64")),
        ):
            with self.subTest(board=board, options=options):
                self.succeeds(run("run", board, *SMALL, *self.pair, *options, "--out", self.out))
                self.compare_with_stats(groups(self.chart(self.out), "edge"))

    def compare_with_stats(self, edges):
        stats = self.stats()
        mbps = {name: float(edge.get("data-mbps")) for name, edge in edges.items()}
        for edge in edges.values():
            self.assertEqual(texts(edge), self.shown(float(edge.get("data-mbps"))))

        def is_sum(names, expected):
            self.assertAlmostEqual(sum(mbps[name] for name in names), expected, delta=1e-9 * (1 + expected))

        for bank in stats["banks"]:
            to_bank = [name for name, edge in edges.items() if edge.get("data-to") == "bank-" + bank["name"]]
            is_sum(to_bank, bank["megabytes_per_second"])
        for port in stats["ports"]:
            of_port = [name for name, edge in edges.items() if edge.get("data-from") == "port-" + port["name"]]
            is_sum(of_port, 4 * port["grants"] * 40 / stats["cycles"])
        if "pci" not in stats:
            return
        clock = 33.333
        rate = lambda words: 4 * words * clock / stats["pci"]["clocks"]
        words = {master["name"]: master["words"] for master in stats["pci"]["masters"]}
        captured = words["left_capture"] + words["right_capture"]
        to_host = stats["bridge"]["posted_words"] < captured
        is_sum(["edge-cpu-pci"], rate(words["host"]))
        is_sum(["edge-left_capture-pci", "edge-right_capture-pci"], rate(captured))
        is_sum(["edge-left_camera-left_capture"], rate(words["left_capture"]))
        is_sum(["edge-bridge-pci"], rate(words["bridge"]))
        is_sum(["edge-pci-bridge"], rate(stats["bridge"]["posted_words"]))
        is_sum(["edge-pci-host_memory"], rate(words["bridge"] + (captured if to_host else 0)))
        if "load" in words:
            is_sum(["edge-load-pci"], rate(words["load"]))
        local = 4 * (stats["bridge"]["posted_words"] + stats["bridge"]["dma_words"]) * 40 / stats["bridge"]["local_clocks"]
        is_sum(["edge-bridge-local_bus"], local)
        is_sum(["edge-local_bus-host"], local)

    @staticmethod
    def shown(value):
        """The numbers at a link: none where nothing moved."""
        return [] if value == 0 else ["<0.1" if value < 0.05 else f"{value:.1f}"]

    def test_writes_the_picture_of_the_readme(self):
        text = (ROOT / "README.md").read_text()
        command = re.search(r"stereotlm diagram (\S+) --out (\S+\.svg)", text)
        self.assertIn(f'src="{command[2]}"', text)
        self.succeeds(run("diagram", command[1], "--out", self.svg))
        self.assertEqual(self.svg.read_bytes(), (ROOT / command[2]).read_bytes(), f"must be written again: {command[0]}")

    def test_takes_a_preset_before_a_folder_of_its_name(self):
        (self.folder / "fpl2003").mkdir()
        self.succeeds(run("diagram", "fpl2003", "--out", "x.svg", cwd=self.folder))

    def test_needs_no_pictures_of_a_run(self):
        self.succeeds(self.run_small("--out", self.out))
        self.left.unlink()
        self.chart(self.out)

    def test_refuses_what_cannot_be_drawn(self):
        self.succeeds(self.run_small("--out", self.out))
        empty = self.folder / "empty"
        empty.mkdir()
        svg = ["--out", self.svg]
        self.all_refused([
            (["diagram", "fpl2003"], "--out: missing"),
            (["diagram", *svg], "BOARD: missing"),
            (["diagram", "fpl2003", "--out", "x.png"], "--out 'x.png': must end in .svg"),
            (["diagram", "fpl2003", "--out", self.folder / "none/x.svg"], "none/x.svg': there is no such folder"),
            (["diagram", "fpl2004", *svg], "fpl2004: not a preset"),
            (["diagram", "fpl2003", "--source", "disk", *svg], "--source = disk: must be camera or preloaded"),
            (["diagram", self.out, "--source", "camera", *svg], "a run has its board"),
            (["diagram", self.out, *sets("matcher.window=5"), *svg], "a run has its board"),
        ], run)
        self.refused(run("diagram", empty, *svg), "BOARD must be a board, or a folder that run --out has written")
        self.assertFalse(self.svg.exists())


if __name__ == "__main__":
    program.main()
