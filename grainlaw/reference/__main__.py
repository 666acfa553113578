"""`python -m grainlaw.reference docs` rewrites the generated parts of the pages in a folder, and the laws' pictures."""

import sys
from pathlib import Path

from grainlaw.reference.law_curves import draw_all
from grainlaw.reference.pages import regenerated_pages


def main() -> None:
    """Write every page that has generated parts, and draw what they show."""
    folder = Path(sys.argv[1])
    for path, text in regenerated_pages(folder).items():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    draw_all(folder)


main()
