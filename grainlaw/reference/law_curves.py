"""The picture on each law's page: curves of one element test, drawn by the command that the page shows."""

import shlex
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

FOLDER = "pictures/laws"


@dataclass(frozen=True)
class Curves:
    """An element test that shows what a law is about, with parameter sets of the law and settings of the test."""

    test: str
    sets: tuple[str, ...]
    settings: tuple[str, ...] = ()


SHEAR, TRIAXIAL = "constant-pressure-shear", "triaxial-drained"
CURVES = {
    "drucker_prager": Curves(TRIAXIAL, ("paper", "aluminium_bars"), ("initial_pressure=1000", "final_strain=0.02")),
    "linear_elastic": Curves(TRIAXIAL, ("soft_solid",), ("initial_pressure=1000",)),
    "modified_cam_clay": Curves(TRIAXIAL, ("paper", "paper_ocr4")),
    "mu_i_elastoplastic": Curves(SHEAR, ("paper", "glass_beads")),
    "mu_i_lc": Curves(SHEAR, ("paper", "published_figure")),
    "mu_i_lc_viscous": Curves(SHEAR, ("paper",)),
    "mu_i_mcc": Curves(SHEAR, ("paper", "paper_ocr4")),
    "mu_i_phi_i": Curves(SHEAR, ("paper", "dem_shear")),
    "mu_i_state": Curves(SHEAR, ("paper", "paper_dense", "dem")),
    "neo_hookean": Curves("oedometer", ("vortex",), ("final_strain=0.15",)),
    "newtonian": Curves(SHEAR, ("glycerol",)),
}


def picture(law: str) -> str:
    """Path of a law's picture below docs/."""
    return f"{FOLDER}/{law}.png"


def command(law: str, plot: str) -> str:
    """The command line that draws it."""
    found = CURVES[law]
    materials = [word for name in found.sets for word in ("--material", f"{law}:{name}")]
    settings = [word for setting in found.settings for word in ("--set", setting)]
    return shlex.join(["grainlaw", "element", found.test, *materials, *settings, "--plot", plot])


def curves_section(law: str) -> str:
    """The part of a law's page with its picture."""
    plot = f"{law}.png"
    alternative = f"{CURVES[law].test} of {law}: stress ratio, volume, compression and stress path"
    return f"## Curves\n\n![{alternative}](../{picture(law)})\n\n```sh\n{command(law, plot)}\n```\n"


def draw_all(folder: Path) -> None:
    """Draw every law's picture below a folder, as the pages say."""
    (folder / FOLDER).mkdir(parents=True, exist_ok=True)
    for law in CURVES:
        words = shlex.split(command(law, str(folder / picture(law))))
        subprocess.run([sys.executable, "-m", *words], check=True, stdout=subprocess.DEVNULL)
