"""usage: report.py BUFFERS.db

Writes buffers.png, buffers.csv and README.md beside this script.
"""
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import study  # noqa: E402

NAMES = {1: "single", 2: "ping-pong", 3: "triple"}
COLORS = {1: study.VERMILION, 2: study.BLUE, 3: study.GREEN}
SHOWN = [10, 20, 29.97, 40, 60]
PAPER_HZ = 29.97


def read(database):
    found = study.points(
    database,
    pictures="allocation.left_image",
    results="allocation.disparity",
    rate_hz="cameras.frame_rate_hz",
    core="frames_per_second.core",
    steady="frames_per_second.steady",
    p50_ms="latency_ms.capture_to_host.p50",
    max_ms="latency_ms.capture_to_host.max",
     dropped_pixels="cameras.left.dropped_pixels")
    for point in found:
        for name in ("pictures", "results"):
            point[name] = len(point[name].split(","))
    return sorted(found, key=lambda point: (point["pictures"], point["results"], point["rate_hz"]))


def table(found, what, form):
    lines = []
    for pictures in NAMES:
        for results in NAMES:
            rates = (
    study.only(
        found,
        pictures=pictures,
        results=results,
         rate_hz=rate)[what] for rate in SHOWN)
            lines.append([NAMES[pictures], NAMES[results], *(format(rate, form) for rate in rates)])
    return study.markdown(["pictures", "results", *(f"{rate} Hz" for rate in SHOWN)], lines)


def draw(found):
    figure, (left, right) = study.panels(2, height=4.2, width=5)
    for pictures in (3, 2, 1):
        for results, dashes in ((2, "-"), (1, "--")):
            line = [point for point in found if point["pictures"] == pictures and point["results"] == results]
            for axis, what in ((left, "steady"), (right, "p50_ms")):
                axis.plot([point["rate_hz"] for point in line],
    [point[what] for point in line],
    dashes,
    marker=".",
    color=COLORS[pictures],
    linewidth=1.2,
     label=f"{NAMES[pictures]}, results {NAMES[results]}")
    core = found[0]["core"]
    left.axhline(core, label="the core alone", color=study.GRAY, linewidth=0.9, linestyle="--")
    for axis in (left, right):
        axis.axvline(PAPER_HZ, color=study.GRAY, linewidth=0.8, linestyle=":", zorder=0)
        axis.set(xlabel="frame rate of the cameras, Hz")
    left.set(title="rate of results", ylabel="whole computer, steady frames/s", ylim=(0, 20))
    right.set(title="age of results", ylabel="capture to result in the host, median, ms", ylim=(0, 190))
    study.legend(left, fontsize=7.5, title="pictures", loc="lower right", ncol=2)
    study.save(figure, HERE / "buffers.png")


TEXT = """# One, two and three buffers

**Question.** The paper keeps two buffers of each picture and of the results. What do one and three give, at
the rate of its cameras and at others?

Made by `results/buffers/run` (after `./setup tests` and the release build) from [plan.yaml](plan.yaml):
`fpl2003` with eleven banks, a bank a buffer, 640x480, 7x7, D = 80; the whole computer, 61 frames a point. A
frame of the core takes 53.8 ms, which is {core:.2f} frames a second. All rows are in
[buffers.csv](buffers.csv); the dotted line is the paper's {paper} Hz.

![frames per second and latency against camera rate](buffers.png)

Steady frames per second:

{rates}

First pixel of a capture to the result in the host, median, ms:

{latency}

**Found.**

- Single: capture and computation take turns, and each begins with a camera frame. At {paper} Hz that is every
  third frame, 9.99 a second, half of what the core could do; the second pair of picture buffers is worth 8
  frames a second.
- Ping-pong is as good as triple as long as the core is faster than the cameras, and again where the cameras
  are about twice as fast as the core (from 36 Hz on). Between, at the paper's rate too, a capture waits for
  the next camera frame: 17.98 instead of 18.60, at 20 Hz even 15.00. A third pair of picture buffers gives
  the 18.60 back.
- The price of the third is age: the queue is one pair longer, and a result is {older:.0f} ms older at {paper}
  Hz ({p50[3]:.0f} ms instead of {p50[2]:.0f}). Who wants fresh results rather than many takes ping-pong.
- A second result buffer is worth half a frame a second with two picture buffers at {paper} Hz, a whole one
  with three, nothing with one. A third result buffer changes no figure at any rate: the host reads a result
  in less time than the core needs for the next.
- More camera frames are not always better: with one buffer 34 Hz give {single[34]:.2f} frames a second, 40 Hz
  give {single[40]:.2f}, because the core then just misses a frame.

**Limits.** Free-running cameras; the host takes results at once and computes nothing. Rates are those of 61
frames: a pattern of captures that repeats after many more frames is seen in part. Other lengths of a core
frame move the steps ([results/system](../system/README.md) has them).
"""


def main():
    found = read(sys.argv[1])
    study.write_csv(HERE / "buffers.csv", found)
    draw(found)
    p50 = {
    pictures: study.only(
        found,
        pictures=pictures,
        results=2,
         rate_hz=PAPER_HZ)["p50_ms"] for pictures in NAMES}
    single = {rate: study.only(found, pictures=1, results=2, rate_hz=rate)["steady"] for rate in (34, 40)}
    text = TEXT.format(core=found[0]["core"], paper=PAPER_HZ, rates=table(found, "steady", ".2f"),
                       latency=table(found, "p50_ms", ".1f"), older=p50[3] - p50[2], p50=p50, single=single)
    (HERE / "README.md").write_text(text)


main()
