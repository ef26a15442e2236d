"""usage: report.py ROWS.db

Writes rows.csv and README.md beside this script.
"""
import csv
import pathlib
import re
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import study  # noqa: E402


def published():
    """The printed rows by their names."""
    with open(HERE / "published.csv", newline="") as file:
        return {row["row"]: row for row in csv.DictReader(file)}


def half_unit(text):
    """Half a unit of the last printed digit."""
    return 0.5 * 10.0 ** -len(text.partition(".")[2])


def compared(point, row):
    """A row of rows.csv: the printed figure, that of W * H * S / f, and that of the model."""
    passes = -(-point["disparities"] // point["units"])
    pixels = int(row["width"]) * int(row["height"])
    printed = float(row["value"])
    ms = row["unit"] == "ms"
    hertz = point["clock_mhz"] * 1e6
    simple = pixels * passes / hertz
    modelled = 1 / point["rate"]
    cycles = round(hertz * modelled)
    figure = (lambda seconds: 1000 * seconds) if ms else (lambda seconds: 1 / seconds)
    # The clock at which the printed figure is W * H * S cycles a frame, for the largest and the smallest
    # number that is printed so.
    half = half_unit(row["value"])
    rates = sorted(1000 / value if ms else value for value in (printed - half, printed + half))
    clocks = [pixels * passes * rate / 1e6 for rate in rates]
    return {"row": row["row"], "design": row["design"], "kind": row["kind"], "unit": row["unit"],
            "passes": passes, "clock_mhz": point["clock_mhz"], "printed": row["value"],
            "pixels_times_passes": round(figure(simple), 3), "model": round(figure(modelled), 3),
            "deviation_percent": round(100 * (figure(modelled) / printed - 1), 2),
            "cycles": cycles, "more_cycles_percent": round(100 * (cycles / (pixels * passes) - 1), 2),
            "clock_from_mhz": round(clocks[0], 1), "clock_to_mhz": round(clocks[1], 1),
            "window": point["window"], "line_block_rams": point["block_rams"],
            "printed_block_rams": (re.findall(r"BRAM18 (\d+)", row["note"]) or [""])[0]}


def table(found):
    header = [
    "design",
    "row",
    "passes",
    "clock, MHz",
    "printed",
    "W * H * S / f",
    "model",
    "model against printed, %",
    "cycles more than W * H * S, %",
     "clock that the print needs, MHz"]
    return study.markdown(header,
    [ [row["design"],
    row["row"],
    row["passes"],
    f"{row['clock_mhz']:g}",
    f"{row['printed']} {row['unit']}",
    f"{row['pixels_times_passes']:.2f}",
    f"{row['model']:.2f}",
    f"{row['deviation_percent']:+.2f}",
    f"{row['more_cycles_percent']:+.2f}",
     f"{row['clock_from_mhz']:.1f}..{row['clock_to_mhz']:.1f}"] for row in found])


def block_ram_table(found):
    rows = [row for row in found if row["printed_block_rams"]]
    first = rows[0]
    lines = []
    for row in rows:
        printed = int(row["printed_block_rams"])
        lines.append([row["row"], row["window"], printed, row["line_block_rams"], printed - \
                     int(first["printed_block_rams"]), row["line_block_rams"] - first["line_block_rams"]])
    return study.markdown(["row", "window", "printed, BRAM18", "model, 18 kbit",
                          "printed, more than the first row", "model, more"], lines)


TEXT = """# Published designs

**Question.** Other people have published stereo matchers for FPGAs, with their sizes, clocks and rates. What
does this model say for the same sizes?

Made by `results/published/run` (after `./setup tests` and the release build) from [rows.yaml](rows.yaml), the
designs as boards, and [published.csv](published.csv), the printed figures with their sources. The boards have
line buffers, no tables, no filter and a bank for each buffer, so memory never limits them. `units` are the
modules of the design: it takes S = ceil(disparities / units) passes for each pixel. All figures are in
[rows.csv](rows.csv).

{table}

The last column is the clock at which W * H * S cycles a frame give the printed figure, from the largest to
the smallest number that is printed so.

**Found.**

- **Vitis, estimates.** All six are W * H * S / f to the last digit. So they leave out the border: a window of
  n rows needs (n-1)/2 rows more than the image has before the last result can leave, and the pipeline has to
  empty. The model has both and takes 0.2 % (5x5) to 0.9 % (21x21) longer. The printed figure can be the time
  from frame to frame of a design that begins the next frame at once; as the latency of one frame, which it is
  called, it is too short.
- **Vitis, measured on the U200.** 11x11 with 32 disparities on 32 units is the same design as the row
  HD_11_32_32, whose estimate is 144.7 frames/s. Measured are 135. The model, whose memories never stall,
  gives 144.0. Both sizes miss the model by about the same part, 6 %: what is lost is lost for each pixel, as
  when memory does not deliver one in each clock. A fixed time for each frame would be a fourth of that part
  at the larger size.
- **FP-Stereo.** Neither clock nor passes are printed where we could read it. The rate fits 300 MHz with 4
  passes, and as well 150 MHz with 2. It is another algorithm (semi-global matching), so only its pixel rate
  is compared. Our images are 1244 wide, because widths are multiples of 4: this makes 0.2 % of the deviation.
- **Thomas, Papadimitriou, Dollas, 1920x1200.** One pixel a clock at 200 MHz gives 86.8 frames/s without any
  border and 86.7 with the least one: both print as 87.
- **The same, 400x320: cannot be right as printed.** 1570 frames/s of 128,000 pixels are 200.96 million pixels
  a second. At one pixel a clock 200 MHz give 1562.5 at most, and 1556.6 with the least border. Either the
  clock was 201 MHz, which the row above allows, or the rate was rounded up.

**Block RAMs.** The estimates of Vitis also print block RAMs, which grow with the window:

{block_rams}

Vitis takes 2 block RAMs more for each row of the window. That is one for each line of 1920 pixels of each
side, if 8 of the 9 bits of a 2K x 9 are used. The model packs the rows side by side and uses the ninth bit.
What it lacks in all rows are the parts that it does not have: another filter, queues, interfaces to memory.

**Limits.** Only sizes, passes and clocks are compared, not what the designs compute, and no resources of
their FPGAs but block RAM. A row that agrees shows that the design takes one pixel a clock and pass; it does
not show that the model would run at that clock.
"""


def main():
    rows = published()
    points = study.points(sys.argv[1], name="name", disparities="matcher.disparities", units="matcher.units",
                          window="matcher.window", clock_mhz="fpga.clock_mhz", rate="frames_per_second.core",
                          block_rams="area.block_rams")
    by_name = {point["name"]: point for point in points}
    if set(by_name) != set(rows):
        raise SystemExit(f"published.csv and rows.yaml differ: {sorted(set(by_name) ^ set(rows))}")
    found = [compared(by_name[name], row) for name, row in rows.items()]
    study.write_csv(HERE / "rows.csv", found)
    (HERE / "README.md").write_text(TEXT.format(table=table(found), block_rams=block_ram_table(found)))


main()
