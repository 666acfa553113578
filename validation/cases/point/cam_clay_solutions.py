"""Closed solutions of Modified Cam Clay from an isotropic, normally consolidated state.

Along a path on the yield surface p_c = p (1 + eta^2/M^2) with eta = q/p, so that (slopes lambda, kappa in ln v - ln p)

    d(eps_v^p) = (lambda - kappa) [dp/p + 2 eta d(eta)/(M^2 + eta^2)],   d(eps_s^p) = d(eps_v^p) 2 eta/(M^2 - eta^2)

and the shear strains below are integrals over eta (Wood 1990, Soil Behaviour and Critical State Soil Mechanics, ch. 5).
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import quad, solve_ivp
from scipy.optimize import brentq


def _integral(function: Callable[[float], float], upper: float) -> float:
    return float(quad(function, 0.0, upper, epsabs=1e-13, epsrel=1e-11)[0])


@dataclass(frozen=True)
class CamClay:
    """Constants of the material and the initial pressure [Pa]."""

    critical_state_ratio: float
    compression_index: float
    swelling_index: float
    poisson_ratio: float
    initial_pressure: float

    @property
    def shear_ratio(self) -> float:
        """G/K."""
        return 1.5 * (1.0 - 2.0 * self.poisson_ratio) / (1.0 + self.poisson_ratio)

    @property
    def plastic_share(self) -> float:
        """(lambda - kappa)/lambda."""
        return 1.0 - self.swelling_index / self.compression_index

    def _shear_strain(
        self, eta: float, plastic_volume: Callable[[float], float], log_pressure: Callable[[float], float]
    ) -> float:
        """eps_s from d(eps_v^p)/d(eta) and d(ln p)/d(eta); dq/(3G) with G = ratio p/kappa is the elastic part."""
        m = self.critical_state_ratio
        elastic = self.swelling_index / (3.0 * self.shear_ratio)
        return _integral(
            lambda x: plastic_volume(x) * 2.0 * x / (m * m - x * x) + elastic * (1.0 + x * log_pressure(x)), eta
        )

    def drained_shear_strain(self, eta: float) -> float:
        """eps_s at a stress ratio on the path dq = 3 dp."""
        m, plastic = self.critical_state_ratio, self.compression_index - self.swelling_index
        return self._shear_strain(
            eta,
            lambda x: plastic * (1.0 / (3.0 - x) + 2.0 * x / (m * m + x * x)),
            lambda x: 1.0 / (3.0 - x),
        )

    def drained_state(self, shear_strain: float) -> tuple[float, float]:
        """Q [Pa] and eps_v at a shear strain on the path dq = 3 dp."""
        m = self.critical_state_ratio
        eta = brentq(lambda x: self.drained_shear_strain(x) - shear_strain, 0.0, m * (1.0 - 1e-5), xtol=1e-14)
        p = 3.0 * self.initial_pressure / (3.0 - eta)
        plastic = self.compression_index - self.swelling_index
        volume = self.compression_index * math.log(p / self.initial_pressure) + plastic * math.log1p((eta / m) ** 2)
        return eta * p, volume

    def drained_failure(self) -> float:
        """Q [Pa] at critical state on the path dq = 3 dp."""
        m = self.critical_state_ratio
        return 3.0 * m * self.initial_pressure / (3.0 - m)

    def undrained_pressure(self, eta: float) -> float:
        """P [Pa] at a stress ratio and constant volume."""
        m = self.critical_state_ratio
        return float(self.initial_pressure * (m * m / (m * m + eta * eta)) ** self.plastic_share)

    def undrained_shear_strain(self, eta: float) -> float:
        """eps_s at a stress ratio and constant volume, where d(eps_v^p) = -d(eps_v^e) = -kappa dp/p."""
        m = self.critical_state_ratio

        def log_pressure(x: float) -> float:
            return -self.plastic_share * 2.0 * x / (m * m + x * x)

        return self._shear_strain(eta, lambda x: -self.swelling_index * log_pressure(x), log_pressure)

    def undrained_state(self, shear_strain: float) -> tuple[float, float]:
        """P and q [Pa] at a shear strain and constant volume."""
        upper = self.critical_state_ratio * (1.0 - 1e-5)
        eta = brentq(lambda x: self.undrained_shear_strain(x) - shear_strain, 0.0, upper, xtol=1e-14)
        p = self.undrained_pressure(eta)
        return p, eta * p

    def stress_ratio_at_rest(self) -> float:
        """Eta of one-dimensional normal compression, where d(eps_s) = 2/3 d(eps_v) with eta and p_c/p constant.

        d(eps_v) = lambda dp/p; elastic shear strain eta dp/(3 G), plastic by the flow rule.
        """
        m, plastic = self.critical_state_ratio, self.compression_index - self.swelling_index
        elastic = self.swelling_index / (3.0 * self.shear_ratio)

        def mismatch(eta: float) -> float:
            return plastic * 2.0 * eta / (m * m - eta * eta) + elastic * eta - 2.0 / 3.0 * self.compression_index

        return float(brentq(mismatch, 0.0, m * (1.0 - 1e-9), xtol=1e-14))

    def one_dimensional_state(self, axial_strain: float) -> tuple[float, float]:
        """P and q [Pa] after one-dimensional compression, from the rate equations in ln p and eta to 1e-11.

        lambda dlnp + (lambda - kappa) h d(eta) = d(eps),  h = 2 eta/(M^2 + eta^2)
        (lambda - kappa) f (dlnp + h d(eta)) + e (d(eta) + eta dlnp) = 2/3 d(eps),  f = 2 eta/(M^2 - eta^2)
        """
        m, plastic = self.critical_state_ratio, self.compression_index - self.swelling_index
        e = self.swelling_index / (3.0 * self.shear_ratio)

        def rates(_: float, state: NDArray[np.float64]) -> NDArray[np.float64]:
            eta = state[1]
            h, f = 2.0 * eta / (m * m + eta * eta), 2.0 * eta / (m * m - eta * eta)
            matrix = [[self.compression_index, plastic * h], [plastic * f + e * eta, plastic * f * h + e]]
            return np.linalg.solve(matrix, [1.0, 2.0 / 3.0])

        start = [math.log(self.initial_pressure), 0.0]
        log_p, eta = solve_ivp(rates, (0.0, axial_strain), start, method="DOP853", rtol=1e-12, atol=1e-12).y[:, -1]
        return math.exp(log_p), eta * math.exp(log_p)

    def earth_pressure_at_rest(self) -> float:
        """K0 = sigma_radial/sigma_axial of one-dimensional normal compression."""
        eta = self.stress_ratio_at_rest()
        return (3.0 - eta) / (3.0 + 2.0 * eta)


# The worked example whose drained and undrained states are known: q_f = 400 kPa drained, 137.844 kPa undrained.
EXAMPLE = CamClay(
    critical_state_ratio=1.2,
    compression_index=0.10,
    swelling_index=0.02,
    poisson_ratio=0.3,
    initial_pressure=200e3,
)
