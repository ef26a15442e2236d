"""Boards of stereotlm in Python: run them on pictures, and ask what limits them.

>>> import stereotlm
>>> board = stereotlm.Board("fpl2003")
>>> board.matcher.window = 5
>>> run = board.run(left, right)     # two arrays of 8 bits, as large as the board's images
>>> run.disparity, run.statistics["frames_per_second"], run.banks, run.blame

The program `stereotlm` does the work, in a process of its own: the one that the variable STEREOTLM_PROGRAM
names, else the one that was installed or built together with this module, else the one that PATH finds.
Tables are DataFrames of pandas, or record arrays of numpy if there is no pandas. Long commands show a bar if
there is tqdm.
"""

from stereotlm.board import Board, Run, boards, keys
from stereotlm.worker import Answer, Failed, Problem, Refused, Worker, WorkerDied, execute

__version__ = "0.1.0"
__all__ = ["Answer", "Board", "Failed", "Problem", "Refused", "Run", "Worker", "WorkerDied", "boards",
           "execute", "keys"]
