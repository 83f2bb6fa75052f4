"""The field of a trial, made once in each process, because it is one of the slowest parts of a trial."""
from __future__ import annotations

import functools
import os
from typing import TYPE_CHECKING, Any, Dict

import numpy as np

from move_base_abstract.common import processes
from soil_mapping.ground_truth.field import DrawnField, load_field
from soil_mapping.ground_truth.inputs import inputs_of

if TYPE_CHECKING:
    from ..config import Crs, TrialConfig


def truth_of(config: TrialConfig) -> DrawnField:
    """Return the Field of a TrialConfig."""
    digests(config.field)  # before the file is read
    return _load(config.field, config.cell_m, config.crs, config.size)


def draw_ahead(config: Any) -> None:
    """Draw the field of a TrialConfig in another process, if it is a random one, until its values are needed.

    Meanwhile this process can import all that a trial needs, and start its nodes, which takes about as long.
    """
    field = truth_of(config)
    if not isinstance(field, DrawnField):
        return
    draw, (ready, done) = field.draw, os.pipe()

    def body() -> Any:
        os.close(ready)
        with open(done, 'wb') as stream:
            stream.write(np.ascontiguousarray(draw(), dtype=np.float64).tobytes())
        return 0

    def read() -> Any:
        with open(ready, 'rb') as stream:
            content = stream.read()
        shape = field.grid.shape
        if len(content) != 8 * shape[0] * shape[1]:  # the process was killed, or out of memory
            return draw()
        return np.frombuffer(content).reshape(shape)
    processes.fork(body, os.devnull)
    os.close(done)
    field.draw_by(read)


@functools.lru_cache(maxsize=None)
def digests(field: str, charge: str = 'none') -> Dict[Any, Any]:
    """Return inputs_of these arguments, read once in each process, like the field."""
    return inputs_of(field, charge)


@functools.lru_cache(maxsize=4)
def _load(source: str, cell_m: float, crs: Crs, size: str) -> Any:
    return load_field(source, cell_m, crs, size)
