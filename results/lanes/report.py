"""usage: report.py FOLDER

The folder holds core.db and stripes.db, core_rig.db and stripes_rig.db with the tables of a real rig,
sdram.db, cheap.db, and cheap_60hz.db with cameras. Writes banks.png, the tables (*.csv) and README.md beside
this script.
"""
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import study  # noqa: E402

TABLES = {"": "identity", "_rig": "real rig"}
LANES = range(1, 9)
BANKS = range(2, 10)
STRIPES = range(2, 9)
PINS_OF_A_BANK = 61
OTHER_PINS = 60
KEYS_OF_A_BANK = ("row_words", "internal_banks")


def read(folder):
    core = {"name": "name", "lanes": "fpga.lanes", "core": "frames_per_second.core", "slices": "area.slices"}
    sdram = {"name": "name", "fetch": "matcher.fetch", "core": "frames_per_second.core",
             **{f"{key} of bank{bank}": f"ssram.banks.bank{bank}.{key}"
                for key in KEYS_OF_A_BANK for bank in range(8)}}
    stripes = {"name": "name", "core": "frames_per_second.core",
               **{f"waits of {side} lane {lane}": f"ports.{side}_pixel.{lane}.stall_cycles"
                  for side in ("left", "right") for lane in range(4)}}

    def of_tables(name, columns):
        return [{"tables": tables, **point} for which, tables in TABLES.items()
                for point in study.points(folder / f"{name}{which}.db", **columns)]

    cheap = {"name": "name", "core": "frames_per_second.core", "pins": "area.pins", "slices": "area.slices"}
    computer = {"name": "name", "delivered": "frames_per_second.steady",
                "lost pixels": "cameras.left.dropped_pixels"}
    at_60_hz = {point["name"]: point for point in study.points(folder / "cheap_60hz.db", **computer)}
    found = {"core": of_tables("core", core), "stripes": of_tables("stripes", stripes),
             "cheap": [{**point, **at_60_hz[point["name"]]}
                       for point in study.points(folder / "cheap.db", **cheap)],
             "sdram": study.points(folder / "sdram.db", **sdram)}
    for point in found["sdram"]:
        for key in KEYS_OF_A_BANK:
            values = [point.pop(f"{key} of bank{bank}") for bank in range(8)]
            point[key] = next(value for value in values if value is not None)
    for point in found["core"]:
        point["banks"] = sum(map(int, point["name"].split(" + ")))
    found["core"].sort(key=lambda point: [point[key] for key in ("tables", "banks", "name", "lanes")])
    found["cheap"].sort(key=lambda point: [point["pins"], point["slices"], point["name"]])
    found["stripes"].sort(key=lambda point: [point[key] for key in ("tables", "name")])
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
    return study.markdown(["banks", "pins", *map(lane_text, LANES)], lines)


def lane_text(lanes):
    return "8 lanes, 2 rows" if lanes == 8 else f"{lanes} lane{'s' * (lanes > 1)}"


def waits(point, lane):
    return point[f"waits of left lane {lane}"] + point[f"waits of right lane {lane}"]


def stripes_table(found):
    lines = []
    for stripes in STRIPES:
        identity, rig = (study.only(found["stripes"], tables=tables, name=str(stripes))
                         for tables in TABLES.values())
        lines.append([stripes, f"{identity['core']:.2f}", f"{rig['core']:.2f}",
                      *(f"{waits(rig, lane):,}" for lane in range(4))])
    return study.markdown(["banks of each buffer", "identity", "rig",
                           *(f"lane {lane}" for lane in range(4))], lines)


def price_table(found):
    """The boards that reach a rate with the tables of the rig, and need the fewest pins or slices for it."""
    points = [point for point in found["core"] if point["tables"] == "real rig"]
    by = {"pins": lambda point: (point["banks"], point["slices"], -point["core"]),
          "slices": lambda point: (point["slices"], point["banks"], -point["core"])}
    lines = []
    for rate in (18, 30, 40, 50, 60, 100):
        for what, key in by.items():
            point = min((point for point in points if point["core"] >= rate), key=key)
            pins = OTHER_PINS + PINS_OF_A_BANK * point["banks"]
            line = [f"{point['core']:.2f}", lane_text(point["lanes"]), f"{point['banks']} ({point['name']})",
                    pins, f"{pins / point['core']:.1f}", f"{point['slices']:,}",
                    f"{point['slices'] / point['core']:.0f}"]
            lines.append([rate, what, *line])
    return study.markdown(["at least", "fewest", "frames/s", "lanes", "banks", "pins", "pins for a frame/s",
                           "slices", "slices for a frame/s"], lines)


def cheap_table(found):
    return study.markdown(["chips", "pins", "slices", "core", "delivered at 60 Hz"],
                          [[point["name"], point["pins"], f"{point['slices']:,}", f"{point['core']:.1f}",
                            f"{point['delivered']:.1f}"] for point in found["cheap"]])


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
        for lanes, color in zip(LANES, [*study.COLORS, "grey"]):
            panel.plot(BANKS, [best(found, tables, banks, lanes)["core"] for banks in BANKS], "o-",
                       color=color, markersize=4, label=lane_text(lanes))
        panel.set(xlabel="banks", ylabel="core, frames/s", ylim=(0, 140), title=tables)
    study.legend(axes[0])
    study.save(figure, HERE / "banks.png")


TEXT = """# Lanes, stripes and SDRAM

**Question.** One lane a side fetches one pixel in a cycle, and a sixth bank gives nothing. What do several
lanes give with buffers striped over banks, and would SDRAM do in place of SSRAM?

Made by `results/lanes/run` (after `./setup tests` and the release build) from [core.yaml](core.yaml),
[stripes.yaml](stripes.yaml) and [sdram.yaml](sdram.yaml): 640x480, 7x7, D = 80, the core alone. All rows are
in [core.csv](core.csv), [stripes.csv](stripes.csv) and [sdram.csv](sdram.csv). The tables of the real rig are
those of [results/calibration](../calibration/README.md).

![frames per second against banks](banks.png)

Joint tables and the word cache; frames a second of the best division of the banks. "4 + 2": the table over
four banks, pictures and results over two. Tables of the identity:

{identity}

Tables of the real rig:

{rig}

The boards that reach a rate with the tables of the rig, and need the fewest pins or the fewest slices for it:

{price}

Four lanes without word cache, separate tables, no filter: pictures and table of each side over two to eight
banks of their own. Frames a second, and with the rig the cycles that the pixel ports of each lane wait, both
sides together, in a frame:

{stripes}

The paper's board with some of its buffers in SDRAM, tables of the identity, frames a second:

{sdram}

Few chips, for 60 frames a second: line buffers, joint tables and the word cache, tables of the identity
([cheap.yaml](cheap.yaml), [cheap.csv](cheap.csv)). "40 modules": half of the matcher's difference modules,
each used twice. With cameras of 60 Hz the captures take accesses too; {lost}.

{cheap}

**Found.**

- **The cheapest memory for 60 frames a second at 7x7**, for the core alone, is one chip of ZBT with 122
  pins: {zbt_core:.1f} frames a second. Half of the modules do as well. Of SDRAM it takes two chips:
  {sdram_core:.1f}. With cameras and PCI neither delivers 60; one chip of QDR does, as do two of ZBT or three
  of SDRAM. A chip is a bank of 32 bits here; one chip for all buffers needs 1,048,576 words.
- **The matcher sets the steps.** Seven slots of a column take 7, 4, 3, 2, 2, 2 and 1 cycles with one to seven
  lanes. So five and six lanes are no faster than four where banks suffice: {four:.2f} frames a second from
  eight banks. With two rows of results at once a column has eight slots, and half as many strips: eight lanes
  then give {eight:.2f} from nine banks.
- **A table needs as many banks as there are lanes**, because each lane reads an entry for each slot. Pictures
  need fewer: the word cache takes three of four reads.
- **The rig costs {loss:.1f} %** of the rate of four lanes in eight banks ({four_rig:.2f}). Its tables bend
  rows, so that lanes of both sides meet in a bank. `stereotlm conflicts eight-banks-four-lanes --source
  preloaded --calibration F` shows them: `right_pixel` waits, mostly for `left_pixel`.
- **Seven lanes** need one bank less: {seven:.2f} frames a second from seven banks with the identity, and
  {seven_rig:.2f} with the rig. The seven entries of a column are then in four banks, two in each but one, and
  take two cycles. The matcher needs one, so that waits for pictures cost nothing.
- **Five stripes are worse than four** with the rig: {five_rig:.2f} against {of_four_rig:.2f} frames a second,
  though the lanes wait less in all. A column takes two consume-cycles. Lane 3 has one slot of it, the others
  have two. So lane 3 can wait a cycle without delay, and the others cannot. With four stripes each lane has
  a bank of its own while rows are straight; where they bend, mostly lane 3 waits for lane 2. With five, the
  second slot of lane 2 lies in the bank of the first slot of lane 1: lane 2 waits, and with it the matcher.
  `stereotlm conflicts` shows it on both boards. With four stripes the longest waits are of `right_pixel.3`
  for `right_pixel.2`, with five of `right_pixel.2` for `right_pixel.1`. With eight stripes lanes hardly
  meet: {of_eight_rig:.2f}.
- **The price.** A bank is 61 pins. From one lane to four the core takes {slices} slices more. Pins can be
  had for slices: two rows of results at once halve the reads of a frame, so that four banks do for 60 frames
  a second. The core then takes half as many slices again as with seven lanes and seven banks.
- **SDRAM for disparities costs nothing**: {disparities:.2f} frames a second. A table in it gives
  {table:.2f}, because each slot of a column is in another row of the SDRAM. Rows of 1024 words, which hold a
  row of the table and more, and 8 internal banks, which keep more rows open, are better.
- **With line buffers all eight banks may be SDRAM**: {line:.2f} of 128.56 frames a second. The preset `sdram`
  has two banks, and gets 81.8.
"""


def main():
    found = read(pathlib.Path(sys.argv[1]))
    draw(found)
    four, four_rig = (best(found, tables, 8, 4)["core"] for tables in TABLES.values())
    seven, seven_rig = (best(found, tables, 7, 7)["core"] for tables in TABLES.values())

    def typical(name, fetch="column"):
        return study.only(found["sdram"], name=name, fetch=fetch, row_words=256, internal_banks=4)["core"]

    slices = [best(found, "identity", 8, lanes)["slices"] for lanes in (1, 4)]
    def striped(stripes):
        return study.only(found["stripes"], tables="real rig", name=str(stripes))["core"]

    losing = [point["name"] for point in found["cheap"] if point["lost pixels"]]
    lost = f"pixels are lost on {', '.join(losing)}" if losing else "no board loses pixels"
    text = TEXT.format(identity=banks_table(found, "identity"), rig=banks_table(found, "real rig"),
                       price=price_table(found), stripes=stripes_table(found),
                       cheap=cheap_table(found), lost=lost,
                       zbt_core=study.only(found["cheap"], name="1 ZBT")["core"],
                       sdram_core=study.only(found["cheap"], name="2 SDRAM")["core"],
                       sdram=sdram_table(found),
                       four=four, four_rig=four_rig, loss=100 * (1 - four_rig / four),
                       eight=best(found, "identity", 9, 8)["core"], seven=seven, seven_rig=seven_rig,
                       five_rig=striped(5), of_four_rig=striped(4), of_eight_rig=striped(8),
                       slices=f"{slices[1] - slices[0]:,}", disparities=typical("disparities"),
                       table=typical("left table"), line=typical("all", "line_buffer"))
    (HERE / "README.md").write_text(text, encoding="utf-8")


main()
