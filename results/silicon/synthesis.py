"""Synthesizes models/rtl with Yosys for Virtex-II: what each block takes, and the longest path of a core."""
import collections
import concurrent.futures
import dataclasses
import itertools
import json
import pathlib
import subprocess
import threading

HERE = pathlib.Path(__file__).resolve().parent
RTL = HERE.parent.parent / "models" / "rtl"
# Each of these is synthesized by itself, once for the same parameters. Other modules belong to the block
# that contains them.
BLOCKS = ("stereo_core", "crossbar", "lane", "match_control", "matcher", "slot_position", "log_filter",
          "window_control", "cost_array", "column_module", "window_module", "candidates", "select_min_chain",
          "select_min_tree", "lr_check", "result_port")
# The cells that DS031 has, and the look-up tables that each of them takes.
LUTS = {"LUT1": 1, "LUT2": 1, "LUT3": 1, "LUT4": 1, "INV": 1, "RAM16X1S": 1, "RAM32X1S": 2, "RAM64X1S": 4,
        "RAM128X1S": 8, "RAM16X1D": 2, "RAM32X1D": 4, "RAM64X1D": 8}
FLIP_FLOPS = {"FDCE", "FDPE", "FDRE", "FDSE"}
CARRY = {"MUXCY", "XORCY"}
STRAPS = {"table_latency_2", "image_latency_2"}  # constants of a board
COMBINATIONAL = {"LUT1", "LUT2", "LUT3", "LUT4", "INV", "MULT18X18", "MUXF5", "MUXF6", "MUXF7", "MUXF8",
                 *CARRY}

# ns of speed grade -4: README.md says where they are from.
T_CKO = 0.57  # clock to the output of a flip-flop
T_DICK = 0.37  # setup of a flip-flop
T_ILO = 0.44  # a look-up table
T_CARRY_IN = 0.30  # from a look-up table into the carry chain
T_CARRY = 0.053  # one step of the carry chain
T_CARRY_OUT = 1.27  # from the carry chain to the output of a slice
T_BCKO = 2.65  # clock to the output of a block RAM
T_MULT = 5.91  # a multiplier, to its highest bit


def log7(parameters):
    """Parameters of a core with the filter log7."""
    rows = [[0, -1, -3, -5], [-1, -6, -14, -16], [-3, -14, 0, 35], [-5, -16, 35, 112]]
    weights = [weight for row in (*rows, *rows[2::-1]) for weight in (*row, *row[2::-1])]
    packed = sum((weight & 0xFFFF) << 16 * place for place, weight in enumerate(weights))
    return {**parameters, "HALF": 3, "SHIFT": 6, "WEIGHTS": f"{16 * 49}'h{packed:x}"}


def yosys(script):
    done = subprocess.run(["yosys", "-q", "-p", "; ".join(script)], stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True)
    if done.returncode:
        raise SystemExit(f"yosys: {done.stdout}")


def read(top, parameters):
    given = " ".join(f"-chparam {name} {value}" for name, value in parameters.items())
    return [f"read_verilog -I{RTL} {RTL}/*.v {HERE}/paper_crossbar.v", f"hierarchy -check -top {top} {given}"]


def base_name(module):
    """The name in the source: Yosys calls modules with parameters $paramod..\\name or $paramod\\name\\..."""
    parts = module.split("\\")
    return module if len(parts) == 1 else parts[1]


def mapped(out):
    """The commands of Yosys from a top module to cells of Virtex-II."""
    synth = "synth_xilinx -family xc2v -flatten -nowidelut -noiopad -noclkbuf -run"
    return [f"{synth} begin:map_memory",
            "maccmap -unmap",  # adds three numbers by two carry chains
            f"{synth} map_memory:map_ffs", "xilinx_srl -fixed -minlen 3",  # synth_xilinx has none for xc2v
            f"techmap -map {RTL}/board/srl16.v", f"{synth} map_ffs:", f"write_json {out}"]


def cells_of(netlist, blocks=frozenset()):
    """How many cells of each type; those that DS031 does not have are refused."""
    cells = collections.Counter(cell["type"] for cell in netlist["cells"].values())
    for kind in cells:
        if not (kind in blocks or kind in LUTS or kind in FLIP_FLOPS or kind in COMBINATIONAL
                or kind == "SRL16E" or kind.startswith("RAMB16_")):
            raise SystemExit(f"{kind}: Virtex-II has no such cell")
    return cells


def resources(cells):
    srls = cells["SRL16E"]
    luts = sum(count * cells[kind] for kind, count in LUTS.items())
    flip_flops = sum(cells[kind] for kind in FLIP_FLOPS)
    return {"luts": luts, "srls": srls, "flip_flops": flip_flops,
            "block_rams": sum(count for kind, count in cells.items() if kind.startswith("RAMB16_")),
            "multipliers": cells["MULT18X18"], "slices": -(-max(luts + srls, flip_flops) // 2)}


@dataclasses.dataclass
class Path:
    """The longest path of a core, by the delays of its cells."""
    ns: float
    luts: int
    carries: int
    multipliers: int
    blocks: list  # those that it passes, from its start to its end


class Synthesis:
    """Netlists of blocks, kept in a folder."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.pool = concurrent.futures.ThreadPoolExecutor(2)
        self.blocks = {}  # a future netlist by the module, whose name has its parameters; the top has not
        self.lock = threading.Lock()

    def block(self, top, parameters):
        """The netlist of one module, with all that it contains."""
        out = self.folder / f"{top}.json"
        yosys([*read(top, parameters), *mapped(out)])
        (netlist,) = (each for each in json.loads(out.read_text())["modules"].values() if "top" in
                      each["attributes"])
        return netlist

    def elaborated(self, number, parameters):
        """A core before synthesis: a file for Yosys, and the names of the modules that are blocks."""
        out = self.folder / f"core{number}"
        flat = [f"setattr -mod -set keep_hierarchy 1 {' '.join(f'*{name}*' for name in BLOCKS)}", "flatten"]
        yosys([*read("stereo_core", parameters), "proc", *flat, f"write_rtlil {out}.il",
               f"write_json {out}.json"])
        return out, list(json.loads(pathlib.Path(f"{out}.json").read_text())["modules"])

    def synthesized(self, core, module, number):
        if base_name(module) == "crossbar":
            return self.block("paper_crossbar", {})
        out = self.folder / f"block{number}.json"
        others = ["select -set blocks " + " ".join(f"*{name}*" for name in BLOCKS),
                  "blackbox @blocks A:top %d"]
        yosys([f"read_rtlil {core}.il", f"hierarchy -top {module}", *others, *mapped(out)])
        return json.loads(out.read_text())["modules"][module]

    def core(self, number, parameters):
        """The blocks of a core: by the name of its module, its netlist."""
        core, modules = self.elaborated(number, parameters)
        keys = {module: (module, number if module == "stereo_core" else None) for module in modules}
        with self.lock:
            for module, key in keys.items():
                if key not in self.blocks:
                    self.blocks[key] = self.pool.submit(self.synthesized, core, module, len(self.blocks))
        return {module: self.blocks[key].result() for module, key in keys.items()}


def counted(netlists, top="stereo_core"):
    """By base name of each block: how many a core has, and the cells of all of them."""
    (top,) = (module for module in netlists if base_name(module) == top)
    counts, cells = collections.Counter(), collections.defaultdict(collections.Counter)

    def walk(module, times):
        counts[base_name(module)] += times
        for kind, count in cells_of(netlists[module], netlists).items():
            if kind in netlists:
                walk(kind, times * count)
            else:
                cells[base_name(module)][kind] += times * count

    walk(top, 1)
    return counts, cells


Cell = collections.namedtuple("Cell", "type block inputs outputs")  # nets of its inputs and outputs by pin
CONSTANT = 0  # the net of constants


def flat(netlists, top="stereo_core"):
    """All cells of a core with the nets that join them, and the nets of its pins."""
    numbers = itertools.count(CONSTANT + 1)
    cells = []

    def add(module, local):  # local: the net of each bit of the module
        for cell in netlists[module]["cells"].values():
            nets = {pin: [local.setdefault(bit, next(numbers)) if isinstance(bit, int) else CONSTANT
                          for bit in bits] for pin, bits in cell["connections"].items()}
            if inside := netlists.get(cell["type"]):
                add(cell["type"], {bit: CONSTANT if pin in STRAPS else net for pin, bits in nets.items()
                                   for bit, net in zip(inside["ports"][pin]["bits"], bits)})
                continue
            inputs, outputs = {}, {}
            for pin, bits in nets.items():
                (outputs if cell["port_directions"][pin] == "output" else inputs)[pin] = bits
            cells.append(Cell(cell["type"], base_name(module), inputs, outputs))

    (top,) = (module for module in netlists if base_name(module) == top)
    bits = [bit for port in netlists[top]["ports"].values() for bit in port["bits"]]
    pins = {bit: next(numbers) for bit in bits}
    add(top, dict(pins))
    return cells, list(pins.values())


def delay(cell, pin):
    """ns from an input to the outputs; None if the path ends at it."""
    if cell.type == "MULT18X18":
        return T_MULT
    if cell.type in CARRY:
        to_sum = cell.type == "XORCY"
        return (T_CARRY_OUT if to_sum else T_CARRY) if pin == "CI" else T_CARRY_IN
    is_address = cell.type.startswith("RAM") and "X1" in cell.type and pin.startswith(("A", "DPRA"))
    return T_ILO if cell.type in COMBINATIONAL or is_address else None


def begin(cell):
    """ns from the clock to the outputs. For a shift register and for a memory in look-up tables it is that of
    a flip-flop and a look-up table, a lower limit."""
    if cell.type in COMBINATIONAL:
        return 0
    if cell.type.startswith("RAMB16_"):
        return T_BCKO
    return T_CKO if cell.type in FLIP_FLOPS else T_CKO + T_ILO


def longest_path(netlists, top="stereo_core"):
    """From a clock edge or a pin of the core to the next clock edge or a pin."""
    cells, pins = flat(netlists, top)
    readers, waits, first = collections.defaultdict(list), {}, {}
    undriven = set(pins).union(*(nets for cell in cells for nets in cell.inputs.values()))
    ready = []
    for number, cell in enumerate(cells):
        undriven.difference_update(*cell.outputs.values())
        through = {net for pin, nets in cell.inputs.items() if delay(cell, pin) is not None for net in nets}
        first[number] = (begin(cell), number, None)
        waits[number] = len(through)
        for net in through:
            readers[net].append(number)
        ready += [] if through else [number]
    arrival = {net: (0, None, None) for net in undriven}  # ns, cell and net before
    passed_on = list(arrival)
    while ready or passed_on:
        while passed_on:
            for number in readers[passed_on.pop()]:
                waits[number] -= 1
                ready += [] if waits[number] else [number]
        for number in ready:
            cell = cells[number]
            times = [first[number]] + [(arrival[net][0] + through, number, net)
                                       for pin, nets in cell.inputs.items()
                                       if (through := delay(cell, pin)) is not None for net in nets]
            last = max(times, key=lambda time: time[0])
            outputs = set(itertools.chain(*cell.outputs.values()))
            arrival.update((net, last) for net in outputs)
            passed_on += outputs
        ready = []
    if any(waits.values()):
        raise SystemExit("a loop of cells without a register")
    ends = [(arrival[net][0] + T_DICK, net) for cell in cells for pin, nets in cell.inputs.items()
            if delay(cell, pin) is None for net in nets] + [(arrival[net][0], net) for net in pins]
    ns, net = max(ends)
    passed = []
    while net is not None and arrival[net][1] is not None:
        _, number, net = arrival[net]
        passed.insert(0, cells[number])
    kinds = collections.Counter(cell.type for cell in passed)
    return Path(ns, sum(kinds[kind] for kind in LUTS), sum(kinds[kind] for kind in CARRY),
                kinds["MULT18X18"], [block for block, _ in itertools.groupby(cell.block for cell in passed)])
