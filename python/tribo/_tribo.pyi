"""Compiled part of the package: types of what Rust gives."""

import os
from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypedDict, final

import numpy as np
import numpy.typing as npt

_Array = npt.NDArray[np.float64]
_Path = str | os.PathLike[str]
_ModelLike = Model | Arm | _Path

VERSION: str
PRESETS: list[str]

class _State(TypedDict):
    time: float
    q: _Array
    dq: _Array
    tau: _Array

class _Hidden(TypedDict):
    q: _Array
    dq: _Array
    friction: _Array
    wrench: _Array

@final
class Arm:
    """A serial arm of six or seven revolute joints; arrays are (n, joints), or (joints,) of one sample."""

    @staticmethod
    def preset(name: str) -> Arm: ...
    @staticmethod
    def from_urdf(path: _Path, *, base_link: str | None = None, tip_link: str | None = None) -> Arm: ...
    @staticmethod
    def from_mjcf(path: _Path, *, base_link: str | None = None, tip_link: str | None = None) -> Arm: ...
    @property
    def name(self) -> str: ...
    @property
    def joints(self) -> int: ...
    @property
    def limits(self) -> dict[str, _Array]: ...
    @property
    def poses(self) -> _Array: ...
    @property
    def inertial_parameters(self) -> _Array: ...
    @property
    def rotor_inertia(self) -> _Array: ...
    def pose(self, q: npt.ArrayLike) -> _Array:
        """Pose of the flange in the base, (n, 4, 4)."""
    def jacobian(self, q: npt.ArrayLike) -> _Array:
        """Jacobian of the flange origin in base axes, (n, 6, joints): linear rows, then angular."""
    def mass_matrix(self, q: npt.ArrayLike) -> _Array:
        """Mass matrix with rotor inertia (kg m²), (n, joints, joints)."""
    def gravity(self, q: npt.ArrayLike) -> _Array:
        """Gravity torque (Nm), (n, joints)."""
    def bias(self, q: npt.ArrayLike, qd: npt.ArrayLike) -> _Array:
        """Coriolis, centrifugal and gravity torque (Nm), (n, joints)."""
    def inverse_dynamics(
        self, q: npt.ArrayLike, qd: npt.ArrayLike | None = None, qdd: npt.ArrayLike | None = None
    ) -> _Array:
        """Joint torque of a motion (Nm), (n, joints)."""
    def forward_dynamics(self, q: npt.ArrayLike, qd: npt.ArrayLike, tau: npt.ArrayLike) -> _Array:
        """Joint acceleration under a torque (rad/s²), (n, joints)."""
    def regressor(
        self, q: npt.ArrayLike, qd: npt.ArrayLike | None = None, qdd: npt.ArrayLike | None = None
    ) -> _Array:
        """Regressor of the rigid-body torque, (n, joints, 10 joints)."""

@final
class Model:
    """What is believed of a robot: arm, friction, further effects, side of the gears on which torques are meant."""

    @staticmethod
    def read(path: _Path) -> Model: ...
    @staticmethod
    def from_yaml(text: str) -> Model: ...
    @staticmethod
    def bare(
        robot: _Path, *, torque_side: str = "motor", base_link: str | None = None, tip_link: str | None = None
    ) -> Model: ...
    def with_friction(self, coulomb: Sequence[float], viscous: Sequence[float]) -> Model: ...
    def with_payload(
        self, mass: float, com: Sequence[float] = ..., inertia: Sequence[float] = ...
    ) -> Model: ...
    def to_yaml(self) -> str: ...
    def save(self, path: _Path) -> None: ...
    @property
    def arm(self) -> Arm: ...
    @property
    def joints(self) -> int: ...
    @property
    def joint_names(self) -> list[str]: ...
    @property
    def torque_side(self) -> str: ...

@final
class Log:
    """A robot log: columns of one length, stamps that increase, every number finite; joint arrays are (n, joints)."""

    @staticmethod
    def from_arrays(
        time: npt.ArrayLike, q: npt.ArrayLike, tau: npt.ArrayLike, dq: npt.ArrayLike | None = None, **more: npt.ArrayLike
    ) -> Log: ...
    @staticmethod
    def from_columns(named: Mapping[str, npt.ArrayLike]) -> Log: ...
    def columns(self) -> list[tuple[str, _Array]]: ...
    def quantity(self, name: str) -> _Array | None: ...
    @property
    def time(self) -> _Array: ...
    @property
    def joints(self) -> int: ...
    @property
    def duration(self) -> float: ...
    @property
    def name(self) -> str: ...
    def named(self, name: str) -> Log: ...
    def summary(self) -> str: ...
    def write(self, path: _Path) -> None: ...
    def slice(self, start: int, end: int) -> Log: ...
    def __len__(self) -> int: ...

@final
class WrenchEstimator:
    """A wrench estimator that is given one sample after the other."""

    def __new__(cls, model: _ModelLike, residual: str = "ekf") -> WrenchEstimator: ...
    def reset(self) -> None: ...
    def step(
        self,
        q: npt.ArrayLike,
        dq: npt.ArrayLike,
        tau: npt.ArrayLike,
        tau_friction: npt.ArrayLike | None = None,
        dt: float = 1e-3,
        theta: npt.ArrayLike | None = None,
    ) -> _Array:
        """Takes one sample and gives the wrench (6,), force (N) then moment (Nm), by the robot on its environment."""
    @property
    def covariance(self) -> _Array: ...
    @property
    def limits95(self) -> _Array: ...

@final
class Compensator:
    """What a campaign tuned: the torque that cancels friction, tick by tick."""

    @staticmethod
    def read(path: _Path) -> Compensator: ...
    @staticmethod
    def from_yaml(text: str) -> Compensator: ...
    def to_yaml(self) -> str: ...
    def save(self, path: _Path) -> None: ...
    def export(self, format: str, name: str | None = None) -> tuple[str, list[str]]:
        """The compensator in a format of another stack, and what the text does not say."""
    def torque(
        self,
        dq: npt.ArrayLike,
        dq_reference: npt.ArrayLike | None = None,
        q: npt.ArrayLike | None = None,
        load: npt.ArrayLike | None = None,
        dt: float = 1e-3,
    ) -> _Array:
        """Torque to add (Nm), (joints,), at the measured velocity dq (rad/s)."""
    @property
    def parameters(self) -> list[dict[str, float]]: ...
    @property
    def velocity(self) -> str: ...
    @property
    def joints(self) -> int: ...

@final
class SimulatedArm:
    """A simulated arm with true friction and hidden effects, driven by motor torque at 1 kHz."""

    def __new__(
        cls,
        robot: str | None = None,
        friction: str = "coulomb_viscous",
        *,
        pose: int = 0,
        seed: int = 1,
        noise: float = 1.0,
    ) -> SimulatedArm: ...
    def reset(self, q: npt.ArrayLike | None = None, *, seed: int | None = None) -> _State: ...
    def step(self, tau: npt.ArrayLike, wrench: npt.ArrayLike | None = None) -> _State: ...
    @property
    def state(self) -> _State: ...
    @property
    def hidden(self) -> _Hidden: ...
    @property
    def dt(self) -> float: ...
    @property
    def joints(self) -> int: ...

@final
class Study:
    """Bayesian optimisation of a function each evaluation of which is dear: costs are minimised over a box."""

    def __new__(
        cls,
        space: Mapping[str, tuple[float, float]] | Sequence[tuple[str, tuple[float, float]]],
        *,
        start: Sequence[float] | None = None,
        seed: int = 1,
        method: str = "bo",
        init: int | None = None,
    ) -> Study: ...
    def ask(self) -> tuple[int, list[float]]: ...
    def tell(self, trial: int, cost: float | None = None) -> None: ...
    @property
    def best(self) -> tuple[int, list[float], float] | None: ...
    def recommend(self) -> tuple[int, list[float], float] | None: ...
    def __len__(self) -> int: ...

@final
class RawDiagnosis:
    def document(self) -> str: ...
    def verdict_sentence(self) -> str: ...
    def finding_sentences(self) -> list[str]: ...
    def joints(self) -> list[str]: ...
    def extended(self) -> Model: ...
    def write_report(self, path: _Path) -> None: ...

def read_log(
    path: _Path, map: str | None, is_text: bool, joints: Sequence[str], content: bytes | None
) -> Log:
    """Reads a log of any known format."""

def record(
    model: _ModelLike, motion: str, duration: float, rate: float, noise: float, seed: int
) -> Log: ...
def diagnose(
    logs: list[Log],
    model: _ModelLike | None,
    reference: list[Log],
    validate: list[Log],
    seed: int,
    band_hz: float | None,
    anyway: bool,
    threads: int,
    progress: Callable[[str, float], object] | None,
) -> RawDiagnosis: ...
def estimate(
    log: Log, model: _ModelLike | None, residual: str, free: Log | None, touched: float | None, anyway: bool
) -> tuple[_Array, _Array, _Array, _Array, _Array, str]: ...
def ask(directory: _Path, given: str, anyway: bool, trial: int | None) -> tuple[str, str]: ...
def tell(directory: _Path, log: Log | None, trial: int | None, failed: str | None) -> str: ...
def withdraw(directory: _Path, trial: int, reason: str) -> str: ...
def give_up(directory: _Path, trial: int) -> None: ...
def campaign_state(directory: _Path) -> tuple[list[int], list[int], int]: ...
def tune(given: str, out: _Path | None, threads: int) -> tuple[str, Compensator | None]: ...
def command(words: list[str]) -> int: ...
