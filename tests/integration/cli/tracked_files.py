"""The files of the project that a test may read: those that git tracks, and those below build."""

import os
import pathlib
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[3]


def tracked(*patterns):
    """The paths of the tracked files that match a pattern of git, in order."""
    listed = subprocess.run(["git", "ls-files", "-z", "--", *patterns], cwd=ROOT, text=True,
                            stdout=subprocess.PIPE, check=True)
    return sorted(ROOT / name for name in listed.stdout.split("\0") if name)


FILES = {str(path) for path in tracked()}


def in_project(path):
    """The absolute path; None if it is not in the project, or below build."""
    if not isinstance(path, (str, bytes, os.PathLike)):
        return None  # a descriptor, or the current folder
    path = os.path.abspath(os.fsdecode(path))
    is_inside = [f"{path}/".startswith(f"{folder}/") for folder in (ROOT, ROOT / "build")]
    return path if is_inside == [True, False] else None


def watch(event, arguments):
    """An audit hook. Raises AssertionError where the script lists a folder of the project, or names a file of
    it that git does not track: opens it, or gives it to a process.

    Python itself lists the folders of modules, and reads its caches.
    """
    names = arguments[1] if event == "subprocess.Popen" else arguments[:1] if event == "open" else []
    for path in filter(None, map(in_project, names)):
        if os.path.isfile(path) and path not in FILES and not path.endswith(".pyc"):
            raise AssertionError(f"{path}: a test reads this file, which git does not track")
    if event in ("os.listdir", "os.scandir"):
        path = in_project(arguments[0])
        if path and not path.startswith(tuple(filter(None, sys.path))):
            raise AssertionError(f"{path}: a test lists this folder: use tracked()")


sys.addaudithook(watch)
