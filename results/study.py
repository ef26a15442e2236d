"""What the studies share: the points of a sweep's database, tables, and figures whose bytes depend on the data alone."""
import csv
import pathlib
import sqlite3
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "sw" / "report" / "plots"))
from points import Points  # noqa: E402


def points(database, **columns):
    """The points of a database, in the order of its rows: a map each from these names to the columns that they stand for."""
    connection = sqlite3.connect(f"file:{database}?mode=ro", uri=True)
    try:
        failed = connection.execute("SELECT reason FROM points WHERE status != 'ok' LIMIT 1").fetchone()
        if failed:
            raise SystemExit(f"{database}: {failed[0]}")
        names = ", ".join(f'"{column}"' for column in columns.values())
        return [dict(zip(columns, row)) for row in connection.execute(f"SELECT {names} FROM points ORDER BY hash")]
    finally:
        connection.close()


def fitting(database):
    """The hashes of the points that fit into their FPGA, by the rule of the program's figures."""
    found = Points(database)
    return set(found.hashes) - {found.hashes[place] for place in found.too_large()}


def only(found, **values):
    """The one of these points that has these values."""
    (one,) = (point for point in found if all(point[name] == value for name, value in values.items()))
    return one


def markdown(header, rows):
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(str(cell) for cell in line) + " |" for line in lines)


def write_csv(path, found):
    with path.open("w", newline="") as file:
        writer = csv.DictWriter(file, list(found[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows(found)


def panels(count, height=3.6, width=4.4, **options):
    figure, axes = plt.subplots(1, count, figsize=(width * count, height), squeeze=False, **options)
    for axis in axes.flat:
        axis.grid(True, alpha=0.3)
    return figure, list(axes.flat)


def save(figure, path):
    figure.tight_layout()
    figure.savefig(path, dpi=110, metadata={"Software": None})
