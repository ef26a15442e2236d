"""usage: report.py CORE.db COMPUTER.db

Writes computer.csv and README.md beside this script.
"""
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import study  # noqa: E402

FETCHES = ("column", "line_buffer")
DISPARITIES = 80


def core_table(found):
    lines = []
    for window in sorted({point["window"] for point in found}):
        column, lines_kept = (
            study.only(found, window=window, disparities=DISPARITIES, fetch=fetch) for fetch in FETCHES
        )
        lines.append(
            [
                f"{window}x{window}",
                f"{column['rate']:.2f}",
                f"{lines_kept['rate']:.2f}",
                f"{lines_kept['rate'] / column['rate']:.1f}",
                f"{column['slices']:.1f}",
                f"{lines_kept['slices']:.1f}",
                column["block_rams"],
                lines_kept["block_rams"],
                *(most(found, window, fetch) for fetch in FETCHES),
            ]
        )
    return study.markdown(
        [
            "window",
            "column, frames/s",
            "line buffer",
            "times",
            "column, % of the slices",
            "line buffer",
            "column, block RAMs",
            "line buffer",
            "column, most D of the sweep that fits",
            "line buffer",
        ],
        lines,
    )


def most(found, window, fetch):
    fits = [
        point["disparities"]
        for point in found
        if point["window"] == window and point["fetch"] == fetch and point["fits"]
    ]
    return max(fits, default="none")


def computer_table(found):
    lines = []
    for rate in sorted({point["rate_hz"] for point in found}):
        for fetch in FETCHES:
            point = study.only(found, rate_hz=rate, fetch=fetch, window=7)
            lines.append(
                [
                    f"{rate:g} Hz",
                    fetch,
                    f"{point['core']:.2f}",
                    f"{point['steady']:.2f}",
                    point["limited_by"],
                    f"{point['p50_ms']:.1f}",
                    f"{100 * point['pci_busy']:.0f}",
                ]
            )
    return study.markdown(
        ["cameras", "fetch", "core", "steady", "limited by", "capture to host, p50, ms", "PCI busy, %"], lines
    )


TEXT = """# Column fetch against line buffers

**Question.** The paper reads each column of the window anew for each pixel: n reads a pixel and side. Keeping
the rows in block RAM needs one. What does that give, and what does it take?

Made by `results/fetch/run` (after `./setup tests` and the release build) from [core.yaml](core.yaml) and
[computer.yaml](computer.yaml): 640x480, `log7`, a bank a buffer. The figures are those of `stereotlm plot`;
their data are beside them.

![frames per second against window](window.png)

At D = {disparities}, the core alone:

{core}

![frames per second and area against disparities](disparities.png)

In the whole computer with three input buffers (`fpl2003-triple`), 7x7, {frames} frames (all windows are in
[computer.csv](computer.csv)):

{computer}

**Found.**

- With line buffers the frame rate no longer depends on the window: 128.6 frames a second at 7x7 instead of
  18.6, 127.5 at 15x15 instead of 8.7. What is gained is n times, less what the rows outside the picture cost.
- It is paid in slices. Column fetch brings one pixel of each column in a clock, so that one absolute
  difference and one adder do for a column of the window; line buffers bring all n at once, and each of the D
  modules needs n of them. At 7x7 that is 52 % of the FPGA instead of 25 %. With line buffers 7x7 fits up to
  120 disparities in this sweep, 15x15 up to 80; with column fetch all windows up to 31x31 fit at 240. The
  paper's 200 disparities at 7x7 would be 124 % with line buffers. Block RAM is not what runs out.
- With the paper's cameras most of the gain cannot be used: the computer delivers their 29.97 frames a second,
  at 26 % of the PCI bus. Cameras of 120 Hz are followed too, with the bus 93 % busy: that is about what 33
  MHz, 32 bit carry.
- Column fetch is thus the choice of a designer with many disparities and slow cameras; 9x9 and smaller with
  fewer than 100 disparities could have had the full camera rate on the same FPGA.

**Limits.** The area of line buffers is counted from the structure and compared with no synthesis
([Area](../../models/area/README.md)); a fuller FPGA may not reach its 40 MHz. Tables are the identity: what
line buffers of *raw* pictures would need with a real rig is another matter (29 lines instead of 7, `stereotlm
calibrate`); here rows of *rectified* pictures are kept, and the memories are still read pixel by pixel
through the tables.
"""


def main():
    core = study.points(
        sys.argv[1],
        hash="hash",
        window="matcher.window",
        disparities="matcher.disparities",
        fetch="matcher.fetch",
        rate="frames_per_second.core",
        slices="area.slices_percent",
        block_rams="area.block_rams",
    )
    fitting = study.fitting(sys.argv[1])
    for point in core:
        point["fits"] = point["hash"] in fitting
    computer = study.points(
        sys.argv[2],
        fetch="matcher.fetch",
        window="matcher.window",
        rate_hz="cameras.frame_rate_hz",
        core="frames_per_second.core",
        steady="frames_per_second.steady",
        bound="bound.system",
        limited_by="bound.system_limited_by",
        p50_ms="latency_ms.capture_to_host.p50",
        dropped_pixels="cameras.left.dropped_pixels",
        frames="frames",
        busy="pci.busy_clocks",
        clocks="pci.clocks",
    )
    for point in computer:
        point["pci_busy"] = round(point.pop("busy") / point.pop("clocks"), 4)
    computer.sort(key=lambda point: (point["window"], point["rate_hz"], point["fetch"]))
    study.write_csv(HERE / "computer.csv", computer)
    text = TEXT.format(
        disparities=DISPARITIES,
        core=core_table(core),
        computer=computer_table(computer),
        frames=computer[0]["frames"],
    )
    (HERE / "README.md").write_text(text)


main()
