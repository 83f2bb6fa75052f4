import numpy as np
import pytest

from move_base_abstract.common.errors import ConfigurationError
from soil_mapping.ground_truth.field import DrawnField, Field, load_field
from soil_mapping.ground_truth.grid import Grid
from soil_mapping.ground_truth.readings import read_meuse, read_readings


def statistics(field):
    values = field.values
    return [values.min(), values.max(), values.mean(), values.std()]


def test_the_published_field_has_its_check_figures_on_both_grids(compaction_source):
    fine = load_field(compaction_source)
    assert fine.values.shape == (220, 324)
    assert statistics(fine) == pytest.approx([758.804, 847.810, 785.2975, 17.0323], abs=6e-4)
    coarse = load_field(compaction_source, cell_m=2)
    assert coarse.values.shape == (110, 162)
    assert statistics(coarse) == pytest.approx([758.80, 847.54, 785.25, 17.02], abs=6e-3)


def test_the_field_equals_pykrige_at_some_rows(compaction_source):
    from pykrige.ok import OrdinaryKriging
    field = load_field(compaction_source)
    readings = read_readings(compaction_source.partition(':')[2])
    lon, lat, value = readings.astype(np.float32).T
    ordinary = OrdinaryKriging(lon, lat, value, variogram_model='gaussian')
    x = np.linspace(readings[:, 0].min(), readings[:, 0].max(), 324, endpoint=False).astype(np.float32)
    y = np.linspace(readings[:, 1].min(), readings[:, 1].max(), 220, endpoint=False).astype(np.float32)
    rows = [0, 77, 219]
    mean, _ = ordinary.execute('grid', x, y[rows])
    assert field.values[rows] == pytest.approx(np.asarray(mean), rel=1e-6)


def test_a_reading_is_the_value_of_the_cell_that_holds_the_place():
    grid = Grid(2, 3, 2.0)
    field = Field(np.arange(6.0).reshape(2, 3), grid, 'six cells')
    assert [field.value_at(*place) for place in ((0.0, 0.0), (1.99, 1.99), (2.0, 1.0), (5.9, 0.1), (0.5, 2.0))] == \
        [0.0, 0.0, 1.0, 2.0, 3.0]
    assert field.value_at(-1.0, 99.0) == 3.0  # outside: the nearest cell
    assert field.every_second_cell().values.tolist() == [[0.0, 2.0]]
    with pytest.raises(ValueError, match='read-only'):
        field.values[0, 0] = 1.0


def test_the_synthetic_field_has_the_published_mean_and_spread_and_depends_on_its_seed_alone():
    field = load_field('synthetic')
    assert field.values.shape == (220, 324)
    assert statistics(field)[2:] == pytest.approx([785.2975, 17.0323], abs=1e-5)
    assert np.array_equal(field.values, load_field('synthetic:1').values)
    assert not np.array_equal(field.values, load_field('synthetic:2').values)
    steps = np.abs(np.diff(field.values, axis=1))
    assert steps.max() < 2.0  # kPa from one metre to the next: smooth


def test_the_meuse_readings_are_the_published_ones():
    readings = read_meuse()
    assert readings.shape == (155, 3)
    assert readings[0].tolist() == [181072.0, 333611.0, 1022.0]
    assert readings.min(axis=0).tolist() == [178605.0, 329714.0, 113.0]
    assert readings.max(axis=0).tolist() == [181390.0, 333611.0, 1839.0]
    assert readings[:, 2].sum() == 72806.0


def test_the_meuse_field_is_zinc_on_the_same_grid():
    field = load_field('meuse')
    assert field.unit == 'mg/kg'
    assert field.values.shape == (220, 324)
    assert statistics(field) == pytest.approx([83.669, 1888.985, 658.381, 414.869], abs=1e-3)


@pytest.mark.parametrize('text, complaint', [
    ('lat,value\n1,2\n', '{}: no column lon'),
    ('lat,lon,v\n1,2,3\n1,3,nan\n', "{}: line 3: v: got 'nan'; allowed: a finite number"),
    ('lat,lon,v\n1,2,3\n1,3,3\n', '{}: got 2; allowed: 3 to 5000 readings'),
    ('lat,lon,v\n1,2,3\n2,3,3\n1,2.0,4\n', '{}: line 4: got (2.0, 1.0); allowed: places that differ; it is also that'),
    ('lat,lon,v\n1,2,1\n1,3,1e308\n1,4,1\n', '{}: line 3: got 1e+308; allowed: numbers in -1e+12..1e+12'),
    ('lat,lon,v\n1,2,"' + '1' * 140000 + '"\n', '{}: cannot be read as CSV: field larger than field limit'),
    ('lat,lon,v\n' + ''.join(f'{n / 100},2,3\n' for n in range(5001)), '{}: got 5001; allowed: 3 to 5000'),
])
def test_a_bad_csv_is_refused_with_file_and_line(tmp_path, text, complaint):
    path = tmp_path / 'readings.csv'
    path.write_text(text)
    with pytest.raises(ConfigurationError) as caught:
        load_field(f'csv:{path}')
    assert str(caught.value).startswith(complaint.format(path))
    assert len(str(caught.value)) < len(str(path)) + 300


@pytest.mark.parametrize('values', [(1e12, -1e12, 0.0), (1e-320, 0.0, 2e-320), (9e11, 9e11 + 1.0, 9e11)])
def test_values_at_the_ends_of_what_is_allowed_make_a_field(tmp_path, values):
    path = tmp_path / 'readings.csv'
    rows = [f'{n / 1e3},{2 * n % 3 / 1e3},{value!r}\n' for n, value in enumerate(values)]
    path.write_text('lat,lon,v\n' + ''.join(rows))
    assert np.isfinite(load_field(f'csv:{path}').values).all()


@pytest.mark.parametrize('source', ['', 'mouse', 'csv:', 'meuse:1', 'synthetic:x', 'synthetic:-1', 'csv:/none.csv',
                                    'synthetic:' + '1' * 5001, 'x' * 5001])
def test_an_unknown_field_is_refused(source):
    with pytest.raises(ConfigurationError):
        load_field(source)


def test_a_synthetic_field_is_drawn_when_its_values_are_asked_for_and_once():
    drawn = []
    grid = Grid(2, 3, 2.0)
    field = DrawnField(grid, 'six cells', lambda: drawn.append(1) or np.arange(6.0).reshape(2, 3))
    coarse = field.every_second_cell()
    assert (field.grid, field.about['width_m'], coarse.grid.shape, drawn) == (grid, 6.0, (1, 2), [])
    assert coarse.values.tolist() == [[0.0, 2.0]]
    assert field.value_at(0.0, 2.0) == 3.0
    assert drawn == [1]


def test_a_field_that_cannot_be_drawn_is_refused_before(monkeypatch):
    monkeypatch.setattr('soil_mapping.ground_truth.field.find_spec', lambda name: None)
    with pytest.raises(ConfigurationError, match='gstools, which draws it, is not installed'):
        load_field('synthetic:7')
