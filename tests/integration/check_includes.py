"""Checks who may include whom, and what a header must and must not contain.

usage: check_includes.py ROOT

ROOT is the repository root (or a tree laid out like it). Prints one line per broken rule, path:line: what,
and exits with 1 if there is any, with 2 if ROOT is not such a tree.
"""

import pathlib
import re
import subprocess
import sys

# Folder -> folders whose files it may include.
MAY_INCLUDE = {
    "models": ["models"],
    "platform": ["platform", "models"],
    "calib": ["calib", "models/kernels"],
    "sw": ["sw", "platform", "models", "calib"],
    "tests": ["tests", "sw", "platform", "models", "calib"],
}
# The same within a folder: room -> rooms below it in the same folder. A file belongs to the longest room that
# its path begins with.
ROOMS = {
    "platform/yaml": [],
    "platform/config": ["platform/boards", "platform/yaml"],
    "platform/figures": ["platform/config"],
    "platform/records": ["platform/config", "platform/figures"],
    "platform/assembly": ["platform/config", "platform/figures", "platform/records"],
    "platform/loop": ["platform/assembly", "platform/config", "platform/figures", "platform/records"],
    "sw/files": [],
    "sw/driver": [],
    "sw/media": ["sw/files", "sw/process"],
    "sw/process": [],
    "sw/sqlite": [],
    "sw/stats": ["sw/files", "sw/media"],
    "sw/explore/store": ["sw/files", "sw/sqlite", "sw/stats"],
    "sw/explore/plan": ["sw/explore/store", "sw/files", "sw/sqlite", "sw/stats"],
    "sw/explore/sweep": [
        "sw/explore/plan", "sw/explore/store", "sw/files", "sw/process", "sw/sqlite", "sw/stats"
    ],
    "sw/explore/optimise": [
        "sw/explore/plan", "sw/explore/store", "sw/files", "sw/process", "sw/sqlite", "sw/stats"
    ],
    "sw/explore/slurm": ["sw/explore/plan", "sw/explore/store", "sw/explore/sweep", "sw/files", "sw/process"],
    "sw/trace": ["sw/files", "sw/process", "sw/sqlite"],
    "sw/runs": [
        "sw/driver", "sw/explore", "sw/files", "sw/media", "sw/process", "sw/sqlite", "sw/stats", "sw/trace"
    ],
    "sw/report": ["sw/explore", "sw/files", "sw/media", "sw/process", "sw/runs", "sw/sqlite", "sw/stats"],
    "sw/demo": ["sw/files", "sw/media"],
    "sw/cli": ["sw"],
}
SUFFIXES = {".h", ".hpp", ".cpp", ".cc"}
HEADER_SUFFIXES = {".h", ".hpp"}

SYSTEMC = re.compile(r"(systemc|systemc\.h|tlm|tlm\.h|(sysc|tlm_core|tlm_utils)/.*)$")
FAST = re.compile(r"models/fpga/fast/")
OPENCV = re.compile(r"opencv(2|4)?(/.*|\.hpp)$")
EIGEN = re.compile(r"(unsupported/)?Eigen/.*$")
FILES_OR_YAML = re.compile(r"(fstream|filesystem|(yaml-cpp|nlohmann)/.*)$")

# Files -> headers that they may not reach, directly or through the project's own headers.
FREE_OF = [
    (re.compile(r"models/(kernels|area)/"), SYSTEMC, "SystemC"),
    (re.compile(r"(models|platform)/.*(_config|register_map|registers)\.h$"), SYSTEMC, "SystemC"),
    (re.compile(r"models/.*_control\.(h|cpp)$"), SYSTEMC, "SystemC"),
    (re.compile(r"models/(clock|local_burst|period|time_ps|words_by_range)\.(h|cpp)$"), SYSTEMC, "SystemC"),
    (re.compile(r"models/capture/(camera_(link|timing)|capture_(fifo|register_file))\."), SYSTEMC, "SystemC"),
    (re.compile(r"models/fpga/(fast|record)/"), SYSTEMC, "SystemC"),
    (re.compile(r"models/fpga/(access_pattern|core_stepper|frame_run|host_port)\."), SYSTEMC, "SystemC"),
    (re.compile(r"models/fpga/core_registers\.cpp"), SYSTEMC, "SystemC"),
    (re.compile(r"models/fpga/(record/|core_(datapath|stepper)\.|(core|lane|match|result)_control\.)"), FAST,
     "what makes frames fast"),
    (re.compile(r"models/memory/(arbitration|bank_arbiter|direct_banks)\."), SYSTEMC, "SystemC"),
    (re.compile(r"models/pci/(bridge_register_file|dma_channel|local_bus_master)\."), SYSTEMC, "SystemC"),
    (re.compile(r"models/pci/(pci_slot|posted_writes)\."), SYSTEMC, "SystemC"),
    (re.compile(r"platform/(config|figures|records|yaml)/"), SYSTEMC, "SystemC"),
    (re.compile(r"(sw/(driver|explore|files|media|paper|process|report|sqlite|stats|trace)|calib)/"), SYSTEMC,
     "SystemC"),
    (re.compile(r"(models|platform)/"), OPENCV, "OpenCV"),
    (re.compile(r"(models|platform)/"), EIGEN, "Eigen"),
    (re.compile(r"models/"), FILES_OR_YAML, "YAML or files"),
]

INCLUDE = re.compile(r'\s*#\s*include\s*(?P<quote>["<])(?P<path>[^">]+)[">]')
USING_NAMESPACE = re.compile(r"\busing\s+namespace\b")
# Comments and literals. An apostrophe behind a digit separates digits.
NOT_CODE = re.compile(
    r"//[^\n]*|/\*.*?\*/"
    r'|R"(?P<tag>[^()\s\\]{0,16})\(.*?\)(?P=tag)"|"(?:\\.|[^"\\\n])*"'
    r"|(?<![0-9a-fA-F])'(?:\\.|[^'\\\n])*'",
    re.DOTALL,
)


def blank(match):
    return re.sub(r"[^\n]", " ", match.group())


def blank_comment(match):
    """Blanks a comment and keeps a literal: the path of an #include is one."""
    return blank(match) if match.group().startswith(("//", "/*")) else match.group()


class File:
    """What one source file includes: (line, path, quoted)."""

    def __init__(self, root, path):
        text = (root / path).read_text(encoding="utf-8")
        self.path = path
        self.lines = NOT_CODE.sub(blank_comment, text).splitlines()
        self.code = NOT_CODE.sub(blank, text).splitlines()
        self.includes = []
        for number, line in enumerate(self.lines, 1):
            match = INCLUDE.match(line)
            if match:
                self.includes.append((number, match["path"], match["quote"] == '"'))


def folder_of(path):
    return path.split("/", 1)[0]


def is_in(path, folder):
    return path.startswith(folder + "/")


def room_of(path):
    return max((room for room in ROOMS if is_in(path, room)), key=len, default=None)


def allowed(includer, included):
    if not any(is_in(included, folder) for folder in MAY_INCLUDE[folder_of(includer)]):
        return False
    room = room_of(includer)
    if room is None or folder_of(included) != folder_of(includer) or room_of(included) == room:
        return True
    return any(is_in(included, below) for below in ROOMS[room])


def check_includes(file, files):
    for line, path, quoted in file.includes:
        if path in files:
            if not quoted:
                yield line, f"<{path}>: a header of the project is included with quotes"
            if not allowed(file.path, path):
                yield line, f'"{path}": {room_of(file.path) or folder_of(file.path)} may not include it'
        elif quoted:
            yield line, f'"{path}": no such file below the repository root'
        elif folder_of(path) in MAY_INCLUDE:
            yield line, f"<{path}>: no such file below the repository root"


def check_header(file):
    first = next((line for line in file.lines if line.strip()), "")
    if first.strip() != "#pragma once":
        yield 1, "a header begins with #pragma once"
    for number, line in enumerate(file.code, 1):
        if USING_NAMESPACE.search(line):
            yield number, "using namespace in a header"


def way_to(start, forbidden, files):
    """The includes from `start` to a forbidden header, shortest first; None if it is out of reach."""
    ways = [(start, [])]
    seen = {start}
    for path, way in ways:
        for line, included, _ in files[path].includes:
            if forbidden.match(included):
                return way + [(path, line, included)]
            if included in files and included not in seen:
                seen.add(included)
                ways.append((included, way + [(path, line, included)]))
    return None


def check_reach(file, files):
    for who, forbidden, name in FREE_OF:
        if not who.match(file.path):
            continue
        way = way_to(file.path, forbidden, files)
        if way:
            through = " -> ".join(included for _, _, included in way)
            yield way[0][1], f"{through}: this file may not include {name}"


def check(root):
    """Every broken rule of the tree as (path, line, what)."""
    patterns = [f"{folder}/*{suffix}" for folder in MAY_INCLUDE for suffix in SUFFIXES]
    listed = subprocess.run(["git", "ls-files", "-z", "--", *patterns], cwd=root, stdout=subprocess.PIPE,
                            text=True, check=True)
    paths = sorted(filter(None, listed.stdout.split("\0")))
    files = {path: File(root, path) for path in paths}
    for file in files.values():
        findings = list(check_includes(file, files)) + list(check_reach(file, files))
        if pathlib.PurePosixPath(file.path).suffix in HEADER_SUFFIXES:
            findings += check_header(file)
        for line, what in sorted(findings):
            yield file.path, line, what


def main(arguments):
    if len(arguments) != 1:
        print("usage: check_includes.py ROOT", file=sys.stderr)
        return 2
    root = pathlib.Path(arguments[0])
    if not (root / "models").is_dir():
        print(f"check_includes.py: {root}: not the repository root: it has no folder models", file=sys.stderr)
        return 2
    findings = list(check(root))
    for path, line, what in findings:
        print(f"{path}:{line}: {what}")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
