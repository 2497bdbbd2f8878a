"""A second wall around the process that runs programs, for the day when the interpreter has a hole.

Linux lets a thread give up rights for itself and for every process that it starts, and never get
them back. So the interpreter is started by a thread that has given up all but what the start needs,
and that ends after it; this process keeps its own rights.

| layer | what it takes | since Linux |
|---|---|---|
| `limits` | open files, written files, processes, core files, memory, computing time | 2.6.36 |
| `privileges` | root's rights, and getting any by a program that has them | 3.5 |
| `landlock` | files but the interpreter's own, TCP, signals to others | 5.13, 6.7, 6.12 |
| `seccomp` | all system calls but those that a program needs that only computes | 3.17 |
| `processes` | to start another process or program, once the interpreter runs | 5.5 |

A layer that the system has not, or does not let us have, is left out; a run never fails for it.
`python -m sandbox.confinement` tells which hold here.
"""

from sandbox.confinement.rlimits import limit
from sandbox.confinement.wall import LAYERS, confined, holding

__all__ = ["LAYERS", "confined", "holding", "limit"]
