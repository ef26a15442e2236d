"""What the studies share: the points of a sweep's database, tables, and figures whose bytes depend on the
data alone."""
import csv
import json
import pathlib
import re
import sqlite3
import sys
import textwrap

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "sw" / "report" / "plots"))
from figures import (BLACK, BLUE, COLORS, GRAY, GREEN, LID_OF_X, ORANGE, PINK, SKY,  # noqa: E402, F401
                     VERMILION, Points, bound, encoded, use_style)

use_style()

def searched(path):
    """What `allocate --json` has printed into this file. By number of banks: the values of the row, such as
    the best rate and an allocation that has it."""
    found = {}
    for row in json.loads(path.read_text())["banks"]:
        if not (rates := row.get("frames_per_second")):
            continue  # none counts
        found[row["banks"]] = {
            "allocations": row["allocations"],
            "best": rates.get("core", rates.get("steady")),
            "uncertainty": rates.get("steady_uncertainty", 0), "bound": row["bound_frames_per_second"],
            "tied": row["tied"], "witness": ", ".join(map(placed, row["sets"]))}
    return found


def placed(allocated):
    """A word of --set: "left_image bank0 bank1" of "allocation.left_image=[bank0, bank1]"."""
    name, _, banks = allocated.removeprefix("allocation.").partition("=")
    return " ".join([name, *banks.strip("[]").split(", ")])


def fewest_of_best(rates):
    """The fewest banks whose best rate ties with the best of all."""
    reached = max(row["best"] - row["uncertainty"] for row in rates.values())
    return min(number for number, row in rates.items() if row["best"] + row["uncertainty"] >= reached)


def best_table(searches, banks):
    """The best rates of searches, each a text and what `searched` has found; the first that ties with the
    best is bold."""
    lines = []
    for what, rates in searches:
        fewest = fewest_of_best(rates)
        cells = (f"{rates[number]['best']:.3f}" if number in rates else "" for number in banks)
        lines.append([what, *(f"**{cell}**" if number == fewest else cell
                              for number, cell in zip(banks, cells))])
    return markdown(["", *(f"{number}" for number in banks)], lines)


def witness_table(rates):
    return markdown(["banks", "allocations", "best", "tied", "one of them"],
                    [[banks, row["allocations"],
                      f"{row['best']:.3f}" + (f" ± {row['uncertainty']:.3f}" if row["uncertainty"] else ""),
                      row["tied"], row["witness"]]
                     for banks, row in rates.items()])


def points(database, **columns):
    """The points of a database, in the order of its rows: a map each from these names to the columns that
    they stand for."""
    connection = sqlite3.connect(f"file:{database}?mode=ro", uri=True)
    try:
        failed = connection.execute("SELECT reason FROM points WHERE status != 'ok' LIMIT 1").fetchone()
        if failed:
            raise SystemExit(f"{database}: {failed[0]}")
        names = ", ".join(f'"{column}"' for column in columns.values())
        return [dict(zip(columns, row))
                     for row in connection.execute(f"SELECT {names} FROM points ORDER BY hash")]
    finally:
        connection.close()


def fitting(database):
    """The hashes of the points that fit into their FPGA, by the rule of the program's figures."""
    found = Points(database)
    return set(found.table.hash[~found.too_large()])


def only(found, **values):
    """The one of these points that has these values."""
    (one,) = (point for point in found if all(point[name] == value for name, value in values.items()))
    return one


def markdown(header, rows):
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines)


def page(text):
    """Markdown whose paragraphs and items are wrapped anew, because the figures in them are of any length."""
    blocks = []
    for block in re.split(r"(\n\n+|\n(?=- ))", text):
        if block and not block.startswith(("|", "!", "#", "\n")):
            words = " ".join(block.split()).replace(" %", "\N{NO-BREAK SPACE}%")
            indent = "  " if block.startswith("- ") else ""
            wrapped = textwrap.fill(words, 110, subsequent_indent=indent, break_long_words=False,
                                    break_on_hyphens=False)
            block = wrapped.replace("\N{NO-BREAK SPACE}", " ") + "\n" * block.endswith("\n")
        blocks.append(block)
    return "".join(blocks)


def write_csv(path, found):
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, list(found[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(found)


def panels(count, height=3.6, width=4.4, rows=1, width_ratios=None):
    """A figure of panels in rows, and the panels. count: in a row; height, width: of a panel, in inches."""
    figure, axes = plt.subplots(rows, count, figsize=(width * count, height * rows), squeeze=False,
                                gridspec_kw={"width_ratios": width_ratios})
    return figure, list(axes.flat)


def legend(axis, **options):
    axis.legend(**{"fontsize": 8, "title_fontsize": 8, **options})


def save(figure, path):
    figure.tight_layout()
    path.write_bytes(encoded(figure, path.suffix[1:], dpi=110))
