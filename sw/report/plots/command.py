"""The command line of the scripts: options, what is refused, the folder of results.

Exit status: 0 done; 2 refused before anything was drawn; 1 failed after that; 130 interrupted.
"""

import argparse
import contextlib
import os
import shutil
import signal
import stat
import sys

from points import MOST_NAMED, Points, Unusable

# plot_all.py speaks as the program does.
NAME = "stereotlm" if os.path.basename(sys.argv[0]) == "plot_all.py" else os.path.basename(sys.argv[0])


def tell(kind, text):
    print(f"{NAME}: {kind}: {text}", file=sys.stderr, flush=True)


def on_interrupt(clean_up):
    """Ends the process there and then: an exception could be lost in somebody's callback.

    clean_up(): what is to be done before; None: no interrupt from now on. A signal that the caller has ignored stays so.
    """

    def leave(*_):
        clean_up()
        tell("note", "interrupted: nothing was written")
        os._exit(130)

    for number in (signal.SIGINT, signal.SIGTERM):
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, leave if clean_up else signal.SIG_IGN)


on_interrupt(lambda: None)
os.environ.pop("MPLBACKEND", None)  # for figures on a screen; matplotlib fails if it does not know the name
try:
    import matplotlib  # noqa: F401
except ImportError as error:
    tell("error", f"needs matplotlib, which ./setup installs: {error}")
    sys.exit(2)
except Exception as error:  # whatever a matplotlibrc of the user makes of it
    tell("error", f"matplotlib cannot be loaded: {error}")
    sys.exit(2)

FIGURES = ["window", "disparities", "banks", "states", "stalls", "use", "pareto"]
ENDINGS = [".png", ".svg", ".csv"]
ASIDE = ".partial"  # in it NEW, and while they are replaced EARLIER
NEW, EARLIER = "new", "earlier"
RULE = "must be empty or hold only files that plot writes"


class Refused(Exception):
    def __init__(self, lines):
        super().__init__("; ".join(lines))
        self.lines = lines


class Folder:
    """The folder of --out: an earlier result or nothing until commit(), the new one after it."""

    def __init__(self, path):
        self.path = path
        self.aside = os.path.join(path, ASIDE)
        self.new, self.earlier = (os.path.join(self.aside, name) for name in (NEW, EARLIER))
        self.created = []

    def problem(self):
        """Why it cannot be used; empty if nothing is wrong that can be seen without writing."""
        if not os.path.lexists(self.path):
            return ""
        try:
            if not os.path.isdir(self.path):
                return "not a folder"
            foreign = foreign_entry(self.path, ignored=ASIDE)
            if not foreign and os.path.lexists(self.aside):
                foreign = self._foreign_aside()
        except OSError as error:
            return f"cannot be read: {error.strerror}"
        return f"holds '{foreign}': {RULE}" if foreign else ""

    def _foreign_aside(self):
        """The first entry of its own folder that no killed process has left there."""
        if not is_folder(self.aside):
            return ASIDE
        for name in sorted(os.listdir(self.aside)):
            path = os.path.join(self.aside, name)
            if name not in (NEW, EARLIER) or not is_folder(path):
                return f"{ASIDE}/{name}"
            inside = foreign_entry(path)
            if inside:
                return f"{ASIDE}/{name}/{inside}"
        return None

    def start(self):
        """Creates what is missing and proves that it can be written to: OSError."""
        missing = os.path.abspath(self.path)
        absent = []
        while not os.path.lexists(missing):
            absent.append(missing)
            missing = os.path.dirname(missing)
        for path in reversed(absent):
            os.mkdir(path)
            self.created.insert(0, path)
        if os.path.isdir(self.aside):
            shutil.rmtree(self.aside)
        os.mkdir(self.aside)
        os.mkdir(self.new)

    def commit(self, files, replaced):
        """files: {name: bytes}; replaced: names of earlier files that go. OSError: all is as it was."""
        for name, data in files.items():
            with open(os.path.join(self.new, name), "wb") as file:
                file.write(data)
        moved = []
        try:
            os.mkdir(self.earlier)
            for name in replaced:
                if is_file(os.path.join(self.path, name)):
                    move(name, self.path, self.earlier, moved)
            for name in files:
                move(name, self.new, self.path, moved)
        except OSError as error:
            for source, target in reversed(moved):
                with contextlib.suppress(OSError):
                    os.rename(target, source)
            raise OSError(f"--out {self.path}: the figures cannot be moved into place: {error.strerror}: "
                          f"'{error.filename2 or error.filename}'") from None
        shutil.rmtree(self.aside, ignore_errors=True)
        self.created = []

    def discard(self):
        """Without commit(): removes what start() made."""
        shutil.rmtree(self.aside, ignore_errors=True)
        for path in self.created:
            try:
                os.rmdir(path)
            except OSError:
                pass


def is_file(path):
    """A symbolic link is neither a file nor a folder."""
    return os.path.lexists(path) and stat.S_ISREG(os.lstat(path).st_mode)


def is_folder(path):
    return os.path.isdir(path) and not os.path.islink(path)


def move(name, source, target, moved):
    """moved: gets the paths, to undo it."""
    paths = [os.path.join(folder, name) for folder in (source, target)]
    os.rename(*paths)
    moved.append(paths)


def foreign_entry(folder, ignored=None):
    """The first entry that plot does not write."""
    for name in sorted(os.listdir(folder)):
        figure, ending = os.path.splitext(name)
        if name != ignored and not (figure in FIGURES and ending in ENDINGS and is_file(os.path.join(folder, name))):
            return name
    return None


class Parser(argparse.ArgumentParser):
    def error(self, message):
        raise Refused([f"{message} (see {self.prog} --help)"])


def parse(arguments, description, has_pareto):
    usage = "%(prog)s DB --out DIR [--only KEY=VALUE].." + " [--pareto X:SENSE,Y:SENSE]" * has_pareto
    parser = Parser(prog=NAME, description=description, allow_abbrev=False, usage=usage)
    parser.add_argument("database", metavar="DB", nargs="?", help="a database of stereotlm sweep")
    parser.add_argument("--out", metavar="DIR", help="folder of the figures, created if missing")
    parser.add_argument("--only", metavar="KEY=VALUE", action="append", default=[],
                        help="only points whose key has that value; may be given for several keys")
    if has_pareto:
        parser.add_argument("--pareto", metavar="X:SENSE,Y:SENSE",
                            help="columns of the Pareto front, and whether the most or the least of each is best: "
                                 "max or min; default area.slices:min,frames_per_second.core:max")
    return parser.parse_args(arguments)


def prepare(options, check):
    """The points and the folder; Refused for all that is wrong with them."""
    problems = []
    points = None  # or what can be told of them
    if options.database is None:
        problems.append("DB: missing: a database of stereotlm sweep")
    else:
        try:
            points = Points(options.database)
            problems += points.keep(options.only)
        except Unusable as error:
            problems += error.lines
    problems += check(points, options)
    folder = Folder(options.out) if options.out else None
    if not folder:
        problems.append("--out: missing: the folder of the figures")
    elif folder.problem():
        problems.append(f"--out {options.out}: {folder.problem()}")
    if problems:
        raise Refused(problems)
    return points, folder


def start(folder):
    try:
        folder.start()
    except OSError as error:
        raise Refused([f"--out {folder.path}: cannot be written to: {error.strerror}"]) from None


def draw_all(points, options, figures):
    """The files of all figures that apply, a line about each, and what their font has no characters for."""
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
    return files, said, boxed


def run(description, figures, arguments, check):
    options = parse(arguments, description, check is not None)
    points, folder = prepare(options, check or (lambda points, options: []))
    lines = about_points(points)
    on_interrupt(folder.discard)
    try:
        start(folder)
        files, said, boxed = draw_all(points, options, figures)
        if not files:
            raise Refused([" ".join(line.split()) for line in said])
        on_interrupt(None)  # all or nothing
        folder.commit(files, [name + ending for name in figures for ending in ENDINGS])
    except BaseException:
        folder.discard()
        raise
    if boxed:
        texts = ", ".join(f"'{each}'" if each.isprintable() else ascii(each) for each in sorted(boxed)[:MOST_NAMED])
        tell("note", f"the font of the figures lacks {texts}: boxes in PNG; SVG and CSV have the text")
    lines += said
    lines.append(f"{options.out}: {len(files)} files: a picture, a drawing and the data of each figure that is drawn")
    say(lines)


def about_points(points):
    left_out = points.left_out_text()
    head = f"{points.path}: {len(points.hashes)} of {points.total} points"
    return [head + (f"; left out: {left_out}" if left_out else ""),
            *(f"  {count} {status}: {reason}" for status, reason, count in points.why_left_out())]


def say(lines):
    sys.stdout.reconfigure(errors="surrogateescape")  # names of files are bytes
    try:
        print("\n".join(lines), flush=True)
    except BrokenPipeError:  # whoever reads it has seen enough
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except OSError as error:
        raise OSError(f"standard output cannot be written to: {error.strerror}") from None


def main(description, figures, check=None):
    """figures: {name: draw(points, options) -> Drawing, or Unusable}, in the order in which they are drawn.

    check(points, options): what is wrong with --pareto, points: None if they cannot be read; None: it is no option here.
    """
    try:
        run(description, figures, sys.argv[1:], check)
        return
    except (Refused, Unusable) as refused:
        for line in refused.lines:
            tell("error", line)
        sys.exit(2)
    except OSError as error:
        tell("error", error)
        sys.exit(1)
