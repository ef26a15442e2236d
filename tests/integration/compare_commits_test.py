"""Tests of tests/compare_commits with the program and with wrappers of it that alter what it writes.

usage: compare_commits_test.py PROGRAM
"""

import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

PROGRAM = pathlib.Path(sys.argv.pop(1)).resolve()
SCRIPT = pathlib.Path(__file__).resolve().parents[1] / "compare_commits"

WRAPPER = """#!/usr/bin/env python3
import os, pathlib, sqlite3, subprocess, sys
arguments = sys.argv[1:]
process = subprocess.run([{program!r}, *arguments], stdout=subprocess.PIPE, check=False)
out, status = process.stdout, process.returncode
def edit(path, change):
    file = pathlib.Path(path)
    if file.exists():
        file.write_bytes(change(file.read_bytes()))
{alteration}
sys.stdout.buffer.write(out)
sys.exit(status)
"""

ANOTHER_VERSION = """
if arguments[0] == '--version':
    out = b'another version'
if arguments[0] == 'run':
    edit(arguments[-1] + '/run.json', lambda data: data.replace(b'"version": "', b'"version": "9.'))
"""


def said(command, **options):
    return subprocess.run(command, capture_output=True, check=True, **options).stdout


class CompareCommits(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)

    def wrapper(self, alteration):
        path = self.folder / "wrapper"
        path.write_text(WRAPPER.format(program=str(PROGRAM), alteration=alteration))
        path.chmod(0o755)
        return path

    def compare(self, program, *options):
        """(exit status, first lines of the differences, all lines)."""
        environment = os.environ | {"TMPDIR": str(self.folder)}
        process = subprocess.run([SCRIPT, PROGRAM, program, *options], env=environment, capture_output=True,
                                 text=True, check=False)
        lines = process.stdout.splitlines()
        return process.returncode, sorted(line for line in lines if line.startswith("different: ")), lines

    def expect_equal(self, program, *options):
        status, different, lines = self.compare(program, *options)
        self.assertEqual((status, different), (0, []), lines)
        self.assertEqual(list(self.folder.glob("compare_commits.*")), [], "folders are left behind")
        return lines

    def test_finds_a_program_equal_to_itself_whatever_its_version_is(self):
        for program in (PROGRAM, self.wrapper(ANOTHER_VERSION)):
            with self.subTest(program):
                (summary,) = self.expect_equal(program, "--only", "random_3")
                self.assertRegex(summary, r"^1 cases, \d+ commands \(\d+ with status 0\), \d+ files, ")

    def test_finds_what_is_altered(self):
        program = self.wrapper("""
if 'candidate_0' in os.getcwd():
    status = 3
if arguments[0] == 'bounds':
    out = out[:-1] + b'?'
if arguments[0] == 'explain':
    status = 1
if arguments[-1] == 'camera_cycle':
    edit('camera_cycle/disparity.pfm', lambda data: data[:-1] + bytes([data[-1] ^ 1]))
if arguments[-1] == 'camera_cycle_timing':
    edit('camera_cycle_timing/stats.json', lambda data: data.replace(b'cycles": ', b'cycles": 1', 1))
    pathlib.Path('camera_cycle_timing/config.yaml').unlink()
if arguments[-1] == 'preloaded.csv':
    edit('preloaded.csv', lambda data: data + b'a row')
""")
        status, different, lines = self.compare(program, "--only", "random_3")
        self.assertEqual(status, 1)
        expected = [
            "different: random_3: camera_cycle/disparity.pfm: byte ",
            "different: random_3: camera_cycle_timing/config.yaml: only in A",
            "different: random_3: camera_cycle_timing/stats.json: line ",
            "different: random_3: exit status 0 in A, 1 in B",
            "different: random_3: preloaded.csv: ",
            "different: random_3: standard output: line ",
            "different: random_3_candidate_0: exit status ",
        ]
        self.assertEqual(len(different), len(expected), lines)
        for line, start in zip(different, expected):
            self.assertTrue(line.startswith(start), line)

    def test_repeats_a_difference_with_its_command(self):
        _, _, lines = self.compare(self.wrapper("out += b'one more line'"), "--only", "lists")
        commands = [line.removeprefix("  repeat: ") for line in lines if line.startswith("  repeat: ")]
        repeated = [said(command, shell=True) for command in commands]
        self.assertEqual(repeated, [said([PROGRAM, "boards"]), said([PROGRAM, "keys"])])

    def test_compares_databases_by_their_rows_if_the_versions_differ(self):
        update = "if arguments[0] == 'sweep': sqlite3.connect('plan.db').executescript({!r})"
        versions = update.format("UPDATE points SET version = '9'")
        self.expect_equal(self.wrapper(ANOTHER_VERSION + versions), "--only", "plan_camera")
        figure = update.format("UPDATE points SET cycles = cycles + 1")
        for alteration in (versions, ANOTHER_VERSION + figure):
            with self.subTest(alteration):
                status, different, _ = self.compare(self.wrapper(alteration), "--only", "plan_camera")
                self.assertEqual((status, len(different)), (1, 1))


if __name__ == "__main__":
    unittest.main()
