"""What functions take for a log or a model."""

from __future__ import annotations

import os
from collections.abc import Iterable
from typing import Any, Union

from tribo._tribo import Arm, Log, Model, read_log

Path = Union[str, "os.PathLike[str]"]
"""Name of a file."""

ModelLike = Union[Model, Arm, Path]
"""A model, an arm without friction, the path of a model file or robot description, or the name of a preset."""

LogLike = Union[Log, Path]
"""A log, or the path of one."""


def as_log(log: LogLike) -> Log:
    """The log, read where it is a path."""
    return log if isinstance(log, Log) else read_log(log, None, False, [], None)


def as_logs(logs: LogLike | Iterable[LogLike]) -> list[Log]:
    """The logs, read where they are paths."""
    if isinstance(logs, (Log, str, os.PathLike)):
        return [as_log(logs)]
    return [as_log(log) for log in logs]


def plain(value: Any) -> Any:
    """Settings as JSON has them: paths are strings, NumPy numbers and arrays plain ones."""
    if hasattr(value, "__fspath__"):
        return os.fspath(value)
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"{value!r} is no setting")
