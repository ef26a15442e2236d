"""usage: report.py CORE.db COMPUTER.db

Writes arbitration.png, core.csv, computer.csv and README.md beside this script.
"""
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))
import study  # noqa: E402

DEFAULT = "[host, result, left_pixel, right_pixel, left_lut, right_lut]"
BUFFERS = ("left_image", "right_image", "left_lut", "right_lut", "disparity")
# By what shares banks, for the core alone: the banks of BUFFERS.
CORE = {
    "results with left table": "0 1 2 3 2",
    "results with right table": "0 1 2 3 3",
    "results with left pictures": "0 1 2 3 0",
    "both pictures": "0 0 2 3 4",
    "both tables": "0 1 2 2 4",
    "tables with their pictures": "0 1 0 1 4",
    "tables with the other side's": "0 1 1 0 4",
    "the best of 3 banks": "0 1 1 2 0",
    "everything": "0 0 0 0 0",
}
# By what shares banks, for the whole computer: the lists of banks of the left pictures and of the results.
COMPUTER = {
    "nothing (8 banks)": ("[bank0, bank1]", "[bank4, bank5]"),
    "the buffers of each list (5 banks)": ("[bank0, bank0]", "[bank2, bank2]"),
    "the same, left table with results (4)": ("[bank0, bank0]", "[bank2, bank2]"),
    "everything (1)": ("[bank0, bank0]", "[bank0, bank0]"),
}
POLICIES = {
    "host first": ("fixed_priority", DEFAULT),
    "results, then host": ("fixed_priority", "[result, host, left_pixel, right_pixel, left_lut, right_lut]"),
    "host last": ("fixed_priority", "[result, left_pixel, right_pixel, left_lut, right_lut, host]"),
    "round robin": ("round_robin", DEFAULT),
}
DRAWN = dict(zip(POLICIES, zip((study.BLUE, study.SKY, study.VERMILION, study.ORANGE), "o^Xs")))


def read_core(database):
    """A row for each allocation and policy: rates of the slowest, the default and the fastest order of
    priority."""
    found = study.points(
        database,
        policy="fpga.arbitration",
        order="fpga.priority",
        rate="frames_per_second.core",
        bound="bound.core",
        **{name: f"allocation.{name}" for name in BUFFERS},
    )
    rows = []
    for shared, banks in CORE.items():
        where = dict(zip(BUFFERS, (f"bank{bank}" for bank in banks.split())))
        for name in ("left_image", "right_image", "disparity"):
            where[name] = f"[{where[name]}]"
        here = [point for point in found if all(point[name] == bank for name, bank in where.items())]
        for policy in ("fixed_priority", "round_robin"):
            rates = [point["rate"] for point in here if point["policy"] == policy]
            default = study.only(here, policy=policy, order=DEFAULT)
            rows.append(
                {
                    "shared": shared,
                    **where,
                    "policy": policy,
                    "orders": len(rates),
                    "slowest": min(rates),
                    "default": default["rate"],
                    "fastest": max(rates),
                    "bound": default["bound"],
                }
            )
    return rows


def read_computer(database):
    found = study.points(
        database,
        policy="fpga.arbitration",
        order="fpga.priority",
        left_image="allocation.left_image",
        left_lut="allocation.left_lut",
        disparity="allocation.disparity",
        core="frames_per_second.core",
        steady="frames_per_second.steady",
        dropped="cameras.left.dropped_pixels",
        frames="cameras.left.captured_frames",
        width="image.width",
        height="image.height",
        p50="latency_ms.capture_to_host.p50",
        host_stall_cycles="ports.host.stall_cycles",
    )
    rows = []
    for shared, (left_image, disparity) in COMPUTER.items():
        for name, (policy, order) in POLICIES.items():
            left_lut = {
                "the buffers of each list (5 banks)": "bank3",
                "the same, left table with results (4)": "bank2",
            }.get(shared)
            here = study.only(
                found,
                policy=policy,
                order=order,
                left_image=left_image,
                disparity=disparity,
                **({"left_lut": left_lut} if left_lut else {}),
            )
            lost = 100 * here["dropped"] / (here["frames"] * here["width"] * here["height"])
            rows.append(
                {
                    "shared": shared,
                    "ports": name,
                    **{
                        key: here[key]
                        for key in ("policy", "order", "core", "steady", "p50", "host_stall_cycles")
                    },
                    "lost_percent": round(lost, 3),
                }
            )
    return rows


def core_table(rows):
    lines = []
    for shared in CORE:
        fixed, ring = (
            study.only(rows, shared=shared, policy=policy) for policy in ("fixed_priority", "round_robin")
        )
        lines.append(
            [
                shared,
                f"{fixed['default']:.3f}",
                f"{fixed['slowest']:.3f} .. {fixed['fastest']:.3f}",
                f"{ring['slowest']:.3f} .. {ring['fastest']:.3f}",
                f"{fixed['bound']:.3f}",
            ]
        )
    return study.markdown(
        ["in one bank", "fixed priority, default", "all 120 orders", "round robin, all 120 rings", "bound"],
        lines,
    )


def computer_table(rows):
    return study.markdown(
        ["in one bank", "ports", "core", "steady", "capture to host, p50, ms", "left pixels lost, %"],
        [
            [
                row["shared"],
                row["ports"],
                f"{row['core']:.2f}",
                f"{row['steady']:.2f}",
                f"{row['p50']:.1f}",
                f"{row['lost_percent']:.1f}",
            ]
            for row in rows
        ],
    )


def draw(core, computer):
    figure, (left, middle, right) = study.panels(3, height=4.6, width=4.5, width_ratios=(1.15, 1, 0.95))
    names = list(CORE)[::-1]
    for policy, shift, color, marker in (
        ("fixed_priority", 0.14, study.BLUE, "o"),
        ("round_robin", -0.14, study.ORANGE, "s"),
    ):
        rows = [study.only(core, shared=name, policy=policy) for name in names]
        at = [number + shift for number in range(len(rows))]
        left.hlines(
            at, [row["slowest"] for row in rows], [row["fastest"] for row in rows], color=color, linewidth=3
        )
        left.plot([row["default"] for row in rows], at, marker, color=color, label=policy.replace("_", " "))
    rows = [study.only(core, shared=name, policy="fixed_priority") for name in names]
    left.plot(
        [row["bound"] for row in rows],
        range(len(rows)),
        label="bound",
        **study.bound(study.BLACK, study.LID_OF_X),
    )
    left.set(
        yticks=range(len(names)),
        yticklabels=names,
        title="the core alone: slowest to fastest of 120 orders",
        xlabel="core, frames/s",
        xlim=(0, 20),
    )
    study.legend(left, ncol=3, loc="upper center", bbox_to_anchor=(0.4, -0.12), columnspacing=1)
    names = list(COMPUTER)[::-1]
    for number, (name, (color, marker)) in enumerate(DRAWN.items()):
        rows = [study.only(computer, shared=shared, ports=name) for shared in names]
        at = [place + 0.27 - 0.18 * number for place in range(len(names))]
        middle.plot([row["steady"] for row in rows], at, marker, color=color, markersize=6, label=name)
        right.barh(at, [row["lost_percent"] for row in rows], 0.16, color=color)
        right.plot([row["lost_percent"] for row in rows], at, marker, color=color, markersize=6)
    for axis in (middle, right):
        axis.set(yticks=range(len(names)), yticklabels=[], ylim=(-0.5, len(names) - 0.5))
        axis.hlines(
            [place + 0.5 for place in range(len(names) - 1)],
            0,
            1,
            transform=axis.get_yaxis_transform(),
            color="#DDDDDD",
            linewidth=0.8,
        )
        axis.grid(False, axis="y")
    middle.set(
        yticklabels=[name.replace(" (", "\n(").replace(", ", ",\n") for name in names],
        xlabel="steady, frames/s",
        title="the whole computer: rate",
        xlim=(0, 20),
    )
    right.set(xlabel="pixels of the left camera, %", title="the whole computer: pixels lost", xlim=(-3, 103))
    study.legend(middle, ncol=4, loc="upper center", bbox_to_anchor=(0.9, -0.12), columnspacing=1)
    middle.get_legend().set_in_layout(False)  # it may reach below the next panel
    study.save(figure, HERE / "arbitration.png")


TEXT = """# Arbitration

**Question.** Where several ports share a bank, does it matter who goes first, and would a fair arbiter be
better than the default, a fixed priority of `host, result, left_pixel, right_pixel, left_lut, right_lut`?

Made by `results/arbitration/run` (after `./setup tests` and the release build) from [core.yaml](core.yaml)
and [computer.yaml](computer.yaml): `fpl2003`, 640x480, 7x7, D = 80, ZBT pipelined memories, large enough for
all buffers. All rows are in [core.csv](core.csv) and [computer.csv](computer.csv).

![frame rates of all orders; pixels lost](arbitration.png)

The core alone, whose host port is idle: every order of the other five ports, and every ring of round robin,
frames per second:

{core}

The whole computer, cameras at 29.97 Hz, 31 frames: where the local bus shares banks with the core.

{computer}

**Found.**

- Within the core the order hardly matters: between the slowest and the fastest of 120 orders lies at most
  {spread:.2f} % ("{widest}"), and round robin is never more than {gain:.2f} % faster than the default. Both
  lanes wait for each other, and a bank that is asked all the time gives one word a clock whoever is first:
  what the bank bounds, the order does not change.
- What matters is the place of the host. With the host last, a lane that reads in 99 % of all clocks leaves
  the local bus next to nothing: the FIFOs of the capture boards overflow and {lost:.0f} % of the pixels are
  lost with 5 banks, although the frame rate looks best. Host first or second, or round robin, loses none.
- Round robin gives the host its words as well, and costs no more: the rate that is delivered is within
  {robin:.1f} % of that of host first wherever no pixel is lost.

**Limits.** One kind of memory: with `sync_burst` each change of direction costs, and the order decides how
often there is one. Queues are those of `fpl2003` ([results/banks](../banks/README.md) has longer ones). A
frame rate beside lost pixels is that of broken pictures; it can be a little above the core's where the first
read-back took longer than the last.
"""


def main():
    core, computer = read_core(sys.argv[1]), read_computer(sys.argv[2])
    study.write_csv(HERE / "core.csv", core)
    study.write_csv(HERE / "computer.csv", computer)
    draw(core, computer)
    fixed = [row for row in core if row["policy"] == "fixed_priority"]
    widest = max(fixed, key=lambda row: row["fastest"] / row["slowest"])
    gain = max(
        study.only(core, shared=row["shared"], policy="round_robin")["default"] / row["default"]
        for row in fixed
    )
    robin = max(
        abs(
            study.only(computer, shared=name, ports="round robin")["steady"]
            / study.only(computer, shared=name, ports="host first")["steady"]
            - 1
        )
        for name in COMPUTER
    )
    text = TEXT.format(
        core=core_table(core),
        computer=computer_table(computer),
        spread=100 * (widest["fastest"] / widest["slowest"] - 1),
        widest=widest["shared"],
        gain=100 * (gain - 1),
        lost=study.only(computer, shared="the buffers of each list (5 banks)", ports="host last")[
            "lost_percent"
        ],
        robin=100 * robin,
    )
    (HERE / "README.md").write_text(text)


main()
