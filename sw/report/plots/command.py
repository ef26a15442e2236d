"""What the plot scripts share: their command line, its checks, and how the figures are written.

`stereotlm plot` checks --out, runs plot_all.py with a folder of its own (--into), and then replaces the files
in --out.
Exit status: 0 done; 2 refused before anything was written; 1 failed after that; 130 interrupted.
"""

import argparse
import csv
import errno
import os
import pathlib
import re
import signal
import sys

from points import MOST_NAMED, Points, Unusable

# plot_all.py is run by `stereotlm plot`, so its messages begin with the name of that program.
NAME = "stereotlm" if os.path.basename(sys.argv[0]) == "plot_all.py" else os.path.basename(sys.argv[0])


def tell(kind, text):
    if os.strerror(errno.EMFILE) in str(text):
        text = f"{text} (the limit: ulimit -n)"
    print(f"{NAME}: {kind}: {text}", file=sys.stderr, flush=True)


def leave(*_):
    """Ends the process immediately: an exception could be lost in a callback of matplotlib."""
    tell("note", "interrupted: nothing was written")
    os._exit(130)


def on_interrupt(action):
    """What SIGINT and SIGTERM do from now on. Signals that are ignored already stay so."""
    for number in (signal.SIGINT, signal.SIGTERM):
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, action)


on_interrupt(leave)
os.environ.pop("MPLBACKEND", None)  # selects a display; matplotlib fails if it does not know the name
try:
    import style  # needs matplotlib, which may have to write a list of fonts
except ImportError as error:
    tell("error", f"needs matplotlib, which ./setup tests installs: {error}")
    sys.exit(2)
except Exception as error:  # of any kind, such as one that a user's matplotlibrc causes
    tell("error", f"matplotlib cannot be loaded: {error}")
    sys.exit(2)

LEAST_SIZE, MOST_SIZE = 2, 40  # inches


class Parser(argparse.ArgumentParser):
    def error(self, message):
        raise Unusable(f"{message} (see {self.prog} --help)")


def parse(arguments, description, has_pareto):
    usage = ("%(prog)s DB --out DIR [--only KEY=VALUE].." + " [--pareto X:SENSE,Y:SENSE]" * has_pareto +
             " [--format F,..] [--size WxH]")
    parser = Parser(prog=NAME, description=description, allow_abbrev=False, usage=usage)
    parser.add_argument("database", metavar="DB", nargs="?", help="a database of stereotlm sweep")
    parser.add_argument("--out", metavar="DIR",
                        help="folder of the figures, created if missing: new or empty")
    parser.add_argument("--only", metavar="KEY=VALUE", action="append", default=[],
                        help="only points whose key has that value; may be given for several keys")
    parser.add_argument("--format", metavar="F,..",
                        help=f"kinds of files, out of {', '.join(style.FORMATS)}; "
                             f"default {','.join(style.USUAL_FORMATS)}")
    parser.add_argument("--size", metavar="WxH",
                        help=f"width and height of each figure in inches, {LEAST_SIZE} to {MOST_SIZE}; "
                             "default: 7.2, and as high as its content")
    if has_pareto:
        parser.add_argument("--pareto", metavar="X:SENSE,Y:SENSE",
                            help="columns of the Pareto front, and whether the most or the least of each "
                                 "is best: max or min; default area.slices:min,frames_per_second.core:max")
    # Of `stereotlm plot`: the folder that gets the figures instead of --out, and what is wrong with --out.
    parser.add_argument("--into", help=argparse.SUPPRESS)
    parser.add_argument("--problem", help=argparse.SUPPRESS)
    return parser.parse_args(arguments)


def read_looks(options):
    """Replaces the texts of --format and --size by their values, or None if they are not given. Returns
    problems."""
    problems = []
    if options.format is not None:
        text, options.format = options.format, options.format.split(",")
        if not set(options.format) <= set(style.FORMATS) or len(set(options.format)) < len(options.format):
            problems.append(f"--format = {text}: must be {', '.join(style.FORMATS)}, or several with commas")
    if options.size is not None:
        text = options.size
        match = re.fullmatch(r"(\d+(?:\.\d+)?)x(\d+(?:\.\d+)?)", text, re.ASCII)
        options.size = tuple(map(float, match.groups())) if match else ()
        if not options.size or not all(LEAST_SIZE <= each <= MOST_SIZE for each in options.size):
            problems.append(f"--size = {text}: must be WIDTHxHEIGHT in inches, each {LEAST_SIZE} to "
                            f"{MOST_SIZE}, such as 7.2x4.5")
    return problems


def folder_problem(folder):
    """Why the folder of a script that runs on its own cannot be used; empty if it can."""
    try:
        if os.path.lexists(folder) and os.listdir(folder):
            return "must be empty: move away what it holds, or give another folder"
        for above in pathlib.Path(os.path.realpath(folder)).parents:
            mark = above / "run.json"  # as in result_folder_problem() of sw/files
            if mark.is_file() and b'"command": "run",' in mark.read_bytes()[:64]:
                return f"the result folder '{above}' of run holds nothing else: must lie elsewhere"
    except OSError as error:
        return f"cannot be written to: {error.strerror}"
    return ""


def prepare(options, check):
    """Returns the points. Raises Unusable with all problems."""
    problems = []
    points = None  # stays None if the database cannot be read
    if options.database is None:
        problems.append("DB: missing: a database of stereotlm sweep")
    else:
        try:
            points = Points(options.database)
            problems += points.keep(options.only)
        except Unusable as error:
            problems += error.lines
    problems += check(points, options)
    problems += read_looks(options)
    if options.problem:
        problems.append(options.problem)
    elif not options.out:
        problems.append("--out: missing: the folder of the figures")
    elif not options.into and folder_problem(options.out):
        problems.append(f"--out {options.out}: {folder_problem(options.out)}")
    if problems:
        raise Unusable(*problems)
    return points


def draw_all(points, options, figures):
    """Returns the files of all figures that apply, a line about each figure, and the texts that the font
    lacks."""
    files = {}
    said = []
    boxed = set()
    for name, draw in figures.items():
        try:
            drawing = draw(points, options)
        except Unusable as error:
            said.append(f"{name:<12} not drawn: {error}")
            continue
        files.update({name + ending: data for ending, data in drawing.files.items()})
        said.append(f"{name:<12} {drawing.said}")
        boxed |= drawing.boxed
    if not files:
        raise Unusable(*(" ".join(line.split()) for line in said))
    return files, said, boxed


def write(folder, files):
    """Writes new files into a folder, which is created if it is missing. files: {name: bytes}."""
    os.makedirs(folder, exist_ok=True)
    for name, data in files.items():
        with open(os.path.join(folder, name), "xb") as file:
            file.write(data)


def run(description, figures, arguments, check):
    options = parse(arguments, description, check is not None)
    points = prepare(options, check or (lambda points, options: []))
    files, said, boxed = draw_all(points, options, figures)
    on_interrupt(signal.SIG_IGN)
    try:
        write(options.into or options.out, files)
    except OSError as error:
        raise OSError(f"--out {options.out}: cannot be written to: {error.strerror}") from None
    if boxed:
        texts = ", ".join(f"'{each}'" if each.isprintable() else ascii(each)
                          for each in sorted(boxed)[:MOST_NAMED])
        tell("note",
             f"the font of the figures lacks {texts}: boxes in PNG and PDF; SVG and CSV have the text")
    kinds = ", ".join(options.format or style.USUAL_FORMATS)
    say([*about_points(points), *said,
         f"{options.out}: {len(files)} files: {kinds} and csv of each figure that is drawn"])


def about_points(points):
    left_out = points.left_out_text()
    head = f"{points.path}: {len(points.hashes)} of {points.total} points"
    return [head + (f"; left out: {left_out}" if left_out else ""),
            *(f"  {count} {status}: {reason}" for status, reason, count in points.why_left_out())]


def say(lines):
    sys.stdout.reconfigure(errors="surrogateescape")  # names of files are bytes
    try:
        print("\n".join(lines), flush=True)
    except BrokenPipeError:  # the reader has closed its end: no error
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except OSError as error:
        raise OSError(f"standard output cannot be written to: {error.strerror}") from None


def main(description, figures, check=None):
    """Runs a plot script and ends the process with its exit status if it fails.

    description: for --help.
    figures: {name: draw}, in the order of drawing. draw(points, options) returns a Drawing, or raises
    Unusable if the figure does not apply.
    check: None if the script has no option --pareto. Otherwise check(points, options) returns the problems of
    its value; points is None if the database cannot be read.
    """
    try:
        run(description, figures, sys.argv[1:], check)
    except Unusable as refused:
        for line in refused.lines:
            tell("error", line)
        sys.exit(2)
    except OSError as error:
        tell("error", error)
        sys.exit(1)


def read_table(folder, name):
    with open(os.path.join(folder, f"{name}.csv"), newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def main_of_tables(description, read, figures):
    """Runs a script that draws the tables in a folder, into the same folder. Without a folder it checks the
    options.

    read(folder) returns what the figures show. figures: {name: draw}; draw(shown, options) returns a Drawing
    or a Sheet, or None if the figure does not apply.
    """
    parser = argparse.ArgumentParser(prog=NAME, description=description, allow_abbrev=False)
    parser.add_argument("folder", nargs="?", help="folder with the tables, which gets the figures")
    parser.add_argument("--format")
    parser.add_argument("--size")
    options = parser.parse_args()
    problems = read_looks(options)
    if problems:
        print("; ".join(problems), file=sys.stderr)
        sys.exit(2)
    try:
        shown = read(options.folder) if options.folder else None
        for name, draw in figures.items() if options.folder else ():
            drawing = draw(shown, options)
            if drawing:
                write(options.folder, {name + ending: data for ending, data in drawing.files.items()})
    except Unusable as error:
        tell("error", error)
        sys.exit(2)
    except (OSError, KeyError, ValueError) as error:
        tell("error", error)
        sys.exit(1)
