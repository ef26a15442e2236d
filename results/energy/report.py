"""usage: report.py FOLDER

The folder holds banks.db, cameras.db, kinds.db and lanes.db. Writes energy.png, the tables (*.csv) and
README.md beside this script.
"""
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import study  # noqa: E402

LANES = {1: "1 lane", 2: "2 lanes", 4: "4 lanes", 7: "7 lanes", 8: "8 lanes, 2 rows"}
BANKS = range(2, 10)
STANDBY_MW = 264  # of a bank of zbt_pipelined


def read(folder):
    figures = {"core": "frames_per_second.core", "mj": "energy.memory_mj_per_frame", "mw": "energy.memory_mw",
               "megabytes": "energy.megabytes_per_frame"}
    columns = {
        "banks": {"name": "name", **figures},
        "cameras": {"name": "name", "hz": "cameras.frame_rate_hz", "delivered": "frames_per_second.steady",
                    **figures},
        "kinds": {"kind": "ssram.banks.bank0.kind", "fetch": "matcher.fetch", "rows": "matcher.rows",
                  **figures},
        "lanes": {"name": "name", "lanes": "fpga.lanes", **figures}}
    found = {}
    for name, its in columns.items():
        found[name] = sorted(study.points(folder / f"{name}.db", **its),
                             key=lambda point: [point[key] for key in its if key not in figures])
        study.write_csv(HERE / f"{name}.csv", found[name])
    for point in found["lanes"]:
        point["banks"] = sum(map(int, point["name"].split(" + ")))
    return found


def best(found, banks, lanes):
    """The division of the banks with the highest rate."""
    return max((point for point in found["lanes"] if (point["banks"], point["lanes"]) == (banks, lanes)),
               key=lambda point: point["core"])


def lane_series(found, lanes):
    return [(banks, best(found, banks, lanes)) for banks in BANKS]


def costlier(series):
    """The steps to one bank less that take more energy a frame: how the time and the energy change."""
    lines = []
    for (fewer, less), (banks, more) in zip(series, series[1:]):
        is_costlier = less["mj"] > more["mj"]
        if is_costlier != (more["core"] * fewer > less["core"] * banks):
            raise SystemExit(f"{banks} to {fewer} banks: the rule of the README does not hold")
        if is_costlier:
            lines.append([f"{banks} to {fewer}", f"{more['core'] / less['core']:.2f}",
                          f"{banks / fewer:.2f}", f"{more['mj']:.1f}", f"{less['mj']:.1f}"])
    return lines


def costlier_table(found):
    paper = [(int(point["name"]), point) for point in found["banks"]]
    lines = [["the paper's", *line] for line in costlier(paper)]
    for lanes, text in LANES.items():
        lines += [[text, *line] for line in costlier(lane_series(found, lanes))]
    return study.markdown(["board", "banks", "time of a frame, times", "banks, times", "mJ before",
                           "mJ after"], lines)


def banks_table(found):
    rates = sorted({point["hz"] for point in found["cameras"]})
    rows = [["the paper's, core alone", *paper_cells(found["banks"])]]
    for hz in rates:
        rows.append([f"the paper's, cameras of {hz:g} Hz",
                     *paper_cells([point for point in found["cameras"] if point["hz"] == hz])])
    for lanes, text in LANES.items():
        rows.append([f"{text}, core alone", *(f"{point['mj']:.1f} ({point['core']:.1f})"
                                              for _, point in lane_series(found, lanes))])
    return study.markdown(["board", *map(str, BANKS)], rows)


def paper_cells(points):
    of = {int(point["name"]): point for point in points}
    return [f"{of[banks]['mj']:.1f} ({of[banks].get('delivered', of[banks]['core']):.1f})"
            if banks in of else "" for banks in BANKS]


def kinds_table(found):
    lines = []
    for kind in ("zbt_pipelined", "sync_burst", "qdr", "sdram"):
        for rows, fetch in ((1, "column"), (2, "column"), (4, "column"), (1, "line_buffer")):
            point = study.only(found["kinds"], kind=kind, rows=rows, fetch=fetch)
            lines.append([kind, fetch, rows, f"{point['core']:.2f}", f"{point['megabytes']:.2f}",
                          f"{point['mj']:.1f}", f"{point['mw']:,.0f}"])
    return study.markdown(["kind", "fetch", "rows", "frames/s", "MB a frame", "mJ a frame", "mW"], lines)


def draw(found):
    figure, (banks, rates) = study.panels(2, height=4.2, width=5)
    colors = iter([*study.COLORS, "grey"])
    banks.plot([int(point["name"]) for point in found["banks"]], [point["mj"] for point in found["banks"]],
               "s-", color="black", label="the paper's")
    for lanes, text in LANES.items():
        banks.plot(BANKS, [point["mj"] for _, point in lane_series(found, lanes)], "o-", markersize=4,
                   color=next(colors), label=text)
    banks.set(xlabel="banks", ylabel="memories, mJ a frame", ylim=(0, 240), title="core alone")
    study.legend(banks, ncol=3, loc="upper left")
    for number, color in zip(("3", "4", "5", "6", "8"), study.COLORS):
        its = [point for point in found["cameras"] if point["name"] == number]
        rates.plot([point["hz"] for point in its], [point["mj"] for point in its], "o-", markersize=4,
                   color=color, label=f"{number} banks")
    rates.set(xlabel="cameras, Hz", ylabel="memories, mJ a frame", ylim=(0, None), title="whole computer")
    study.legend(rates)
    study.save(figure, HERE / "energy.png")


TEXT = """# Energy of the memories

**Question.** What does a frame cost in the memories, and when do fewer banks cost more energy?

Made by `results/energy/run` (after `./setup tests` and the release build) from [banks.yaml](banks.yaml),
[cameras.yaml](cameras.yaml), [kinds.yaml](kinds.yaml) and the plan of [lanes](../lanes/README.md): 640x480,
7x7, D = 80, tables of the identity. All rows are in the tables beside. The figures of the banks are
[typical ones](../../models/memory/README.md), of the memories alone: no FPGA, PCI, pins, controllers.

![energy of a frame against banks and against the rate of the cameras](energy.png)

Energy of a frame in mJ, behind it frames a second (with cameras: delivered). Of the paper's board with the
best allocation to so many banks; of boards with lanes, joint tables and the word cache with the best
division of so many banks:

{banks}

The steps to one bank less that take more energy:

{costlier}

The paper's board with eight banks of one kind, with several rows of results at once, and with line buffers:

{kinds}

**Found.**

- **Fewer banks cost more energy when a frame then takes longer by a larger factor than the number of banks
  shrinks.** A bank takes its standby all the time, and an access costs the same in every bank. So the
  standby of a frame is banks * time of the frame, and the accesses of a frame stay. All {steps} steps above
  are of this kind, and no other step of these boards is.
- **On the paper's board that is the step from four banks to three**: a frame takes {times:.2f} times as
  long, with {energy3:.1f} mJ instead of {energy4:.1f}. Down to four banks each bank less saves energy:
  eight take {energy8:.1f} mJ, five, with the same rate, {energy5:.1f}.
- **With cameras that set the rate, fewer banks always cost less**: at {slow:g} Hz three banks deliver every
  frame for {slow3:.0f} mJ, eight for {slow8:.0f}. As soon as the banks no longer keep up, the rule above
  holds again: at 29.97 Hz three banks take {fast3:.0f} mJ, four {fast4:.0f}. Every slower rate costs more a
  frame, because the banks stand by for longer.
- **Standby is {standby:.0f} % of the energy** of the paper's board. So what makes a frame shorter saves it,
  and what saves reads saves the rest. Four rows at once do both: {rows4:.1f} mJ instead of {rows1:.1f}.
  Line buffers: {line:.1f} mJ.
- **SDRAM** takes less power than SRAM, and more energy where each slot of a column opens a row: {sdram:.1f}
  mJ a frame. With line buffers it takes the least: {sdram_line:.1f} mJ.

**Limits.** Standby is an upper limit: it is that of the clock of the data sheet, not of 40 MHz. With less
of it the differences between numbers of banks shrink, but none changes its sign. ZBT and conventional SRAM
have the same figures, and the paper's board has no turnaround. The identity's tables make the frames short;
those of a real rig cost time, and so standby.
"""


def main():
    found = read(pathlib.Path(sys.argv[1]))
    draw(found)

    def paper(banks):
        return study.only(found["banks"], name=str(banks))

    def camera(banks, hz):
        return study.only(found["cameras"], name=str(banks), hz=hz)["mj"]

    def kind(name, fetch, rows):
        return study.only(found["kinds"], kind=name, fetch=fetch, rows=rows)["mj"]

    slow = min(point["hz"] for point in found["cameras"])
    steps = costlier_table(found)
    text = TEXT.format(
        banks=banks_table(found), costlier=steps, kinds=kinds_table(found), steps=len(steps.splitlines()) - 2,
        times=paper(4)["core"] / paper(3)["core"], energy3=paper(3)["mj"], energy4=paper(4)["mj"],
        energy5=paper(5)["mj"], energy8=paper(8)["mj"], slow=slow, slow3=camera(3, slow),
        slow8=camera(8, slow), fast3=camera(3, 29.97), fast4=camera(4, 29.97),
        standby=100 * 8 * STANDBY_MW / paper(8)["mw"], rows4=kind("zbt_pipelined", "column", 4),
        rows1=kind("zbt_pipelined", "column", 1), line=kind("zbt_pipelined", "line_buffer", 1),
        sdram=kind("sdram", "column", 1), sdram_line=kind("sdram", "line_buffer", 1))
    (HERE / "README.md").write_text(study.page(text), encoding="utf-8")


main()
