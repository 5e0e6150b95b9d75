"""The notebooks of `examples` run from top to bottom, as does the example of the README."""

import importlib.util
import json
import pathlib
import re

import pytest

HERE = pathlib.Path(__file__).parent
NOTEBOOKS = sorted((HERE.parent / "examples").glob("*.ipynb"))


def test_there_are_notebooks():
    assert len(NOTEBOOKS) >= 3


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(path, tmp_path, monkeypatch):
    notebook = json.loads(path.read_text(encoding="utf-8"))
    cells = ["".join(cell["source"]) for cell in notebook["cells"] if cell["cell_type"] == "code"]
    needed = {name for cell in cells for name in re.findall(r"^(?:import|from) (\w+)", cell, re.M)}
    missing = sorted(name for name in needed if importlib.util.find_spec(name) is None)
    if missing:
        pytest.skip(f"SKIPPED: no {', '.join(missing)} here")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    names = {"__name__": "__main__"}
    for cell in cells:
        exec(compile(cell, f"{path.name}", "exec"), names)  # noqa: S102


def test_the_readme_runs():
    text = (HERE.parent / "README.md").read_text(encoding="utf-8")
    blocks = re.findall(r"```python\n(.*?)```", text, re.S)
    assert blocks
    for block in blocks:
        exec(compile(block, "README.md", "exec"), {"__name__": "__main__"})  # noqa: S102
