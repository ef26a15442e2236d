"""The server of `stereotlm serve`: the page of the live board, and the commands that it asks for.

README.md has the routes, the limits, and what is refused.
"""

import argparse
import base64
import contextlib
import hashlib
import http.server
import io
import json
import math
import os
import queue
import re
import secrets
import select
import shutil
import signal
import socket
import socketserver
import threading
import time
import warnings
import webbrowser

import numpy

from stereotlm.worker import Failed, Problem, Refused, Worker, WorkerDied, temporary_folder

CONNECTIONS = 64
QUICK, LONG = 4, 2  # commands at once: run, check and save; explain and sweep
IDLE, REQUEST, ANSWER = 60, 20, 60  # s: until a request begins; until it is there; until a write is taken
WAIT, WORK = 30, 120  # s: of a quick command for a worker; of its work
MEMORY = 6 << 30  # bytes of address space of a worker
BODY, BOARD, PICTURE = 256 << 10, 1 << 20, 64 << 20  # bytes of a request, of a board file, of a picture
PICTURES, PICTURE_BYTES = 12, 256 << 20  # that are kept
POINTS = 2000  # of a sweep
DEPTH, FILES, FOLDERS = 3, 500, 10000  # of the list of boards
ROUTES = {"/": "GET", "/boards": "GET", "/picture": "PUT",
          **dict.fromkeys(("/run", "/check", "/explain", "/sweep", "/save"), "POST")}


class _Error(Exception):
    """A request that is answered with a status and a sentence."""


class _Gone(Exception):
    """The browser has closed the connection."""


def _require(is_right, status, sentence):
    if not is_right:
        raise _Error(status, sentence)


def _refuse(key, value, rule):
    raise Refused([Problem("the request", rule, f"{key} = {value}: {rule}", key, value)])


def _said(error):
    """(status, document) of what went wrong."""
    if isinstance(error, _Error):
        return error.args[0], {"error": error.args[1]}
    if isinstance(error, Refused):  # as check --json prints it
        return 200, {"problems": [{name: value for name, value in vars(problem).items() if value}
                                  for problem in error.problems]}
    is_known = isinstance(error, (Failed, WorkerDied))
    return 500, {"error": str(error) if is_known else f"{type(error).__name__}: {error}"}


def _is_text(value, most=4096, form=r"[^\0\ud800-\udfff]+"):  # halves of surrogate pairs are no text
    return isinstance(value, str) and len(value) <= most and re.fullmatch(form, value) is not None


def _is_list(value, most, is_right):
    return isinstance(value, list) and len(value) <= most and all(map(is_right, value))


def _is_set(value):
    return _is_list(value, 2, lambda text: text == "" or _is_text(text)) and len(value) == 2


# What a plan may take as it is: a word, a list of words, a map of one key to one of them, or a list of these.
_WORD = r"[\w.+-]+"
_WORDS = rf"{_WORD}|\[{_WORD}(?:, ?{_WORD})*\]"
_PLAIN = rf"(?:{_WORDS}|{{{_WORD}: (?:{_WORDS})}})"
_VALUE = rf"{_PLAIN}|\[{_PLAIN}(?:, ?{_PLAIN})*\]"


def _is_value(value):
    return _is_text(value, 999, _VALUE)


def _varies(value):
    return isinstance(value, dict) and len(value) in (1, 2) and all(
        _is_text(key, 200, r"[A-Za-z][\w.-]*") and _is_list(texts, POINTS, _is_value)
        for key, texts in value.items()) and 1 <= math.prod(map(len, value.values())) <= POINTS


def _number(low, high, *kinds):
    return lambda value: type(value) in kinds and low <= value <= high, f"a number, {low}..{high}"


_ID = _is_text, "the id of a picture"
_RULES = {  # key of a body: what is right, and the same in words
    "board": (lambda value: _is_text(value) and value[0] != "-", "a preset or a path; it begins with no -"),
    "sets": (lambda value: _is_list(value, 300, _is_set), "at most 300 pairs [key, value] of texts"),
    "calibration": (_is_text, "a path"),
    "source": (lambda value: value in ("preloaded", "camera"), "preloaded or camera"),
    "frames": _number(1, 100000, int),
    "pictures": (lambda value: isinstance(value, dict), "an object"),
    "synthetic": _number(0, (1 << 31) - 1, int), "left": _ID, "right": _ID, "truth": _ID,
    "truth_scale": _number(1e-6, 1e6, int, float),
    "fit": (lambda value: value in ("crop", "pad"), "crop or pad"),
    "offset": _number(-4096, 4096, int),
    "vary": (_varies, "one or two keys, each with values such as 3, [a, b], {rows: [a, b]}; "
             f"at most {POINTS} points"),
    "record": (lambda value: isinstance(value, bool), "true or false"),
    "name": (lambda value: _is_text(value, 200, r"[A-Za-z0-9][A-Za-z0-9_.-]*\.yaml"),
             "letters, digits, _ . and -, with .yaml at the end"),
    "yaml": (lambda value: _is_text(value, BODY), "the text of a board file"),
}
_OPTIONS = ["sets", "calibration", "source", "frames"]


def _checked(body, needed, optional=()):
    """The values of an object that are not null. Those of `needed` are there."""
    _require(isinstance(body, dict), 400, "the body: must be an object")
    for key, value in body.items():
        _require(key in (*needed, *optional), 400, f"{json.dumps(key[:40])}: unknown key")
        _require(value is None or _RULES[key][0](value), 400, f"{key}: must be {_RULES[key][1]}")
    for key in needed:
        _require(body.get(key) is not None, 400, f"{key}: is missing")
    return {key: value for key, value in body.items() if value is not None}


class _Received(io.RawIOBase):
    """What the browser sends, until a deadline, however slowly it comes."""

    def __init__(self, connection):
        self._connection = connection

    def allow(self, seconds):
        self._deadline = time.monotonic() + seconds

    def readable(self):
        return True

    def readinto(self, buffer):
        self._connection.settimeout(max(self._deadline - time.monotonic(), 1e-3))
        return self._connection.recv_into(buffer)


class _Handler(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    disable_nagle_algorithm = True

    def setup(self):
        super().setup()
        self._received = _Received(self.connection)
        self.rfile = io.BufferedReader(self._received)

    def handle_one_request(self):
        self._is_read = False  # whole, so that another request may follow
        self._received.allow(IDLE)
        self.rfile.peek(1)
        self._received.allow(REQUEST)
        super().handle_one_request()

    version_string = lambda self: "stereotlm"
    log_message = lambda *_: None

    def send_error(self, code, message=None, explain=None):  # about a head that cannot be read
        self._answer(code, message or self.responses[code][0], "text/plain")

    def do_GET(self):
        try:
            self._route()
        except _Gone:
            self.close_connection = True
        except (ConnectionError, socket.timeout):
            raise
        except Exception as error:
            status, document = _said(error)
            is_page = self.path.partition("?")[0] == "/"
            self._answer(status, *([document["error"], "text/plain"] if is_page else [json.dumps(document)]))

    do_POST = do_PUT = do_GET

    def _header(self, name):
        """Its value; nothing if it is missing, or if there are several."""
        values = self.headers.get_all(name, [])
        return values[0].strip() if len(values) == 1 else ""

    def _route(self):
        server, (path, _, query) = self.server, self.path.partition("?")
        _require(self._header("Host").lower() in server.hosts, 403,
                 f"The header Host must be one of: {', '.join(sorted(server.hosts))}")
        _require(self.request_version == "HTTP/1.1", 505, "The request must be of HTTP/1.1")
        _require(path in ROUTES, 404, "There is no such page")
        method = ROUTES[path]
        _require(self.command == method, 405, f"{path} takes {method} only")
        length = self._header("Content-Length") if "Content-Length" in self.headers else "0"
        _require("Transfer-Encoding" not in self.headers and re.fullmatch(r"[0-9]{1,18}", length), 411,
                 "The header Content-Length must say how long the body is")
        most, kind = {"GET": (0, ""), "POST": (BODY, "application/json"),
                      "PUT": (PICTURE, "application/octet-stream")}[method]
        _require(int(length) <= most, 413, f"The body must have at most {most} bytes")
        self._is_read = method == "GET"
        if path == "/" and query:
            return self._open(query)
        cookies = [part.strip().encode() for part in self._header("Cookie").split(";")]
        _require(any(secrets.compare_digest(each, server.cookie.encode()) for each in cookies), 403,
                 "Open the address that stereotlm serve has printed")
        if method != "GET":
            _require(self._header("Origin").lower() in server.origins, 403, "The Origin must be this page")
            _require(self._header("Content-Type").lower().partition(";")[0].strip() == kind, 415,
                     f"The header Content-Type must be {kind}")
        body = [] if method == "GET" else [self._json(int(length)) if method == "POST" else int(length)]
        return getattr(self, f"_{path[1:] or 'page'}")(*body)

    def _data(self, length):
        data = self.rfile.read(length)
        if len(data) < length:
            raise _Gone
        self._is_read = True
        return data

    def _json(self, length):
        try:
            return json.loads(self._data(length).decode(), parse_constant=int)  # NaN is no integer
        except (ValueError, RecursionError):
            raise _Error(400, "the body: must be JSON in UTF-8") from None

    # Answers.

    def _head(self, status, kind, **headers):
        self.connection.settimeout(ANSWER)
        self.close_connection |= not self._is_read
        self.send_response(status)
        for name, value in {**self.server.headers, "Content-Type": f"{kind}; charset=utf-8",
                            "Connection": "close" if self.close_connection else "keep-alive",
                            **headers}.items():
            self.send_header(name.replace("_", "-"), value)
        self.end_headers()

    def _answer(self, status, text, kind="application/json", **headers):
        data = text.encode()
        self._head(status, kind, Content_Length=len(data), **headers)
        self.wfile.write(data)

    def _line(self, text):
        """Sends a line of a stream."""
        data = text.encode() + b"\n"
        try:
            self.wfile.write(b"%x\r\n%b\r\n" % (len(data), data))
        except OSError:
            raise _Gone from None

    def _stream(self, work):
        """Answers with the progress that work(execute) makes, a line each, and then with its document."""
        refusal = "two long questions are at work: wait until one has ended"
        show = lambda *progress: self._line(json.dumps(dict(zip(("done", "of", "text"), progress))))
        try:
            with self._worker(self.server.long, 0, None, refusal) as worker:
                self._head(200, "application/x-ndjson", Transfer_Encoding="chunked")
                document = work(lambda *words, **more: worker.execute(*words, **more, progress=show).output)
            self._line('{"document": %s}' % document.replace("\n", " "))  # its texts have no line ends
        except (_Gone, _Error):
            raise
        except Exception as error:
            self._line(json.dumps(_said(error)[1]))
        self.wfile.write(b"0\r\n\r\n")

    # Commands.

    @contextlib.contextmanager
    def _worker(self, free, wait, work, refusal):
        """A worker that is free within `wait` s. It is killed after `work` s, or if the browser goes away."""
        try:
            worker = free.get(wait > 0, wait)
        except queue.Empty:
            raise _Error(503, refusal) from None
        why = []
        ended, end = os.pipe()

        def watch():
            poll = select.poll()
            poll.register(ended, select.POLLIN)
            poll.register(self.connection, select.POLLRDHUP)
            events = dict(poll.poll(work and work * 1000))
            poll.unregister(self.connection)
            while ended not in events:
                why.append(_Gone() if events else Failed(f"it takes longer than {work} s"))
                worker.kill()  # again and again: the process may have just begun
                events = dict(poll.poll(20))

        thread = threading.Thread(target=watch, daemon=True)
        thread.start()
        try:
            yield worker
        except WorkerDied as died:
            raise (why or [died])[0] from None
        finally:
            os.close(end)
            thread.join()
            os.close(ended)
            if why:
                worker.close()
                with contextlib.suppress(OSError):  # the next command tries it again
                    worker.start()
            free.put(worker)

    def _execute(self, *words, arrays=None):
        """What a quick command prints. It is tried once more if its worker has been killed."""
        for attempt in range(2):
            try:
                with self._worker(self.server.quick, WAIT, WORK, "all workers are busy: try again") as worker:
                    return worker.execute(*words, arrays=arrays, progress=False).output
            except WorkerDied:
                if attempt == 1:
                    raise

    def _inside(self, key, path):
        """The size of a regular file in the folder."""
        real = os.path.realpath(path)
        if os.path.commonpath([self.server.folder, real]) != self.server.folder:
            _refuse(key, path, "must be in the folder of stereotlm serve")
        if not os.path.isfile(real):
            _refuse(key, path, "must be a file")
        return os.path.getsize(real)

    def _words(self, body):
        """BOARD and its options."""
        board, calibration = body["board"], body.get("calibration")
        if ("/" in board or board.endswith(".yaml")) and self._inside("board", board) > BOARD:
            _refuse("board", board, f"must have at most {BOARD} bytes")
        if calibration not in (None, self.server.calibration):
            stem = calibration.removesuffix(".yaml")
            for path in (calibration, f"{stem}_left.lut", f"{stem}_right.lut"):
                self._inside("calibration", path)
        return [board, *(f"--set={key}={value}" for key, value in body.get("sets", [])),
                *(f"--{name}={body[name]}" for name in ("calibration", "source", "frames") if name in body)]

    # Routes.

    def _page(self):
        self._answer(200, self.server.page, "text/html")

    def _open(self, query):
        _require(secrets.compare_digest(query.encode(), f"token={self.server.token}".encode()), 403,
                 "Open the address that stereotlm serve has printed")
        cookie = f"{self.server.cookie}; HttpOnly; SameSite=Lax"
        self._answer(303, "", "text/plain", Location="./", Set_Cookie=cookie)

    def _boards(self):
        files = []
        for number, (folder, folders, names) in enumerate(os.walk(".")):
            folders[:] = sorted(name for name in folders if name[0] != "." and folder.count("/") < DEPTH)
            for path in (os.path.join(folder, name)[2:] for name in sorted(names) if name.endswith(".yaml")):
                with contextlib.suppress(Refused, OSError):
                    if _RULES["board"][0](path) and self._inside("board", path) <= BOARD:
                        files.append(path)
            if len(files) >= FILES or number >= FOLDERS:
                break
        self._answer(200, json.dumps({"files": files[:FILES]}))

    def _run(self, body):
        body = _checked(body, ["board"], [*_OPTIONS, "pictures", "record"])
        words, pictures = ["--timing-only"], body.get("pictures")
        if pictures is not None:
            made, sent = ["synthetic"], ["truth", "truth_scale", "fit", "offset"]
            pictures = _checked(pictures, *([made] if "synthetic" in pictures else [["left", "right"], sent]))
            for name in {"left", "right", "truth"} & pictures.keys():
                if pictures[name] not in self.server.pictures:
                    _refuse(name, pictures[name], "no picture of this id is kept: send it again")
                pictures[name] = os.path.join(self.server.scratch, pictures[name])
            options = {"truth_scale": "truth-scale", "offset": "disparity-offset"}
            words = [f"--{options.get(name, name)}={value}" for name, value in pictures.items()]
        if not body.get("record", True):
            words.append("--no-record")
        self._answer(200, self._execute("run", *self._words(body), *words, "--page-data"))

    def _check(self, body):
        if isinstance(body, dict) and "yaml" in body:
            text = numpy.frombuffer(_checked(body, ["yaml"])["yaml"].encode(), numpy.uint8)
            output = self._execute("check", "board.yaml", "--json", arrays={"board.yaml": text})
        else:
            output = self._execute("check", *self._words(_checked(body, ["board"], _OPTIONS[:2])), "--json")
        self._answer(200, output)

    def _save(self, body):
        body = _checked(body, ["board", "name"], _OPTIONS[:2])
        path = os.path.join(self.server.folder, body["name"])
        if os.path.islink(path):
            _refuse("name", body["name"], "must not be a symbolic link")
        self._execute("check", *self._words(body), f"--write={path}")
        self._answer(200, json.dumps({"path": path}))

    def _explain(self, body):
        words = self._words(_checked(body, ["board"], _OPTIONS))
        self._stream(lambda execute: execute("explain", *words, "--page-data"))

    def _sweep(self, body):
        body = _checked(body, ["board", "vary"], _OPTIONS)
        run = [f"{name}: {body.pop(name)}" for name in ("source", "frames") if name in body]
        plan = f"run: {{{', '.join(run)}}}\nvary:\n" + "".join(
            f"  {path}: [{', '.join(values)}]\n" for path, values in body["vary"].items())
        words = self._words(body)

        def work(execute):
            folder = os.path.join(self.server.scratch, secrets.token_hex(8))
            os.mkdir(folder)
            try:
                execute("check", *words, f"--write={folder}/board.yaml")  # no text of `sets` is in the plan
                execute("sweep", "the plan", f"--board={folder}/board.yaml", f"--out={folder}/points.db",
                        *words[1 + len(body.get("sets", [])):],
                        arrays={"plan.yaml": numpy.frombuffer(plan.encode(), numpy.uint8)})
                return execute("report", f"{folder}/points.db", "--json")
            finally:
                shutil.rmtree(folder, ignore_errors=True)

        self._stream(work)

    def _picture(self, length):
        name, kept = secrets.token_hex(8), self.server.pictures
        with self.server.upload:  # one at a time, because the server has it in memory meanwhile
            data = self._data(length)
            with open(os.path.join(self.server.scratch, name), "xb") as file:
                file.write(data)
            kept[name] = length
            while len(kept) > PICTURES or sum(kept.values()) > PICTURE_BYTES:
                oldest = next(iter(kept))
                del kept[oldest]
                os.unlink(os.path.join(self.server.scratch, oldest))
        self._answer(200, json.dumps({"id": name}))


class _Server(socketserver.ThreadingTCPServer):
    allow_reuse_address = daemon_threads = True
    request_queue_size = 128

    def __init__(self, arguments, page, scratch):
        super().__init__(("127.0.0.1", arguments.port), _Handler)
        port = self.server_address[1]
        origin = (arguments.origin or f"http://localhost:{port}").lower()
        self.origins = {f"http://127.0.0.1:{port}", f"http://localhost:{port}", origin}
        self.hosts = {each.partition("//")[2] for each in self.origins}
        self.cookie, self.token = f"stereotlm_{port}={secrets.token_urlsafe(32)}", secrets.token_urlsafe(32)
        self.url = f"http://127.0.0.1:{port}/?token={self.token}"
        self.page, self.folder, self.scratch = page, os.getcwd(), scratch
        self.calibration = arguments.calibration
        self.workers = [Worker(arguments.program, MEMORY) for _ in range(QUICK + LONG)]
        self.quick, self.long = queue.LifoQueue(), queue.LifoQueue()  # those that are free
        for number, worker in enumerate(self.workers):
            (self.quick if number < QUICK else self.long).put(worker)
        self._connections = threading.BoundedSemaphore(CONNECTIONS)
        self.pictures = {}  # id -> bytes, the oldest first
        self.upload = threading.Lock()
        none = "'none'"
        scripts = [f"'sha256-{base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()}'"
                   for script in re.findall(r"<script\b[^>]*>(.*?)</script>", page, re.DOTALL)]
        self.headers = {
            "Content-Security-Policy":
                f"default-src 'none'; script-src {' '.join(scripts) or none}; style-src 'unsafe-inline'; "
                "img-src data: blob:; connect-src 'self'; base-uri 'none'; form-action 'none'; "
                f"frame-ancestors 'self' http://127.0.0.1:* http://localhost:* {origin}",
            "X-Content-Type-Options": "nosniff", "Cache-Control": "no-store",
            "Referrer-Policy": "no-referrer", "Cross-Origin-Resource-Policy": "same-origin"}

    def process_request(self, request, client_address):
        if self._connections.acquire(blocking=False):
            return super().process_request(request, client_address)
        with contextlib.suppress(OSError):
            request.setblocking(False)
            request.send(b"HTTP/1.1 503 Service Unavailable\r\nContent-Length: 0\r\n"
                         b"Connection: close\r\n\r\n")
            request.shutdown(socket.SHUT_WR)
            request.recv(1 << 16)  # what is not read when the connection closes takes the answer away
        return self.close_request(request)

    def shutdown_request(self, request):
        end = time.monotonic() + 2
        with contextlib.suppress(OSError):
            request.shutdown(socket.SHUT_WR)
            request.settimeout(1)
            while request.recv(1 << 16) and time.monotonic() < end:
                pass  # as above
        self.close_request(request)
        self._connections.release()

    handle_error = lambda *_: None  # the connection is closed


def main():
    """Serves until a signal ends it."""
    parser = argparse.ArgumentParser(allow_abbrev=False)
    for name, kind in (("page", int), ("port", int), ("program", str), ("folder", str)):
        parser.add_argument(f"--{name}", type=kind, required=True)
    parser.add_argument("--origin")
    parser.add_argument("--calibration")
    parser.add_argument("--open", action="store_true")
    arguments = parser.parse_args()
    if arguments.origin and not re.fullmatch(r"https?://[\w.:\[\]-]+", arguments.origin):
        parser.error(f"--origin = {arguments.origin}: must be as in https://hub.example.org")
    read, write = os.pipe()
    os.set_blocking(write, False)
    signal.set_wakeup_fd(write)  # whichever thread gets the signal; a handler needs the main thread to go on
    for each in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(each, lambda *_: None)
    warnings.simplefilter("ignore")
    os.lseek(arguments.page, 0, os.SEEK_SET)
    with open(arguments.page, encoding="utf-8", newline="") as file:
        page = file.read()
    os.chdir(arguments.folder)
    with temporary_folder() as scratch:
        try:
            server = _Server(arguments, page, scratch)
        except (OSError, OverflowError) as error:
            parser.exit(2, f"stereotlm: error: --port = {arguments.port}: {error}\n")
        for worker in server.workers[:QUICK]:
            worker.start()
        threading.Thread(target=server.serve_forever, daemon=True).start()
        print(f"Open this address in a browser: {server.url}", flush=True)
        if arguments.open:
            threading.Thread(target=webbrowser.open, args=[server.url], daemon=True).start()
        os.read(read, 1)  # a signal writes
        server.server_close()
        for worker in server.workers:
            worker.kill()
    os._exit(0)  # whatever the threads do
