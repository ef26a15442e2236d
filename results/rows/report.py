"""usage: report.py FOLDER

The folder holds core, two_banks and cameras.db, and two_banks_rig and cameras_rig.db with the tables of a
real rig. Writes rows.png, core.csv, two_banks.csv, cameras.csv and README.md beside this script.
"""
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import study  # noqa: E402

WINDOW = 7
FETCHES = ("column", "line_buffer")
DRAWN = {3: study.GREEN, 7: study.BLUE, 15: study.ORANGE, 31: study.VERMILION}
TABLES = {"": "identity", "_rig": "real rig"}
DRAWN_ROWS = 8
CAMERA_ROWS = (1, 2, 3, 4, 5, 6, 8)


def line(points):
    """Column fetch in the order of its rows."""
    return sorted((point for point in points if point["fetch"] == "column"), key=lambda point: point["rows"])


def read(folder):
    columns = {"rows": "matcher.rows", "fetch": "matcher.fetch", "core": "frames_per_second.core"}
    core = {
        **columns,
        "window": "matcher.window",
        "slices": "area.slices_percent",
        "block_rams": "area.block_rams",
        "limited_by": "bound.core_limited_by",
    }
    two = {
        **columns,
        "bound": "bound.core",
        "limited_by": "bound.core_limited_by",
        "slices": "area.slices_percent",
        "left_stalls": "ports.left_pixel.stall_cycles",
        "right_stalls": "ports.right_pixel.stall_cycles",
    }
    cameras = {
        **columns,
        "name": "name",
        "rate_hz": "cameras.frame_rate_hz",
        "steady": "frames_per_second.steady",
        "dropped_pixels": "cameras.left.dropped_pixels",
        "limited_by": "bound.system_limited_by",
    }

    def both(name, wanted):
        return [
            {"tables": tables, **point}
            for which, tables in TABLES.items()
            for point in study.points(folder / f"{name}{which}.db", **wanted)
        ]

    found = {
        "core": study.points(folder / "core.db", **core),
        "two_banks": both("two_banks", two),
        "cameras": both("cameras", cameras),
    }
    order = {
        "core": ("window", "fetch", "rows"),
        "two_banks": ("tables", "fetch", "rows"),
        "cameras": ("name", "tables", "rate_hz", "fetch", "rows"),
    }
    for name, points in found.items():
        points.sort(key=lambda point: [point[key] for key in order[name]])
        study.write_csv(HERE / f"{name}.csv", points)
    return found


def rows_table(found):
    lines = []
    points = line(point for point in found["core"] if point["window"] == WINDOW)
    two = {
        tables: line(point for point in found["two_banks"] if point["tables"] == tables)
        for tables in TABLES.values()
    }
    for number, point in enumerate(points):
        rows = point["rows"]
        more = point["core"] - points[number - 1]["core"] if number else None
        lines.append(
            [
                rows,
                f"{(WINDOW + rows - 1) / rows:.2f}",
                f"{point['core']:.2f}",
                "" if more is None else f"{more:+.2f}",
                *(f"{two[tables][number]['core']:.2f}" for tables in TABLES.values()),
                f"{point['slices']:.1f}",
                point["block_rams"],
                f"{point['core'] / point['slices']:.2f}",
            ]
        )
    kept = study.only(found["core"], window=WINDOW, fetch="line_buffer")
    two = [study.only(found["two_banks"], tables=tables, fetch="line_buffer") for tables in TABLES.values()]
    lines.append(
        [
            "line buffers",
            "1.00",
            f"{kept['core']:.2f}",
            "",
            *(f"{point['core']:.2f}" for point in two),
            f"{kept['slices']:.1f}",
            kept["block_rams"],
            f"{kept['core'] / kept['slices']:.2f}",
        ]
    )
    return study.markdown(
        [
            "rows",
            "slots a result",
            "frames/s",
            "more",
            "two banks, identity",
            "two banks, real rig",
            "% of the slices",
            "block RAMs",
            "frames/s for 1 % of the slices",
        ],
        lines,
    )


def takeover_table(found):
    lines = []
    for window in sorted({point["window"] for point in found["core"]}):
        points = line(point for point in found["core"] if point["window"] == window)
        kept = study.only(found["core"], window=window, fetch="line_buffer")
        below = max(
            (point for point in points if point["slices"] <= kept["slices"]), key=lambda point: point["rows"]
        )
        fits = max((point for point in points if point["slices"] <= 100), key=lambda point: point["rows"])
        best = max(points, key=lambda point: point["core"] / point["slices"])
        lines.append(
            [
                f"{window}x{window}",
                f"{points[0]['core']:.2f}",
                best["rows"],
                f"{kept['core']:.2f}",
                f"{kept['slices']:.1f}",
                below["rows"],
                f"{below['core']:.2f}",
                fits["rows"],
                f"{fits['core']:.2f}",
                f"{fits['slices']:.1f}",
            ]
        )
    return study.markdown(
        [
            "window",
            "one row, frames/s",
            "rows with the most frames for an area",
            "line buffers, frames/s",
            "their slices, %",
            "most rows that are no larger",
            "frames/s",
            "most rows that fit",
            "frames/s",
            "slices, %",
        ],
        lines,
    )


def cameras_table(found):
    lines = []
    for rate in (29.97, 60):
        for name in ("eight banks", "two banks"):
            for tables in TABLES.values():
                points = [
                    point
                    for point in found["cameras"]
                    if point["name"] == name and point["tables"] == tables and point["rate_hz"] == rate
                ]
                if any(point["dropped_pixels"] for point in points):
                    raise SystemExit(f"{name}, {tables}: pixels are lost")
                cells = [study.only(points, fetch="column", rows=rows) for rows in CAMERA_ROWS]
                cells.append(study.only(points, fetch="line_buffer"))
                lines.append([f"{rate:g} Hz", name, tables, *(f"{point['steady']:.2f}" for point in cells)])
    return study.markdown(
        ["cameras", "banks", "tables", *(f"{rows}" for rows in CAMERA_ROWS), "line buffers"], lines
    )


def draw(found):
    figure, (left, right) = study.panels(2, height=4.2, width=5)
    points = line(point for point in found["core"] if point["window"] == WINDOW)
    left.plot(
        [point["rows"] for point in points],
        [point["core"] for point in points],
        "o-",
        color=study.BLUE,
        markersize=5,
        label="eight banks",
    )
    for tables, color in zip(TABLES.values(), (study.GREEN, study.VERMILION)):
        two = line(point for point in found["two_banks"] if point["tables"] == tables)
        left.plot(
            [point["rows"] for point in two],
            [point["core"] for point in two],
            "s--",
            color=color,
            markersize=4,
            label=f"two banks, {tables}",
        )
    kept = study.only(found["core"], window=WINDOW, fetch="line_buffer")
    left.axhline(kept["core"], color=study.GRAY, linestyle=":", label="line buffers, eight banks")
    left.set(
        xlabel="rows at once",
        ylabel="core, frames/s",
        title=f"the core alone, {WINDOW}x{WINDOW}",
        ylim=(0, 140),
        xticks=range(1, 17, 3),
    )
    study.legend(left)
    for window, color in DRAWN.items():
        points = line(
            point for point in found["core"] if point["window"] == window and point["rows"] <= DRAWN_ROWS
        )
        kept = study.only(found["core"], window=window, fetch="line_buffer")
        right.plot(
            [point["slices"] for point in points],
            [point["core"] for point in points],
            "o-",
            color=color,
            markersize=4,
            label=f"{window}x{window}",
        )
        right.plot([kept["slices"]], [kept["core"]], "*", color=color, markersize=12)
    right.axvline(100, color=study.GRAY, linestyle=":")
    right.set(
        xlabel="area, % of the slices",
        ylabel="core, frames/s",
        xlim=(0, 190),
        ylim=(0, 140),
        title=f"one to {DRAWN_ROWS} rows; star: line buffers",
    )
    study.legend(right, loc="center right")
    study.save(figure, HERE / "rows.png")


TEXT = """# Several rows at once

**Question.** Column fetch reads n pixels for each result. R rows of results at once share what is read: n+R-1
pixels for R results. What does that give, what does it take, and when are line buffers the better choice?

Made by `results/rows/run` (after `./setup tests` and the release build) from [core.yaml](core.yaml),
[two_banks.yaml](two_banks.yaml) and [cameras.yaml](cameras.yaml): 640x480, D = 80, `log7`, a result queue of
32 words. All rows are in [core.csv](core.csv), [two_banks.csv](two_banks.csv) and [cameras.csv](cameras.csv).
The tables of the real rig are those of [results/calibration](../calibration/README.md).

![frames per second against rows and against area](rows.png)

7x7, the core alone. Two banks are the preset `two-banks`, with joint tables and the word cache:

{rows}

Where line buffers take over, eight banks:

{takeover}

The whole computer, 7x7, two picture buffers, 61 frames, steady frames a second by the number of rows:

{cameras}

**Found.**

- The first rows are worth most: two give {two:.2f} frames a second instead of {one:.2f}, four {four:.2f},
  eight {eight:.2f}, sixteen {sixteen:.2f}. n times one row, the rate of line buffers, stays out of reach,
  because n-1 rows are read again for each strip.
- At 7x7 each row takes {each:.1f} % of the FPGA more, and {fits} rows fit. The rate grows by less and less,
  so two or three rows have the most frames for an area. With larger windows rows share more: the best of all
  is three at 9x9 and 11x11, four at 15x15 and 21x21 and five at 31x31.
- The matcher limits every board with a bank for each buffer: it consumes one slot a clock. Rows that do not
  divide the 480 rows of the image waste a part of the last strip (14 rows give hardly more than 13).
- The queue needs a place for each row before the matcher takes a slot, and R words come at once. A queue of R
  words makes the matcher wait until it is empty. So these boards have one of 32.
- **Line buffers take over early**: at 7x7 from three rows on they are smaller, and {faster:.1f} times as
  fast. The larger the window, the later, because they need n absolute differences in each module, while rows
  need R windows, select-min units and checks whatever the window. At 15x15 five rows are smaller. At 21x21
  and 31x31 line buffers do not fit, and four rows do. With fewer modules line buffers fit again, and are the
  better choice everywhere ([results/folds](../folds/README.md)).
- In two banks with the identity four rows keep all of their rate and eight {two_eight:.0f} % of it: more
  words of results interrupt the reads of the pictures, which share their bank. With the real rig two banks
  lose {rig_least:.0f} to {rig_most:.0f} % at one to eight rows ([why](../two_banks/README.md)).
- With the paper's cameras {needed} rows are enough for all 29.97 frames, in two banks too, with either
  tables. Where the core is slower than the cameras, captures wait for the next camera frame, and the rate
  comes in steps.

**Limits.** The area of rows is counted from one structure ([area](../../models/area/README.md)). A window
module works in one of n+R-1 clocks there; a circuit that shares it among rows would be smaller. Nothing is
placed or routed.
"""


def main():
    found = read(pathlib.Path(sys.argv[1]))
    draw(found)
    by_rows = {
        point["rows"]: point
        for point in found["core"]
        if point["window"] == WINDOW and point["fetch"] == "column"
    }
    kept = study.only(found["core"], window=WINDOW, fetch="line_buffer")
    two = {
        tables: {
            point["rows"]: point["core"] for point in line(found["two_banks"]) if point["tables"] == tables
        }
        for tables in TABLES.values()
    }
    lost = [1 - two["real rig"][rows] / by_rows[rows]["core"] for rows in range(1, 9)]
    needed = min(
        rows
        for rows in CAMERA_ROWS
        if all(
            point["steady"] > 29.96
            for point in found["cameras"]
            if point["rate_hz"] == 29.97 and point["fetch"] == "column" and point["rows"] == rows
        )
    )
    text = TEXT.format(
        rows=rows_table(found),
        takeover=takeover_table(found),
        cameras=cameras_table(found),
        one=by_rows[1]["core"],
        two=by_rows[2]["core"],
        four=by_rows[4]["core"],
        eight=by_rows[8]["core"],
        sixteen=by_rows[16]["core"],
        fits=max(rows for rows, point in by_rows.items() if point["slices"] <= 100),
        two_eight=100 * two["identity"][8] / by_rows[8]["core"],
        rig_least=100 * min(lost),
        rig_most=100 * max(lost),
        each=(by_rows[16]["slices"] - by_rows[2]["slices"]) / 14,
        faster=kept["core"] / by_rows[3]["core"],
        needed=needed,
    )
    (HERE / "README.md").write_text(study.page(text))


main()
