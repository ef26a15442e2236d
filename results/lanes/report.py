"""usage: report.py FOLDER

The folder holds core.db, core_rig.db with the tables of a real rig, and sdram.db. Writes banks.png, core.csv,
sdram.csv and README.md beside this script.
"""
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import study  # noqa: E402
from study import style  # noqa: E402

TABLES = {"": "identity", "_rig": "real rig"}
LANES = range(1, 8)
BANKS = range(2, 10)
PINS_OF_A_BANK = 61
OTHER_PINS = 60
KEYS_OF_A_BANK = ("row_words", "internal_banks")


def read(folder):
    core = {"name": "name", "lanes": "fpga.lanes", "core": "frames_per_second.core", "slices": "area.slices"}
    sdram = {"name": "name", "fetch": "matcher.fetch", "core": "frames_per_second.core",
             **{f"{key} of bank{bank}": f"ssram.banks.bank{bank}.{key}"
                for key in KEYS_OF_A_BANK for bank in range(8)}}
    found = {"core": [{"tables": tables, **point} for which, tables in TABLES.items()
                      for point in study.points(folder / f"core{which}.db", **core)],
             "sdram": study.points(folder / "sdram.db", **sdram)}
    for point in found["sdram"]:
        for key in KEYS_OF_A_BANK:
            values = [point.pop(f"{key} of bank{bank}") for bank in range(8)]
            point[key] = next(value for value in values if value is not None)
    for point in found["core"]:
        point["banks"] = sum(map(int, point["name"].split(" + ")))
    found["core"].sort(key=lambda point: [point[key] for key in ("tables", "banks", "name", "lanes")])
    found["sdram"].sort(key=lambda point: [point[key] for key in ("name", "fetch", *KEYS_OF_A_BANK)])
    for name, points in found.items():
        study.write_csv(HERE / f"{name}.csv", points)
    return found


def best(found, tables, banks, lanes):
    """The division of the banks with the highest rate."""
    return max((point for point in found["core"]
                if (point["tables"], point["banks"], point["lanes"]) == (tables, banks, lanes)),
               key=lambda point: point["core"])


def banks_table(found, tables):
    lines = []
    for banks in BANKS:
        cells = [best(found, tables, banks, lanes) for lanes in LANES]
        lines.append([banks, OTHER_PINS + PINS_OF_A_BANK * banks,
                      *(f"{point['core']:.2f} ({point['name']})" for point in cells)])
    lines.append(["slices", "", *(best(found, tables, 9, lanes)["slices"] for lanes in LANES)])
    return study.markdown(["banks", "pins", *(f"{lanes} lane{'s' * (lanes > 1)}" for lanes in LANES)], lines)


def sdram_table(found):
    lines = []
    for name in ("disparities", "left pictures", "left table", "all"):
        for fetch in ("column", "line_buffer"):
            points = [point for point in found["sdram"] if (point["name"], point["fetch"]) == (name, fetch)]
            of_typical = [study.only(points, row_words=words, internal_banks=4)
                          for words in (128, 256, 512, 1024)]
            others = [study.only(points, row_words=256, internal_banks=count) for count in (2, 8)]
            lines.append([name, fetch, *(f"{point['core']:.2f}" for point in of_typical + others)])
    return study.markdown(["in SDRAM", "fetch", "rows of 128 words", "256", "512", "1024",
                           "256, 2 internal banks", "256, 8 internal banks"], lines)


def draw(found):
    figure, axes = study.panels(2, height=4.2, width=5)
    for panel, tables in zip(axes, TABLES.values()):
        for lanes, color in zip(LANES, style.COLORS):
            panel.plot(BANKS, [best(found, tables, banks, lanes)["core"] for banks in BANKS], "o-",
                       color=color, markersize=4, label=f"{lanes} lane{'s' * (lanes > 1)}")
        panel.set(xlabel="banks", ylabel="core, frames/s", ylim=(0, 70), title=tables)
    study.legend(axes[0])
    study.save(figure, HERE / "banks.png")


TEXT = """# Lanes, stripes and SDRAM

**Question.** One lane a side fetches one pixel in a cycle, and a sixth bank gives nothing. What do several
lanes give with buffers striped over banks, and would SDRAM do in place of SSRAM?

Made by `results/lanes/run` (after `./setup tests` and the release build) from [core.yaml](core.yaml) and
[sdram.yaml](sdram.yaml): 640x480, 7x7, D = 80, `log7`, the core alone. All rows are in [core.csv](core.csv)
and [sdram.csv](sdram.csv). The tables of the real rig are those of
[results/calibration](../calibration/README.md).

![frames per second against banks](banks.png)

Joint tables and the word cache; frames a second of the best division of the banks. "4 + 2": the table over
four banks, pictures and results over two. Tables of the identity:

{identity}

Tables of the real rig:

{rig}

The paper's board with some of its buffers in SDRAM, tables of the identity, frames a second:

{sdram}

**Found.**

- **The matcher sets the steps.** Seven slots of a column take 7, 4, 3, 2, 2, 2 and 1 cycles with one to seven
  lanes. So five and six lanes are no faster than four where banks suffice: {four:.2f} frames a second from
  eight banks.
- **A table needs as many banks as there are lanes**, because each lane reads an entry for each slot. Pictures
  need fewer: the word cache takes three of four reads.
- **The rig costs {loss:.1f} %** of the rate of four lanes in eight banks ({four_rig:.2f}). Its tables bend
  rows, so that lanes of both sides meet in a bank. `stereotlm conflicts eight-banks-four-lanes --source
  preloaded --calibration F` shows them: `right_pixel` waits, mostly for `left_pixel`.
- **Seven lanes** need one bank less: {seven:.2f} frames a second from seven banks with the identity, and
  {seven_rig:.2f} with the rig. The seven entries of a column are then in four banks, two in each but one, and
  take two cycles. The matcher needs one, so that waits for pictures cost nothing.
- **The price.** A bank is 61 pins. From one lane to four the core takes {slices} slices more.
- **SDRAM for disparities costs nothing**: {disparities:.2f} frames a second. A table in it gives
  {table:.2f}, because each slot of a column is in another row of the SDRAM. Rows of 1024 words, which hold a
  row of the table and more, and 8 internal banks, which keep more rows open, are better.
- **With line buffers all of it may be SDRAM**: {line:.2f} of 128.56 frames a second with a bank for each
  buffer. The preset `sdram` gets 81.8 from two banks.
"""


def main():
    found = read(pathlib.Path(sys.argv[1]))
    draw(found)
    four, four_rig = (best(found, tables, 8, 4)["core"] for tables in TABLES.values())
    seven, seven_rig = (best(found, tables, 7, 7)["core"] for tables in TABLES.values())

    def typical(name, fetch="column"):
        return study.only(found["sdram"], name=name, fetch=fetch, row_words=256, internal_banks=4)["core"]

    slices = [best(found, "identity", 8, lanes)["slices"] for lanes in (1, 4)]
    text = TEXT.format(identity=banks_table(found, "identity"), rig=banks_table(found, "real rig"),
                       sdram=sdram_table(found), four=four, four_rig=four_rig,
                       loss=100 * (1 - four_rig / four), seven=seven, seven_rig=seven_rig,
                       slices=f"{slices[1] - slices[0]:,}", disparities=typical("disparities"),
                       table=typical("left table"), line=typical("all", "line_buffer"))
    (HERE / "README.md").write_text(text, encoding="utf-8")


main()
