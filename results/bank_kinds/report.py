"""usage: report.py CORE.db COMPUTER.db

Writes bank_kinds.png, core.csv, computer.csv and README.md beside this script.
"""
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import study  # noqa: E402

KINDS = [("zbt_pipelined", 0), ("zbt_flow_through", 0), *(("sync_burst", clocks) for clocks in (1, 2, 3, 4))]
# By what shares banks: the banks of left_image, right_image, left_lut and disparity in the allocation.
CORE = {
    "nothing": ("[bank0]", "[bank1]", "bank2", "[bank4]"),
    "results with left pictures": ("[bank0]", "[bank1]", "bank2", "[bank0]"),
    "results with left table": ("[bank0]", "[bank1]", "bank2", "[bank2]"),
    "tables with their pictures": ("[bank0]", "[bank1]", "bank0", "[bank4]"),
    "everything": ("[bank0]", "[bank0]", "bank0", "[bank0]"),
}
COMPUTER = {
    "nothing (8 banks)": ("[bank0, bank1]", "[bank2, bank3]", "bank6", "[bank4, bank5]"),
    "the two buffers of each list (5 banks)": ("[bank0, bank0]", "[bank1, bank1]", "bank3", "[bank2, bank2]"),
    "left table with every second left picture (7 banks)":
        ("[bank0, bank1]", "[bank2, bank3]", "bank0", "[bank4, bank5]"),
}
COLUMNS = {
    "kind": "ssram.banks.bank0.kind",
    "turnaround_cycles": "ssram.banks.bank0.turnaround_cycles",
    "left_image": "allocation.left_image",
    "right_image": "allocation.right_image",
    "left_lut": "allocation.left_lut",
    "disparity": "allocation.disparity",
     "core": "frames_per_second.core"}
STYLES = ["o-", "s--", "^-", "v--", "D:"]


def read(database, shares, **more):
    """The points of a database, in the order of `shares` and then of KINDS.

    turnaround_cycles is 0 for kinds without it.
    """
    found = study.points(database, **COLUMNS, **more)
    for point in found:
        point["turnaround_cycles"] = point["turnaround_cycles"] or 0
    buffers = ("left_image", "right_image", "left_lut", "disparity")
    return [{"shared": name,
             **study.only(found, kind=kind, turnaround_cycles=clocks, **dict(zip(buffers, where)))}
            for name, where in shares.items() for kind, clocks in KINDS]


def table(found, shares, rate):
    header = ["in one bank", "ZBT pipelined", "ZBT flow-through", *(f"sync burst, {n}" for n in (1, 2, 3, 4))]
    rows = [[name, *(f"{point[rate]:.2f}" for point in found if point["shared"] == name)] for name in shares]
    return study.markdown(header, rows)


def draw(axis, found, shares, rate, title):
    for name, style in zip(shares, STYLES):
        line = [point for point in found if point["shared"] == name and point["kind"] != "zbt_flow_through"]
        axis.plot([point["turnaround_cycles"] for point in line], [point[rate]
                  for point in line], style, label=name, markersize=9 if style == "s--" else 5)
    axis.set(title=title, xlabel="clocks lost when the direction turns (0: ZBT)",
             ylabel="core, frames/s", ylim=(0, 20), xticks=range(5))
    study.legend(axis, title="in one bank", loc="upper center", bbox_to_anchor=(0.5, -0.17))


TEXT = """# Kinds of memory

**Question.** The paper's memories are ZBT: a write may follow a read in the next clock. What would
conventional synchronous burst memories cost, which lose 1 to 4 clocks at each change of direction, and does
it matter that flow-through memories answer a clock earlier than pipelined ones?

Made by `results/bank_kinds/run` (after `./setup tests` and the release build) from [core.yaml](core.yaml) and
[computer.yaml](computer.yaml): `fpl2003`, 640x480, 7x7, D = 80, all banks of one kind, fixed priority. All
rows are in [core.csv](core.csv) and [computer.csv](computer.csv).

![frames per second against turnaround](bank_kinds.png)

The core alone, frames per second:

{core}

The whole computer with cameras at 29.97 Hz, steady frames per second over 31 frames:

{computer}

**Found.**

- With a bank for each buffer the kind of memory makes no difference: in the core alone each bank goes one way
  for a whole frame, so no clock is lost to turning. The clock of latency that flow-through memories save
  comes once a frame (2 cycles in 2,151,016), not once an access.
- Sharing a bank among readers costs the same in every kind: half the frame rate, because there are twice as
  many reads in it and each bank is 99 % busy with one reader already.
- Where results share a bank with something that is read, ZBT costs 3.4 % (17.96 instead of 18.60), and each
  clock of turnaround {per_clock:,} cycles a frame more: two turns for each of 76,800 words of results. With 2
  clocks that is 15.8 frames a second, with 4 it is 14.1. This is what the paper's ZBT memories are for: they
  make it cheap to let results share a bank.
- In the whole computer captures and read-backs are further writes and reads. Both buffers of each list in one
  bank give {zbt_shared:.2f} instead of {own:.2f} frames a second with ZBT, and {burst_shared:.2f} with
  `sync_burst` of 2 clocks: little less, because the bus writes in bursts, which turn a bank twice each and
  not twice a word.
- There flow-through memories are a little better, {flow_shared:.2f}: of the 16 slots of a lane's queue fewer
  are on their way through the memories, and more bridge the bursts of the bus. Two slots more do the same for
  pipelined memories (`--set fpga.lane_fifo_slots=18`, to the cycle but for one), and longer queues do more
  ([results/banks](../banks/README.md)).

**Limits.** One kind for all banks; a memory's own longest clock is not modelled (flow-through parts are
slower to clock); `turnaround_cycles` is a figure of the controller and the board as much as of the memory.
"""


def main():
    core = read(sys.argv[1], CORE, cycles="cycles")
    computer = read(
    sys.argv[2],
    COMPUTER,
    steady="frames_per_second.steady",
     dropped_pixels="cameras.left.dropped_pixels")
    study.write_csv(HERE / "core.csv", core)
    study.write_csv(HERE / "computer.csv", computer)
    figure, (left, right) = study.panels(2, height=4.8)
    draw(left, core, CORE, "core", "the core alone")
    draw(right, computer, COMPUTER, "steady", "the whole computer")
    study.save(figure, HERE / "bank_kinds.png")
    with_table = [point["cycles"] for point in core if point["shared"] == "results with left table"]
    shared = [point["steady"] for point in computer if point["shared"].startswith("the two")]
    text = TEXT.format(
    core=table(
        core,
        CORE,
        "core"),
        computer=table(
            computer,
            COMPUTER,
            "steady"),
            per_clock=round(
                (with_table[5] - with_table[2]) / 3),
                own=computer[0]["steady"],
                zbt_shared=shared[0],
                flow_shared=shared[1],
                 burst_shared=shared[3])
    (HERE / "README.md").write_text(text)


main()
