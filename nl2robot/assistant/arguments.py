"""A server of the Model Context Protocol whose refusals are sentences.

The SDK tells of an argument that does not fit in the words of its library, for programmers, and
sets its own words before every other error. Here an assistant, and whoever reads along, is told
what was wrong and what is expected; what it is given besides is refused as well, for what it meant
by that would be done otherwise than it thinks. A stop is a stop whatever comes with it.
"""

from __future__ import annotations

import difflib
from collections.abc import Mapping
from typing import Any, Final

from mcp.server.mcpserver import Context, MCPServer
from mcp.server.mcpserver.exceptions import ToolError, UnexpectedToolError
from mcp_types import CallToolResult, InputRequiredResult, Tool
from pydantic import ValidationError

STOP: Final = "stop"
"""The tool that takes anything."""
MOST_TOLD: Final = 5
"""Things that are wrong with one call, of which an assistant is told."""
LONGEST_TOLD: Final = 60
"""Characters of what was given instead."""


class SentenceServer(MCPServer[Any]):
    """One that says in a sentence what is wrong with a call."""

    async def call_tool(
        self, name: str, arguments: dict[str, Any], context: Context[Any, Any] | None = None
    ) -> CallToolResult | InputRequiredResult:
        tools = {tool.name: tool for tool in await self.list_tools()}
        if name not in tools:
            raise ToolError(f"There is no tool {_short(name)}. There are: {', '.join(tools)}.")
        schema = tools[name].input_schema
        given = {} if name == STOP else arguments
        unknown = [each for each in given if each not in schema.get("properties", {})]
        if unknown:
            raise ToolError(" ".join(_unknown(name, each, schema) for each in unknown[:MOST_TOLD]))
        try:
            return await super().call_tool(name, given, context)
        except UnexpectedToolError:
            raise
        except ToolError as error:
            cause = error.__cause__
            if isinstance(cause, ValidationError):
                raise ToolError(_refused(name, cause, schema)) from cause
            raise ToolError(str(cause)) from cause

    async def list_tools(self) -> list[Tool]:
        """Each says that it takes no further arguments."""
        tools = await super().list_tools()
        return [
            tool.model_copy(
                update={"input_schema": {**tool.input_schema, "additionalProperties": False}}
            )
            for tool in tools
        ]


def _unknown(tool: str, argument: str, schema: Mapping[str, Any]) -> str:
    takes = list(schema.get("properties", {}))
    told = f"{tool} takes no argument {_short(argument)}."
    if not takes:
        return f"{told} Call it without any."
    near = difflib.get_close_matches(argument, takes, n=1)
    return f"{told} Did you mean {near[0]}?" if near else f"{told} It takes: {', '.join(takes)}."


def _refused(tool: str, error: ValidationError, schema: Mapping[str, Any]) -> str:
    told = []
    for each in error.errors(include_url=False, include_context=False)[:MOST_TOLD]:
        name = str(each["loc"][0]) if each["loc"] else ""
        expected = _expected(schema.get("properties", {}).get(name, {}))
        if each["type"] == "missing":
            told.append(f"{tool} needs {name}: {expected}.")
        else:
            told.append(f"{name} of {tool} is {_given(each['input'])}. Expected: {expected}.")
    return " ".join(told)


_KINDS: Final = {
    "string": "a text",
    "integer": "a whole number",
    "number": "a number",
    "boolean": "true or false",
}


def _expected(schema: Mapping[str, Any]) -> str:
    """What an argument has to be, as its JSON Schema has it."""
    told = _KINDS[schema["type"]]
    least, most = schema.get("minimum"), schema.get("maximum")
    if most is not None:
        told += f" from {least:g} to {most:g}"
    elif least is not None:
        told += f" from {least:g}"
    if "minLength" in schema:
        told += ", not empty"
    if "maxLength" in schema:
        told += f", at most {schema['maxLength']} characters"
    return f"{told} ({schema['description']})" if "description" in schema else told


def _given(value: Any) -> str:
    match value:
        case None:
            return "nothing (null)"
        case bool() | int() | float():
            return _short(str(value).lower(), quoted=False)
        case str() if len(value) > LONGEST_TOLD:
            return f"a text of {len(value)} characters"
        case str():
            return _short(value)
        case list():
            return "a list"
    return "an object"


def _short(text: str, *, quoted: bool = True) -> str:
    """On one line, and not longer than anybody reads."""
    told = "".join(each if each.isprintable() else " " for each in text)
    if len(told) > LONGEST_TOLD:
        told = f"{told[:LONGEST_TOLD]}…"
    return f"“{told}”" if quoted else told
