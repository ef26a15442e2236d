"""The files of the project that a test may read: those that git tracks, and those below build."""

import os
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[3]


def tracked(*patterns, root=ROOT):
    """The paths of the tracked files that match a pattern of git, in order."""
    listed = subprocess.run(["git", "ls-files", "-z", "--", *patterns], cwd=root, text=True,
                            stdout=subprocess.PIPE, check=True)
    return sorted(root / name for name in listed.stdout.split("\0") if name)


class ReadsOnlyTracked:
    """An audit hook. Raises AssertionError where the script lists a folder of the project, or names any other
    file of it: opens it, or gives it to a process.

    Python itself lists the folders of modules, and reads its caches.
    """

    def __init__(self, root=ROOT):
        self.root = str(root)
        self.build = os.path.join(self.root, "build")
        self.files = {str(path) for path in tracked(root=root)}

    def __call__(self, event, arguments):
        if event in ("os.listdir", "os.scandir"):
            path = self.in_project(arguments[0])
            if path and not path.startswith(tuple(filter(None, sys.path))):
                raise AssertionError(f"{path}: a test lists this folder: use tracked()")
        elif event == "open":
            self.check(arguments[0])
        elif event == "subprocess.Popen":
            for argument in arguments[1]:
                self.check(argument)

    def in_project(self, path):
        """The absolute path, or None if it is not below the project, or below build."""
        if not isinstance(path, (str, bytes, os.PathLike)):
            return None  # a descriptor, or the current folder
        path = os.path.abspath(os.fsdecode(path))
        inside = os.path.commonpath([path, self.root]) == self.root
        return path if inside and os.path.commonpath([path, self.build]) != self.build else None

    def check(self, name):
        path = self.in_project(name)
        if path and os.path.isfile(path) and path not in self.files and not path.endswith(".pyc"):
            raise AssertionError(f"{path}: a test reads this file, which git does not track")


sys.addaudithook(ReadsOnlyTracked())
