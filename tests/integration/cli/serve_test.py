"""The server of the live board (sw/python/stereotlm/serve.py), with the real program behind it."""

import base64
import contextlib
import ctypes
import hashlib
import http.client
import json
import os
import pathlib
import random
import re
import resource
import signal
import socket
import subprocess
import sys
import time
import unittest
import unittest.mock
import urllib.request

import program
from pictures import PYTHON, pgm
from program import HEIGHT, PROGRAM, WIDTH, ProgramTest, descendants, of_process, run, slow, stat, wait_until
from report_data import data_of

MODULES = pathlib.Path(__file__).resolve().parents[3] / "sw" / "python"
os.environ["STEREOTLM_PROGRAM"] = PROGRAM
sys.path.insert(0, str(MODULES))
import stereotlm  # noqa: E402
from stereotlm import serve  # noqa: E402

SCRIPT = "\nconst text = '<ä>';\n"
PAGE = f"<!doctype html><title>Stub</title><script type=\"module\">{SCRIPT}</script>"
SMALL = [["image.width", str(WIDTH)], ["image.height", str(HEIGHT)]]
ALONE = {"source": "preloaded", "frames": 6}
LONG = {"board": "fpl2003", "source": "camera", "frames": 99996}  # explain works for minutes
LONG_RUN = {"board": "fpl2003", "frames": 100000, "pictures": {"synthetic": 1}}
BOMB = "a: &a [x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"{name}: &{name} [{', '.join(['*' + chr(ord(name) - 1)] * 9)}]\n" for name in "bcdefghijklmnop")


class Server:
    """A server of a folder. `constants`: other limits."""

    def __init__(self, folder, *options, **constants):
        page = os.memfd_create("page")
        os.write(page, PAGE.encode())
        limits = "".join(f"serve.{name} = {value}; " for name, value in constants.items())
        self.process = subprocess.Popen(
            [PYTHON, "-B", "-c", f"from stereotlm import serve; {limits}serve.main()", f"--page={page}",
             f"--program={PROGRAM}", "--folder", folder, "--port", "0", *options],
            pass_fds=[page], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd="/",
            env={**os.environ, "PYTHONPATH": str(MODULES), "TMPDIR": str(folder.parent)})
        os.close(page)
        self.line = self.process.stdout.readline()
        port, self.token = re.fullmatch(r"Open .*: http://127\.0\.0\.1:(\d+)/\?token=([\w-]{43})\n",
                                        self.line).groups()
        self.port = int(port)
        self.host = f"127.0.0.1:{port}"
        _, head, _ = self.ask("GET", f"/?token={self.token}", Cookie=None)
        self.cookie = head["Set-Cookie"].partition(";")[0]

    def connect(self):
        return socket.create_connection(("127.0.0.1", self.port), timeout=60)

    def head(self, method, path, length=None, **headers):
        """The bytes of a good head, but for these headers; None leaves one out."""
        kind = "application/octet-stream" if method == "PUT" else "application/json"
        headers = {name.replace("_", "-"): value for name, value in headers.items()}
        if length is not None:
            headers = {"Origin": f"http://{self.host}", "Content-Type": kind, "Content-Length": length,
                       **headers}
        headers = {"Host": self.host, "Cookie": getattr(self, "cookie", None), **headers}
        lines = [f"{name}: {value}\r\n" for name, value in headers.items() if value is not None]
        return f"{method} {path} HTTP/1.1\r\n{''.join(lines)}\r\n".encode()

    def ask(self, method, path, body=None, **headers):
        """(status, headers, text) of the answer."""
        data = body if body is None or isinstance(body, bytes) else json.dumps(body).encode()
        with self.connect() as connection:
            connection.sendall(self.head(method, path, None if data is None else len(data), **headers))
            with contextlib.suppress(BrokenPipeError, ConnectionResetError):
                connection.sendall(data or b"")
            return self.answer(connection)

    def answer(self, connection):
        answer = http.client.HTTPResponse(connection)
        answer.begin()
        return answer.status, answer.headers, answer.read().decode()

    def post(self, path, body, **headers):
        """(status, document)"""
        status, _, text = self.ask("POST", path, body, **headers)
        return status, json.loads(text)

    def stream(self, path, body):
        """The lines of a stream."""
        status, _, text = self.ask("POST", path, body)
        assert status == 200, text
        return list(map(json.loads, text.splitlines()))

    def begin(self, path, body):
        """A connection on which a command works."""
        data = json.dumps(body).encode()
        connection = self.connect()
        connection.sendall(self.head("POST", path, len(data)) + data)
        return connection

    def end(self, number=signal.SIGTERM):
        self.process.send_signal(number)
        out, errors = self.process.communicate(timeout=20)
        return self.process.returncode, out + errors


@slow  # Python; python_test.py tries the worker
class ServeTest(ProgramTest):
    def setUp(self):
        super().setUp()
        self.home = self.folder / "home"
        self.home.mkdir()
        self.file("home/own.yaml", "extends: fpl2003\nname: own\nmatcher: {window: 5}\n")
        self.file("secret.yaml", "extends: fpl2003\nname: secret\n")

    def serve(self, *options, **constants):
        server = Server(self.home, *options, **constants)
        self.addCleanup(lambda: server.process.poll() is None and server.end())
        return server


class Routes(ServeTest):
    def test_the_page_is_for_the_cookie_that_the_token_gives(self):
        server = self.serve()
        status, head, text = server.ask("GET", f"/?token={server.token}", Cookie=None)
        self.assertEqual((status, head["Location"], text), (303, "./", ""))
        self.assertRegex(head["Set-Cookie"],
                         rf"^stereotlm_{server.port}=[\w-]{{43}}; HttpOnly; SameSite=Lax$")
        self.assertNotIn(server.token, head["Set-Cookie"])
        status, head, text = server.ask("GET", "/", Cookie=f"a=b; {server.cookie}; {server.cookie}x")
        self.assertEqual((status, text), (200, PAGE))
        digest = base64.b64encode(hashlib.sha256(SCRIPT.encode()).digest()).decode()
        self.assertIn(f"default-src 'none'; script-src 'sha256-{digest}'; ", head["Content-Security-Policy"])
        self.assertEqual((head["Server"], head["Cache-Control"], head["X-Content-Type-Options"]),
                         ("stereotlm", "no-store", "nosniff"))
        self.assertEqual((head["Referrer-Policy"], head["Cross-Origin-Resource-Policy"]),
                         ("no-referrer", "same-origin"))
        for path, cookie in (("/", None), ("/", "a=b"), ("/", server.cookie + "x"), ("/?token=ä", None),
                             (f"/?token={server.token}x", server.cookie), ("/?", None)):
            status, _, text = server.ask("GET", path, Cookie=cookie)
            self.assertEqual((status, text), (403, "Open the address that stereotlm serve has printed"))

    def test_refuses_foreign_requests(self):
        server = self.serve("--origin=https://hub.example.org")
        check = {"board": "fpl2003"}
        for host in (server.host, f"LOCALHOST:{server.port}", "hub.example.org"):
            self.assertEqual(server.post("/check", check, Host=host)[0], 200, host)
        for host in ("127.0.0.1", f"127.0.0.1:{server.port + 1}", f"evil.org:{server.port}", "", None):
            self.assertEqual(server.ask("GET", "/", Host=host)[0], 403, host)
        for origin in (f"http://localhost:{server.port}", "https://hub.example.org"):
            self.assertEqual(server.post("/check", check, Origin=origin)[0], 200, origin)
        for origin in ("null", "http://evil.org", f"https://{server.host}", "", None):
            self.assertEqual(server.post("/check", check, Origin=origin)[0], 403, origin)
        for kind in ("text/plain", "multipart/form-data", None):
            status, head, _ = server.ask("POST", "/check", check, Content_Type=kind)
            self.assertEqual((status, head["Connection"]), (415, "close"), kind)  # the body is left
        self.assertEqual(server.ask("POST", "/check", {"board": 1})[1]["Connection"], "keep-alive")
        for path in ("/check", "/run", "/explain", "/sweep", "/save"):
            self.assertEqual(server.post(path, check, Cookie=None)[0], 403, path)
        self.assertEqual(server.ask("PUT", "/picture", b"x", Cookie=None)[0], 403)
        self.assertEqual(server.ask("GET", "/boards", Cookie=None)[0], 403)
        self.assertIn("hub.example.org", server.ask("GET", "/")[1]["Content-Security-Policy"])

    def test_refuses_other_routes_methods_and_sizes(self):
        server = self.serve()
        asked = [("GET", "/favicon.ico", 404), ("GET", "/../secret.yaml", 404), ("GET", "//", 403),
                 ("GET", f"http://{server.host}/", 404), ("GET", "/run", 405), ("DELETE", "/", 501)]
        for method, path, expected in asked:
            self.assertEqual(server.ask(method, path, Cookie=None)[0], expected, path)
        self.assertEqual(server.ask("POST", "/", {})[0], 405)
        self.assertEqual(server.ask("POST", "/run", b" " * (serve.BODY + 1))[0], 413)
        self.assertEqual(server.ask("PUT", "/picture", b"", Content_Length=serve.PICTURE + 1)[0], 413)
        self.assertEqual(server.ask("GET", "/", b"x")[0], 413)
        for length in ("-1", "1_0", "٣", "9" * 19, ""):
            self.assertEqual(server.ask("POST", "/run", b"", Content_Length=length)[0], 411, length)
        self.assertEqual(server.ask("POST", "/run", b"", Transfer_Encoding="chunked")[0], 411)
        with server.connect() as connection:
            connection.sendall(server.head("GET", "/").replace(b"HTTP/1.1", b"HTTP/1.0"))
            self.assertEqual(server.answer(connection)[0], 505)

    def test_refuses_wrong_values_by_their_keys(self):
        server = self.serve()
        bad = [("/run", "board", ["", "-x", "--help", 1, "x" * 4097, "a\0b", "\ud800", None]),
               ("/run", "sets", [1, [1], [["a"]], [["a", 1]], [["a", "\0"]], [["a", "b"]] * 301, {"a": "b"}]),
               ("/run", "calibration", [1, "", [], "a\0"]), ("/run", "source", ["x", 1, True, []]),
               ("/explain", "frames", [0, 100001, 1.5, "1", True, 10**400, [1]]),
               ("/run", "pictures", [1, "x", []]),
               ("/save", "name", ["a", "../a.yaml", "-a.yaml", "a/b.yaml"]),
               ("/sweep", "vary", [1, {}, {"a": []}, {"a": ["1"] * 2001}, {"a": ["1"] * 50, "b": ["1"] * 41},
                                   {"a": ["1"], "b": ["1"], "c": ["1"]}, {"a: b": ["1"]}, {"a": [1]},
                                   {"a": ["5]\nset: {a: b"]}, {"a": ["[1"]}, {"a": ["1, 2"]}, {"a": ["*x"]}]),
               ("/run", "other", [1]), ("/check", "frames", [1]), ("/explain", "pictures", [{}])]
        for path, key, values in bad:
            for value in values:
                body = {"board": "fpl2003", "name": "a.yaml", "vary": {"matcher.window": ["5"]}}
                body = {name: each for name, each in body.items()
                        if name == "board" or (path, name) in (("/save", "name"), ("/sweep", "vary"))}
                status, document = server.post(path, {**body, key: value})
                self.assertEqual((status, key in document["error"]), (400, True), (path, key, value))
        for pictures in ({}, {"left": "a"}, {"synthetic": -1}, {"synthetic": 1, "left": "a", "right": "b"},
                         {"left": "a", "right": "b", "fit": "x"}, {"left": "a", "right": "b", "offset": 1e9}):
            body = {"board": "fpl2003", "pictures": pictures}
            self.assertEqual(server.post("/run", body)[0], 400, pictures)
        for body in (b"", b"{", b"[]", b"\xff", b"NaN", b'{"board": Infinity}', b"[" * 200000, b"1" * 5000):
            self.assertEqual(server.ask("POST", "/check", body)[0], 400, body[:20])
        self.assertEqual(server.post("/check", {"yaml": "a", "board": "fpl2003"})[0], 400)

    def test_reads_and_writes_in_the_folder_only(self):
        server = self.serve("--calibration=/nowhere/rig.yaml")
        (self.home / "out.yaml").symlink_to("../secret.yaml")
        (self.home / "in.yaml").symlink_to("own.yaml")
        (self.home / "up").symlink_to("..")
        self.file("home/a/b/c/deep.yaml", "extends: fpl2003\n")
        self.file("home/a/b/c/d/deeper.yaml", "extends: fpl2003\n")
        self.file("home/.hidden/no.yaml", "extends: fpl2003\n")
        self.file("home/large.yaml", b"#" * (serve.BOARD + 1))
        os.mkfifo(self.home / "fifo.yaml")
        self.assertEqual(json.loads(server.ask("GET", "/boards")[2]),
                         {"files": ["in.yaml", "own.yaml", "a/b/c/deep.yaml"]})
        for board in ("own.yaml", "./own.yaml", "in.yaml", f"{self.home}/own.yaml", "a/b/c/d/deeper.yaml"):
            self.assertEqual(server.post("/check", {"board": board})[0], 200, board)
        outside = ["../secret.yaml", "out.yaml", "up/secret.yaml", f"{self.folder}/secret.yaml", "/dev/zero",
                   "fifo.yaml", "large.yaml", "a/", "none.yaml", "a/" * 2000 + "x.yaml"]
        for key, path in [("board", each) for each in outside] + [
                ("calibration", each) for each in outside if each != "large.yaml"]:
            status, document = server.post("/check", {"board": "own.yaml", key: path})
            self.assertEqual(status, 200, path)
            self.assertEqual((document["problems"][0]["key"], document["problems"][0]["value"]), (key, path))
            self.assertNotIn("secret\n", str(document))
        for end in (".yaml", "_left.lut", "_right.lut"):
            self.file(f"home/rig{end}")
        (self.home / "rig_left.lut").unlink()
        (self.home / "rig_left.lut").symlink_to("../secret.yaml")
        document = server.post("/check", {"board": "own.yaml", "calibration": "rig.yaml"})[1]
        self.assertEqual(document["problems"][0]["value"], "rig_left.lut")
        # The one that was allowed is asked for, and is missing.
        document = server.post("/check", {"board": "own.yaml", "calibration": "/nowhere/rig.yaml"})[1]
        self.assertEqual(document["problems"][0]["place"], "command line")
        with self.unchanged(self.folder / "secret.yaml"):
            self.assertIn("problems", server.post("/save", {"board": "fpl2003", "name": "out.yaml"})[1])
        (self.home / "made.yaml").symlink_to("../made.yaml")
        self.assertIn("problems", server.post("/save", {"board": "fpl2003", "name": "made.yaml"})[1])
        self.assertFalse((self.folder / "made.yaml").exists())


class Figures(ServeTest):
    def test_answers_are_what_the_program_prints(self):
        server = self.serve()
        asked = [({"board": "fpl2003", "sets": SMALL, **ALONE}, ["fpl2003"]),
                 ({"board": "own.yaml", "sets": [*SMALL, ["allocation.left_image", "[bank0, bank2]"]],
                   "source": "camera", "frames": 3}, ["own.yaml"])]
        for body, words in asked:
            words += [f"--set={key}={value}" for key, value in body["sets"]]
            same = lambda *more: run(*more, cwd=self.home).stdout
            options = [f"--source={body['source']}", f"--frames={body['frames']}"]
            status, _, text = server.ask("POST", "/run", body)
            self.assertEqual((status, text),
                             (200, same("run", *words, *options, "--timing-only", "--page-data")))
            status, _, text = server.ask("POST", "/run", {**body, "pictures": {"synthetic": 3}})
            self.assertEqual((status, text),
                             (200, same("run", *words, *options, "--synthetic=3", "--page-data")))
            check = {name: body[name] for name in ("board", "sets")}
            self.assertEqual(server.ask("POST", "/check", check)[2], same("check", *words, "--json"))
        lines = server.stream("/explain", asked[0][0])
        self.assertEqual(lines[-1]["document"],
                         json.loads(run("explain", "fpl2003", *program.SMALL, "--source=preloaded",
                                        "--frames=6", "--page-data").stdout))

    def test_explain_says_how_far_it_is(self):
        lines = self.serve().stream("/explain", {"board": "fpl2003", "sets": SMALL})
        self.assertGreater(len(lines), 1)
        for line in lines[:-1]:
            self.assertEqual(list(line), ["done", "of", "text"])
            self.assertLessEqual(line["done"], line["of"])

    def test_refusals_are_those_of_check(self):
        server = self.serve()
        wrong = [["matcher.window", "6"], ["no.key", "1"]]
        expected = json.loads(run("check", "fpl2003", *program.sets("matcher.window=6", "no.key=1"),
                                  "--json").stdout)["problems"]
        for path in ("/run", "/check"):
            self.assertEqual(server.post(path, {"board": "fpl2003", "sets": wrong}),
                             (200, {"problems": expected}))
        body = {"board": "fpl2003", "sets": wrong}
        self.assertEqual(server.stream("/explain", body), [{"problems": expected}])
        status, document = server.post("/check", {"yaml": "extends: fpl2003\nmatcher: {window: 6}\n"})
        self.assertEqual((status, document["problems"][0]["place"]), (200, "board.yaml:2:19"))
        self.assertEqual(server.post("/check", {"yaml": "extends: fpl2003\n"})[1]["ok"], True)

    def test_sweep_gives_all_points(self):
        server = self.serve()
        vary = {"matcher.window": ["5", "7", "6"],
                "allocation.left_image": ["[bank0, bank1]", "[{rows: [bank0, bank1]}, bank2]"]}
        lines = server.stream("/sweep", {"board": "own.yaml", "sets": SMALL, "vary": vary})
        self.assertIn("problems", lines[-1])  # of window 6
        vary["matcher.window"].pop()
        lines = server.stream("/sweep", {"board": "own.yaml", "sets": SMALL, "vary": vary})
        self.assertEqual(lines[-1]["document"]["database"]["points"], 4)

    def test_save_replaces_no_foreign_file(self):
        server = self.serve()
        body = {"board": "own.yaml", "sets": [["matcher.disparities", "64"]], "name": "new.yaml"}
        self.assertEqual(server.post("/save", body), (200, {"path": str(self.home / "new.yaml")}))
        self.assertEqual(server.post("/check", {"board": "new.yaml"})[1]["values"]["matcher.disparities"], 64)
        self.file("home/notes.yaml", "mine: 1\n")
        for name in ("own.yaml", "notes.yaml", "new.yaml"):
            with self.unchanged(self.home / name):
                self.assertIn("problems", server.post("/save", {"board": "fpl2003", "name": name})[1], name)

    def test_pictures_are_kept_and_the_oldest_goes(self):
        server = self.serve()
        put = lambda data: json.loads(server.ask("PUT", "/picture", data)[2])["id"]
        left, right = put(self.left.read_bytes()), put(self.right.read_bytes())
        truth = put(pgm(WIDTH, HEIGHT, [8] * WIDTH * HEIGHT))
        pictures = {"left": left, "right": right, "truth": truth, "truth_scale": 2, "offset": 1,
                    "fit": "crop"}
        body = {"board": "fpl2003", "sets": SMALL, **ALONE, "pictures": pictures}
        status, _, text = server.ask("POST", "/run", body)
        self.assertEqual((status, text), (200, run(
            "run", "fpl2003", *program.SMALL, "--source=preloaded", "--frames=6", *self.pair,
            "--truth", self.file("truth.pgm", pgm(WIDTH, HEIGHT, [8] * WIDTH * HEIGHT)), "--truth-scale=2",
            "--disparity-offset=1", "--fit=crop", "--page-data").stdout.replace(
                str(self.left), self.kept(left)).replace(str(self.right), self.kept(right))))
        for _ in range(serve.PICTURES - 2):
            put(b"no picture")
        self.assertEqual(server.post("/run", body)[1]["problems"][0]["key"], "left")
        self.assertEqual(len(list(self.folder.glob("stereotlm_*/*"))), serve.PICTURES)
        self.assertEqual(server.ask("PUT", "/picture", b"x", Content_Type="application/json")[0], 415)

    def kept(self, name):
        return str(next(self.folder.glob(f"stereotlm_*/{name}")))


class Lifetimes(ServeTest):
    def workers(self, server):
        return [pid for pid in descendants(server.process.pid)
                if (of_process(pid, "cmdline") or "").endswith("\0worker\0")
                and int((stat(pid) or [0, 0])[1]) == server.process.pid]

    def working(self, server):
        """Workers whose commands have computed for 0.2 s."""
        is_busy = lambda pid: int((stat(pid) or [0] * 12)[11]) > 20
        return [pid for pid in self.workers(server) if any(map(is_busy, descendants(pid)))]

    def test_a_command_ends_with_its_connection(self):
        server = self.serve()
        for path, body in (("/explain", LONG), ("/run", LONG_RUN)):
            with server.begin(path, body):
                (worker,) = wait_until(lambda: self.working(server))
                at_work = [worker, *descendants(worker)]
            wait_until(lambda: not any(map(stat, at_work)), 2)
        self.assertEqual(server.post("/check", {"board": "fpl2003"})[0], 200)

    def test_a_worker_that_is_killed_while_idle_costs_nothing(self):
        server = self.serve()
        workers = self.workers(server)
        self.assertEqual(len(workers), serve.QUICK)
        self.assertEqual(resource.prlimit(workers[0], resource.RLIMIT_AS), (serve.MEMORY, serve.MEMORY))
        for pid in workers:
            os.kill(pid, signal.SIGKILL)
        for _ in range(2 * serve.QUICK):
            self.assertEqual(server.post("/check", {"board": "fpl2003"})[0], 200)

    def test_a_worker_that_is_killed_costs_its_own_request_only(self):
        server = self.serve()
        with server.begin("/explain", LONG) as one, server.begin("/explain", LONG) as other:
            killed, stays = wait_until(lambda: len(both := self.working(server)) == 2 and both)
            status, document = server.post("/explain", LONG)
            self.assertEqual((status, document["error"][:22]), (503, "two long questions are"))
            self.assertEqual(server.post("/check", {"board": "fpl2003"})[0], 200)
            os.kill(killed, signal.SIGKILL)
            said = {one: b"", other: b""}
            one.setblocking(False), other.setblocking(False)

            def has_ended():
                for connection in said:
                    with contextlib.suppress(BlockingIOError):
                        said[connection] += connection.recv(1 << 16)
                return [b"been ended by signal 9" in text for text in said.values()].count(True) == 1
            wait_until(has_ended)
            time.sleep(0.3)
            self.assertTrue(has_ended())
            wait_until(lambda: self.working(server) == [stays])
        wait_until(lambda: not self.working(server))
        with server.begin("/run", LONG_RUN) as connection:
            for _ in range(2):  # it is tried again once
                (pid,) = wait_until(lambda: self.working(server))
                os.kill(pid, signal.SIGKILL)
                wait_until(lambda: not stat(pid))
            status, _, text = server.answer(connection)
            self.assertEqual((status, "been ended by signal 9" in text), (500, True), text)

    def test_limits_of_time_and_number(self):
        server = self.serve(WORK=8, WAIT=1, REQUEST=1, IDLE=2, CONNECTIONS=8, QUICK=1)
        with server.begin("/run", LONG_RUN) as connection:
            wait_until(lambda: self.working(server))
            self.assertEqual(server.post("/check", {"board": "fpl2003"}),
                             (503, {"error": "all workers are busy: try again"}))
            self.assertEqual(server.answer(connection)[::2],
                             (500, '{"error": "it takes longer than 8 s"}'))
        with server.connect() as slow_head, server.connect() as slow_body, server.connect() as idle:
            slow_body.sendall(server.head("POST", "/run", 1000))
            begin = time.monotonic()
            for _ in range(8):  # whatever comes meanwhile
                with contextlib.suppress(OSError):
                    slow_head.send(b"G")
                    slow_body.send(b" ")
                time.sleep(0.15)
            for connection in (slow_head, slow_body, idle):
                with contextlib.suppress(ConnectionResetError):
                    self.assertEqual(connection.recv(1), b"")
            self.assertTrue(1.8 < time.monotonic() - begin < 10)
        with contextlib.ExitStack() as stack:
            wait_until(lambda: server.ask("GET", "/")[0] == 200)
            for _ in range(8):
                stack.enter_context(server.connect())
            self.assertEqual(server.ask("GET", "/")[0], 503)
        wait_until(lambda: server.ask("GET", "/")[0] == 200, 5)

    def test_a_signal_ends_all(self):
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            server = self.serve()
            server.ask("PUT", "/picture", b"x")
            with server.begin("/explain", LONG):
                wait_until(lambda: self.working(server))
                left = descendants(server.process.pid)
                self.assertEqual(len(list(self.folder.glob("stereotlm_*"))), 1)
                self.assertEqual(server.end(number), (0, ""))
                wait_until(lambda: not any(map(stat, left)), 2)
                self.assertEqual(list(self.folder.glob("stereotlm_*")), [])

    def test_a_signal_to_another_thread_ends_it_too(self):
        server = self.serve()
        process = server.process.pid
        other = next(int(path.name) for path in pathlib.Path(f"/proc/{process}/task").iterdir()
                     if int(path.name) != process)
        time.sleep(0.2)  # the main thread waits
        self.assertEqual(ctypes.CDLL(None).tgkill(process, other, signal.SIGINT), 0)
        self.assertEqual(server.process.wait(10), 0)

    def test_a_board_shows_it_in_a_notebook(self):
        live = stereotlm.Board("fpl2003", sets={"matcher.window": 5}).live(height=300)
        self.assertIn('height="300"', live._repr_html_())
        opener = urllib.request.build_opener(urllib.request.HTTPCookieProcessor())
        with opener.open(live.url) as page:
            path = self.file("page.html", page.read().decode())
        data = data_of(path)["live"]
        self.assertEqual((data["preset"], data["sets"]), ("fpl2003", ["matcher.window=5"]))
        left = descendants(live._process.pid)
        self.assertGreater(len(left), 1)
        live.close()
        live.close()
        wait_until(lambda: not any(map(stat, left)), 2)
        with unittest.mock.patch.dict(os.environ, STEREOTLM_PROGRAM="/bin/false"):
            with self.assertRaises(FileNotFoundError):
                stereotlm.Board("fpl2003").live()


class Hostile(ServeTest):
    """Random requests that are wrong. STEREOTLM_RANDOM_REQUESTS: how many."""

    def request(self, server, chance):
        """The bytes of a request, and whether it is cut off."""
        texts = ["", "a", "\0", "é\ud800", "-x", "--write=/tmp/x", "../secret.yaml", "out.yaml",
                 "/etc/passwd", "a/../../secret.yaml", "fpl2003", "own.yaml", "x" * 5000, BOMB, "[" * 3000,
                 "1e999", "%s%n", "{a: &a [*a, *a]}", "5]\n- x", "<script>", "$(touch x)", "`touch x`"]
        numbers = [0, -1, 1e308, 10**300, 2**63, 1.5, True, None]
        any_value = lambda: chance.choice([chance.choice(texts), chance.choice(numbers), [], {}, [[["x"]]],
                                           {"a": chance.choice(texts)}, [[chance.choice(texts)] * 2]])
        paths = [*serve.ROUTES, "/x", "/%2e%2e/", "//etc/passwd", "/run/../check", "/?token=", "*", "/\u00e9",
                 "http://evil.org/run"]
        method = chance.choice(["GET", "PUT", "POST", "POST", "POST", "POST", "HEAD", "TRACE", "get", ""])
        path = chance.choice(list(serve.ROUTES) if chance.random() < 0.8 else paths)
        keys = chance.sample(list(serve._RULES), chance.randint(1, 4))
        body = {key: any_value() for key in keys}
        if chance.random() < 0.7:
            body["board"] = "fpl2003"
        if chance.random() < 0.3:
            body["sets"] = [[chance.choice(["matcher.window", "name", "ssram.banks"]), chance.choice(texts)]]
        data = chance.choice([json.dumps(body).encode("utf-8", "surrogatepass")] * 6 + [
            chance.randbytes(200), b"[" * 100000, b'{"a":' * 50000, json.dumps({"yaml": BOMB}).encode(),
            b"9" * 5000, json.dumps(body).encode("utf-16"), b"null", b'{"frames": 1e999}', b"\0" * 300])
        wrong = chance.choice([
            {}, {}, {}, {}, {"Host": "evil.org"}, {"Origin": "http://evil.org"}, {"Cookie": "x" * 60000},
            {"Content_Type": "text/html"}, {"Content_Length": chance.choice(["-1", "x", "9" * 18, "0", "5"])},
            {"Transfer_Encoding": "chunked"}, {"X": "y" * 70000}, {"Expect": "100-continue"},
            {f"X{n}": "1" for n in range(200)}, {"X": "a\r\n b"}, {"X y": "z"}, {"Cookie": "\u00ff=;;=\""}])
        head = server.head(method, path, len(data), **wrong)
        whole = (head.replace(b"HTTP/1.1", chance.choice([b"HTTP/1.1"] * 9 + [b"HTTP/9", b"", b"HTTP/1.1 x"]))
                 if chance.random() < 0.2 else head) + data
        is_cut = chance.random() < 0.1
        return whole[:chance.randrange(len(whole))] if is_cut else whole, is_cut

    def send(self, server, chance):
        data, is_cut = self.request(server, chance)
        with server.connect() as connection, contextlib.suppress(BrokenPipeError, ConnectionResetError):
            if chance.random() < 0.02:  # slowly
                for at in range(5):
                    connection.sendall(data[at : at + 1])
                    time.sleep(0.001)
                data = data[5:]
            connection.sendall(data)
            connection.shutdown(socket.SHUT_WR) if is_cut else None
            answer = connection.recv(100)
            if answer and not is_cut:
                self.assertRegex(answer, rb"^(HTTP/1\.1 [1-5]\d\d |[A-Z{])", data[:200])
                self.assertNotRegex(answer, rb"^HTTP/1\.1 500", data[:2000])

    def rss(self, server):
        return int(re.search(r"VmRSS:\s+(\d+)",
                             pathlib.Path(f"/proc/{server.process.pid}/status").read_text())[1]) / 1024  # MB

    def test_random_requests_do_nothing(self):
        count = int(os.environ.get("STEREOTLM_RANDOM_REQUESTS", 2000))
        server = self.serve(REQUEST=2)
        (self.home / "out.yaml").symlink_to("../secret.yaml")
        begin, first = time.monotonic(), None
        outside = lambda: {path: path.read_bytes() for path in self.folder.rglob("*")
                           if path.is_file() and "stereotlm_" not in str(path)}
        before = outside()
        good = {"board": "own.yaml", "sets": SMALL, **ALONE}
        expected = server.post("/run", good)
        for number in range(count):
            self.send(server, random.Random(number))
            if number % 200 == 199:
                self.assertEqual(server.post("/run", good), expected)
                self.assertEqual(outside(), before)
                memory = self.rss(server)
                first = first or memory if number >= 999 else first
        print(f"{count} requests in {time.monotonic() - begin:.1f} s; the server has {memory:.0f} MB,"
              f" {first:.0f} MB after 1000", file=sys.stderr)
        self.assertLess(memory - first, 20)
        self.assertEqual(server.end(), (0, ""))


program.main(program.AtOnce if len(sys.argv) == 1 else unittest.TestSuite)
