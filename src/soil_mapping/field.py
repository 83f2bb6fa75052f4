"""The truth: soil compaction over the whole field, and where it comes from."""

from dataclasses import dataclass, field, replace

import numpy as np

from move_base_abstract.errors import ConfigurationError

from .grid import Grid
from .readings import read_meuse, read_readings
from .seeds import Purpose, generator
from .variogram import evaluate_mean, fit

SYNTHETIC_MEAN_KPA = 785.2975  # statistics of the interpolated compaction of the published study's field
SYNTHETIC_SD_KPA = 17.0323
SYNTHETIC_LENGTH_M = 65.0  # makes its autocorrelation at 40 m that of the published study's field, 0.6 to 0.8
SYNTHETIC_NODE_M = 4.0  # it is drawn at nodes so far apart and is smooth between them: 16 times faster


@dataclass(frozen=True)
class Field:
    """Values over a grid.

    values: kPa (the unit says so), float64, shape (rows, columns), row 0 in the south; read only.
    """

    values: np.ndarray = field(repr=False)
    grid: Grid
    source: str  # the text that load_field was given
    unit: str = 'kPa'

    def __post_init__(self):
        values = np.array(self.values, dtype=np.float64)
        if values.shape != self.grid.shape:
            raise ValueError(f'values must have the shape of the grid, {self.grid.shape}, got {values.shape}')
        if not np.isfinite(values).all():
            raise ValueError('values must be finite')
        values.flags.writeable = False
        object.__setattr__(self, 'values', values)

    def value_at(self, x, y):
        """Return the reading at a place of the map frame [m]: the value of the cell that holds it."""
        return float(self.values[self.grid.cell_of(x, y)])

    def every_second_cell(self):
        """Return the field of cells twice as large, of which each has the value of its south-western quarter."""
        coarse = Grid(-(-self.grid.rows // 2), -(-self.grid.columns // 2), 2.0 * self.grid.cell_m)
        return replace(self, values=self.values[::2, ::2], grid=coarse)


def load_field(source='synthetic', cell_m=1):
    """Return the Field that a text names, 324 x 220 m in cells of 1 m, or of 2 m (every second one).

    'synthetic' or 'synthetic:SEED': a random field; 'csv:PATH': readings at lat, lon; 'meuse': zinc [mg/kg] in the
    topsoil of the Meuse's flood plain (Rikken and Van Rijn, 1993), its box stretched over the field.

    :raises ConfigurationError: if the text is none of these, or the file cannot be used.
    """
    kind, _, rest = source.partition(':')
    if kind == 'synthetic':
        made = _synthetic(source, rest or '1')
    elif kind == 'csv' and rest:
        made = interpolate(read_readings(rest), source)
    elif source == 'meuse':
        made = interpolate(read_meuse(), source, 'mg/kg')
    else:
        raise ConfigurationError(f"field must be 'synthetic', 'synthetic:SEED', 'meuse' or 'csv:PATH', got {source!r}")
    if cell_m not in (1, 2):
        raise ConfigurationError(f'cell_m must be 1 or 2 m, got {cell_m!r}')
    return made if cell_m == 1 else made.every_second_cell()


def interpolate(readings, source, unit='kPa'):
    """Return the Field of readings (columns east, north, value), by ordinary kriging to the field's grid.

    As the published study did it: the variogram is gaussian and fitted by PyKrige, coordinates are float32 and taken as
    planar whatever their unit, and the grid divides the readings' bounding box evenly, its last edge excluded.
    """
    grid = Grid.of_field(1)
    exact = np.asarray(readings, dtype=np.float64)
    rounded = exact.astype(np.float32).astype(np.float64)
    points, values = rounded[:, :2], rounded[:, 2]
    east = np.linspace(exact[:, 0].min(), exact[:, 0].max(), grid.columns, endpoint=False, dtype=np.float32)
    north = np.linspace(exact[:, 1].min(), exact[:, 1].max(), grid.rows, endpoint=False, dtype=np.float32)
    mean = evaluate_mean(points, values, fit(points, values), east.astype(np.float64), north.astype(np.float64))
    return Field(mean, grid, source, unit)


def _synthetic(source, seed_text):
    """Return a gaussian random field with the mean and the standard deviation of the published study's, exactly."""
    if not seed_text.isdecimal():
        raise ConfigurationError(f'field {source!r}: the seed must be a whole number >= 0')
    import gstools  # takes 0.7 s to import, and nothing else needs it
    from scipy.interpolate import RectBivariateSpline
    grid = Grid.of_field(1)
    model = gstools.Gaussian(dim=2, var=1.0, len_scale=SYNTHETIC_LENGTH_M)
    seed = int(generator(int(seed_text), Purpose.FIELD).integers(2**31))
    nodes_x, nodes_y = (np.arange(0.0, extent + SYNTHETIC_NODE_M, SYNTHETIC_NODE_M)
                        for extent in (grid.width_m, grid.height_m))
    nodes = gstools.SRF(model, seed=seed).structured([nodes_x, nodes_y]).T
    values = RectBivariateSpline(nodes_y, nodes_x, nodes)(grid.y_centres(), grid.x_centres())
    values = (values - values.mean()) / values.std()
    return Field(SYNTHETIC_MEAN_KPA + SYNTHETIC_SD_KPA * values, grid, source)
