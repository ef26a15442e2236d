"""usage: report.py QUEUES.db

Reads QUEUES.db, and what `allocate --json` has printed beside this script. Writes banks.png, queues.csv
and README.md beside it.
"""
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import study  # noqa: E402

# By name of the output file: what `allocate` searched.
SEARCHES = {
    "core": "core alone, ZBT",
    "core_sync_burst": "core alone, sync burst, 2 clocks",
    "core_round_robin": "core alone, round robin",
    "core_line_buffer": "core alone, line buffers",
    "core_no_tables": "core alone, no tables",
    "computer": "computer, ZBT",
    "computer_sync_burst": "computer, sync burst, 2 clocks",
    "computer_long_queues": "computer, ZBT, queues of 32 slots",
}
DRAWN = {"core": ("o-", study.BLUE), "core_sync_burst": ("o--", study.SKY),
         "computer": ("s-", study.VERMILION), "computer_sync_burst": ("s--", study.ORANGE),
         "computer_long_queues": ("s-", study.GREEN)}
BANKS = range(1, 9)


def queues_table(queues):
    return study.markdown(["slots", *(point["lane_fifo_slots"] for point in queues)],
                          [["core, frames/s", *(f"{point['core']:.2f}" for point in queues)],
                           ["steady", *(f"{point['steady']:.2f}" for point in queues)],
                           ["slices", *(point["slices"] for point in queues)]])


def draw(found, queues):
    figure, (left, right) = study.panels(2, height=4, width=4.8)
    for name, (look, color) in DRAWN.items():
        rates = found[name]
        left.plot(list(rates), [row["best"] for row in rates.values()],
                  look, color=color, markersize=5, label=SEARCHES[name])
    left.set(title="the best of all allocations", xlabel="banks", ylabel="best rate, frames/s",
             xticks=range(3, 9), ylim=(0, 20))
    study.legend(left, loc="lower right")
    right.axhline(found["computer"][8]["best"], color=study.GRAY, linestyle="--", label="8 banks, 16 slots")
    right.plot([point["lane_fifo_slots"] for point in queues], [point["steady"]
               for point in queues], "s-", color=study.VERMILION, markersize=5, label="5 banks")
    right.set(title="longer queues, five banks", xlabel="slots of a lane's queue (fpga.lane_fifo_slots)",
              ylabel="whole computer, steady frames/s", ylim=(16, 18.2))
    study.legend(right, loc="lower right")
    study.save(figure, HERE / "banks.png")


TEXT = """# How many banks?

**Question.** The paper says that its system needs "at least eight" memory banks. How many does it need, with
and without the traffic of the cameras, and what are the others for?

Made by `results/banks/run` (after `./setup tests` and the release build): `stereotlm allocate fpl2003 --banks
8` tries every way to place the eight buffers (two for each picture, two for results, two tables) in at most
eight banks: 4,140 different ones, of which 2,507 fit into banks of 524,288 words. 640x480, 7x7, D = 80. What
it says is beside this page: {files}.

![best frame rate against banks; frame rate against queues](banks.png)

The best frame rate with so many banks, the first that ties with the best of all in bold. Of the core alone:
with an ideal host. Of the computer: steady, over 120 frames, cameras at 29.97 Hz, no pixel lost.

{best}

The core alone (`core.json`):

{core}

The whole computer (`computer.json`); behind ± stands what 120 frames leave open:

{computer}

**Found.**

- The core alone needs five banks, one for each of its ports: four of them read in 99 % of all clocks, and
  only one buffer of each list is in use at a time. That five are needed is proved: the rate of each of the
  1,081 allocations to four banks is known, and none is above {core4:.3f} frames a second (96.6 % of
  {core5:.3f}). It is five with `sync_burst`, round robin and line buffers too, and three without tables.
- The whole computer needs seven for its very best, {best7:.3f} frames a second; six give {best6:.3f} (99.6
  %), five {best5:.3f} (97.2 %), four {best4:.3f} (93.3 %). 120 frames leave open whether seven are faster
  than six; 1,200 frames show it (17.982 ± 0.005 and 17.904 ± 0.007). What camera traffic adds is that the
  next pictures come in while these are read: the two banks beyond five keep captures out of the banks that
  lanes read.
- The eighth bank gives nothing: eight banks have the rate of seven, in which both result buffers share a
  bank, with ZBT and with `sync_burst`: the core writes one result in 3.6 % of the clocks while the host reads
  the last one. Eight is one bank for each buffer, the number at which no two ports ever ask the same bank: a
  board without arbiters needs it. With arbiters that let the host go first, "at least eight" is not a
  minimum.
- `sync_burst` makes sharing dearer, not eight banks necessary: it loses most with four, where results share
  with a table.
- Five banks lose what they lose to short queues: bursts of the bus interrupt the lanes, and 16 slots do not
  bridge them. With queues of 32 slots, for 63 slices more (0.7 %), five banks give {long5:.3f} frames a
  second, 99.5 % of the best, and four {long4:.3f}. 24 slots are nearly as good, longer ones than 32 no better
  ([queues.yaml](queues.yaml): five banks, both buffers of each list in one, 61 frames):

{queues}

**Limits.** Rates of the computer are known up to ± some tenths of a percent. The bank of a buffer is the only
thing that moves; words of one bank are not split between buffers of a list. Placements that differ by an
exchange of alike banks count as one. An allocation whose bound shows that another with as many banks is
faster is not simulated. Other windows, cameras and numbers of buffers need a search of their own: give
`--set` to `allocate`.
"""


def main():
    found = {name: study.searched(HERE / f"{name}.json") for name in SEARCHES}
    queues = study.points(sys.argv[1], lane_fifo_slots="fpga.lane_fifo_slots", core="frames_per_second.core",
                          steady="frames_per_second.steady", slices="area.slices")
    queues.sort(key=lambda point: point["lane_fifo_slots"])
    study.write_csv(HERE / "queues.csv", queues)
    draw(found, queues)
    core, computer = found["core"], found["computer"]
    text = TEXT.format(
        files=",\n".join(f"[{name}.json]({name}.json)" for name in SEARCHES),
        best=study.best_table([(what, found[name]) for name, what in SEARCHES.items()], BANKS),
        core=study.witness_table(core), computer=study.witness_table(computer), queues=queues_table(queues),
        core4=core[4]["best"], core5=core[5]["best"], best4=computer[4]["best"], best5=computer[5]["best"],
        best6=computer[6]["best"], best7=computer[7]["best"],
        long4=found["computer_long_queues"][4]["best"], long5=found["computer_long_queues"][5]["best"])
    (HERE / "README.md").write_text(study.page(text))


main()
