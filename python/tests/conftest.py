"""What the tests share."""

import pathlib
import subprocess
import sys

import numpy as np
import pytest
import tribo


@pytest.fixture(scope="session")
def friction() -> dict[str, list[float]]:
    """Coulomb and viscous friction of the model that logs are held against."""
    return {"coulomb": [0.6, 0.9, 0.55, 0.8, 0.4, 0.3, 0.35], "viscous": [0.9, 1.2, 0.7, 0.9, 0.4, 0.3, 0.3]}


@pytest.fixture(scope="session")
def model(friction):
    """A Panda with friction."""
    return tribo.Model.bare("panda").with_friction(**friction)


@pytest.fixture(scope="session")
def loaded_log(model):
    """A log of that Panda with a payload that the model does not know."""
    return tribo.record(model.with_payload(0.8, com=[0.0, 0.01, 0.06]), duration=20.0, seed=3)


@pytest.fixture
def random():
    """Numbers that are the same in every run."""
    return np.random.default_rng(7)


@pytest.fixture
def command(tmp_path):
    """Runs the `tribo` command of the package."""

    def run(*words, check=True):
        done = subprocess.run(
            [sys.executable, "-m", "tribo", *map(str, words)], cwd=tmp_path, capture_output=True, text=True, check=False
        )
        if check:
            assert done.returncode == 0, done.stderr
        return done

    return run


HERE = pathlib.Path(__file__).parent
