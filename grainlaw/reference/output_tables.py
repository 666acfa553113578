"""Tables of what a run writes: fields of a frame, columns of the history."""

from grainlaw.mpm_core.output.fields import BODY_FIELD, FIELDS
from grainlaw.mpm_core.output.history import columns_in_all_spaces
from grainlaw.reference.markdown import code, table


def field_table() -> str:
    """The fields that `output.fields` may name, besides the state variables of the laws."""
    rows = [
        [code(field.name), field.unit, field.doc, f"a law with {code(field.needs)}" if field.needs else ""]
        for field in FIELDS.values()
    ]
    rows.append([code(BODY_FIELD), "1", "number of the body in the scene, from 0", ""])
    return table(["field", "unit", "meaning", "needs"], rows)


def history_table() -> str:
    """The columns of history.csv."""
    rows = [[code(column.name), column.unit, column.doc] for column in columns_in_all_spaces()]
    return table(["column", "unit", "meaning"], rows)
