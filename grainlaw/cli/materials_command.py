"""`grainlaw materials`: the laws, what they declare and where they came from."""

import json
import sys
from typing import TYPE_CHECKING, Annotated, Any

import typer

from grainlaw.cli.options import PluginFiles, load_plugins
from grainlaw.materials import registry

if TYPE_CHECKING:
    from grainlaw.materials.registry import RegisteredLaw

PIPED_WIDTH = 140


def materials(
    name: Annotated[str | None, typer.Argument(help="Describe this law only.", show_default=False)] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print JSON.")] = False,
    plugin: PluginFiles = None,
) -> None:
    """List the laws, or describe one: parameters, units, bounds, defaults, state variables, parameter sets."""
    load_plugins(plugin)
    known = registry()
    chosen = [known.get(name)] if name else [known.laws[key] for key in sorted(known.laws)]
    for refusal in known.refusals:
        typer.echo(f"warning: {refusal}", err=True)
    if as_json:
        described = [description(entry) for entry in chosen]
        typer.echo(json.dumps(described[0] if name else described, indent=2))
    elif name:
        _print_law(chosen[0])
    else:
        _print_list(chosen)


def description(entry: "RegisteredLaw") -> dict[str, Any]:
    """Everything that a law declares, as plain values."""
    law = entry.law
    defaults = law.parameters._field_defaults
    return {
        "name": law.name,
        "summary": law.summary,
        "origin": entry.origin,
        "file": str(law.source_file),
        "parameters": [
            {"name": key, "unit": found.unit, "bounds": found.bounds, "default": defaults.get(key), "doc": found.doc}
            for key, found in law.parameter_declarations.items()
        ],
        "state_variables": [
            {"name": key, "unit": found.unit, "output": found.output, "doc": found.doc}
            for key, found in law.state_declarations.items()
        ],
        "parameter_sets": [
            {"name": key, "source": found.source, "values": found.parameters._asdict()}
            for key, found in law.parameter_sets.items()
        ],
    }


def _print_list(entries: "list[RegisteredLaw]") -> None:
    rows = [[entry.law.name, entry.law.summary, ", ".join(entry.law.parameter_sets), entry.origin] for entry in entries]
    _print_table(["law", "summary", "parameter sets", "from"], rows)


def _print_law(entry: "RegisteredLaw") -> None:
    law, found = entry.law, description(entry)
    typer.echo(f"{law.name}: {law.summary}\nfrom {entry.origin}, {law.source_file}\n\n{law.documentation}\n")
    sets = found["parameter_sets"]
    rows = [
        [item["name"], item["unit"], item["bounds"], _text(item["default"])]
        + [_text(chosen["values"][item["name"]]) for chosen in sets]
        + [item["doc"]]
        for item in found["parameters"]
    ]
    _print_table(["parameter", "unit", "bounds", "default", *(chosen["name"] for chosen in sets), "meaning"], rows)
    rows = [
        [item["name"], item["unit"], "yes" if item["output"] else "no", item["doc"]]
        for item in found["state_variables"]
    ]
    if rows:
        _print_table(["state variable", "unit", "written by default", "meaning"], rows)
    for chosen in sets:
        typer.echo(f"parameter set {chosen['name']}: {chosen['source']}")


def _text(value: float | None) -> str:
    return "" if value is None else f"{value:g}"


def _print_table(headings: list[str], rows: list[list[str]]) -> None:
    from rich import box
    from rich.console import Console
    from rich.table import Table

    table = Table(box=box.SIMPLE_HEAD)
    for heading in headings:
        table.add_column(heading, no_wrap=heading not in ("meaning", "summary"))
    for row in rows:
        table.add_row(*row)
    Console(width=None if sys.stdout.isatty() else PIPED_WIDTH, markup=False).print(table)
