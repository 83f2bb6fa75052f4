"""The field of a trial, made once per process: making it takes longer than most else."""

import functools

from soil_mapping.field import load_field
from soil_mapping.inputs import inputs_of


def truth_of(config):
    """Return the Field of a TrialConfig."""
    digests(config.field)  # before it is read
    return _load(config.field, config.cell_m, config.crs, config.size)


@functools.lru_cache(maxsize=None)
def digests(field, charge='none'):
    """Return inputs.inputs_of these, looked at once per process, as the field is."""
    return inputs_of(field, charge)


@functools.lru_cache(maxsize=4)
def _load(source, cell_m, crs, size):
    return load_field(source, cell_m, crs, size)
