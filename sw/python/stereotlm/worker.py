"""Commands of the program, executed by the process `stereotlm worker`. README.md has the protocol."""

import contextlib
import dataclasses
import io
import json
import math
import os
import pathlib
import resource
import shutil
import subprocess
import tempfile
import threading
import warnings
import weakref

import numpy


@dataclasses.dataclass(frozen=True)
class Problem:
    """Why a command is refused."""

    place: str  # file:line:column, --set KEY, a preset, or "command line"
    rule: str  # the rule that is broken
    message: str  # key, value and rule
    key: str = ""
    value: str = ""
    between_keys: bool = False  # the rule involves several keys: each of them could be changed

    def __str__(self):
        return self.message if self.place == "command line" else f"{self.place}: {self.message}"


class Refused(ValueError):
    """A command is refused before it does anything. Each of its `problems` names place, value and rule."""

    def __init__(self, problems):
        self.problems = list(dict.fromkeys(problems))  # each once
        super().__init__(self.problems)  # from which a copy is made

    def __str__(self):
        return "\n".join(map(str, self.problems))


class Failed(RuntimeError):
    """A command has failed while it worked."""


class WorkerDied(RuntimeError):
    """The worker has ended, for example because it was killed. The next command starts another one."""


@dataclasses.dataclass
class Answer:
    """What a command has said."""

    output: str  # what the command prints
    arrays: dict  # name -> array of 8 bits
    messages: list  # lines: "stereotlm: note: .."

    @property
    def document(self):
        """The document that a command prints with --json."""
        return json.loads(self.output)


def find_program():
    """The path of the program, as the text of the module stereotlm says."""
    folders = pathlib.Path(__file__).resolve().parents
    # PREFIX/lib/python3/dist-packages/stereotlm/worker.py, or sw/python/stereotlm/worker.py of the sources
    places = [folders[4] / "bin" / "stereotlm", folders[3] / "build" / "release" / "bin" / "stereotlm"]
    named = os.environ.get("STEREOTLM_PROGRAM")
    for program in filter(None, [named, *filter(pathlib.Path.is_file, places), shutil.which("stereotlm")]):
        return _checked(str(program), "STEREOTLM_PROGRAM" if named else "the program stereotlm")
    raise FileNotFoundError(
        f"the program stereotlm is neither {places[0]} nor in PATH: STEREOTLM_PROGRAM can name it")


def _checked(program, name):
    """The path of a program. Raises FileNotFoundError, with the name, if it is not that of this module."""
    from stereotlm import __version__
    try:
        end = subprocess.run([program, "--version"], stdin=subprocess.DEVNULL, capture_output=True,
                             timeout=20, check=False)
        said = end.stdout.decode(errors="replace").strip()
        cause = f"with --version it prints {said[:40]!r}"
    except (OSError, subprocess.TimeoutExpired) as error:
        said, cause = "", getattr(error, "strerror", "with --version it does not end")
    if said != f"stereotlm {__version__}":
        raise FileNotFoundError(f"{name} = {program}: {cause}: must be the program stereotlm {__version__}")
    return program


class _Bar:
    """The progress of a command, by tqdm. Nothing without tqdm."""

    def __init__(self, is_shown):
        self._is_shown = is_shown
        self._bar = None

    def show(self, done, of, text):
        if self._is_shown and self._bar is None:
            self._begin(of)
        if self._bar is not None:
            self._bar.total, self._bar.n = of, done
            self._bar.set_description_str(text)

    def _begin(self, of):
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # in a notebook without widgets the bar is text
                from tqdm.auto import tqdm
        except ImportError:
            self._is_shown = False
        else:
            self._bar = tqdm(total=of, bar_format="{percentage:3.0f}%|{bar}| {desc}", leave=False)

    def close(self):
        if self._bar is not None:
            self._bar.close()


@contextlib.contextmanager
def temporary_folder():
    """A folder for temporary files. It is removed even if this process is killed."""
    folder = tempfile.mkdtemp(prefix="stereotlm_")
    # The shell waits for a line or the end of the pipe. Killed processes may still write for a moment.
    script = 'read -r _; for i in 1 2 3 4 5 6 7 8 9; do /bin/rm -rf -- "$1" && break; sleep 0.1; done'
    words = ["stereotlm-remover", "-c", script, "/bin/sh", folder]
    with subprocess.Popen(words, executable="/bin/sh", bufsize=0, stdin=subprocess.PIPE,
                          stderr=subprocess.DEVNULL, start_new_session=True) as remover:
        pipes.add(remover.stdin)
        try:
            yield folder
        finally:
            remover.stdin.write(b"\n")


class Worker:
    """A process that executes commands, one after the other. Threads may share it."""

    def __init__(self, program=None, memory=None):
        """`program`: the path of the program stereotlm; by default as the module's text says. `memory`: the
        bytes of address space that the worker and each of its commands may have."""
        self._program = program
        self._memory = memory
        self._process = None
        self._answers = None
        self._lock = threading.RLock()
        _workers.add(self)

    def execute(self, *arguments, arrays=None, progress=True):
        """Executes the command of these words, with arrays of 8 bits by their names. Returns an Answer.

        Raises Refused, Failed or WorkerDied. Warnings of the program become warnings of Python. If it is
        interrupted (KeyboardInterrupt), the worker is ended. `progress`: whether a bar is shown, or a
        function that is called with (done, of, text); what it raises ends the worker, too.
        """
        pixels = {name: _pixels(name, array) for name, array in (arrays or {}).items()}
        words = [_word(argument) for argument in arguments]
        folder = _word(os.getcwd())
        with self._lock:  # from here on it does not matter what other threads change
            bar = _Bar(progress)
            try:
                self._send(words, folder, pixels)
                return self._receive(progress if callable(progress) else bar.show)
            except (BrokenPipeError, EOFError):
                raise WorkerDied(f"the worker has {self._end()}: the command is lost") from None
            except (Refused, Failed):
                raise
            except BaseException:  # what follows in the pipe is not known
                self.close()
                raise
            finally:
                bar.close()

    def close(self):
        """Ends the process."""
        with self._lock:
            if self._process is not None:
                self._process.kill()
                self._end()

    def kill(self):
        """Kills the process, also while another thread waits for its answer: that thread gets WorkerDied."""
        process = self._process
        if process is not None:
            process.kill()

    def start(self):
        """Starts the process, if there is none, so that the next command need not wait for that."""
        with self._lock:
            if self._process is not None and self._process.poll() is not None:
                self._end()  # while it had nothing to do: nothing is lost
            if self._process is None:
                self._begin()

    @property
    def pid(self):
        """The number of the process; None if there is none yet."""
        return self._process.pid if self._process else None

    def _end(self):
        """How the process has ended."""
        process, self._process = self._process, None
        process.stdin.close()
        self._answers.close()
        status = process.wait()
        return f"been ended by signal {-status}" if status < 0 else f"ended with status {status}"

    def _begin(self):
        # A session of its own: Ctrl-C is for this process, which then ends the worker.
        # No buffer in front of the pipe: a process that is forked meanwhile would send it again.
        program = _checked(self._program, "program") if self._program else find_program()
        self._process = subprocess.Popen([program, "worker"], bufsize=0, stdin=subprocess.PIPE,
                                         stdout=subprocess.PIPE, start_new_session=True)
        pipes.update((self._process.stdin, self._process.stdout))
        self._answers = io.BufferedReader(self._process.stdout)
        if self._memory is not None:
            hard = resource.prlimit(self._process.pid, resource.RLIMIT_AS)[1]
            most = self._memory if hard == resource.RLIM_INFINITY else min(self._memory, hard)
            resource.prlimit(self._process.pid, resource.RLIMIT_AS, (most, most))

    def _send(self, arguments, folder, pixels):
        self.start()
        request = {"arguments": arguments, "folder": folder, "encoding": "latin-1",
                   "arrays": [{"name": name, "shape": shape} for name, (shape, _) in pixels.items()]}
        line = json.dumps(request).encode() + b"\n"
        for data in (line, *(data for _, data in pixels.values())):
            left = memoryview(data)
            while left:
                left = left[self._process.stdin.write(left):]

    def _receive(self, show):
        answer = Answer("", {}, [])
        while True:
            line = self._answers.readline()
            if not line.endswith(b"\n"):
                raise EOFError
            part = json.loads(line)
            if "array" in part:
                size = math.prod(part["shape"])
                data = self._answers.read(size)
                if len(data) < size:
                    raise EOFError
                array = numpy.frombuffer(bytearray(data), numpy.uint8)
                answer.arrays[part["array"]] = array.reshape(part["shape"])
            elif "progress" in part:
                show(part["done"], part["of"], part["progress"])
            elif "message" in part:
                answer.messages.append(part["message"])
            else:
                break
        answer.output = part["output"]
        for message in answer.messages:
            if message.startswith("stereotlm: warning: "):
                warnings.warn(message.removeprefix("stereotlm: warning: "), stacklevel=4)
        if part["status"] == 2:
            problems = [Problem(**problem) for problem in part["problems"]]
            texts = [message.removeprefix("stereotlm: error: ") for message in answer.messages]
            raise Refused(problems or [Problem("command line", text, text) for text in texts])
        if part["status"] != 0:
            raise Failed("\n".join(message.removeprefix("stereotlm: error: ") for message in answer.messages))
        return answer


def _word(argument):
    """A word of a command. Each character stands for a byte, because a path need not be UTF-8."""
    is_path = isinstance(argument, (bytes, os.PathLike))
    return os.fsencode(argument if is_path else str(argument)).decode("latin-1")


def _pixels(name, array):
    """(shape, bytes) of an array."""
    array = numpy.asarray(array)
    if array.dtype != numpy.uint8:
        raise TypeError(f"{name}: {array.dtype}: must be an array of uint8")
    return array.shape, array.tobytes()


def _leave():
    """In a forked process: leaves workers and folders to its parent, whose end only closed pipes show."""
    null = os.open(os.devnull, os.O_RDWR)
    for pipe in list(pipes):
        if not pipe.closed:
            os.dup2(null, pipe.fileno(), inheritable=False)
    os.close(null)
    for worker in list(_workers):
        worker._process, worker._lock = None, threading.RLock()


pipes = weakref.WeakSet()  # to workers, and to shells that remove folders
_workers = weakref.WeakSet()
os.register_at_fork(after_in_child=_leave)
_shared = Worker()


def execute(*arguments, arrays=None, progress=True):
    """Executes a command by the worker that all boards share. See Worker.execute()."""
    return _shared.execute(*arguments, arrays=arrays, progress=progress)
