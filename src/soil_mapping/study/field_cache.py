"""The field of a trial, made once per process: making it takes longer than most else."""

import functools
import os

import numpy as np

from move_base_abstract.common import processes
from soil_mapping.ground_truth.field import DrawnField, load_field
from soil_mapping.ground_truth.inputs import inputs_of


def truth_of(config):
    """Return the Field of a TrialConfig."""
    digests(config.field)  # before it is read
    return _load(config.field, config.cell_m, config.crs, config.size)


def draw_ahead(config):
    """Have a process of its own draw the field of a TrialConfig, if it is drawn, until its values are asked for.

    So that this process can import what else a trial needs, and start its nodes: all of it takes about as long.
    """
    field = truth_of(config)
    if not isinstance(field, DrawnField):
        return
    draw, (ready, done) = field.draw, os.pipe()

    def body():
        os.close(ready)
        with open(done, 'wb') as stream:
            stream.write(np.ascontiguousarray(draw(), dtype=np.float64).tobytes())
        return 0

    def read():
        with open(ready, 'rb') as stream:
            content = stream.read()
        shape = field.grid.shape
        if len(content) != 8 * shape[0] * shape[1]:  # it was killed, or out of memory
            return draw()
        return np.frombuffer(content).reshape(shape)
    processes.fork(body, os.devnull)
    os.close(done)
    field.draw_by(read)


@functools.lru_cache(maxsize=None)
def digests(field, charge='none'):
    """Return inputs.inputs_of these, looked at once per process, as the field is."""
    return inputs_of(field, charge)


@functools.lru_cache(maxsize=4)
def _load(source, cell_m, crs, size):
    return load_field(source, cell_m, crs, size)
