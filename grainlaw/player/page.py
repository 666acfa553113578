"""Writing the page that plays a run: one file, with the frames inside and nothing from elsewhere."""

from pathlib import Path

from jinja2 import Environment, PackageLoader, StrictUndefined

from grainlaw.materials import InputError, atomic
from grainlaw.mpm_core.output.run_folder import RunFolder
from grainlaw.player.content import page_content

PAGE_NAME = "view.html"


def write_page(run: RunFolder, path: Path) -> Path:
    """Write the page of a run's frames; return its path.

    Raises InputError for frames that are missing or broken, and for a path that does not end in .html.
    """
    if path.suffix.lower() != ".html":
        raise InputError(f"{path}: the page ends in .html")
    if path.is_dir():
        raise InputError(f"{path} is a folder; the page is a file")
    environment = Environment(
        loader=PackageLoader("grainlaw.player", "templates"), autoescape=True, undefined=StrictUndefined
    )
    text = environment.get_template("player.html").render(content=page_content(run))
    path.parent.mkdir(parents=True, exist_ok=True)
    atomic.write_text(path, text)
    return path
