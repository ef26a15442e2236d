"""The files of the project that a test may read: those that git tracks."""

import pathlib
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[3]


def tracked(*patterns):
    """The paths of the tracked files that match a pattern of git, in order."""
    listed = subprocess.run(["git", "ls-files", "-z", "--", *patterns], cwd=ROOT, text=True,
                            stdout=subprocess.PIPE, check=True)
    return sorted(ROOT / name for name in listed.stdout.split("\0") if name)
