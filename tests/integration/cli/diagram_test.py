"""diagram: the memory chart of boards and of runs."""

import json
import pathlib
import re
import xml.etree.ElementTree as ElementTree

import program
from program import PRELOADED, SMALL, ProgramTest, run, sets

ROOT = pathlib.Path(__file__).resolve().parents[3]
SVG = "{http://www.w3.org/2000/svg}"


def groups(svg, kind):
    """The groups of a class of the chart, by id."""
    found = [group for group in svg.iter(SVG + "g") if kind in group.get("class").split()]
    by_id = {group.get("id"): group for group in found}
    assert len(by_id) == len(found), "an id is there twice"
    return by_id


class Diagram(ProgramTest):
    def setUp(self):
        super().setUp()
        self.svg = self.folder / "chart.svg"

    def chart(self, *arguments):
        self.succeeds(run("diagram", *arguments, "--out", self.svg))
        return ElementTree.parse(self.svg).getroot()

    def test_draws_every_preset(self):
        for name in (each["name"] for each in json.loads(run("boards", "--json").stdout)["boards"]):
            for source in ("camera", "preloaded"):
                with self.subTest(name=name, source=source):
                    svg = self.chart(name, "--source", source)
                    self.assertEqual(svg.find(SVG + "title").text, f"Memory chart of {name}")
                    self.assertEqual("part-pci" in groups(svg, "block"), source == "camera")

    def test_has_the_traffic_of_a_run(self):
        load = sets("pci.load={burst_words: 8, interval_us: 20}")
        to_host = sets("capture.destination=host_memory")
        for board, *options in (("fpl2003", *PRELOADED), ("eight-banks-four-lanes", *PRELOADED),
                                ("sdram", *PRELOADED), ("fpl2003", *load), ("two-banks", *load, *to_host)):
            command = ["run", board, *SMALL, *options, "--timing-only", "--frames", 3, "--out", self.out]
            self.succeeds(run(*command))
            values = json.loads(self.succeeds(run("check", self.out / "config.yaml", "--json")))["values"]
            self.has_traffic(groups(self.chart(self.out), "edge"), self.stats(), values)

    def has_traffic(self, edges, stats, values):
        """The links of each bank, port and PCI master have the sums of the figures."""
        rate = lambda edge: float(edge.get("data-mbps"))
        sum_of = lambda block: sum(rate(edge) for edge in edges.values()
                                   if block in (edge.get("data-from"), edge.get("data-to")))
        for bank in stats["banks"]:
            self.assertAlmostEqual(sum_of("bank-" + bank["name"]), bank["megabytes_per_second"], places=9)
        for port in {each["name"].split(".")[0] for each in stats["ports"]}:
            grants = sum(each["grants"] for each in stats["ports"] if each["name"].split(".")[0] == port)
            expected = 4 * grants * values["fpga.clock_mhz"] / stats["cycles"]
            if port == "host" and "pci" in stats:
                expected += rate(edges["edge-local_bus-host"])
            self.assertAlmostEqual(sum_of("port-" + port), expected, places=9)
        if "pci" in stats:
            mbps = lambda words: 4 * words * values["pci.clock_mhz"] / stats["pci"]["clocks"]
            words = {each["name"]: each["words"] for each in stats["pci"]["masters"]}
            for master, its in words.items():
                link = f"edge-{'cpu' if master == 'host' else master}-pci"
                self.assertAlmostEqual(rate(edges[link]), mbps(its), places=9)
            captured = words["left_capture"] + words["right_capture"]
            is_to_host = values["capture.destination"] == "host_memory"
            self.assertAlmostEqual(rate(edges["edge-pci-host_memory"]),
                                   mbps(words["bridge"] + captured * is_to_host), places=9)
            self.assertAlmostEqual(rate(edges["edge-pci-bridge"]), mbps(stats["bridge"]["posted_words"]),
                                   places=9)
        for edge in edges.values():
            with self.subTest(edge.get("id")):
                value = rate(edge)
                shown = [] if value == 0 else ["<0.1" if value < 0.05 else f"{value:.1f}"]
                self.assertEqual([text.text for text in edge.iter(SVG + "text")], shown)

    def test_writes_the_picture_of_the_readme(self):
        text = (ROOT / "README.md").read_text()
        command = re.search(r"stereotlm diagram (\S+) --out (\S+\.svg)", text)
        self.assertIn(f'src="{command[2]}"', text)
        self.succeeds(run("diagram", command[1], "--out", self.svg))
        self.assertEqual(self.svg.read_bytes(), (ROOT / command[2]).read_bytes(),
                         f"must be written again: {command[0]}")

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
            (["diagram", "fpl2003", "--out", self.folder / "none/x.svg"],
             "none/x.svg': there is no such folder"),
            (["diagram", "fpl2004", *svg], "fpl2004: not a preset"),
            (["diagram", "fpl2003", "--source", "disk", *svg],
             "--source = disk: must be camera or preloaded"),
            (["diagram", self.out, "--source", "camera", *svg], "a run has its board"),
            (["diagram", self.out, *sets("matcher.window=5"), *svg], "a run has its board"),
        ], run)
        self.refused(run("diagram", empty, *svg),
                     "BOARD must be a board, or a folder that run --out has written")
        self.assertFalse(self.svg.exists())


if __name__ == "__main__":
    program.main()
