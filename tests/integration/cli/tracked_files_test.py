"""Tests do not depend on what lies about in the project's folder."""

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
        for event, arguments in (
                ("open", (str(self.stray), "r", 0)),
                ("open", (os.fsencode(self.stray), "r", 0)),
                ("open", (os.path.relpath(self.stray), "r", 0)),
                ("subprocess.Popen", ("stereotlm", ["stereotlm", "check", str(self.stray)], None, None)),
                ("os.listdir", (str(self.project),)),
                ("os.scandir", (self.project / "results",))):
            with self.subTest(event=event), self.assertRaises(AssertionError):
                self.hook(event, arguments)

    def test_other_reads_pass(self):
        for event, arguments in (
                ("open", (str(self.project / "tracked.yaml"), "r", 0)),
                ("open", (str(self.project / "build" / "made.yaml"), "r", 0)),
                ("open", (3, "r", 0)),
                ("subprocess.Popen", ("stereotlm", ["stereotlm", "check", "fpl2003"], None, None)),
                ("os.scandir", (str(self.folder),))):
            with self.subTest(event=event):
                self.hook(event, arguments)

    def test_the_hook_watches_this_script(self):
        with self.assertRaises(AssertionError):
            os.listdir(ROOT / "results")


if __name__ == "__main__":
    program.main()
