"""`python -m grainlaw.reference docs` rewrites the generated parts of the pages in a folder."""

import sys
from pathlib import Path

from grainlaw.reference.pages import regenerated_pages


def main() -> None:
    """Write every page that has generated parts."""
    folder = Path(sys.argv[1])
    for path, text in regenerated_pages(folder).items():
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")


main()
