"""What the plot scripts share: their command line, its checks, and the folder that gets the figures.

Exit status: 0 done; 2 refused before anything was drawn; 1 failed after that; 130 interrupted.
"""

import argparse
import contextlib
import errno
import os
import re
import shutil
import signal
import stat
import sys

from points import MOST_NAMED, Points, Unusable

# plot_all.py is run by `stereotlm plot`, so its messages begin with the name of that program.
NAME = "stereotlm" if os.path.basename(sys.argv[0]) == "plot_all.py" else os.path.basename(sys.argv[0])


def tell(kind, text):
    if os.strerror(errno.EMFILE) in str(text):
        text = f"{text} (the limit: ulimit -n)"
    print(f"{NAME}: {kind}: {text}", file=sys.stderr, flush=True)


def on_interrupt(clean_up):
    """From now on SIGINT and SIGTERM end the process immediately, after clean_up(); None: they are ignored.

    An exception instead could be lost in a callback of matplotlib. Signals that are ignored already stay so.
    """

    def leave(*_):
        clean_up()
        tell("note", "interrupted: nothing was written")
        os._exit(130)

    for number in (signal.SIGINT, signal.SIGTERM):
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, leave if clean_up else signal.SIG_IGN)


on_interrupt(lambda: None)
os.environ.pop("MPLBACKEND", None)  # selects a display; matplotlib fails if it does not know the name
try:
    import matplotlib  # noqa: F401
except ImportError as error:
    tell("error", f"needs matplotlib, which ./setup tests installs: {error}")
    sys.exit(2)
except Exception as error:  # of any kind, such as one that a user's matplotlibrc causes
    tell("error", f"matplotlib cannot be loaded: {error}")
    sys.exit(2)

import style  # noqa: E402: it needs matplotlib

FIGURES = ["window", "disparities", "rows", "units", "banks", "states", "stalls", "use", "pareto"]
ENDINGS = [*(f".{kind}" for kind in style.FORMATS), ".csv"]
LEAST_SIZE, MOST_SIZE = 2, 40  # inches
ASIDE = ".partial"  # holds NEW, and during commit() EARLIER
NEW, EARLIER = "new", "earlier"
RULE = "must be empty or hold only files that plot has written: move it away, or give another folder"


class Refused(Exception):
    def __init__(self, lines):
        super().__init__("; ".join(lines))
        self.lines = lines


class Folder:
    """The folder of --out. commit() replaces an earlier result by the new one; until then it is unchanged."""

    def __init__(self, path, database):
        """database: which is read, and must not be replaced."""
        self.path = path
        self.database = database
        self.aside = os.path.join(path, ASIDE)
        self.new, self.earlier = (os.path.join(self.aside, name) for name in (NEW, EARLIER))
        self.created = []

    def problem(self):
        """Why the folder cannot be used. Empty if no problem is found without writing to the folder."""
        if not os.path.lexists(self.path):
            return ""
        try:
            if not os.path.isdir(self.path):
                return "not a folder"
            is_left = os.path.lexists(self.aside)  # by a killed process, which may have moved some of the files
            foreign = foreign_entry(self.path, known_entry if is_left else self._is_own)
            if not foreign and is_left:
                foreign = self._foreign_aside()
        except OSError as error:
            return f"cannot be read: {error.strerror}"
        return f"holds '{foreign}': {RULE}" if foreign else ""

    def _is_own(self, path):
        """Whether plot has written the entry, or it is empty: a figure by its bytes, a table by the figure beside it."""
        name, ending = os.path.splitext(path)
        if not known_entry(path) or (os.path.exists(self.database) and os.path.samefile(path, self.database)):
            return False
        if os.path.getsize(path) == 0:
            return True
        if ending == ".csv":
            return any(is_file(name + each) and self._is_own(name + each) for each in ENDINGS if each != ".csv")
        with open(path, "rb") as file:
            return style.is_made_here(file.read(), ending[1:])

    def _foreign_aside(self):
        """The first entry of ASIDE that no killed process can have left there; None if there is none."""
        if not is_folder(self.aside):
            return ASIDE
        for name in sorted(os.listdir(self.aside)):
            path = os.path.join(self.aside, name)
            if name not in (NEW, EARLIER) or not is_folder(path):
                return f"{ASIDE}/{name}"
            inside = foreign_entry(path, known_entry)
            if inside:
                return f"{ASIDE}/{name}/{inside}"
        return None

    def start(self):
        """Creates the folder and its missing parents. Raises OSError if it cannot be written to."""
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
        self.earlier_files = os.listdir(self.path)
        os.mkdir(self.aside)
        os.mkdir(self.new)

    def commit(self, files, replaced):
        """Replaces the earlier result. If that fails, restores it and raises OSError.

        files: {name: bytes}; replaced: names of files to remove, if they were there at the start.
        """
        for name, data in files.items():
            with open(os.path.join(self.new, name), "wb") as file:
                file.write(data)
        moved = []
        try:
            os.mkdir(self.earlier)
            for name in replaced:
                if name in self.earlier_files and is_file(os.path.join(self.path, name)):
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
        """Removes what start() has created, unless commit() was called."""
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
    """Moves a file from folder `source` to folder `target`, which must not have one of this name.

    Adds both paths to `moved`, to undo the move.
    """
    paths = [os.path.join(folder, name) for folder in (source, target)]
    if os.path.lexists(paths[1]):
        raise OSError(errno.EEXIST, os.strerror(errno.EEXIST), paths[1])
    os.rename(*paths)
    moved.append(paths)


def known_entry(path):
    """Whether plot writes files of this name."""
    figure, ending = os.path.splitext(os.path.basename(path))
    return figure in FIGURES and ending in ENDINGS and is_file(path)


def foreign_entry(folder, is_own):
    """The first entry of the folder, except ASIDE, that is not the own; None if there is none."""
    return next((name for name in sorted(os.listdir(folder))
                 if name != ASIDE and not is_own(os.path.join(folder, name))), None)


class Parser(argparse.ArgumentParser):
    def error(self, message):
        raise Refused([f"{message} (see {self.prog} --help)"])


def parse(arguments, description, has_pareto):
    usage = ("%(prog)s DB --out DIR [--only KEY=VALUE].." + " [--pareto X:SENSE,Y:SENSE]" * has_pareto +
             " [--format F,..] [--size WxH]")
    parser = Parser(prog=NAME, description=description, allow_abbrev=False, usage=usage)
    parser.add_argument("database", metavar="DB", nargs="?", help="a database of stereotlm sweep")
    parser.add_argument("--out", metavar="DIR", help="folder of the figures, created if missing")
    parser.add_argument("--only", metavar="KEY=VALUE", action="append", default=[],
                        help="only points whose key has that value; may be given for several keys")
    parser.add_argument("--format", metavar="F,..",
                        help=f"kinds of files, out of {', '.join(style.FORMATS)}; "
                             f"default {','.join(style.USUAL_FORMATS)}")
    parser.add_argument("--size", metavar="WxH",
                        help=f"width and height of each figure in inches, {LEAST_SIZE} to {MOST_SIZE}; default: 7.2, "
                             "and as high as its content")
    if has_pareto:
        parser.add_argument("--pareto", metavar="X:SENSE,Y:SENSE",
                            help="columns of the Pareto front, and whether the most or the least of each is best: "
                                 "max or min; default area.slices:min,frames_per_second.core:max")
    return parser.parse_args(arguments)


def formats_of(text):
    """The value of --format as a list; None if it does not have this form."""
    kinds = text.split(",")
    return kinds if set(kinds) <= set(style.FORMATS) and len(set(kinds)) == len(kinds) else None


def size_of(text):
    """The value of --size as (width, height) in inches; None if it does not have this form or range."""
    match = re.fullmatch(r"(\d+(?:\.\d+)?)x(\d+(?:\.\d+)?)", text, re.ASCII)
    size = tuple(map(float, match.groups())) if match else ()
    return size if size and all(LEAST_SIZE <= each <= MOST_SIZE for each in size) else None


def read_looks(options):
    """Replaces the texts of --format and --size by their values, or None if they are not given. Returns problems."""
    problems = []
    kinds = f"must be {', '.join(style.FORMATS)}, or several with commas"
    inches = f"must be WIDTHxHEIGHT in inches, each {LEAST_SIZE} to {MOST_SIZE}, such as 7.2x4.5"
    for name, read, rule in (("format", formats_of, kinds), ("size", size_of, inches)):
        text = getattr(options, name)
        value = None if text is None else read(text)
        if text is not None and value is None:
            problems.append(f"--{name} = {text}: {rule}")
        setattr(options, name, value)
    return problems


def prepare(options, check):
    """Returns the points and the folder. Raises Refused with all problems."""
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
    folder = Folder(options.out, options.database or "") if options.out else None
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
    """Returns the files of all figures that apply, a line about each figure, and the texts that the font lacks."""
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
        on_interrupt(None)  # the commit is not interrupted
        folder.commit(files, [name + ending for name in figures for ending in ENDINGS])
    except BaseException:
        folder.discard()
        raise
    if boxed:
        texts = ", ".join(f"'{each}'" if each.isprintable() else ascii(each) for each in sorted(boxed)[:MOST_NAMED])
        tell("note", f"the font of the figures lacks {texts}: boxes in PNG and PDF; SVG and CSV have the text")
    lines += said
    kinds = ", ".join(options.format or style.USUAL_FORMATS)
    lines.append(f"{options.out}: {len(files)} files: {kinds} and csv of each figure that is drawn")
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
    except BrokenPipeError:  # the reader has closed its end: no error
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
    except OSError as error:
        raise OSError(f"standard output cannot be written to: {error.strerror}") from None


def main(description, figures, check=None):
    """Runs a plot script and ends the process with its exit status if it fails.

    description: for --help.
    figures: {name: draw}, in the order of drawing. draw(points, options) returns a Drawing, or raises Unusable if
    the figure does not apply.
    check: None if the script has no option --pareto. Otherwise check(points, options) returns the problems of its
    value; points is None if the database cannot be read.
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
