"""The package as such: the command, types, start-up."""

import importlib.util
import pathlib
import signal
import subprocess
import sys
import time

import pytest
import tribo


def test_the_command_runs_and_its_exit_codes_are_kept(command):
    assert command("--version").stdout.strip() == f"tribo {tribo.__version__}"
    wrong = command("estimate", "no_such.csv", check=False)
    assert wrong.returncode == 2 and "no_such.csv" in wrong.stderr


@pytest.mark.skipif(sys.platform == "win32", reason="signals of POSIX")
def test_control_c_reaches_the_command(tmp_path):
    words = [sys.executable, "-m", "tribo", "tune", "--trials", "500", "--strategy", "random", "--out", "campaign"]
    running = subprocess.Popen(words, cwd=tmp_path, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    while not (tmp_path / "campaign" / "trials").is_dir() and running.poll() is None:
        time.sleep(0.05)
    running.send_signal(signal.SIGINT)
    _, said = running.communicate(timeout=60)
    assert "go on with: tribo tune --resume" in said


def test_everything_has_a_docstring():
    for name in tribo.__all__:
        item = getattr(tribo, name)
        if name not in {"PRESETS", "__version__"}:
            assert item.__doc__, name
            for part, member in vars(item).items() if isinstance(item, type) else []:
                if not part.startswith("_") and callable(member):
                    assert member.__doc__, f"{name}.{part}"


def test_types_are_strict():
    if importlib.util.find_spec("mypy") is None:
        pytest.skip("SKIPPED: no mypy here")
    package = pathlib.Path(tribo.__file__).parent
    words = [sys.executable, "-m", "mypy", "--strict", "--no-error-summary", str(package)]
    done = subprocess.run(words, capture_output=True, text=True, check=False, cwd=package.parent)
    complaints = [line for line in done.stdout.splitlines() if ": error:" in line and "stubs" not in line]
    assert complaints == [], done.stdout + done.stderr


def test_the_stub_has_what_the_module_has():
    if importlib.util.find_spec("mypy") is None:
        pytest.skip("SKIPPED: no mypy here")
    done = subprocess.run(
        [sys.executable, "-m", "mypy.stubtest", "tribo._tribo", "--ignore-missing-stub", "--ignore-disjoint-bases"],
        capture_output=True,
        text=True,
        check=False,
        cwd=pathlib.Path(tribo.__file__).parent.parent,
    )
    assert done.returncode == 0, done.stdout
