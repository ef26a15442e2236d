"""report: the page's data, and what is refused. The page itself: report_page_test.py."""

import base64
import csv
import json
import os
import re
import shutil
import sqlite3
import struct

import program
from pictures import read_png
from report_data import data_of
from program import CAMERA_RATES, PRELOADED, SMALL, ProgramTest, run, sets

SHARED = sets("allocation.left_lut=bank0")
MOST_BYTES = 1_000_000


def csv_rows(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def png_size(url):
    head = base64.b64decode(url.partition(",")[2])
    return struct.unpack(">II", head[16:24])


class ReportTest(ProgramTest):
    def setUp(self):
        super().setUp()
        self.page = self.folder / "page.html"

    def run_of(self, name, *arguments, size=SMALL):
        out = self.folder / name
        self.succeeds(run("run", "fpl2003", *size, "--synthetic", "1", *arguments, "--out", out))
        return out

    def data(self, *inputs):
        """The data of the report, which is a small page without bytes from elsewhere."""
        self.assertRegex(self.succeeds(run("report", *inputs, "--out", self.page)), r"page\.html: \d+ kB\n$")
        text = self.page.read_text()
        self.assertLess(len(text), MOST_BYTES)
        for attribute in ('src="', "src='", 'href="http', "url(", "import("):
            self.assertNotIn(attribute, text.split('id="data">')[0])
        return data_of(self.page)


class Run(ReportTest):
    def test_holds_the_files_of_the_run_and_its_memory_chart(self):
        folder = self.run_of("a", *PRELOADED, *SHARED, "--frames", "3")
        data = self.data(folder)["run"]
        stats = self.stats(folder)
        self.assertEqual(data["stats"], stats)
        self.assertEqual(data["config_yaml"], (folder / "config.yaml").read_text())
        self.assertEqual(sum(item["luts"] for item in data["area"]["parts"]), stats["area"]["luts"])
        chart = self.folder / "chart.svg"
        self.succeeds(run("diagram", folder, "--out", chart))
        self.assertEqual(data["memory_chart"], chart.read_text())

    def test_is_printed_without_a_page_too(self):
        for number, mode in enumerate(([*PRELOADED, *SHARED], CAMERA_RATES)):
            folder = self.run_of(f"a{number}", *mode, "--frames", "12")
            page = self.data(folder)
            self.assertEqual(json.loads(self.succeeds(run("report", folder, "--json"))), page)
            printed = json.loads(self.succeeds(run("run", "fpl2003", *SMALL, "--synthetic", "1", *mode,
                                                   "--frames", "12", "--page-data")))
            self.assertEqual(png_size(printed["pictures"].pop("truth")), (program.WIDTH, program.HEIGHT))
            of_page = page["run"]
            for key in printed["stats"].keys() - of_page["stats"].keys():
                self.assertIn(key, ("disparities_percent", "waitless_frames_per_second", "accuracy"))
                printed["stats"].pop(key)
            for key in ("folder", "command", "knobs"):
                knobs = of_page.pop(key)
            self.assertEqual(printed, of_page)
            explained = run("explain", folder / "config.yaml", "--page-data",
                            *(PRELOADED if number == 0 else []))
            self.assertEqual(json.loads(self.succeeds(explained)), knobs)
            bare = json.loads(self.succeeds(run("run", "fpl2003", *SMALL, *mode, "--timing-only", "--frames",
                                                "12", "--no-record", "--page-data")))
            self.assertEqual((bare["memory_chart"], "recording" in bare), (of_page["memory_chart"], False))
        both = run("run", "fpl2003", "--timing-only", "--page-data", "--json")
        self.refused(both, "--page-data: does not go with --json")
        self.refused(run("report", folder), "--out: missing: the page to write")

    def test_a_change_takes_a_bank_that_holds_nothing_if_it_is_deep_enough(self):
        for more, idle, lacking in (((), ["bank6"], 0),
                                    (("ssram.banks.bank6.kind=qdr",), ["bank6"], 0),
                                    (("ssram.banks.bank6.words=64",), [], 1)):
            with self.subTest(more=more):
                folder = self.run_of(f"a{len(idle)}{len(more)}{more}", *PRELOADED, *SHARED, *sets(*more))
                changes = self.data(folder)["run"]["knobs"]["changes"]
                (step,) = (each for each in changes if each["key"] == "a bank more")
                self.assertEqual((step["idle_banks"], step["new_banks"]), (idle, lacking))
                for each in changes:
                    if each["key"] == "matcher.window":
                        self.assertEqual((each["idle_banks"], each["new_banks"]), ([], 0))

    def test_says_of_changes_and_differences_what_the_commands_say(self):
        a = self.run_of("a", *PRELOADED, "--frames", "6")
        b = self.run_of("b", *PRELOADED, *SHARED, "--frames", "6")
        explained = json.loads(self.succeeds(run("explain", b / "config.yaml", *PRELOADED, "--json")))
        knobs = self.data(b)["run"]["knobs"]
        of_explain = lambda shown, said: {key: shown[key] for key in said}
        changes = [of_explain(*pair) for pair in zip(knobs["changes"], explained["changes"], strict=True)]
        self.assertEqual({**of_explain(knobs, explained), "changes": changes}, explained)
        said = json.loads(self.succeeds(run("diff", a, b, "--json")))
        shown = self.data(a, b)["difference"]
        self.assertEqual({**shown, "rows": said["rows"]}, said | {"camera_frame": shown["camera_frame"]})

    def test_names_the_command_that_repeats_it(self):
        folder = self.run_of("a b'c", *PRELOADED, "--frames", "2")
        command = self.data(folder)["run"]["command"]
        again = self.folder / "again"
        self.assertTrue(command.startswith("stereotlm run ") and command.endswith(" --out DIR"))
        line = f"{program.PROGRAM} {command[len('stereotlm '):-len('DIR')]}'{again}' > /dev/null"
        self.assertEqual(os.system(line), 0)
        self.assertEqual(self.result(again), self.result(folder))

    def test_without_pixels_has_no_pictures(self):
        self.assertNotIn("pictures", self.data(self.run_of("a", *PRELOADED, "--timing-only"))["run"])

    def test_quick_leaves_out_the_changes(self):
        folder = self.run_of("a", *PRELOADED)
        (quick, whole) = (self.data(folder, *more)["run"] for more in (["--quick"], []))
        self.assertEqual({"knobs": whole.pop("knobs"), **whole}.keys() - quick.keys(), {"knobs"})
        self.assertEqual(whole, quick)

    def test_of_a_run_that_has_recorded_nothing_is_a_page_and_a_note(self):
        folder = self.run_of("a", *PRELOADED, "--no-record")
        process = run("report", folder, "--quick", "--out", self.page)
        self.succeeds(process)
        self.assertIn(f"note: '{folder}': the run has recorded nothing", process.stderr)
        data = data_of(self.page)["run"]
        self.assertNotIn("recording", data)
        self.assertEqual(set(data["pictures"]), {"disparity", "disparities"})

    def test_shows_the_first_frames_of_a_long_run_and_the_latencies_of_all(self):
        folder = self.run_of("a", *CAMERA_RATES, *SHARED, "--timing-only", "--frames", "70")
        whole = self.run_of("b", *CAMERA_RATES, *SHARED, "--timing-only", "--frames", "70", "--record")
        short, long = (self.data(each, "--quick")["run"]["recording"] for each in (folder, whole))
        self.assertEqual((short["frames"], long["frames"]), (60, 70))
        self.assertEqual(short["latency"], long["latency"])
        last = sum(self.stats(folder)["frame_cycles"][:60])
        self.assertLess(sum(short["rows"]["cycles"]), last)
        ends = [row[5] for row in short["events"]["rows"]]
        rows = [row for row in csv_rows(whole / "timeline.csv") if int(row["end_ps"]) <= max(ends)]
        self.assertEqual(rows, csv_rows(folder / "timeline.csv"))
        delivered = csv_rows(folder / "latency.csv")[59]
        self.assertLessEqual(max(ends), int(delivered["captured_ps"]) + int(delivered["latency_ps"]))

    def test_shows_the_left_picture_of_the_last_frame(self):
        pairs = self.sequence(4)
        for number, source in enumerate((PRELOADED, CAMERA_RATES)):
            out = self.folder / f"run{number}"
            self.succeeds(run("run", "fpl2003", *SMALL, *source, "--sequence", pairs, "--frames", "6",
                              "--save-frames", "--out", out))
            last = max((out / "frames").iterdir())
            url = self.data(out, "--quick")["run"]["pictures"]["left"].removeprefix("data:image/png;base64,")
            shown = self.file("shown.png", base64.b64decode(url))
            self.assertEqual(b"".join(map(bytes, read_png(shown)[3])), self.side(int(last.stem) % 4, "left"))

    def test_shows_the_first_of_the_busiest_banks(self):
        data = self.data(self.run_of("a", *PRELOADED, "--frames", "2"))["run"]
        busy = {bank["name"]: bank["busy_cycles"] for bank in data["stats"]["banks"]}
        self.assertEqual([name for name in busy if busy[name] == max(busy.values())], ["bank6", "bank7"])
        self.assertEqual(data["knobs"]["busiest_bank"]["name"], "bank6")


class RecordedFiles(ReportTest):
    """Files of a run that are changed by one pattern each: where, and which value and rule are named."""

    STATS = [
        (r'"utilization": [\d.]+', '"utilization": 7.5', 19, "banks.0.utilization = 7.5: must be 0."),
        (r'"utilization": [\d.]+', '"utilization": nan', 19, "must be as run writes it: "),
        (r'"reads": \d+', '"reads": -1', 13,
         "banks.0.reads = -1: must be an integer of 0..9223372036854775807"),
        (r'"reads": \d+', '"reads": 18446744073709551615', 13,
         "banks.0.reads = 18446744073709551615: must be"),
        (r'"reads": \d+,\n *', "", 11, "banks.0.reads: missing"),
        (r'"contended_cycles": \d+', '"contended_cycles": 99999', 11,
         "bank bank0: contended_cycles = 99999, but cycles"),
        (r'"idle_cycles": \d+', '"idle_cycles": 1', 11, "bank bank0: busy + turnaround + idle cycles"),
        (r'"name": "bank3"', '"name": "bank9"', 48, 'banks.3.name = "bank9": must be "bank3"'),
        (r'    {\n      "name": "bank3",(?s:.*?)\n    },\n', "", 21, "banks.0.energy.energy_percent = "),
        (r'"passed_cycles": \d+', '"passed_cycles": 1', 98, "port left_lut: sum of its states"),
        (r'"grants": (\d+), "stall_cycles": 0', r'"grants": \g<1>0, "stall_cycles": 0', 99,
         "port right_lut: "),
        (r'"by": "left_pixel"', '"by": "left_eye"', 106,
         'blame.0.by = "left_eye": must be one of left_lut, '),
        (r'"bank": "bank0"', '"bank": "bank7"', 106,
         'blame.0.bank = "bank7": must be a bank that the port accesses'),
        (r'"frames": 3', '"frames": 4', 5, "frames = 4: must be 3"),
        (r'"cycles": \d+,\n', '"cycles": 5,\n', 6, "cycles = 5: must be "),
        (r'"core": [\d.]+', '"core": 1', 8, "frames_per_second.core = 1: must be "),
        (r'"core_limited_by": "[^"]*"', '"core_limited_by": "luck"', 9,
         'bound.core_limited_by = "luck": must be one of'),
        (r'"schema": 1,', '"schema": 1,\n  "extra": 1,', 3, "extra = 1: must be left out"),
        (r'"schema": 1,', '"schema":  1,', 2, "must be as run writes it: keys in their order"),
        (r'"dropped_busy": \d+', '"dropped_busy": 77', 135, "camera left: dropped_frames"),
    ]
    TABLES = [
        ("conflicts.csv", r"\n0,0,0,", r"\n18446744073709551615,0,0,", 3,
         "first_row = 18446744073709551615: must be an integer of 0..23"),
        ("conflicts.csv", r"\n0,0,0,3", r"\n0,0,0,7", 3,
         "first_row = 0: must be the place of a tile, such as '0,0,0,3'"),
        ("conflicts.csv", r"\n0,0,0,3,", r"\n0,0,32,35,", 3,
         "first_column = 32: must be an integer of 0..31"),
        ("conflicts.csv", r"(\n0,0,0,3,.*)", r"\1\1", None,
         "left_lut on bank0 because of left_pixel: stalls in the tiles"),
        ("conflicts.csv", r"(?s)\n.*", "\n" + "".join(f",,,,9,port{i},bank0,host,1\n" for i in range(20000)),
         2,
         "port = port0: must be one of left_lut, right_lut, "),
        ("conflicts.csv", r",bank0,left_pixel,", ",bank9,left_pixel,", 2,
         "bank = bank9: must be one of bank0, bank1, "),
        ("conflicts.csv", r"(left_pixel),\d+\n", r"\1,1\n", None,
         "left_lut on bank0 because of left_pixel: stalls in the tiles"),
        ("conflicts.csv", r"(?s)\n.*", "\n", 1,
         "left_lut on bank0 because of left_pixel: stalls in the tiles = 0"),
        ("conflicts.csv", r"(?s).*", "", 1, "missing: the head 'first_row,"),
        ("rows.csv", r"\n0,0,0,\d+", r"\n0,0,0,nan", 3, "cycles = nan: must be an integer"),
        ("rows.csv", r"\n0,0,0,\d+", r"\n0,0,0,07", 3, "cycles = 07: must be an integer"),
        ("rows.csv", r"\n0,1,1,", r"\n0,2,2,", 4, "first_row = 2: must be the rows '1,1' of the next line"),
        ("rows.csv", r"\n0,0,0,(\d+)", r"\n0,0,0,\g<1>0", None, "recorded: cycles of frame 0"),
        ("rows.csv", r"\n2,.*", "", None, "must be the rows"),
        ("rows.csv", r"(?s)\n2,.*", "\n", None, "recorded: frames with rows = 2, but frames = 3"),
        ("rows.csv", r"\n$", "", None, "must end with a newline"),
        ("rows.csv", r"(?s).*", "frame\n", 1, "must be the head 'frame,first_row,"),
        ("timeline.csv", r"(?s)\n.*", "\n" + "".join(f"wait,c{i},,,0,0,0,0,host\n" for i in range(200000)), 2,
         "class = c0: must be a class of wait with why = host\n"),
        ("timeline.csv", r"\ndrop,left,,0,0,", r"\ndrop,left,,0,5,", 2,
         "end_ps = 0: must be an integer of 5.."),
        ("timeline.csv", r"not_armed", "tired", 2, "class = left: must be a class of drop with why = tired"),
        ("timeline.csv", r"(\nframe,cycles,.*),(\d+),0,", r"\1,1,0,", None, "recorded: words of results"),
        ("latency.csv", r",(\d+)\n1,", r",\g<1>0\n1,", 2, "latency_ps = "),
        ("latency.csv", r"\n2,.*", "", None, "recorded: latencies = 2, but frames = 3"),
        ("latency.csv", r"\n1,", "\n2,", 3, "frame = 2: must be an integer of 1..1"),
    ]

    def setUp(self):
        super().setUp()
        self.run = self.run_of("run", *CAMERA_RATES, *SHARED, "--frames", "3", "--record")

    def refuses_all(self, rows, *commands):
        for name, pattern, text, line, rule in rows:
            path = self.run / name
            before = path.read_text()
            after = re.sub(pattern, text, before, count=1)
            self.assertNotEqual(after, before, pattern)
            path.write_text(after)
            at = f"{path}:" if line is None else f"{path}:{line}: "
            for command in commands:
                with self.subTest(name=name, pattern=pattern, command=command[0]):
                    self.refused_in_one_line(run(*command), at, rule)
            path.write_text(before)

    def test_wrong_tables_are_refused(self):
        self.refuses_all(self.TABLES, ["report", self.run, "--quick", "--out", self.page])
        self.assertFalse(self.page.exists())

    def test_tables_that_an_editor_has_saved_are_read(self):
        command = ["report", self.run, "--quick", "--out", self.page]
        self.succeeds(run(*command))
        before = self.page.read_text()
        for path in self.run.glob("*.csv"):
            path.write_bytes(b"\xef\xbb\xbf" + path.read_bytes().replace(b"\n", b"\r\n"))
        self.succeeds(run(*command))
        self.assertEqual(self.page.read_text(), before)

    def test_wrong_figures_are_refused_by_every_command(self):
        right = shutil.copytree(self.run, self.folder / "right")
        rows = [("stats.json", *row) for row in self.STATS]
        quick = ["report", self.run, "--quick", "--out", self.page]
        self.refuses_all(rows, quick)
        self.refuses_all(rows[:1], ["report", self.run, "--out", self.page], ["diff", right, self.run],
                         ["conflicts", self.run], ["diagram", self.run, "--out", self.folder / "chart.svg"],
                         ["report", right, self.run, "--out", self.page])

    def test_the_tables_of_another_run_are_refused(self):
        other = self.run_of("other", *CAMERA_RATES, *SHARED, "--frames", "2", "--record")
        for name in ("stats.json", "rows.csv", "conflicts.csv", "timeline.csv", "latency.csv"):
            mine = (self.run / name).read_bytes()
            shutil.copy(other / name, self.run)
            process = run("report", self.run, "--quick", "--out", self.page)
            self.refused_in_one_line(process, f"{self.run / name}:")
            (self.run / name).write_bytes(mine)


class TwoRuns(ReportTest):
    def test_have_the_verdict_of_diff_and_the_last_camera_frame_of_both(self):
        frames = ["--frames", "6", "--save-frames"]
        a = self.run_of("a", *CAMERA_RATES, *frames)
        b = self.run_of("b", *CAMERA_RATES, *SHARED, *frames)
        data = self.data(a, b)
        verdict = self.succeeds(run("diff", a, b)).split("\n\n")[-1]
        self.assertEqual(data["difference"]["verdict"].split(), verdict.split())
        names_a, names_b = ({path.name for path in (folder / "frames").iterdir()} for folder in (a, b))
        last = max(names_a & names_b)
        self.assertNotEqual([last, last], [max(names_a), max(names_b)])
        self.assertEqual(data["difference"]["camera_frame"], int(last.split(".")[0]))
        for folder, of_run in zip((a, b), data["runs"]):
            url = of_run["pictures"]["disparity"].removeprefix("data:image/png;base64,")
            self.assertEqual(base64.b64decode(url), (folder / "frames" / last).read_bytes())

    def test_divide_the_waits_for_the_host_by_what_it_moves(self):
        a = self.run_of("a", *CAMERA_RATES, "--frames", "4")
        b = self.run_of("b", *CAMERA_RATES, *SHARED, "--frames", "4")
        (_, of_b) = self.data(a, b)["runs"]
        stalls = [(row["by"], sum(row["rows"]))
                  for row in of_b["recording"]["stalls"]]
        self.assertIn("host capture", dict(stalls))
        self.assertEqual(sum(cycles for _, cycles in stalls),
                         sum(row["cycles"] for row in self.stats(b)["blame"]))


class Refusals(ReportTest):
    def test_of_usage(self):
        self.all_refused([
            (["--out", "a.html"], "INPUT: missing"),
            (["a", "b", "c", "--out", "a.html"], "INPUT: 3 given"),
            (["a"], "--out: missing"),
            (["a", "--out", "a.txt"], "--out 'a.txt': must end in .html"),
            (["a", "b", "--out", "a.html", "--quick"], "--quick: not with two runs"),
        ], lambda *arguments: run("report", *arguments))

    def test_of_what_is_no_input(self):
        text = self.file("text.db", "no database")
        empty = self.folder / "empty.db"
        other = sqlite3.connect(empty)
        other.execute("CREATE TABLE points(a)")
        other.close()
        for path in (self.folder / "missing", self.folder, text, empty):
            with self.subTest(path=path):
                self.refused(run("report", path, "--out", self.page), path)
                self.assertFalse(self.page.exists())

    def test_of_a_database_without_points(self):
        plan = self.file("plan.yaml", "board: fpl2003\nvary: {matcher.window: [3]}\n")
        self.succeeds(run("sweep", plan, "--out", self.folder / "a.db"))
        with sqlite3.connect(self.folder / "a.db") as store:
            store.execute("DELETE FROM points")
        self.refused(run("report", self.folder / "a.db", "--out", self.page), "has no points")

    def test_leave_an_earlier_page(self):
        folder = self.run_of("a", *PRELOADED)
        self.data(folder)
        shutil.rmtree(folder)
        with self.unchanged(self.page):
            self.refused(run("report", folder, "--out", self.page))

    def test_of_a_page_that_cannot_be_written(self):
        folder = self.run_of("a", *PRELOADED)
        self.refused(run("report", folder, "--out", self.folder / "none/a.html"), "--out")


if __name__ == "__main__":
    program.main()
