"""usage: report.py FOLDER

The folder holds rig_left.lut and rig_right.lut, and ports, banks and cameras.db, each also with the tables of
the rig (ports_rig.db, ..). Reads these, and what `allocate --json` has printed beside this script. Writes
banks.png, misses.png and README.md beside it.
"""
import pathlib
import sys

import numpy

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import study  # noqa: E402

# By name of the output file: what `allocate` searched.
SEARCHES = {
    "core": "as the paper",
    "core_joint": "joint tables",
    "core_cache": "word cache",
    "core_both": "both",
    "core_both_four_rows": "both, four rows",
    "computer_both": "computer, both",
}
DRAWN = {
    "core": study.BLUE,
    "core_joint": study.GREEN,
    "core_cache": study.ORANGE,
     "core_both": study.VERMILION}
BANKS = range(2, 9)
# The points of ports.yaml and of banks.yaml.
PORTS = ("two banks", "no cache", "round robin", "age", "queues of 8", "queues of 11", "queues of 12",
         "queues of 64")
PLACES = {
    "one bank": "one bank, `two-banks`",
    "one qdr": "one bank, `qdr`",
    "results apart": "results in a third bank",
    "right apart": "right pictures in a third bank",
    "right apart and qdr": "right pictures in a third bank, the others in a `qdr` one",
     "all apart": "left, right and results in three banks"}
SIDES = ("left", "right")
TABLES = {"": "identity", "_rig": "real rig"}
WIDTH, HEIGHT, WINDOW, FILTER_ROWS = 640, 480, 7, 3
REACH = 32  # of the means of the map, in pixels


def identity():
    rows, columns = numpy.divmod(numpy.arange(WIDTH * HEIGHT), WIDTH)
    return (1 << 31 | rows << 16 | columns).reshape(HEIGHT, WIDTH)


def times_read():
    """How many strips of a frame read each row: those with v + h - r + k = row."""
    radius = WINDOW // 2
    first = -max(0, FILTER_ROWS - radius)
    top = numpy.arange(first, HEIGHT) + FILTER_ROWS - radius
    return numpy.array([numpy.count_nonzero((top <= row) & (row < top + WINDOW)) for row in range(HEIGHT)])


def misses(table):
    """By the rules of the word cache (contract, 7.4): maps of the slots that have a source pixel, and of
    those of them
    that read, which are the same in each strip; then of those that read as a row's first, and of the others
    those whose
    source is in other words across, and those whose source is in another row of the picture only."""
    valid = table >> 31 == 1
    rows, columns = table >> 16 & 0x7FF, table & 0x7FF
    at = numpy.maximum.accumulate(numpy.where(valid, numpy.arange(WIDTH), -1), axis=1)
    before = numpy.hstack([numpy.full((HEIGHT, 1), -1), at[:, :-1]])
    first = valid & (before < 0)
    earlier = numpy.maximum(before, 0)
    same_row = numpy.take_along_axis(rows, earlier, 1) == rows
    same_word = numpy.take_along_axis(columns // 4, earlier, 1) == columns // 4
    others = valid & ~first
    across, row_only = others & ~same_word, others & same_word & ~same_row
    return {
    "valid": valid,
    "read": first | across | row_only,
    "first": first,
    "across": across,
     "row_only": row_only}


def read_tables(folder):
    tables = {("", side): identity() for side in SIDES}
    for side in SIDES:
        words = numpy.fromfile(folder / f"rig_{side}.lut", "<u4").astype(numpy.int64)
        tables["_rig", side] = words.reshape(HEIGHT, WIDTH)
    return tables


def in_a_frame(mask):
    return int(numpy.dot(numpy.count_nonzero(mask, axis=1), times_read()))


def check(maps, runs):
    """The sums of the maps are what the run has counted."""
    for (which, side), found in maps.items():
        granted = study.only(runs["banks" + which], name="one bank", rows=1)[f"{side}_grants"]
        if in_a_frame(found["read"]) != granted:
            raise SystemExit(
                f"{side}{which}: {in_a_frame(found['read'])} misses by the table, {granted} words read by "
                "the run")


def reads_table(maps):
    lines = []
    for (which, side), found in maps.items():
        counts = {name: in_a_frame(found[name]) for name in found}
        valid = counts.pop("valid")
        lines.append([f"{TABLES[which]}, {side}",
    f"{valid:,}",
    f"{counts['read']:,}",
    f"{100 * counts['read'] / valid:.1f}",
    *(f"{100 * counts[name] / valid:.1f}" for name in ("across",
    "row_only",
     "first"))])
    return study.markdown(["tables, port",
    "slots with a pixel",
    "words read",
    "% of the slots",
    "next word across, %",
    "only another row, %",
    "first of a row, %"],
     lines)


def runs_table(runs, plan, names):
    lines = []
    for name, what in names.items():
        cells = []
        for rows in (1, 4):
            for which in TABLES:
                point = study.only(runs[plan + which], name=name, rows=rows)
                cells += [f"{point['core']:.2f}", f"{point['left_stalls'] + point['right_stalls']:,}"]
        lines.append([what, *cells])
    header = [
    f"{rows} {'row' if rows == 1 else 'rows'}, {what}" for rows in (
        1, 4) for what in TABLES.values()]
    return study.markdown(["", *(cell for text in header for cell in (text, "waits"))], lines)


def cameras_table(runs):
    lines = []
    for name in ("two banks", "host first", "three banks", "four banks", "five banks", "eight banks"):
        cells = []
        for rows in (1, 4):
            for which in TABLES:
                point = study.only(runs["cameras" + which], name=name, rows=rows)
                if point["dropped_pixels"]:
                    raise SystemExit(f"{name}{which}: pixels are lost")
                cells += [f"{point['core']:.2f}", f"{point['steady']:.2f}"]
        lines.append(["two banks, the host first" if name == "host first" else name, *cells])
    header = [f"{hz}, {what}" for hz in ("1 row, 29.97 Hz", "4 rows, 60 Hz") for what in TABLES.values()]
    return study.markdown(["", *(cell for text in header for cell in (text + ", core", "steady"))], lines)


def draw_banks(found):
    figure, (left, right) = study.panels(2, height=4, width=4.8)
    for name, color in DRAWN.items():
        for which, look in (("", "o-"), ("_rig", "s--")):
            rates = found[name + which]
            left.plot(list(rates), [row["best"] for row in rates.values()], look, color=color, markersize=5,
                      markerfacecolor="white" if which else color, label=f"{SEARCHES[name]}, {TABLES[which]}")
    left.set(title="the core alone")
    for which, look in (("", "o-"), ("_rig", "s--")):
        rates = found["computer_both" + which]
        right.plot(list(rates),
    [row["best"] for row in rates.values()],
    look,
    color=study.VERMILION,
    markersize=5,
    markerfacecolor="white" if which else study.VERMILION,
     label=f"steady, {TABLES[which]}")
    right.set(title="the whole computer, joint tables and word cache")
    for axis in (left, right):
        axis.set(xlabel="banks", ylabel="best rate, frames/s", xticks=BANKS, ylim=(0, 20))
        study.legend(axis, fontsize=7.5, loc="lower right")
    study.save(figure, HERE / "banks.png")


def smooth(mask):
    """The mean around each pixel, weighted by the distance in columns and in rows."""
    weights = REACH - numpy.abs(numpy.arange(1 - REACH, REACH))
    for axis in (0, 1):
        mask = numpy.apply_along_axis(
    numpy.convolve,
    axis,
    mask.astype(float),
    weights /
    weights.sum(),
     "same")
    return mask


def draw_misses(maps):
    figure, axes = study.panels(2, height=3.6, width=5.2)
    for axis, side in zip(axes, SIDES):
        found = maps["_rig", side]
        share = 100 * smooth(found["read"]) / numpy.maximum(smooth(found["valid"]), 1e-3)
        shown = axis.imshow(numpy.ma.masked_where(~found["valid"], share), vmin=20, vmax=32)
        axis.set(title=f"{side} port", xlabel="column of the rectified picture, pixels", ylabel="row, pixels")
        axis.grid(False)
        axis.set_facecolor("#D9D9D9")
        figure.colorbar(shown, ax=axis, label="slots that read a word, %")
    study.save(figure, HERE / "misses.png")


def read_runs(folder):
    columns = {"name": "name",
    "rows": "matcher.rows",
    "core": "frames_per_second.core",
    "clock_mhz": "fpga.clock_mhz",
    **{f"{side}_grants": f"ports.{side}_pixel.grants" for side in SIDES},
     **{f"{side}_stalls": f"ports.{side}_pixel.stall_cycles" for side in SIDES}}
    cameras = {**columns, "steady": "frames_per_second.steady",
        "dropped_pixels": "cameras.left.dropped_pixels"}
    return {plan + which: study.points(folder / f"{plan}{which}.db",
    **(cameras if plan == "cameras" else columns)) for plan in ("ports",
    "banks",
     "cameras") for which in TABLES}


TEXT = """# How few banks, with joint tables and a word cache?

**Question.** The core reads four words in nearly every clock, so the paper's board needs five banks for its
rate ([results/banks](../banks/README.md)). One table for both sides saves one of the four. A cache that keeps
the last word of each row saves three quarters of two others. How few banks are then enough: with the identity
as tables, with those of a real rig, and with cameras?

Made by `results/two_banks/run` (after `./setup tests` and the release build). 640x480, 7x7, D = 80, `log7`,
banks of 524,288 words. The tables of the real rig are those of
[results/calibration](../calibration/README.md), from 13 pairs of chessboards. `stereotlm allocate` tries
every placement of the buffers; what it says is beside this page: {files}.

![best frame rate against banks](banks.png)

Best frames a second with so many banks, the first that ties with the best of all in bold. The rows of the
computer are steady rates over 120 frames, cameras at 29.97 Hz, no pixel lost.

{best}

The core alone, both knobs, tables of the real rig (`core_both_rig.json`):

{core_rig}

The whole computer, both knobs, tables of the real rig (`computer_both_rig.json`):

{computer_rig}

## Which words are read

{reads}

The counts follow from the tables alone, by the rules of the cache; the run reads exactly as many (checked
when this page is made). The map shows where, for the real rig, as means over {reach} pixels around each; in
the grey part the left table has no source. The identity has 25 % everywhere.

![share of slots that read a word, left and right](misses.png)

## What the banks do

Clocks in which the pixel ports wait and frames a second of the core alone. Pictures and results share bank1
of `two-banks`; who may go first there, and the length of the queues ([ports.yaml](ports.yaml)):

{ports}

Pictures and results in one, two or three banks beside that of the table ([banks.yaml](banks.yaml)):

{banks}

With cameras, 61 frames ([cameras.yaml](cameras.yaml)). The host comes last in the priorities of `two-banks`.
Eight banks are the paper's, without either knob:

{cameras}

**Found.**

- **Two banks do what eight did**, with the identity: {two_cycles:,} clocks a frame against {eight_cycles:,},
  because the right port waits {two_stalls} clocks once a frame. With four rows at once the same two banks
  give {two_rows:.2f} frames a second. Two are the fewest that hold the buffers.
- Both knobs are needed. Each table is read in 99 % of all clocks and so needs a bank for itself: with joint
  tables alone it takes four banks, with the cache alone three.
- **The real rig costs {rig_loss:.1f} % in two banks**: {rig_two:.2f} frames a second, {rig_two_rows:.2f} with
  four rows at once. That no other placement in two banks is better is proved (`two_banks_rig.json`). Three
  banks give {rig_three:.2f}, four the full rate.
- It is not the number of words. The rig reads {rig_words:,} words a frame, the identity {identity_words:,}.
  On average a step of one column in the rectified picture is less than one column in the camera's, because
  the lenses squeeze the sides, so the next word comes later. And the left table has no source for 11 % of its
  entries. On the other hand 3 % of the slots read only because a row of the rectified picture crosses into
  another row of the camera's, most of them in the corners, where rows are bent most (5 %; 1 % in the middle).
  The bank is busy in 48 % of the clocks.
- It is *when*. The seven slots of a column mostly come to their next words together, so a lane reads in
  bursts of seven. With the identity each lane has a burst in every fourth column. The right lane waits for
  the first one, and for the rest of the frame its bursts are seven clocks behind those of the left one, in
  their gaps. With the rig the bursts of the two sides come at different distances, and meet again and again.
- What a lane loses is never made up: it handles one slot a clock, and the matcher consumes one a clock. Each
  clock that the right port waits makes the frame one clock longer ({rig_extra:,} of each). So longer queues
  do not help, and the bound, which counts words, still says 18.60.
- To keep the bursts apart, one lane has to fall behind the other by a burst. A fixed order does that, and
  `age` too. Round robin keeps the lanes in step and loses {robin_loss:.1f} % with the identity. Queues of
  fewer than 12 slots lose as well: they cannot hold a burst and the latencies. With the rig round robin is
  {robin_gain:.1f} % better than the fixed order, and `age` as good.
- A `qdr` bank takes the writes of the results out of the way, as a bank of their own does: both give
  {qdr:.2f} with the rig. The two readers still share one port. With the right pictures in a third bank, and
  results in a `qdr` bank, three banks give the full rate.
- **With cameras** {fewest} banks are as fast as a bank for each buffer with the identity ({top:.3f}), and
  {rig_fewest} with the rig ({rig_top:.3f}); four give the rig {rig_four:.3f}. There the host comes first, as
  on the paper's board.
- In two banks a clock that the bus takes from a lane is lost: with the host first they give {first:.2f}
  steady with the identity, {rig_first:.2f} with the rig. The cache leaves every second clock of the bank
  free, which is enough for the bus. So the host comes last in `two-banks`, and the whole computer has the
  rate of the core, or of the cameras: {computer_two:.2f} and {computer_rig_two:.2f}. No pixel is lost.

**Limits.** One rig, whose cameras are nearly parallel; another has other bursts, and one that turns a picture
by several degrees reads more words. A lane that passes several hits in one clock would make up for lost
clocks; the contract has no such lane.
"""


def main():
    folder = pathlib.Path(sys.argv[1])
    found = {name + which: study.searched(HERE / f"{name}{which}.json")
                                          for name in SEARCHES for which in TABLES}
    runs = read_runs(folder)
    maps = {key: misses(table) for key, table in read_tables(folder).items()}
    check(maps, runs)
    draw_banks(found)
    draw_misses(maps)

    def banks(which, **values):
        return study.only(runs["banks" + which], **values)

    def words(which):
        return sum(in_a_frame(maps[which, side]["read"]) for side in SIDES)

    two, rig = banks("", name="one bank", rows=1), banks("_rig", name="one bank", rows=1)
    eight = banks("", name="all apart", rows=1)
    robin = {which: study.only(runs["ports" + which], name="round robin", rows=1)["core"] for which in TABLES}
    steady = {name + which: study.only(runs["cameras" + which], name=name, rows=1)["steady"]
              for name in ("two banks", "host first") for which in TABLES}
    computer = found["computer_both_rig"]
    fewest, rig_fewest = (study.fewest_of_best(found["computer_both" + which]) for which in TABLES)
    top, rig_top = (max(row["best"] for row in found["computer_both" + which].values()) for which in TABLES)
    def cycles(point):
        return round(point["clock_mhz"] * 1e6 / point["core"])

    names = [name + which for name in (*SEARCHES, "two_banks") for which in TABLES]
    text = TEXT.format(
        files=",\n".join(f"[{name}.json]({name}.json)" for name in names),
        best=study.best_table([(f"{what}, {tables}", found[name + which]) for name, what in SEARCHES.items()
                               for which, tables in TABLES.items()], BANKS),
        core_rig=study.witness_table(found["core_both_rig"]), computer_rig=study.witness_table(computer),
        reads=reads_table(maps), reach=REACH, ports=runs_table(runs, "ports", dict(zip(PORTS, PORTS))),
        banks=runs_table(runs, "banks", PLACES), cameras=cameras_table(runs),
        two_cycles=cycles(two), eight_cycles=cycles(eight), two_stalls=two["right_stalls"],
        two_rows=banks("", name="one bank", rows=4)["core"], rig_two=rig["core"],
        rig_two_rows=banks("_rig", name="one bank", rows=4)["core"],
        rig_three=found["core_both_rig"][3]["best"], rig_loss=100 * (1 - rig["core"] / two["core"]),
        rig_words=words("_rig"), identity_words=words(""), rig_extra=cycles(rig) - cycles(eight),
        robin_loss=100 * (1 - robin[""] / two["core"]), robin_gain=100 * (robin["_rig"] / rig["core"] - 1),
        qdr=banks("_rig", name="one qdr", rows=1)["core"], fewest=fewest, top=top, rig_fewest=rig_fewest,
        rig_top=rig_top,
        rig_four=computer[4]["best"],
        computer_two=steady["two banks"],
        computer_rig_two=steady["two banks_rig"], first=steady["host first"],
        rig_first=steady["host first_rig"])
    (HERE / "README.md").write_text(study.page(text))


main()
