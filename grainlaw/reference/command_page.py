"""The commands and their options, from the command line itself."""

from typing import Any

import typer

from grainlaw.cli.main import app
from grainlaw.reference.markdown import code, table


def command_reference() -> str:
    """Every command with its arguments and options."""
    group: Any = typer.main.get_command(app)
    parts = [_table_of(group)]
    for name, command in commands(group).items():
        parts += [f"## grainlaw {name}\n", f"{command.help}\n", f"```text\n{_usage(name, command)}\n```\n"]
        parts.append(_table_of(command))
    return "\n".join(parts)


def commands(group: Any) -> dict[str, Any]:
    """Every command by its full name; those of a sub-group bear its name before theirs."""
    found: dict[str, Any] = {}
    for name, command in group.commands.items():
        if hasattr(command, "commands"):
            found |= {f"{name} {inner}": one for inner, one in commands(command).items()}
        else:
            found[name] = command
    return found


def _usage(name: str, command: Any) -> str:
    arguments = [_shown(parameter) for parameter in command.params if not _is_option(parameter)]
    return " ".join(["grainlaw", name, *arguments, "[OPTIONS]"])


def _table_of(command: Any) -> str:
    rows = [
        [code(_shown(parameter)), "required" if parameter.required else _default(parameter), parameter.help or ""]
        for parameter in command.params
    ]
    return table(["argument or option", "default", "meaning"], rows)


def _is_option(parameter: Any) -> bool:
    return bool(parameter.param_type_name == "option")


def _shown(parameter: Any) -> str:
    value = parameter.metavar or parameter.name.upper()
    if not _is_option(parameter):
        return value if parameter.required or value.startswith("[") else f"[{value}]"
    return ", ".join(parameter.opts) + ("" if parameter.is_flag else f" {value}")


def _default(parameter: Any) -> str:
    return "" if parameter.default in (None, False) else code(str(parameter.default))
