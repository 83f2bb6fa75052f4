"""The truth: the soil compaction of the whole field, from a file or drawn at random."""
from __future__ import annotations

import functools
import hashlib
import math
import sys
import warnings
from dataclasses import dataclass, field
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, Dict, Union

import numpy as np

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.shown import shown

from ..config import Crs, parse_size
from ..interpolation.kriging import neighbourhoods
from ..interpolation.kriging_system import KrigingSystem
from ..interpolation.variogram import Variogram, fit
from ..seeds import Purpose, generator
from .grid import FIELD_HEIGHT_M, FIELD_WIDTH_M, MAX_CELLS, Grid
from .readings import read_meuse, read_readings

if TYPE_CHECKING:
    from ..config import TrialConfig

SYNTHETIC_MEAN_KPA = 785.2975  # statistics of the interpolated compaction of the published study's field
SYNTHETIC_SD_KPA = 17.0323
SYNTHETIC_LENGTH_M = 65.0  # its autocorrelation at 40 m is then as in the published study's field, 0.6 to 0.8
PUBLISHED_SIZE = (FIELD_WIDTH_M, FIELD_HEIGHT_M)
PUBLISHED_READINGS = '9a06310d7d32033b0aa37d09e20161efe2de10cc1b7cc48c4ebc1f534c13fd09'  # SHA-256 of (lon, lat, kPa)
# The variogram that PyKrige fits to them, in degrees. Its eleventh digit depends on the processor.
PUBLISHED_VARIOGRAM = Variogram(psill=4213.91527, range_m=0.004399242190810138, nugget=9656.74710)
MANY_READINGS = 512  # up to this number, all readings decide each cell; above, the nearest ones do
NEAR_READINGS = 128
PLACE_DECIMALS = 3  # of metres: projections on different computers differ by less
SYNTHETIC_DECIMALS = 4  # of kPa: the libraries that draw it differ by less
WHOLE = 1e-9  # of a cell: a box that is longer than whole cells by this much needs no further cell
SYNTHETIC_NODE_M = 4.0  # distance of the nodes at which it is drawn; splines between them make it 16 times faster


@dataclass(frozen=True)
class Field:
    """Values over a grid.

    values: in the field's unit, float64, shape (rows, columns), row 0 in the south; read only.
    """

    values: np.ndarray = field(repr=False)
    grid: Grid
    source: str  # the text that was given to load_field
    unit: str = 'kPa'
    extent: str = ''  # for people: how its size was found; '' for synthetic fields

    def __post_init__(self) -> None:
        values = np.array(self.values, dtype=np.float64)
        if values.shape != self.grid.shape:
            raise ValueError(f'values must have the shape of the grid, {self.grid.shape}, got {values.shape}')
        if not np.isfinite(values).all():
            raise ValueError('values must be finite')
        values.flags.writeable = False
        object.__setattr__(self, 'values', values)

    @property
    def about(self) -> Dict[str, Union[float, str]]:
        """What a trial records about it, as plain values."""
        return {'source': self.source, 'unit': self.unit, 'width_m': self.grid.width_m, 'height_m': self.grid.height_m,
                'extent': self.extent}

    def value_at(self, x: float, y: float) -> float:
        """Return the reading at a place of the map frame [m]: the value of the cell that contains it."""
        return float(self.values[self.grid.cell_of(x, y)])

    def every_second_cell(self) -> Field:
        """Return the field with cells of twice the edge. Each has the value of its south-western quarter."""
        return Field(self.values[::2, ::2], _coarse(self.grid), self.source, self.unit, self.extent)


class DrawnField(Field):
    """A Field that is drawn when its values are first used, because drawing takes longer than all other work on it."""

    draw: Callable[..., Any]  # returns its values

    def __init__(self, grid: Grid, source: str, draw: Callable[..., Any]) -> None:
        """draw() returns the values, as in Field."""
        for name, value in (('grid', grid), ('source', source), ('unit', 'kPa'), ('extent', ''), ('draw', draw)):
            object.__setattr__(self, name, value)

    def draw_by(self, draw: Any) -> None:
        """Set another function to draw its values, if they are not drawn yet."""
        object.__setattr__(self, 'draw', draw)

    @functools.cached_property
    def values(self) -> np.ndarray:
        """As in Field."""
        return Field(self.draw(), self.grid, self.source).values

    def every_second_cell(self) -> DrawnField:
        """As in Field."""
        return DrawnField(_coarse(self.grid), self.source, lambda: self.values[::2, ::2])


def _coarse(grid: Grid) -> Grid:
    """Return the Grid with cells of twice the edge."""
    return Grid(-(-grid.rows // 2), -(-grid.columns // 2), 2.0 * grid.cell_m)


def field_of(config: TrialConfig) -> Field:
    """Return the Field of a TrialConfig; see load_field."""
    return load_field(config.field, config.cell_m, config.crs, config.size)


def load_field(source: str = 'synthetic', cell_m: float = 1, crs: Union[str, Crs] = Crs.DEGREES,
               size: Any = '') -> Union[DrawnField, Field]:
    """Return the Field that a text names.

    'synthetic' or 'synthetic:SEED': a random field of 324 x 220 m. 'csv:PATH': readings at lat, lon, or with crs metres
    at x, y. 'meuse': zinc [mg/kg] in the topsoil of the Meuse's flood plain (Rikken and Van Rijn, 1993), its box
    stretched to 324 x 220 m if no size is given.

    A csv field is as large as the readings' bounding box. With a size, 'WIDTHxHEIGHT' [m], the box is stretched to that
    size. The published study's readings are stretched to 324 x 220 m, as published, if no size is given. Field.extent
    describes this. Synthetic and stretched fields have cells of 1 m, or of 2 m (every second one); others of any
    cell_m.

    :raises ConfigurationError: if the text is none of these, the file cannot be used, or the values contradict each
        other.
    """
    kind, _, rest = source.partition(':')
    size = parse_size(size)
    if kind == 'synthetic':
        if size is not None:
            raise ConfigurationError(f"field {source!r}: only 'csv:PATH' and 'meuse' can be stretched over a size")
        made = _synthetic(source, rest or '1')
    elif kind == 'csv' and rest:
        readings = read_readings(rest, crs)
        size = size or (PUBLISHED_SIZE if is_published(readings) else None)
        if size is None:
            return interpolate_true(readings, source, cell_m, crs)
        made = interpolate(readings, source, size=size)
    elif source == 'meuse':
        made = interpolate(read_meuse(), source, 'mg/kg', size or PUBLISHED_SIZE)
    else:
        raise ConfigurationError("field must be 'synthetic', 'synthetic:SEED', 'meuse' or 'csv:PATH', "
                                 f'got {shown(source)}')
    if cell_m not in (1, 2):
        raise ConfigurationError(f'field {source!r}: cell_m must be 1 or 2 m, got {cell_m!r}')
    return made if cell_m == 1 else made.every_second_cell()


def interpolate(readings: np.ndarray, source: str, unit: str = 'kPa',
                size: Any = PUBLISHED_SIZE) -> Any:
    """Return the Field of readings (columns east, north, value), stretched to a size (width, height) [m].

    It is made as in the published study: the variogram is gaussian (for the study's own readings it is the published
    one), coordinates are float32 and count as planar in any unit, and the grid divides the readings' bounding box
    evenly, without its last edge.
    """
    grid = _checked(Grid(round(size[1]), round(size[0]), 1.0), source)
    exact = np.asarray(readings, dtype=np.float64)
    rounded = exact.astype(np.float32).astype(np.float64)
    points, values = rounded[:, :2], rounded[:, 2]
    east = np.linspace(exact[:, 0].min(), exact[:, 0].max(), grid.columns, endpoint=False, dtype=np.float32)
    north = np.linspace(exact[:, 1].min(), exact[:, 1].max(), grid.rows, endpoint=False, dtype=np.float32)
    variogram = PUBLISHED_VARIOGRAM if is_published(exact) else None
    mean = _krige(points, values, east.astype(np.float64), north.astype(np.float64), variogram)
    extent = f'bounding box of {np.ptp(exact[:, 0]):.6g} x {np.ptp(exact[:, 1]):.6g} (unit of its coordinates) ' \
             f'stretched over {grid.width_m:g} x {grid.height_m:g} m'
    return Field(mean, grid, source, unit, extent)


def interpolate_true(readings: np.ndarray, source: str, cell_m: float, crs: Union[str, Crs] = Crs.DEGREES) -> Field:
    """Return the Field of readings in its true size, by ordinary kriging in metres at the centres of its cells.

    The map frame's origin is the south-west corner of the readings' bounding box. Whole cells cover the box.
    """
    x, y, name = readings[:, 0], readings[:, 1], 'the file'
    if Crs(crs) is Crs.DEGREES:
        x, y, name = to_plane(x, y, source)
        x, y = np.round(x, PLACE_DECIMALS), np.round(y, PLACE_DECIMALS)
    grid = _checked(Grid(math.ceil(np.ptp(y) / cell_m - WHOLE), math.ceil(np.ptp(x) / cell_m - WHOLE), float(cell_m)),
                    source)
    points = np.column_stack((x - x.min(), y - y.min()))
    mean = _krige(points, readings[:, 2], grid.x_centres(), grid.y_centres())
    extent = f'bounding box of {np.ptp(x):.1f} x {np.ptp(y):.1f} m in true size; the map frame begins at x ' \
             f'{x.min():.3f}, y {y.min():.3f} m of {name}'
    return Field(mean, grid, source, extent=extent)


def _krige(points: np.ndarray, values: np.ndarray, x: np.ndarray, y: np.ndarray, variogram: Any = None) -> np.ndarray:
    """Return the kriged mean of readings on the grid that x and y span; by default with a Variogram fitted to them."""
    if variogram is None:
        width, height = np.ptp(points, axis=0)
        variogram = fit(points, values, math.sqrt(width * width + height * height))
    if variogram.sill == 0.0:
        return np.full((len(y), len(x)), float(values[0]))
    mean = np.empty((len(y), len(x)))
    most = len(points) if len(points) <= MANY_READINGS else NEAR_READINGS
    for rows, columns, near in neighbourhoods(points, x, y, most):
        mean[rows, columns] = KrigingSystem(points[near], values[near], variogram).mean(x[columns], y[rows])
    return mean


def is_published(readings: np.ndarray) -> bool:
    """Return whether these are the readings of the published study's field: the same numbers in the same order."""
    return hashlib.sha256(np.ascontiguousarray(readings, dtype='<f8').tobytes()).hexdigest() == PUBLISHED_READINGS


def _checked(grid: Grid, source: str) -> Grid:
    """Return the grid. :raises ConfigurationError: if it has no cells, or more than kriging allows."""
    if min(grid.shape) < 1 or grid.rows * grid.columns > MAX_CELLS:
        raise ConfigurationError(f'field {source!r}: {grid.width_m:g} x {grid.height_m:g} m in cells of '
                                 f'{grid.cell_m:g} m are {grid.columns} x {grid.rows} cells; 1 to {MAX_CELLS} in all '
                                 'are allowed: give another cell_m, or check the places')
    return grid


def _synthetic(source: str, seed_text: str) -> DrawnField:
    """Return a gaussian random field with the mean and standard deviation of the published study's field."""
    if not seed_text.isdecimal() or len(seed_text) > 19:
        raise ConfigurationError(f'field {shown(source)}: the seed must be a whole number of at most 19 digits')
    if find_spec('gstools') is None:
        raise ConfigurationError(f'field {shown(source)}: gstools, which draws it, is not installed')
    grid = Grid.of_field(1)
    return DrawnField(grid, source, lambda: _draw(grid, int(seed_text)))


def _draw(grid: Grid, field_seed: int) -> np.ndarray:
    """Return the values of a gaussian random field [kPa]."""
    import gstools  # takes 0.7 s to import, and nothing else needs it
    from scipy.interpolate import RectBivariateSpline
    model = gstools.Gaussian(dim=2, var=1.0, len_scale=SYNTHETIC_LENGTH_M)
    seed = int(generator(field_seed, Purpose.FIELD).integers(2**31))
    nodes_x, nodes_y = (np.arange(0.0, extent + SYNTHETIC_NODE_M, SYNTHETIC_NODE_M)
                        for extent in (grid.width_m, grid.height_m))
    nodes = gstools.SRF(model, seed=seed).structured([nodes_x, nodes_y]).T
    values = RectBivariateSpline(nodes_y, nodes_x, nodes)(grid.y_centres(), grid.x_centres())
    values = (values - values.mean()) / values.std()
    return np.round(SYNTHETIC_MEAN_KPA + SYNTHETIC_SD_KPA * values, SYNTHETIC_DECIMALS)


MAX_SPAN_DEG = 1.0  # about 111 km: no field is larger, and lengths are true to 0.01 %
DECIMALS = 6  # of the degrees of the projection's origin: 0.1 m


def _find_database(pyproj: Any) -> None:
    """Tell Debian's pyproj, which looks only below sys.prefix, where its database is if it runs in an environment."""
    folder = Path(sys.base_prefix) / 'share' / 'proj'
    try:
        pyproj.datadir.get_data_dir()
    except pyproj.exceptions.DataDirError:
        if (folder / 'proj.db').is_file():
            pyproj.datadir.set_data_dir(str(folder))


def to_plane(lon: Any, lat: Any, where: str) -> Any:
    """Return (x, y, name): metres east and north of the places' middle, and the projection's PROJ text.

    PROJ computes it: a transverse Mercator projection of WGS84 about the middle of the places, with scale 1 there. It
    is the projection of UTM, but with the field on its central meridian, so that y is north and lengths are true.

    lon, lat: arrays [degrees]. where: the file, for errors.
    :raises ConfigurationError: if the places span too much for a field, or pyproj is not installed.
    """
    if max(np.ptp(lon), np.ptp(lat)) > MAX_SPAN_DEG or np.abs(lat).max() > 89.0:
        raise ConfigurationError(f'{where}: the readings span {np.ptp(lat):g} x {np.ptp(lon):g} degrees of lat and lon'
                                 f'; a field has at most {MAX_SPAN_DEG:g}, between 89 degrees south and north')
    try:
        with warnings.catch_warnings():
            warnings.simplefilter('ignore')  # in a virtual environment it does not find its database
            import pyproj
        _find_database(pyproj)
    except ImportError:
        raise ConfigurationError(f'{where}: lat and lon need pyproj (python3-pyproj), which is not installed; or give '
                                 'x and y with crs metres') from None
    lat_0, lon_0 = (round(float(each.min() + each.max()) / 2.0, DECIMALS) for each in (lat, lon))
    text = f'+proj=tmerc +lat_0={lat_0:.{DECIMALS}f} +lon_0={lon_0:.{DECIMALS}f} +k=1 +ellps=WGS84 +units=m'
    x, y = pyproj.Proj(text)(lon, lat)
    return np.asarray(x), np.asarray(y), text
