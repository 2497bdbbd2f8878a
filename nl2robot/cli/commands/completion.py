"""`nl2robot completion`: what a shell needs to complete commands by Tab; never moves anything.

The shell asks `nl2robot` itself, by way of argcomplete (`nl2robot.cli.main`), so what is offered is
what the parser knows.
"""

from __future__ import annotations

import argparse

from nl2robot.errors import ExitStatus

SHELLS = {
    "bash": "echo 'eval \"$(nl2robot completion bash)\"' >> ~/.bashrc",
    "zsh": "echo 'eval \"$(nl2robot completion zsh)\"' >> ~/.zshrc",
    "fish": "nl2robot completion fish > ~/.config/fish/completions/nl2robot.fish",
}
"""How each is told, for good."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.formatter_class = argparse.RawDescriptionHelpFormatter
    parser.add_argument("shell", choices=SHELLS, help="which shell you use")
    ways = "\n".join(f"  {shell:4}  {way}" for shell, way in SHELLS.items())
    parser.epilog = f"Once for each user:\n{ways}\nThen open a new terminal."


def run(options: argparse.Namespace) -> int:
    from argcomplete.shell_integration import shellcode

    code = shellcode(["nl2robot"], shell=options.shell)
    if options.shell == "zsh":  # argcomplete's code needs this, and not everybody has it on
        code = f"autoload -U compinit && compinit -i\n{code}"
    print(code)
    return ExitStatus.OK
