"""`python -m sandbox.confinement` tells which layers of the wall hold on this machine."""

from sandbox.confinement import LAYERS
from sandbox.worker import layers

_SAID = {
    "limits": "limits of memory, computing time, files and processes",
    "privileges": "no rights of root, and none to be got",
    "landlock": "no files (Landlock)",
    "seccomp": "no system calls but those of computing (seccomp)",
    "processes": "no other process or program",
}


def main() -> None:
    held = layers()
    for layer in sorted(LAYERS):
        print(f"{'yes' if layer in held else 'NO ':4} {layer:11} {_SAID[layer]}")
    if held < LAYERS:
        print(
            "Programs run without what is missing. The kernel may be too old for it, or a "
            "container or a service manager may not allow it: see docs/programs.md."
        )


if __name__ == "__main__":
    main()
