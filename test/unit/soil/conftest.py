"""What the tests of the study share: the published data where it is named, and small fields and results."""

import os
from pathlib import Path

import numpy as np
import pytest

from soil_mapping.config import TrialConfig
from soil_mapping.ground_truth.field import Field
from soil_mapping.ground_truth.grid import Grid

NAME = 'SOIL_MAPPING_DATA'


@pytest.fixture(scope='session')
def data_folder():
    if not os.environ.get(NAME):
        pytest.skip(f'{NAME} names no folder with the published data')
    return Path(os.environ[NAME])


@pytest.fixture(scope='session')
def compaction_source(data_folder):
    return f'csv:{data_folder / "riseholme_compaction_0cm_kpa.csv"}'


def mesa_model():
    """Return the module, or skip where there is no Mesa: on Python below 3.11 (Debian 11)."""
    pytest.importorskip('mesa', reason='Mesa is not installed; it needs Python 3.11')
    from soil_mapping.mesa_models import mesa_model as module
    return module


def hill(cell_m=2):
    """Return a smooth Field without randomness."""
    grid = Grid.of_field(cell_m)
    x, y = np.meshgrid(grid.x_centres() / 324.0, grid.y_centres() / 220.0)
    return Field(800.0 + 30.0 * np.sin(3.0 * x) * np.cos(4.0 * y + x), grid, 'hill')


@pytest.fixture(name='hill', scope='session')
def hill_fixture():
    return hill()


@pytest.fixture(scope='session')
def result(hill):
    """One short trial, with maps."""
    run_mesa_trial = mesa_model().run_mesa_trial
    config = TrialConfig(field='hill', cell_m=2, budget_s=60.0, allocation='ssi', sampling='dynamic')
    return run_mesa_trial(config, 7, truth=hill)
