"""usage: report.py FOLDER

The folder holds folds, together, banks and cameras.db, and banks_rig and cameras_rig.db with the tables of a
real rig. Writes folds.png, folds.csv, together.csv, banks.csv, cameras.csv and README.md beside this script.
"""
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import study  # noqa: E402

WINDOW, PAPER, FEW = 7, 80, 14
FETCHES = {"column": "column fetch", "line_buffer": "line buffers"}
DRAWN = {
    ("column", 80): ("o-", study.BLUE),
    ("line_buffer", 80): ("o-", study.VERMILION),
    ("column", 200): ("s--", study.SKY),
    ("line_buffer", 200): ("s--", study.ORANGE),
}
TABLES = {"": "identity", "_rig": "real rig"}
BANKS = ("one bank", "two banks", "eight banks")
WINDOWS = {7: study.BLUE, 15: study.ORANGE, 31: study.GREEN}


def read(folder):
    columns = {"units": "matcher.units", "core": "frames_per_second.core", "slices": "area.slices_percent"}
    folds = {
        **columns,
        "window": "matcher.window",
        "disparities": "matcher.disparities",
        "fetch": "matcher.fetch",
        "block_rams": "area.block_rams",
    }
    together = {
        **columns,
        "window": "matcher.window",
        "fetch": "matcher.fetch",
        "rows": "matcher.rows",
        "block_rams": "area.block_rams",
    }
    banks = {**columns, "name": "name", "limited_by": "bound.core_limited_by"}
    cameras = {
        **columns,
        "name": "name",
        "steady": "frames_per_second.steady",
        "limited_by": "bound.system_limited_by",
        "dropped_pixels": "cameras.left.dropped_pixels",
    }

    def both(name, wanted):
        return [
            {"tables": tables, **point}
            for which, tables in TABLES.items()
            for point in study.points(folder / f"{name}{which}.db", **wanted)
        ]

    found = {
        "folds": study.points(folder / "folds.db", **folds),
        "together": study.points(folder / "together.db", **together),
        "banks": both("banks", banks),
        "cameras": both("cameras", cameras),
    }
    order = {
        "folds": ("window", "disparities", "fetch", "core"),
        "together": ("window", "slices", "core"),
        "banks": ("name", "tables", "core"),
        "cameras": ("name", "tables", "core"),
    }
    for name, points in found.items():
        for point in points:
            point["units"] = int(point["units"])
            disparities = point.get("disparities", PAPER)
            point["passes"] = -(-disparities // point["units"])
        points.sort(key=lambda point: [point[key] for key in order[name]])
        study.write_csv(HERE / f"{name}.csv", points)
    return found


def folds_table(found, disparities):
    here = [
        point for point in found["folds"] if point["window"] == WINDOW and point["disparities"] == disparities
    ]
    lines = []
    for units in sorted({point["units"] for point in here}, reverse=True):
        column, kept = (study.only(here, units=units, fetch=fetch) for fetch in FETCHES)
        lines.append(
            [
                column["passes"],
                units,
                f"{column['core']:.2f}",
                f"{column['slices']:.1f}",
                f"{kept['core']:.2f}",
                f"{kept['slices']:.1f}",
            ]
        )
    return study.markdown(
        [
            "passes",
            "modules",
            "column, frames/s",
            "% of the slices",
            "line buffers, frames/s",
            "% of the slices",
        ],
        lines,
    )


def front(points):
    """The points that no other one of at most their area reaches, by growing area."""
    kept = []
    for point in sorted(points, key=lambda point: (point["slices"], -point["core"])):
        if not kept or point["core"] > kept[-1]["core"]:
            kept.append(point)
    return kept


def together_table(found):
    lines = []
    for window in WINDOWS:
        for rate in (10, 18, 29.97, 60):
            cells = []
            for fetch in FETCHES:
                here = [
                    point
                    for point in found["together"]
                    if point["window"] == window and point["fetch"] == fetch and point["core"] >= rate
                ]
                best = min(here, key=lambda point: point["slices"], default=None)
                rows = f", {best['rows']} row{'s' * (best['rows'] > 1)}" if best and fetch == "column" else ""
                cells += [f"{best['units']} modules{rows}", f"{best['slices']:.1f}"] if best else ["none", ""]
            lines.append([f"{window}x{window}", f"{rate:g}", *cells])
    return study.markdown(
        [
            "window",
            "frames/s at least",
            "smallest with column fetch",
            "% of the slices",
            "smallest with line buffers",
            "% of the slices",
        ],
        lines,
    )


def banks_table(found):
    lines = []
    for units in sorted({point["units"] for point in found["banks"]}, reverse=True):
        cells = []
        for name in BANKS:
            for tables in TABLES.values():
                point = study.only(found["cameras"], name=name, tables=tables, units=units)
                if point["dropped_pixels"]:
                    raise SystemExit(f"{name}, {tables}, {units}: pixels are lost")
                alone = study.only(found["banks"], name=name, tables=tables, units=units)
                cells.append(f"{alone['core']:.2f}, {point['steady']:.2f}")
        point = study.only(found["banks"], name="one bank", tables="identity", units=units)
        lines.append([point["passes"], units, f"{point['slices']:.1f}", *cells])
    return study.markdown(
        [
            "passes",
            "modules",
            "% of the slices",
            *(f"{name}, {tables}" for name in BANKS for tables in TABLES.values()),
        ],
        lines,
    )


def draw(found):
    figure, (left, right) = study.panels(2, height=4.4, width=5.2)
    for (fetch, disparities), (look, color) in DRAWN.items():
        points = sorted(
            (
                point
                for point in found["folds"]
                if point["window"] == WINDOW
                and point["fetch"] == fetch
                and point["disparities"] == disparities
            ),
            key=lambda point: point["slices"],
        )
        left.plot(
            [point["slices"] for point in points],
            [point["core"] for point in points],
            look,
            color=color,
            markersize=4,
            label=f"{FETCHES[fetch]}, D = {disparities}",
        )
    left.set(title=f"fewer modules, {WINDOW}x{WINDOW}")
    here = [point for point in found["together"] if point["window"] == WINDOW]
    for fetch, color in (("column", study.BLUE), ("line_buffer", study.VERMILION)):
        points = [point for point in here if point["fetch"] == fetch]
        right.plot(
            [point["slices"] for point in points],
            [point["core"] for point in points],
            "o",
            color=color,
            markersize=3,
            label=f"{FETCHES[fetch]}{', 1 to 8 rows' if fetch == 'column' else ''}",
        )
        best = front(points)
        right.plot(
            [point["slices"] for point in best],
            [point["core"] for point in best],
            "-",
            color=color,
            linewidth=1,
        )
    paper = study.only(here, fetch="column", rows=1, units=PAPER)
    right.plot([paper["slices"]], [paper["core"]], "k*", markersize=11, label="the paper's board")
    right.set(title=f"rows and fewer modules together, D = {PAPER}")
    for axis in (left, right):
        axis.axvline(100, color=study.GRAY, linestyle=":")
        axis.set(
            xlabel="area, % of the slices",
            ylabel="core, frames/s",
            xscale="log",
            yscale="log",
            xlim=(3, 200),
            ylim=(0.8, 200),
            xticks=(5, 10, 20, 50, 100),
            yticks=(1, 2, 5, 10, 20, 50, 100),
        )
        axis.set_xticks([], minor=True)
        axis.set_yticks([], minor=True)
        axis.set(xticklabels=(5, 10, 20, 50, 100), yticklabels=(1, 2, 5, 10, 20, 50, 100))
        study.legend(axis, loc="upper left")
    study.save(figure, HERE / "folds.png")


TEXT = """# Fewer modules than disparities

**Question.** The paper builds a module for each disparity. With fewer, a pixel takes several passes. What
does that cost and save, and which way of fetching suits it?

Made by `results/folds/run` (after `./setup tests` and the release build) from [folds.yaml](folds.yaml),
[together.yaml](together.yaml), [banks.yaml](banks.yaml) and [cameras.yaml](cameras.yaml): 640x480, `log7`.
All rows are in [folds.csv](folds.csv), [together.csv](together.csv), [banks.csv](banks.csv) and
[cameras.csv](cameras.csv).

![frames per second against area](folds.png)

The core alone, 7x7, the fewest modules for each number of passes, D = 80:

{folds80}

D = 200, the most that the paper names:

{folds200}

The smallest board for a frame rate, D = 80, of all modules from 5 to 80, with column fetch also of 1 to 8
rows ([together.yaml](together.yaml)):

{together}

Line buffers with fewer modules need few reads. Each cell has the frames a second of the core alone, and
steady ones of the whole computer with cameras at 29.97 Hz. In one bank everything is in it (banks of
2,097,152 words; the buffers need 1,075,200). Two banks have joint tables in one, pictures and results in the
other; no board has the word cache:

{banks}

**Found.**

- Half the modules give half the frames: the matcher limits all boards of the first two tables. They save less
  than half of the area, because queues, filters and source addresses stay, and because each pass needs a
  place of its own for what it keeps from column to column. With column fetch half of 80 take {half80:.0f} %
  of the slices of all, half of 200 take {half200:.0f} %.
- **200 disparities fit with line buffers on half the modules**: {kept200:.1f} frames a second with
  {slices200:.0f} % of the slices. With a module for each disparity line buffers need {all200:.0f} %. Column
  fetch gives {column200:.1f} with {column_slices200:.0f} %.
- **Line buffers with few modules beat column fetch** at every rate and window of the third table: they take a
  third to three fifths of the area. The paper's rate takes {paper_slices:.1f} % with column fetch, and
  {fast_slices:.1f} % with line buffers and {fast_units} modules ({fast_rate:.2f} frames a second). Column
  fetch spends n clocks on a result, one for each row of the window; line buffers with folds spend as many,
  one for each pass. The absolute differences are as many too. But there are n times fewer windows, select-min
  units and checks of candidates. What they keep for each pass waits in shift registers, and a LUT has 16
  places.
- Folds hardly help column fetch: its smallest board for a rate has all modules in all rows of that table but
  one, and as many rows at once as the rate takes.
- **One bank does what eight did.** With line buffers a pixel and side takes one read of the table and one of
  the picture, instead of seven each. With {fast_units} modules all buffers of the paper's board share one
  bank, and the computer delivers {one_bank:.2f} frames a second, with the tables of the real rig
  {one_bank_rig:.2f}. The paper's board delivers 17.98, with eight banks and 1.6 times the area. With
  cameras {more_units} modules are no better than {fast_units}, because captures wait for the next camera
  frame. Two banks and 20 modules ({all_slices:.1f} %) deliver all 29.97.
- The real rig costs nothing here: with several clocks for each slot a lane makes up for a clock that it has
  lost. In one bank the rig is even faster where the bank limits, because entries without source are not read.

**Limits.** Areas are estimates, and those of folds and of line buffers are compared with no board
([area](../../models/area/README.md)); no placement is tried. Line buffers take {block_rams} block RAMs
instead of 15. One bank for all needs 1,075,200 words, twice what the banks of our `fpl2003` have.
"""


def main():
    found = read(pathlib.Path(sys.argv[1]))
    draw(found)

    def fold(**values):
        return study.only(found["folds"], window=WINDOW, **values)

    all80, half80 = (fold(disparities=80, fetch="column", units=units) for units in (80, 40))
    all200, half200 = (fold(disparities=200, fetch="column", units=units) for units in (200, 100))
    fast = fold(disparities=80, fetch="line_buffer", units=FEW)
    one_bank = {
        tables: study.only(found["cameras"], name="one bank", tables=tables, units=FEW)["steady"]
        for tables in TABLES.values()
    }
    kept200 = fold(disparities=200, fetch="line_buffer", units=100)
    text = TEXT.format(
        folds80=folds_table(found, 80),
        folds200=folds_table(found, 200),
        together=together_table(found),
        banks=banks_table(found),
        half80=100 * half80["slices"] / all80["slices"],
        half200=100 * half200["slices"] / all200["slices"],
        kept200=kept200["core"],
        slices200=kept200["slices"],
        all200=fold(disparities=200, fetch="line_buffer", units=200)["slices"],
        column200=all200["core"],
        column_slices200=all200["slices"],
        fast_slices=fast["slices"],
        fast_units=fast["units"],
        fast_rate=fast["core"],
        one_bank=one_bank["identity"],
        one_bank_rig=one_bank["real rig"],
        more_units=16,
        all_slices=fold(disparities=80, fetch="line_buffer", units=20)["slices"],
        paper_slices=all80["slices"],
        block_rams=fast["block_rams"],
    )
    (HERE / "README.md").write_text(study.page(text))


main()
