"""One page for each law that ships with grainlaw: header, curves, parameters, state variables and parameter sets."""

from grainlaw.materials import Law, registry
from grainlaw.reference.law_curves import curves_section
from grainlaw.reference.markdown import code, table

OWN_PACKAGE = "grainlaw.plugins."


def own_laws() -> list[Law]:
    """The laws that ship with grainlaw, by name; laws of other installed packages are no part of its docs."""
    laws = registry().laws
    return [laws[name].law for name in sorted(laws) if laws[name].law.update.__module__.startswith(OWN_PACKAGE)]


def law_table() -> str:
    """All laws in one table."""
    rows = [[f"[`{law.name}`](laws/{law.name}.md)", law.summary, _set_names(law)] for law in own_laws()]
    return table(["law", "summary", "parameter sets"], rows)


def state_variable_table() -> str:
    """The state variables of all laws, which are fields of a frame too."""
    rows = [
        [code(law.name), code(name), found.unit, found.doc, "yes" if found.output else "no"]
        for law in own_laws()
        for name, found in law.state_declarations.items()
    ]
    return table(["law", "field", "unit", "meaning", "written by default"], rows)


def law_page(law: Law) -> str:
    """The page of a law."""
    parts = [
        f"# {law.name}\n",
        f"**{law.summary}**\n",
        f"The law is one file, [{law.source_file.name}](../../plugins/{law.source_file.name}), which begins:\n",
        f"```text\n{law.documentation}\n```\n",
        curves_section(law.name),
        "## Parameters\n",
        "A column after the default holds the values of a named parameter set, as `--parameters` takes it.\n",
        _parameter_table(law),
        "".join(f"- `{name}`: {found.source}.\n" for name, found in law.parameter_sets.items()),
        "## State variables\n",
        _state_table(law),
    ]
    return "\n".join(parts)


def _set_names(law: Law) -> str:
    return ", ".join(code(name) for name in law.parameter_sets)


def _parameter_table(law: Law) -> str:
    defaults, sets = law.parameters._field_defaults, law.parameter_sets
    rows = []
    for name, found in law.parameter_declarations.items():
        default = f"{defaults[name]:g}" if name in defaults else "required"
        values = [f"{getattr(chosen.parameters, name):.6g}" for chosen in sets.values()]
        rows.append([code(name), found.unit, code(found.bounds), default, *values, found.doc])
    return table(["parameter", "unit", "allowed", "default", *(code(name) for name in sets), "meaning"], rows)


def _state_table(law: Law) -> str:
    if not law.state_declarations:
        return "None: the stress is all the memory there is.\n"
    rows = [
        [code(name), found.unit, "yes" if found.output else "no", found.doc]
        for name, found in law.state_declarations.items()
    ]
    return table(["state variable", "unit", "written by default", "meaning"], rows)
