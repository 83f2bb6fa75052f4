"""A field of the user's own has the size of its data; only what is said is stretched."""

from pathlib import Path

import numpy as np
import pytest

from move_base_abstract.common.errors import ConfigurationError
from soil_mapping.config import TrialConfig
from soil_mapping.ground_truth.field import field_of, load_field
from soil_mapping.mission.coarse_cells import coarse_cells

ROWS = [(0.0, 0.0), (120.0, 0.0), (0.0, 60.5), (120.0, 60.5), (50.0, 20.0), (90.0, 45.0)]


def write(path, header, rows):
    path.write_text('\n'.join([header, *(','.join(map(repr, row)) for row in rows)]) + '\n')
    return f'csv:{path}'


def in_metres(path):
    return write(path, 'x,y,ec', [(600000.0 + x, 5700000.0 + y, 30.0 + 0.1 * x - 0.05 * y) for x, y in ROWS])


def test_metres_are_kept_and_whole_cells_cover_the_readings(tmp_path):
    source = in_metres(tmp_path / 'xy.csv')
    field = load_field(source, crs='metres')
    assert field.values.shape == (61, 120)
    assert 'bounding box of 120.0 x 60.5 m in true size' in field.extent
    assert 'x 600000.000, y 5700000.000' in field.extent
    assert load_field(source, 5.0, 'metres').values.shape == (13, 24)
    assert np.abs(field.value_at(50.0, 20.0) - 34.0) < 0.2


def test_degrees_become_metres_of_the_ellipsoid(tmp_path):
    """At 45 degrees a degree is 111131.8 m of latitude and 78846.8 m of longitude (WGS84)."""
    rows = [(45.0, 7.0, 1.0), (45.002, 7.0, 2.0), (45.0, 7.003, 3.0), (45.002, 7.003, 5.0), (45.001, 7.001, 4.0)]
    field = load_field(write(tmp_path / 'll.csv', 'lat,lon,ec', rows))
    assert field.grid.height_m == 223.0  # 222.26 m, and whole cells
    assert field.grid.width_m == 237.0  # 236.54 m
    assert '+proj=tmerc' in field.extent


def test_a_field_is_stretched_only_where_its_size_is_given_and_says_so(tmp_path):
    source = in_metres(tmp_path / 'xy.csv')
    config = TrialConfig(field=source, crs='metres', size='200x100')
    field = field_of(config)
    assert field.values.shape == (100, 200)
    assert 'stretched over 200 x 100 m' in field.extent
    assert field.about['width_m'] == 200.0


def test_the_published_readings_are_taken_in_the_published_size_and_other_ones_are_not(compaction_source, tmp_path):
    field = load_field(compaction_source)
    assert (field.grid.width_m, field.grid.height_m) == (324.0, 220.0)
    assert 'stretched over 324 x 220 m' in field.extent
    lines = Path(compaction_source.partition(':')[2]).read_text(encoding='utf-8').splitlines()
    (tmp_path / 'fewer.csv').write_text('\n'.join(lines[:100] + lines[101:]) + '\n')  # none at the edge is missing
    other = load_field(f'csv:{tmp_path / "fewer.csv"}')
    assert (other.grid.width_m, other.grid.height_m) == (330.0, 240.0)  # 329.9 x 239.1 m
    assert load_field(f'csv:{tmp_path / "fewer.csv"}', size='324x220').values.shape == (220, 324)


@pytest.mark.parametrize('options, complaint', [
    ({'size': '324'}, "size must be 'WIDTHxHEIGHT'"), ({'size': '0x5'}, "size must be 'WIDTHxHEIGHT'"),
    ({'size': 3}, "size must be 'WIDTHxHEIGHT'"), ({'crs': 'feet'}, "crs: got 'feet'; allowed: degrees, metres"),
    ({'cell_m': 0.01}, '1 to 1000000 in all are allowed'), ({'size': '99999x99999'}, '1 to 1000000 in all'),
    ({'size': '200x100', 'cell_m': 3}, 'cell_m must be 1 or 2 m'), ({'field': 'synthetic', 'size': '9x9'}, 'only'),
    ({'crs': 'degrees'}, 'no column lon, lat')])
def test_what_makes_no_field_is_refused_with_its_reason(tmp_path, options, complaint):
    with pytest.raises(ConfigurationError, match=complaint):
        field_of(TrialConfig(**{'field': in_metres(tmp_path / 'xy.csv'), 'crs': 'metres', **options}))


def test_readings_that_span_degrees_are_no_field(tmp_path):
    rows = [(45.0, 7.0, 1.0), (45.0, 9.0, 2.0), (46.0, 8.0, 3.0)]
    with pytest.raises(ConfigurationError, match='a field has at most 1'):
        load_field(write(tmp_path / 'll.csv', 'lat,lon,ec', rows))


def test_the_published_clusters_are_refused_for_another_size(tmp_path):
    config = TrialConfig(field=in_metres(tmp_path / 'xy.csv'), crs='metres', coarse_cells='clusters')
    with pytest.raises(ConfigurationError, match='take squares'):
        coarse_cells(config, field_of(config).grid)
