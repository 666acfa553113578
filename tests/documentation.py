"""The pages of docs/ as scripts: what a reader would type and save, in the order of the page."""

import os
import re
import subprocess
import sys
from collections.abc import Iterable, Mapping, Sequence
from itertools import groupby
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
DOCS = ROOT / "docs"
_BLOCK = re.compile(r"^```(?P<language>\w+) (?P<use>runnable|file=(?P<name>\S+))\n(?P<body>.*?)^```$", re.M | re.S)


def page_script(*pages: Path) -> str:
    """The runnable blocks of pages, one page after the other, and the files that they show, as one shell script.

    Python blocks that follow one another are one program, as the cells of a notebook are.
    """
    blocks = (block for page in pages for block in _BLOCK.finditer(page.read_text(encoding="utf-8")))
    grouped = groupby(blocks, lambda block: block["language"] == "python" and not block["name"])
    return "set -e\n" + "".join(
        _as_program(group) if is_python else "".join(map(_as_shell, group)) for is_python, group in grouped
    )


def _as_program(blocks: Iterable[re.Match[str]]) -> str:
    return f"python - <<'END_OF_FILE'\n{''.join(block['body'] for block in blocks)}END_OF_FILE\n"


def _as_shell(block: re.Match[str]) -> str:
    return f"cat > {block['name']} <<'END_OF_FILE'\n{block['body']}END_OF_FILE\n" if block["name"] else block["body"]


def run_page(
    page: Path, clone: Path, binaries: Path = Path(sys.executable).parent, settings: Mapping[str, str] | None = None
) -> str:
    """Run a page in a folder that looks like the top of a clone; see `run_pages`."""
    return run_pages([page], clone, binaries, settings)


def run_pages(
    pages: Sequence[Path],
    clone: Path,
    binaries: Path = Path(sys.executable).parent,
    settings: Mapping[str, str] | None = None,
) -> str:
    """Run pages one after the other in a folder that looks like the top of a clone, with an environment's commands.

    Returns what the commands printed; fails with it if one of them fails.
    """
    clone.mkdir()
    for name in ("scenes", "plugins", "tests", "validation", "materials"):
        (clone / name).symlink_to(ROOT / name)
    environment = {
        **os.environ,
        "PATH": f"{binaries}{os.pathsep}{os.environ['PATH']}",
        # Small scenes gain nothing from threads, and lose much where the machine has other work.
        "NUMBA_NUM_THREADS": "1",
        **(settings or {}),
    }
    done = subprocess.run(
        ["bash", "-c", page_script(*pages)], cwd=clone, env=environment, capture_output=True, text=True, check=False
    )
    names = ", ".join(page.name for page in pages)
    assert done.returncode == 0, f"{names}\n{done.stdout[-4000:]}\n{done.stderr[-4000:]}"
    return done.stdout
