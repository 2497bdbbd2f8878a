"""The command line where a language model is installed that begins a program and never ends it."""

import sys
from pathlib import Path

from grammar.planning.model.planner import ModelPlanner
from nl2robot.cli import main as cli
from nl2robot.language_model.scripted import ScriptedWriter
from nl2robot.translate import planners

writer = ScriptedWriter({"ward a might do with a wave from you": ['goto("ward a")\n']})
writer.held.set()
planners.PLANNERS["model"] = lambda: ModelPlanner(writer)
planners.installed_model = lambda: Path("scripted")
sys.exit(cli.main())
