"""Boards, their runs, and the questions that the program answers about them."""

import collections.abc
import copy
import decimal
import functools
import html
import json
import os
import pathlib
import re
import secrets
import sqlite3
import subprocess

import numpy

from stereotlm import worker
from stereotlm.worker import Failed, Problem, Refused, execute, temporary_folder


def boards():
    """The preset boards: name -> what it is."""
    return {board["name"]: board["description"] for board in execute("boards", "--json").document["boards"]}


def keys():
    """A table of the keys of boards: key, meaning, unit, range."""
    return _table(execute("keys", "--json").document["keys"], columns=["key", "meaning", "unit", "range"])


@functools.cache
def _paths():
    return [key["key"] for key in execute("keys", "--json").document["keys"]]


CONFLICTS = ["port", "bank", "by", "cycles", "cycles_percent", "before_first_row"]


class _Table(numpy.recarray):
    """A table without pandas. `attrs` is as in pandas: parts and copies of the table have it, too."""

    def __array_finalize__(self, source):
        super().__array_finalize__(source)
        self.attrs = dict(getattr(source, "attrs", {}))

    def __reduce__(self):
        make, arguments, state = super().__reduce__()
        return make, arguments, (state, self.attrs)

    def __setstate__(self, state):
        array, self.attrs = state
        super().__setstate__(array)


def _table(rows, document=None, columns=None):
    """Rows, which are dicts, as a DataFrame. `document` becomes its attrs["document"]."""
    rows = [dict(_flat(row)) for row in rows]
    if columns is None:
        columns = list(dict.fromkeys(name for row in rows for name in row))
    try:
        import pandas
    except ImportError:
        data = [tuple(row.get(name) for name in columns) for row in rows]
        kinds = {name: numpy.array([line[i] for line in data]).dtype if _is_plain([line[i] for line in data])
                 else object for i, name in enumerate(columns)}
        table = numpy.array(data, dtype=list(kinds.items())).view(_Table)
    else:
        table = pandas.DataFrame(rows, columns=columns)
    table.attrs = {"document": document}
    return table


def _is_plain(values):
    return len({type(value) for value in values}) == 1 and isinstance(values[0], (bool, int, float, str))


def _flat(value, path=""):
    """(dotted path, value) of what a dict holds. Lists stay as they are."""
    for name, inner in value.items():
        if isinstance(inner, dict):
            yield from _flat(inner, f"{path}{name}.")
        else:
            yield path + name, inner


def _yaml(value, name):
    """The value of the key `name` as a YAML flow value."""
    if hasattr(value, "tolist"):  # of numpy or pandas
        value = value.tolist()
    if isinstance(value, float):
        return numpy.format_float_positional(value, trim="0")
    if isinstance(value, decimal.Decimal):
        return f"{value:f}"
    if hasattr(value, "items"):
        word = lambda key: key if re.fullmatch(r"[\w.-]+", key) else _yaml(key, name)
        return "{" + ", ".join(f"{word(str(key))}: {_yaml(inner, f'{name}.{key}')}"
                               for key, inner in value.items()) + "}"
    if isinstance(value, collections.abc.Set):
        value = sorted(value, key=lambda each: (str(type(each)), each))
    if isinstance(value, collections.abc.Iterable) and not isinstance(value, (str, bytes)):
        return "[" + ", ".join(_yaml(each, name) for each in value) + "]"
    try:
        return json.dumps(value, ensure_ascii=False)
    except TypeError:
        raise TypeError(f"{name} = {value!r}: must be a number, a text, a list or a dict") from None


def _options(options):
    """Options of a command: keep_fps=99 is --keep-fps=99, True is a flag, a list an option for each value."""
    words = []
    for name, value in options.items():
        if name == "help":
            text = f"help = {value}: is no option here: see help(stereotlm.Board)"
            raise Refused([Problem("command line", text, text)])
        if isinstance(value, numpy.ndarray):
            raise TypeError(f"{name}: an array: must be a number, a text or a path")
        for each in value if isinstance(value, (list, tuple)) else [value]:
            if each is not None and each is not False:
                words.append("--" + name.replace("_", "-") + ("" if each is True else f"={each}"))
    return words


def _pictures(left, right, options):
    """(arrays, options) of a command that takes pictures: as arrays, as paths, or none."""
    arrays = {}
    if left is not None or right is not None:
        if any(isinstance(side, (str, os.PathLike)) for side in (left, right)):
            options = {"left": left, "right": right, **options}
        else:
            arrays = {name: side for name, side in (("left", left), ("right", right)) if side is not None}
    elif not {"left", "sequence", "video", "synthetic"} & options.keys():
        options = {"timing_only": True, **options}
    return arrays, options


def _truth(truth, scale):
    """The bytes of a PFM that holds an array of levels, (rows, columns)."""
    levels = numpy.asarray(truth)
    if levels.ndim != 2 or levels.dtype.kind not in "fiu":
        raise TypeError(f"truth: {levels.dtype} {levels.shape}: must be an array of numbers, (rows, columns)")
    if levels.dtype == numpy.uint16 and scale is None:
        raise ValueError("truth: uint16: truth_scale must be given, 256 for one of KITTI")
    head = b"Pf\n%d %d\n-1\n" % levels.shape[::-1]
    return numpy.frombuffer(head + levels[::-1].astype("<f4").tobytes(), numpy.uint8)


class _Section:
    """The keys of a board below one path, such as board.matcher."""

    def __init__(self, board, path):
        object.__setattr__(self, "_board", board)
        object.__setattr__(self, "_path", path)

    def __getattr__(self, name):
        if name.startswith("_"):
            raise AttributeError(name)
        return self._board._get(f"{self._path}.{name}")

    def __setattr__(self, name, value):
        self._board[f"{self._path}.{name}"] = value

    def __getitem__(self, name):
        return self._board[f"{self._path}.{name}"]

    def __setitem__(self, name, value):
        self._board[f"{self._path}.{name}"] = value

    def keys(self):
        return self._board._names(self._path + ".")

    def __iter__(self):
        return iter(self.keys())

    def __dir__(self):
        return list(self)

    def __repr__(self):
        values = self._board.values
        return "\n".join(f"{path}: {values[path]}" for path in values if path.startswith(self._path + "."))


class Board:
    """A board. Its keys are attributes, `board.matcher.window`, and items, `board["matcher.window"]`.

    A value that breaks the rule of its key is refused when it is assigned. Rules between keys, such as that
    the bank of a buffer exists, are checked by each command, and by check(): several keys can be changed one
    after the other. Iteration gives the paths of the keys.

    The files of a board and of its calibration are read once, when the object is made.
    """

    def __init__(self, board="fpl2003", sets=None, calibration=None):
        """`board`: a preset (see boards()) or the path of a board file. `sets`: values of keys, by their
        dotted paths. `calibration`: the path of a calibration, whose tables take the place of the identity.

        Raises Refused for a board that has problems.
        """
        self._begin(os.fsdecode(board), calibration, _with({}, {} if sets is None else sets), {})

    # Keys.

    @property
    def sets(self):
        """The keys that were set, as in --set KEY=VALUE."""
        return [f"{path}={text}" for path, text in self._state[0].items()]

    @property
    def values(self):
        """A copy of all keys with their values, by their paths. If keys contradict each other, the values
        before they did, and those that were set since."""
        return copy.deepcopy(self._state[1])

    def changed(self, sets, calibration=None):
        """A copy with other values: a dict by dotted paths, or a list of "KEY=VALUE" as in the tables of
        explain() and allocate(). `calibration`: the path of another one."""
        files = {name: its for name, its in self._files.items()
                 if calibration is None or name == "board.yaml"}
        changed = Board.__new__(Board)
        changed._begin(self.board, self.calibration if calibration is None else calibration,
                       _with(self._state[0], sets), files)
        return changed

    def check(self):
        """Raises Refused with all problems of the board."""
        self._execute("check", "--json")

    def save(self, path):
        """Writes NAME.yaml: Board(path) is this board, without its calibration. Replaces no other file."""
        self._execute("check", *_options({"write": os.fsdecode(path)}))

    def __getitem__(self, path):
        try:
            return self._get(path)
        except AttributeError as error:
            raise KeyError(str(error)) from None

    def keys(self):
        return self.values.keys()

    def __iter__(self):
        return iter(self.values)

    def __contains__(self, path):
        return path in self.values

    def __eq__(self, other):
        return isinstance(other, Board) and self.values == other.values and self._tables() == other._tables()

    __hash__ = None  # a board can be changed

    def __setitem__(self, path, value):
        last, values = self._state
        # What was set below the path is replaced, too.
        sets = {name: text for name, text in last.items() if not f"{name}.".startswith(f"{path}.")}
        sets[path] = _yaml(value, path)
        try:
            values = self._execute("check", "--json", sets=sets).document["values"]
        except Refused as refused:
            own = [problem for problem in refused.problems
                   if f"{problem.key}.".startswith(f"{path}.") and not problem.between_keys]
            if own:
                raise Refused(own) from None
            values = {**values, path: copy.deepcopy(value)}
        object.__setattr__(self, "_state", (sets, values))

    def __getattr__(self, name):
        if name.startswith("_"):
            raise AttributeError(name)
        return self._get(name)

    def __setattr__(self, name, value):
        self[name] = value

    def __dir__(self):
        return [*super().__dir__(), *self._names("")]

    def __repr__(self):
        return f"Board({self.board!r}, {self.sets})"

    def _begin(self, board, calibration, sets, files):
        """Reads what is not in `files`, and checks everything. Paths become absolute."""
        set_ = object.__setattr__  # a plain assignment sets a key
        path = str(pathlib.Path(board).absolute())
        set_(self, "board", board)
        set_(self, "calibration", calibration and str(pathlib.Path(os.fsdecode(calibration)).absolute()))
        set_(self, "_files", files)  # name -> content; each command gets them
        answer = self._execute("check", "--json", sets=sets)
        set_(self, "_files", {**files, **answer.arrays})
        set_(self, "board", path if "board.yaml" in self._files else board)
        # A tuple, which is replaced whole: (path -> value as YAML of the keys that were set, path -> value)
        set_(self, "_state", (sets, answer.document["values"]))

    def _tables(self):
        return {name: its.tobytes() for name, its in self._files.items() if name != "board.yaml"}

    def _get(self, path):
        values = self.values
        if path in values:
            return values[path]
        if any(name.startswith(path + ".") for name in (*values, *_paths())):
            return _Section(self, path)
        raise AttributeError(f"{path}: not a key of this board: see stereotlm.keys()")

    def _names(self, beginning):
        return sorted({path.removeprefix(beginning).split(".")[0] for path in self.values
                       if path.startswith(beginning)})

    def _execute(self, command, *words, sets=None, arrays=None):
        """Executes a command for the board, or for the board with other keys set."""
        board = f"./{self.board}" if self.board.startswith("-") else self.board  # not an option
        options = _options({"calibration": self.calibration})
        sets = self._state[0] if sets is None else sets
        options += [f"--set={path}={text}" for path, text in sets.items()]
        return execute(command, board, *options, *words, arrays={**self._files, **(arrays or {})})

    # Commands.

    def run(self, left=None, right=None, **options):
        """Simulates the board on pictures. Returns a Run.

        `left`, `right`: arrays of uint8, (rows, columns) for one pair or (pairs, rows, columns) for as many,
        or the paths of two files. Without pictures only times and counts are simulated. `options`: those of
        `stereotlm run`: frames=100, synthetic=1, fidelity="cycle", truth="truth.png", out="folder". `out`
        keeps the results for `stereotlm report` and `diff`, of arrays with their pictures.

        `truth`: the path of a file, or an array of disparities, (rows, columns); with truth_scale of as many
        levels per disparity. NaN, infinite, and not above 0: unknown.

        By default the whole computer with its cameras runs until it has delivered as many frames as there are
        pairs. source="preloaded" is the core alone.
        """
        board = copy.copy(self)  # whatever another thread changes
        arrays, options = _pictures(left, right, copy.deepcopy(options))
        if not isinstance(options.get("truth"), (str, bytes, os.PathLike, type(None))):
            arrays["truth.pfm"] = _truth(options["truth"], options.get("truth_scale"))
            options["truth"] = "the array"
        sets, calibration = (options.pop(name, None) for name in ("set", "calibration"))
        if sets is not None or calibration is not None:
            board = board.changed([] if sets is None else sets, calibration)
        if any(numpy.ndim(array) == 3 for array in arrays.values()) and not options.get("timing_only"):
            options["save_frames"] = True
        answer = board._execute("run", *_options(options), "--json", arrays=arrays)
        return Run(board, options, answer)

    def bounds(self):
        """Limits of the frame rate without a simulation, and the area: the document of `stereotlm bounds`."""
        return self._execute("bounds", "--json").document

    def explain(self, **options):
        """A table of single changes, and what each gains: the best first. `sets` are for changed().

        attrs["document"] has what limits the board, its resources, and who waits for whom.
        """
        document = self._execute("explain", *_options(options), "--json").document
        return _table(document["changes"], document)

    def conflicts(self, left=None, right=None, **options):
        """A table of who waits for whom at which bank: one row for each port, bank and cause.

        `left`, `right`, `options`: as for run(), without out.

        attrs["document"] has the waits and accesses by rows of the picture.
        """
        arrays, options = _pictures(left, right, options)
        document = self._execute("conflicts", *_options(options), "--json", arrays=arrays).document
        return _table(document["waits"], document, CONFLICTS)

    def allocate(self, banks, out=None, **options):
        """A table of the best allocation of the buffers for each number of banks. `sets` are for changed().

        `banks`: the most banks to use; numbers in which the buffers do not fit have no rate. `out`: the path
        of a database that is continued. `options`: those of `stereotlm allocate`. By default the whole
        computer is searched, which may take minutes; source="preloaded" is the core alone.
        attrs["document"] has the best of all.
        """
        words = _options({"banks": banks, "out": out, **options})
        document = self._execute("allocate", *words, "--json").document
        return _table(document["banks"], document)

    def sweep(self, vary=None, out=None, source="preloaded", frames=None, zip=None, where=None, sample=None,
              **options):
        """Simulates the board with all combinations of values, without pixels. Returns a table of the points.

        The table has the keys that vary, then status and reason, the frame rates, the other figures and the
        other keys. By default the core alone is simulated; source="camera" is the whole computer.
        `vary`: {"matcher.window": [5, 7], "fpga.clock_mhz": range(20, 81, 20)}. `zip`: dicts of keys that
        move together. `where`: SQL expressions that must hold. `sample`: {"points": 100, "seed": 1}. `out`:
        the path of a database that is continued; the table then has all its points. `options`: jobs=2.
        """
        plan = {"board": None if "board.yaml" in self._files else self.board,
                "run": {"source": source} if frames is None else {"source": source, "frames": frames},
                "vary": vary, "zip": zip, "where": where, "sample": sample}
        text = "".join(f"{name}: {_yaml(value, name)}\n" for name, value in plan.items() if value is not None)
        groups = [{} if vary is None else vary, *([] if zip is None else zip)]
        varied = [path for keys in groups for path in keys]
        fixed = [f"{path}: {value}" for path, value in self._state[0].items() if path not in varied]
        if fixed:
            text += "set: {" + ", ".join(fixed) + "}\n"
        files = {**self._files, "plan.yaml": numpy.frombuffer(text.encode(), numpy.uint8)}
        with temporary_folder() as folder:
            database = pathlib.Path(folder) / "points.db" if out is None else out
            if database != "":  # which the program refuses; for sqlite3, ":memory:" is no file
                database = pathlib.Path(os.fsdecode(database)).absolute()
            words = {"out": database, "calibration": self.calibration, **options}
            if "board.yaml" in self._files:
                words["board"] = self.board  # a path need not be UTF-8, as a plan must be
            execute("sweep", "the plan", *_options(words), arrays=files)
            return _points(database, varied)

    def live(self, height=1000):
        """The live board in the cell of a notebook, so many pixels high: see Live. It starts as this board.

        It may read and write files in the current folder only.
        """
        board = f"./{self.board}" if self.board.startswith("-") else self.board
        sets = [f"--set={path}={text}" for path, text in self._state[0].items()]
        options = _options({"calibration": self.calibration, "folder": os.getcwd(), "port": 0})
        return Live([board, *sets, *options], height)

    def chart(self, source="camera"):
        """The memory chart of the board as SVG."""
        return _chart(self._execute, source=source)

    def _repr_html_(self):
        return f"<p>{html.escape(repr(self))}</p>{self.chart()}"


def _with(sets, more):
    """The keys that were set, path -> value as YAML, with more of them: as for Board.changed()."""
    if isinstance(more, dict):
        more = {path: _yaml(value, path) for path, value in more.items()}
    else:
        more = dict(each.partition("=")[::2] for each in ([more] if isinstance(more, str) else more))
    return {**{path: text for path, text in sets.items() if path not in more}, **more}


def _points(database, varied):
    """The points of a database of sweep: first the keys that vary, then the figures, then the other keys."""
    connection = sqlite3.connect(database)
    try:
        connection.row_factory = sqlite3.Row
        order = ", ".join(f'"{path}"' for path in varied) or "1"
        rows = [dict(row) for row in connection.execute(f"SELECT * FROM points ORDER BY {order}")]
        keys = [name for name, in connection.execute("SELECT name FROM columns WHERE is_key")]
        fixed = [name for name in keys if name not in varied]
    finally:
        connection.close()
    hidden = {"hash", "version", "config", *varied, *fixed}
    first = ("status", "reason", "frames_per_second", "bound")
    figures = [name for name in (rows[0] if rows else []) if name not in hidden]
    figures.sort(key=lambda name: [not name.startswith(head) for head in first])
    return _table(rows, columns=[*varied, *figures, *fixed])


def _chart(draw, **options):
    """What diagram draws. `draw`: executes it for what it draws."""
    with temporary_folder() as folder:
        file = pathlib.Path(folder) / "chart.svg"
        draw("diagram", "--out", file, *_options(options))
        return file.read_text(encoding="utf-8")


class Live:
    """A page of `stereotlm serve`, which ends with Python, or by close(). `url` is its address."""

    # The shell ends the server when the pipe closes, whatever ends Python.
    _SCRIPT = '"$@" & exec >&- 2>&-; read -r _; kill $!; wait'

    def __init__(self, words, height):
        command = ["stereotlm-live", "-c", self._SCRIPT, "/bin/sh", worker.find_program(), "serve", *words]
        self._process = subprocess.Popen(command, executable="/bin/sh", bufsize=0, stdin=subprocess.PIPE,
                                         stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                         start_new_session=True)
        worker.pipes.update((self._process.stdin, self._process.stdout))
        self._height = height
        said = []
        for line in map(os.fsdecode, self._process.stdout):
            said.append(line.removeprefix("stereotlm: error: "))
            self.url = next(iter(re.findall(r"http://127\.0\.0\.1:\d+/\S*", line)), None)
            if self.url:
                return
        self.close()
        raise Failed("".join(said).strip())

    def close(self):
        """Ends the server."""
        if not self._process.stdin.closed:
            self._process.stdin.close()
            self._process.wait()
            self._process.stdout.close()

    def _repr_html_(self):
        # The cookie is for one name of this machine: the page has that of the notebook.
        name = f"stereotlm-{secrets.token_hex(4)}"
        return (f'<iframe id="{name}" width="100%" height="{int(self._height)}" style="border: 0"></iframe>'
                f'<script>document.getElementById("{name}").src = {json.dumps(self.url)}.replace('
                '"127.0.0.1", location.hostname === "localhost" ? "localhost" : "127.0.0.1")</script>')


class Run:
    """A run: its disparities and its counts.

    statistics: all figures, as a dict; keys as in the file stats.json that `stereotlm run --out` writes.
    disparity: the disparities of the last frame, (rows, columns), 255 without an answer; None if only times
    were simulated.
    disparities: those of all frames, (frames, rows, columns), if the pictures were several pairs; else None.
    frame_numbers: the number of the camera's frame for each of disparities.
    messages: what the program says about the run.
    """

    def __init__(self, board, options, answer):
        self.board = board
        self.messages = answer.messages
        self.statistics = answer.document
        self._options = options
        self.disparity = answer.arrays.pop("disparity", None)
        self.frame_numbers = [int(pathlib.Path(name).stem) for name in answer.arrays]
        self.disparities = numpy.stack(list(answer.arrays.values())) if answer.arrays else None

    @property
    def frames_per_second(self):
        """Rates by their names: "core": while the core works; with cameras "system": delivered frames since
        power-up, and from about 14 frames on "steady": delivered frames without the beginning."""
        return self.statistics["frames_per_second"]

    @property
    def energy(self):
        """Energy and traffic of the memories alone: without FPGA, PCI, pins and controllers."""
        return self.statistics["energy"]

    @property
    def banks(self):
        """A table of the accesses, cycles and energy of each bank."""
        return _table(self.statistics["banks"])

    @property
    def ports(self):
        """A table of the grants and waits of each port."""
        return _table(self.statistics["ports"])

    @property
    def blame(self):
        """A table of who waits for whom at which bank: port, bank, by, cycles."""
        return _table(self.statistics["blame"], columns=["port", "bank", "by", "cycles"])

    def chart(self):
        """The memory chart of the board with the traffic of the run, as SVG. The run is simulated again."""
        of_pictures = {"left", "right", "sequence", "video", "video_layout", "synthetic", "truth", "verify",
                       "truth_scale", "save_frames", "record", "no_record", "trace", "trace_window"}
        options = {name: value for name, value in self._options.items() if name not in of_pictures}
        options["frames"] = self.statistics["frames"]
        with temporary_folder() as folder:
            out = pathlib.Path(folder) / "run"  # pixels change no count
            simulated = {**options, "timing_only": True, "no_record": True, "out": out}
            self.board._execute("run", *_options(simulated))
            return _chart(lambda command, *words: execute(command, out, *words))

    def __repr__(self):
        texts = {"system": "from power-up", "steady_uncertainty": "±"}
        rates = ", ".join(f"{texts.get(name, name)} {value:.3f}"
                          for name, value in self.frames_per_second.items()).replace(", ±", " ±")
        frames = self.statistics["frames"]
        lost = sum(camera["dropped_pixels"] for camera in self.statistics.get("cameras", []))
        loss = f", with {lost} pixel{'s' * (lost != 1)} lost" if lost else ""
        run = f"Run of {self.statistics['board']}: {frames} frame{'s' * (frames != 1)}"
        return f"{run}, frames/s: {rates}{loss}"

    def _repr_html_(self):
        return f"<p>{html.escape(repr(self))}</p>{self.chart()}"
