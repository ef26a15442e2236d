"""Tests do not depend on what lies about in the project's folder."""

import os
import subprocess
import unittest.mock

import program
import tracked_files
from program import ProgramTest
from tracked_files import ROOT


class TrackedFilesTest(ProgramTest):
    def test_reads_of_other_files_are_found(self):
        file = ROOT / "README.md"
        reads = [lambda: file.read_text(), lambda: open(os.fsencode(file)).close(),
                 lambda: open(os.path.relpath(file)).close(), lambda: subprocess.run(["true", file])]
        with unittest.mock.patch.object(tracked_files, "FILES", set()):
            for read in (*reads, lambda: os.listdir(ROOT), lambda: os.scandir(ROOT / "results")):
                self.assertRaises(AssertionError, read)
            self.assertTrue(os.listdir(self.folder) and self.left.read_bytes())
            self.succeeds(program.run("check", "fpl2003"))
        for read in reads:
            read()


if __name__ == "__main__":
    program.main()
