"""Tests do not depend on what lies about in the project's folder."""

import contextlib
import os
import subprocess
import unittest

import program
from program import ProgramTest
from tracked_files import ROOT, ReadsOnlyTracked, tracked


class TrackedFilesTest(ProgramTest):
    def setUp(self):
        super().setUp()
        self.project = self.folder / "project"
        self.file("project/tracked.yaml", "a: 1")
        for arguments in (["init", "-q"], ["add", "."]):
            subprocess.run(["git", *arguments], cwd=self.project, check=True)
        self.stray = self.file("project/results/stray.yaml", "a: 2")
        self.file("project/build/made.yaml", "a: 3")
        self.hook = ReadsOnlyTracked(self.project)

    def test_files_are_listed_by_git(self):
        self.assertEqual(tracked("*.yaml", root=self.project), [self.project / "tracked.yaml"])

    def test_reads_of_other_files_are_found(self):
        tracked_file, made = self.project / "tracked.yaml", self.project / "build" / "made.yaml"
        program = lambda argument: ("stereotlm", ["stereotlm", "check", str(argument)], None, None)
        for is_found, event, *rows in (
                (True, "open", (str(self.stray), "r", 0), (os.fsencode(self.stray), "r", 0),
                 (os.path.relpath(self.stray), "r", 0)),
                (True, "subprocess.Popen", program(self.stray)),
                (True, "os.listdir", (str(self.project),)), (True, "os.scandir", (self.project / "results",)),
                (False, "open", (str(tracked_file), "r", 0), (str(made), "r", 0), (3, "r", 0)),
                (False, "subprocess.Popen", program("fpl2003")), (False, "os.scandir", (str(self.folder),))):
            for arguments in rows:
                context = self.assertRaises(AssertionError) if is_found else contextlib.nullcontext()
                with self.subTest(event=event, arguments=arguments), context:
                    self.hook(event, arguments)

    def test_the_hook_watches_this_script(self):
        with self.assertRaises(AssertionError):
            os.listdir(ROOT / "results")


if __name__ == "__main__":
    program.main()
