"""Conversion of places from latitude and longitude to metres in a plane."""

import sys
import warnings
from pathlib import Path

import numpy as np

from move_base_abstract.common.errors import ConfigurationError

MAX_SPAN_DEG = 1.0  # about 111 km: no field is larger, and lengths are true to 0.01 %
DECIMALS = 6  # of the degrees of the projection's origin: 0.1 m


def _find_database(pyproj):
    """Tell Debian's pyproj, which looks only below sys.prefix, where its database is if it runs in an environment."""
    folder = Path(sys.base_prefix) / 'share' / 'proj'
    try:
        pyproj.datadir.get_data_dir()
    except pyproj.exceptions.DataDirError:
        if (folder / 'proj.db').is_file():
            pyproj.datadir.set_data_dir(str(folder))


def to_plane(lon, lat, where):
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
