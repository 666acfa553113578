"""Tables as text and as HTML, and figures that a notebook shows."""

from collections.abc import Sequence
from html import escape


def text_table(headings: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """Rows under their headings, in columns of equal width."""
    widths = [max(len(row[column]) for row in [headings, *rows]) for column in range(len(headings))]
    lines = ["  ".join(entry.ljust(width) for entry, width in zip(row, widths, strict=True)) for row in rows]
    heading = "  ".join(entry.ljust(width) for entry, width in zip(headings, widths, strict=True))
    return "\n".join(line.rstrip() for line in [heading, "  ".join("-" * width for width in widths), *lines])


def html_table(headings: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    """The same as HTML."""
    head = _html_row("th", headings)
    return f"<table><thead>{head}</thead><tbody>{''.join(_html_row('td', row) for row in rows)}</tbody></table>"


def _html_row(tag: str, entries: Sequence[str]) -> str:
    cells = "".join(f'<{tag} style="text-align: left">{escape(entry)}</{tag}>' for entry in entries)
    return f"<tr>{cells}</tr>"
