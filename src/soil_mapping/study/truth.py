"""The field of a trial, made once per process: making it takes longer than most else."""

import functools

from soil_mapping.field import load_field


def truth_of(config):
    """Return the Field of a TrialConfig."""
    return _load(config.field, config.cell_m, config.crs, config.size)


@functools.lru_cache(maxsize=4)
def _load(source, cell_m, crs, size):
    return load_field(source, cell_m, crs, size)
