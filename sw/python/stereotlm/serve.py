"""The server of `stereotlm serve`: the page of the live board, and the commands that it asks for.

README.md has the routes, the limits, and what is refused.
"""

import argparse
import base64
import contextlib
import dataclasses
import hashlib
import hmac
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
import tempfile
import threading
import time
import warnings
import webbrowser

import numpy

from stereotlm.worker import Failed, Problem, Refused, Worker, WorkerDied, temporary_folder

CONNECTIONS, UPLOADS = 64, 4  # at once
QUICK, LONG = 4, 2  # commands at once: run, check and save; explain and sweep
IDLE, REQUEST, ANSWER = 60, 20, 60  # s: until a request begins; until it is there; until a write is taken
WAIT, WORK = 30, 120  # s: of a quick command for a worker; of its work
MEMORY = 6 << 30  # bytes of address space of a worker
BODY, BOARD, PICTURE = 256 << 10, 1 << 20, 64 << 20  # bytes of a request, of a board file, of a picture
PICTURES, PICTURE_BYTES = 12, 256 << 20  # that are kept
POINTS = 2000  # of a sweep
DEPTH, FILES, FOLDERS = 3, 500, 10000  # of the list of boards


class _Error(Exception):
    """A request that is answered with a status and a sentence."""


class _Gone(Exception):
    """The browser has closed the connection."""


# Bodies of requests.

def _is_text(value, most=4096):
    return isinstance(value, str) and 0 < len(value.encode(errors="replace")) <= most and not re.search(
        "[\0\ud800-\udfff]", value)  # halves of surrogate pairs are no text


def _number(low, high, *kinds):
    return lambda value: type(value) in kinds and low <= value <= high, f"a number, {low}..{high}"


def _one_of(*words):
    return lambda value: value in words, " or ".join(words)


def _are_sets(value):
    return isinstance(value, list) and len(value) <= 300 and all(
        isinstance(pair, list) and len(pair) == 2 and all(each == "" or _is_text(each) for each in pair)
        for pair in value)


# What a plan may take as it is: a word, a list of words, or a map of one key to one of them.
_WORD = r"[\w.+-]+"
_LIST = rf"\[{_WORD}(?:, ?{_WORD})*\]"
_VALUE = re.compile(rf"{_WORD}|{_LIST}|{{{_WORD}: (?:{_WORD}|{_LIST})}}")


def _varies(value):
    return isinstance(value, dict) and 1 <= len(value) <= 2 and all(
        _is_text(path, 200) and re.fullmatch(r"[A-Za-z][\w.-]*", path) and isinstance(values, list)
        and all(_is_text(each) and _VALUE.fullmatch(each) for each in values)
        for path, values in value.items()) and 1 <= math.prod(map(len, value.values())) <= POINTS


_ID = lambda value: _is_text(value, 64), "the id of a picture"
_RULES = {  # key: what is right, and the same in words
    "board": (lambda value: _is_text(value) and value[0] != "-",
              "a preset or the path of a board file; it does not begin with -"),
    "sets": (_are_sets, "a list of at most 300 pairs [key, value], texts of at most 4096 bytes"),
    "calibration": (_is_text, "a path"),
    "source": _one_of("preloaded", "camera"),
    "frames": _number(1, 100000, int),
    "pictures": (lambda value: isinstance(value, dict), "an object"),
    "synthetic": _number(0, (1 << 31) - 1, int),
    "left": _ID, "right": _ID, "truth": _ID,
    "truth_scale": _number(1e-6, 1e6, int, float),
    "fit": _one_of("crop", "pad"),
    "offset": _number(-4096, 4096, int),
    "vary": (_varies, f"one or two keys, each with a list of plain values; at most {POINTS} points"),
    "record": (lambda value: isinstance(value, bool), "true or false"),
    "name": (lambda value: _is_text(value, 200) and re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_.-]*\.yaml", value),
             "the name of a file, of letters, digits, _ . and -, which ends in .yaml"),
    "yaml": (lambda value: _is_text(value, BODY), "the text of a board file"),
}
_OPTIONS = ["sets", "calibration", "source", "frames"]


def _checked(body, needed, optional=()):
    """The values of an object that are not null. Those of `needed` are there."""
    if not isinstance(body, dict):
        raise _Error(400, "the body: must be an object")
    for key, value in body.items():
        if key not in (*needed, *optional):
            raise _Error(400, f"{json.dumps(key[:40])}: unknown key")
        if value is not None and not _RULES[key][0](value):
            raise _Error(400, f"{key}: must be {_RULES[key][1]}")
    body = {key: value for key, value in body.items() if value is not None}
    for key in needed:
        if key not in body:
            raise _Error(400, f"{key}: is missing")
    return body


def _refusal(key, value, rule):
    return Refused([Problem("the request", rule, f"{key} = {value}: {rule}", key, value)])


def _said(error):
    """(status, document) of what went wrong."""
    if isinstance(error, _Error):
        return error.args[0], {"error": error.args[1]}
    if isinstance(error, Refused):  # as check --json prints it
        return 200, {"problems": [
            {name: value for name, value in dataclasses.asdict(problem).items() if value not in ("", False)}
            for problem in error.problems]}
    is_known = isinstance(error, (Failed, WorkerDied))
    return 500, {"error": str(error) if is_known else f"{type(error).__name__}: {error}"}


def _equal(one, other):
    return hmac.compare_digest(one.encode(errors="replace"), other.encode())


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

    def version_string(self):
        return "stereotlm"

    def log_message(self, *_):
        pass

    def send_error(self, code, message=None, explain=None):  # about a head that cannot be read
        self._answer(code, message or self.responses[code][0], "text/plain")

    def do_GET(self):
        try:
            self._route()
        except _Gone:
            self.close_connection = True
        except OSError:
            raise  # the connection is lost
        except Exception as error:
            status, document = _said(error)
            if self.path.partition("?")[0] == "/":
                self._answer(status, document["error"], "text/plain")
            else:
                self._answer(status, json.dumps(document))

    do_POST = do_PUT = do_GET

    def _header(self, name):
        """Its value; nothing if it is missing, or if there are several."""
        values = self.headers.get_all(name, [])
        return values[0].strip() if len(values) == 1 else ""

    def _route(self):
        server = self.server
        if self._header("Host").lower() not in server.hosts:
            raise _Error(403, f"The header Host must be one of: {', '.join(sorted(server.hosts))}")
        if self.request_version != "HTTP/1.1":
            raise _Error(505, "The request must be of HTTP/1.1")
        path, _, query = self.path.partition("?")
        routes = {"/": "GET", "/boards": "GET", "/picture": "PUT",
                  **dict.fromkeys(("/run", "/check", "/explain", "/sweep", "/save"), "POST")}
        if path not in routes:
            raise _Error(404, "There is no such page")
        method = routes[path]
        if self.command != method:
            raise _Error(405, f"{path} takes {method} only")
        length = self._header("Content-Length") if "Content-Length" in self.headers else "0"
        if "Transfer-Encoding" in self.headers or not re.fullmatch(r"[0-9]{1,18}", length):
            raise _Error(411, "The header Content-Length must say how long the body is")
        most = {"GET": 0, "POST": BODY, "PUT": PICTURE}[method]
        if int(length) > most:
            raise _Error(413, f"The body must have at most {most} bytes")
        self._is_read = method == "GET"
        if path == "/" and query:
            return self._open(query)
        cookies = [part.strip().partition("=") for part in self._header("Cookie").split(";")]
        if not any(name == server.cookie and _equal(value, server.secret) for name, _, value in cookies):
            raise _Error(403, "Open the address that stereotlm serve has printed")
        if method != "GET" and self._header("Origin").lower() not in server.origins:
            raise _Error(403, "The header Origin must be that of the page")
        kind = {"POST": "application/json", "PUT": "application/octet-stream"}.get(method, "")
        if self._header("Content-Type").lower().partition(";")[0].strip() != kind and kind:
            raise _Error(415, f"The header Content-Type must be {kind}")
        arguments = {"GET": list, "POST": lambda: [self._json(int(length))], "PUT": lambda: [int(length)]}
        return getattr(self, f"_{path[1:] or 'page'}")(*arguments[method]())

    def _json(self, length):
        def refuse(name):
            raise ValueError(name)

        data = self.rfile.read(length)
        if len(data) < length:
            raise _Gone
        self._is_read = True
        try:
            return json.loads(data.decode(), parse_constant=refuse)
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
        with self._worker(self.server.long, 0, None, refusal) as worker:
            self._head(200, "application/x-ndjson", Transfer_Encoding="chunked")
            show = lambda *progress: self._line(json.dumps(dict(zip(("done", "of", "text"), progress))))
            try:
                document = work(lambda *words, **more: worker.execute(*words, **more, progress=show).output)
                self._line('{"document": %s}' % document.replace("\n", " "))  # its texts have no line ends
            except (Refused, Failed) as error:
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
        except WorkerDied:
            if why:
                raise why[0] from None
            raise
        finally:
            os.close(end)
            thread.join()
            os.close(ended)
            if why:  # for the next command
                worker.close()
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

    def _inside(self, key, path, most=math.inf):
        """The path of a regular file in the folder."""
        real = os.path.realpath(path)
        if os.path.commonpath([self.server.folder, real]) != self.server.folder:
            raise _refusal(key, path, "must be in the folder of stereotlm serve")
        if not os.path.isfile(real) or os.path.getsize(real) > most:
            raise _refusal(key, path, f"must be a file of at most {most} bytes")
        return path

    def _words(self, body):
        """BOARD and its options."""
        board, calibration = body["board"], body.get("calibration")
        if "/" in board or board.endswith(".yaml"):
            self._inside("board", board, BOARD)
        if calibration not in (None, self.server.calibration):
            for end in (".yaml", "_left.lut", "_right.lut"):
                self._inside("calibration", calibration.removesuffix(".yaml") + end)
        return [board, *(f"--set={key}={value}" for key, value in body.get("sets", [])),
                *(f"--{name}={body[name]}" for name in ("calibration", "source", "frames") if name in body)]

    # Routes.

    def _page(self):
        self._answer(200, self.server.page, "text/html")

    def _open(self, query):
        if not _equal(query, f"token={self.server.token}"):
            raise _Error(403, "Open the address that stereotlm serve has printed")
        self._answer(303, "", "text/plain", Location="./", Set_Cookie=
                     f"{self.server.cookie}={self.server.secret}; HttpOnly; SameSite=Lax; Path=/")

    def _boards(self):
        files = []
        for number, (folder, folders, names) in enumerate(os.walk(".")):
            folders[:] = sorted(name for name in folders if name[0] != "." and folder.count("/") < DEPTH)
            for path in (os.path.join(folder, name)[2:] for name in sorted(names) if name.endswith(".yaml")):
                with contextlib.suppress(Refused):
                    files += [self._inside("board", path, BOARD)] * _RULES["board"][0](path)
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
                pictures[name] = self.server.path(name, pictures[name])
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
            raise _refusal("name", body["name"], "must not be a symbolic link")
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
            folder = tempfile.mkdtemp(dir=self.server.scratch)
            board, points = f"--board={folder}/board.yaml", f"--out={folder}/points.db"
            try:
                execute("check", *words, f"--write={folder}/board.yaml")  # no text of `sets` is in the plan
                execute("sweep", "the plan", board, points, *words[1 + len(body.get("sets", [])):],
                        arrays={"plan.yaml": numpy.frombuffer(plan.encode(), numpy.uint8)})
                return execute("report", f"{folder}/points.db", "--json")
            finally:
                shutil.rmtree(folder, ignore_errors=True)

        self._stream(work)

    def _picture(self, length):
        if not self.server.uploads.acquire(blocking=False):
            raise _Error(503, f"{UPLOADS} pictures are being sent: try again")
        try:
            name = self.server.keep(self.rfile, length)
        finally:
            self.server.uploads.release()
        self._is_read = True
        self._answer(200, json.dumps({"id": name}))


class _Server(http.server.ThreadingHTTPServer):
    request_queue_size = 128

    def __init__(self, arguments, page, scratch):
        super().__init__(("127.0.0.1", arguments.port), _Handler)
        port = self.server_address[1]
        origin = (arguments.origin or f"http://localhost:{port}").lower()
        self.origins = {f"http://127.0.0.1:{port}", f"http://localhost:{port}", origin}
        self.hosts = {each.partition("//")[2] for each in self.origins}
        self.cookie, self.secret, self.token = f"stereotlm_{port}", *(secrets.token_urlsafe(32) for _ in "12")
        self.url = f"http://127.0.0.1:{port}/?token={self.token}"
        self.page, self.folder, self.scratch = page, os.getcwd(), scratch
        self.calibration = arguments.calibration
        self.workers = [Worker(arguments.program, MEMORY) for _ in range(QUICK + LONG)]
        self.quick, self.long = queue.LifoQueue(), queue.LifoQueue()  # those that are free
        for number, worker in enumerate(self.workers):
            (self.quick if number < QUICK else self.long).put(worker)
        self.uploads = threading.BoundedSemaphore(UPLOADS)
        self._connections = threading.BoundedSemaphore(CONNECTIONS)
        self._pictures = {}  # id -> bytes, the oldest first
        self._lock = threading.Lock()
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

    def server_bind(self):
        socketserver.TCPServer.server_bind(self)  # that of HTTPServer asks for the name of this machine

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

    def process_request_thread(self, request, client_address):
        try:
            super().process_request_thread(request, client_address)
        finally:
            self._connections.release()

    def shutdown_request(self, request):
        end = time.monotonic() + 2
        with contextlib.suppress(OSError):
            request.shutdown(socket.SHUT_WR)
            request.settimeout(1)
            while request.recv(1 << 16) and time.monotonic() < end:
                pass  # as above
        self.close_request(request)

    def handle_error(self, request, client_address):
        pass  # the connection is closed

    # Pictures.

    def keep(self, source, length):
        """Reads a picture of so many bytes. Returns its id. The oldest go when there are too many."""
        name = secrets.token_hex(8)
        path = os.path.join(self.scratch, name)
        try:
            with open(path, "xb") as file:
                while file.tell() < length:
                    data = source.read(min(length - file.tell(), 1 << 20))
                    if not data:
                        raise _Gone
                    file.write(data)
        except BaseException:
            os.unlink(path)
            raise
        with self._lock:
            self._pictures[name] = length
            while len(self._pictures) > PICTURES or sum(self._pictures.values()) > PICTURE_BYTES:
                oldest = next(iter(self._pictures))
                del self._pictures[oldest]
                os.unlink(os.path.join(self.scratch, oldest))
        return name

    def path(self, key, name):
        """The path of a picture."""
        with self._lock:
            if name not in self._pictures:
                raise _refusal(key, name, "no picture of this id is kept: send it again")
        return os.path.join(self.scratch, name)


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
    for each in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        signal.signal(each, lambda *_: os.write(write, b"\n"))
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
