"""Random states and strain increments for the return maps of the Cam Clay laws, and norms of their results."""

import numpy as np


def random_cases(
    count: int, smallest: float, largest: float, critical_state_ratio: float, largest_ocr: float = 100.0
) -> np.ndarray:
    """Columns p, p_c [Pa], six components of s [Pa] and of a strain increment; shape (14, count).

    p, OCR and the norm of the increment are spread evenly in the logarithm, over 1 Pa to 1 MPa, 1 to `largest_ocr` and
    `smallest` to `largest`; q/p and the directions evenly, over 0 to 2.
    """
    random = np.random.default_rng(20240607)
    p = 10.0 ** random.uniform(0.0, 6.0, count)
    q = p * random.uniform(0.0, 2.0, count)
    ocr = largest_ocr ** random.uniform(0.0, 1.0, count)
    deviator, strain = random.normal(size=(2, 6, count))
    deviator[:3] -= deviator[:3].mean(axis=0)
    norms = np.exp(random.uniform(np.log(smallest), np.log(largest), count))
    deviator *= q / (np.sqrt(1.5) * norm(deviator))
    strain *= norms / norm(strain)
    return np.vstack([p, ocr * (p + (q / critical_state_ratio) ** 2 / p), deviator, strain])


def norm(tensors: np.ndarray) -> np.ndarray:
    """sqrt(a:a) of components xx, yy, zz, xy, yz, xz; shape (count,)."""
    return np.asarray(np.sqrt((tensors[:3] ** 2).sum(axis=0) + 2.0 * (tensors[3:] ** 2).sum(axis=0)))


def stress_norm(results: np.ndarray) -> np.ndarray:
    """|sigma| = sqrt(3 p^2 + s:s) [Pa] of rows p, any other, six components of s; shape (count,)."""
    return np.asarray(np.sqrt(3.0 * results[0] ** 2 + norm(results[2:]) ** 2))
