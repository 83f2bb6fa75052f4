"""How the report writes numbers, draws scales and chooses colours."""

import math

import pytest

from experiment_folder import plain
from move_base_abstract.common.shown import listed
from move_base_abstract_experiments.report.colours import PALETTE, palette
from move_base_abstract_experiments.report.design import Metric
from move_base_abstract_experiments.report.intervals import NOTHING, Estimate
from move_base_abstract_experiments.report.pictures import axis
from move_base_abstract_experiments.report.wording import (
    Scale,
    digits,
    duration,
    probability,
    scale_of,
    shortened,
    with_interval as text_of,
)


@pytest.mark.parametrize(('value', 'low', 'high', 'text'), [
    (12.13, 9.05, 15.21, '12 s (9 to 15 s)'),
    (-0.31, -1.22, 0.6, '−0.3 s (−1.2 to 0.6 s)'),
    (612.3, 598.1, 626.5, '612 s (598 to 626 s)'),
    (12345.6, 11945.6, 12745.6, '12,300 s (11,900 to 12,700 s)'),
    (0.0951, 0.0412, 0.149, '0.10 s (0.04 to 0.15 s)'),
    (5.0, 0.04, 9.96, '5.00 s (0.04 to 9.96 s)'),  # a bound that is not 0 is not shown as 0
    (2e-9, -1e-9, 5e-9, '2·10⁻⁹ s (−1·10⁻⁹ to 5·10⁻⁹ s)'),
    (14400.0, 14400.0, 14400.0, '14,400 s in all')])
def test_numbers_have_the_digits_that_their_intervals_carry(value, low, high, text):
    estimate = Estimate(value, low, high, 30, 'constant' if low == high else 't')
    assert plain(text_of(estimate, Scale(1.0, 's'))) == text


def test_without_an_interval_there_are_four_digits():
    assert plain(text_of(Estimate(612.3456, math.nan, math.nan, 1, 'none'), Scale(1.0, 's'))) == '612.3 s'
    assert text_of(NOTHING, Scale(1.0, 's')) == '–'


@pytest.mark.parametrize(('value', 'text'), [(0.0, '0'), (-0.0, '0'), (40.0, '40'), (57013489284.0, '57,013,489,284'),
                                             (0.00012345, '0.0001234'), (-2.5e-7, '−2.5·10⁻⁷'), (math.nan, '–')])
def test_digits(value, text):
    assert digits(value) == text


def test_units_are_those_that_read_best():
    assert scale_of(Metric('a', 'A', 'ns', None), 57013489284.0) == (1e-9, 's')
    assert scale_of(Metric('a', 'A', 's', None), 3600.0) == (1.0, 's')
    assert scale_of(Metric('a', 'A', 'm2', None), 3.0) == (1.0, 'm²')
    assert scale_of(Metric('a', 'A', '', None, is_share=True), 1.0) == (100.0, '%')


def test_small_words():
    assert [plain(duration(each)) for each in (12.3, 600.0, 7200.0, 864000.0)] == ['12.3 s', '10 min', '2 h', '10 days']
    assert listed(['a']) == 'a' and listed(['a', 'b', 'c']) == 'a, b and c' and listed([]) == ''
    assert [plain(probability(each)) for each in (1e-5, 0.0234, 0.5)] == ['< 0.001', '= 0.023', '= 0.50']
    assert shortened('auction', 9) == 'auction'
    assert len(shortened('x' * 300, 9)) <= 9 and len(shortened('日' * 30, 9)) <= 5


@pytest.mark.parametrize('values', [[3.0], [0.0], [-5.0, -5.0], [1e-9, 2e-9], [0.0, 1e12], [600.1, 600.2]])
def test_axes_hold_their_values_and_have_round_numbers(values):
    found = axis(values)
    assert all(0.0 < found.share(each) < 1.0 for each in values)
    assert 2 <= len(found.ticks) <= 7
    assert len({text for _, text in found.ticks}) == len(found.ticks)


def linear(colour):
    channels = [int(colour[at:at + 2], 16) / 255.0 for at in (1, 3, 5)]
    return [each / 12.92 if each <= 0.04045 else ((each + 0.055) / 1.055) ** 2.4 for each in channels]


def luminance(colour):
    return sum(weight * each for weight, each in zip((0.2126, 0.7152, 0.0722), linear(colour)))


@pytest.mark.parametrize('count', [1, 6, 12])
def test_colours_stand_out_from_both_pages(count):
    for mode, page in ((0, '#ffffff'), (1, '#15181c')):
        for colour in palette(count):
            dark, light = sorted((luminance(colour[mode]), luminance(page)))
            assert (light + 0.05) / (dark + 0.05) >= 3.0


#: linear RGB as seen without red, green, blue cones: Machado, Oliveira, Fernandes 2009, table 1, severity 1.0
BLIND = (((0.152286, 1.052583, -0.204868), (0.114503, 0.786281, 0.099216), (-0.003882, -0.048116, 1.051998)),
         ((0.367322, 0.860646, -0.227968), (0.280085, 0.672501, 0.047413), (-0.011820, 0.042940, 0.968881)),
         ((1.255528, -0.076749, -0.178779), (-0.078411, 0.930809, 0.147602), (0.004733, 0.691367, 0.303900)),
         ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)))


def lab(rgb):
    rgb = [min(1.0, max(0.0, each)) for each in rgb]
    rows = ((0.4124, 0.3576, 0.1805, 0.9505), (0.2126, 0.7152, 0.0722, 1.0), (0.0193, 0.1192, 0.9505, 1.089))
    x, y, z = (sum(weight * each for weight, each in zip(row, rgb)) / row[3] for row in rows)
    x, y, z = (each ** (1.0 / 3.0) if each > 0.008856 else 7.787 * each + 16.0 / 116.0 for each in (x, y, z))
    return 116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)


@pytest.mark.parametrize('mode', [0, 1])
@pytest.mark.parametrize('matrix', BLIND)
def test_colours_are_told_apart_also_without_some_cones(mode, matrix):
    seen = [lab([sum(weight * each for weight, each in zip(row, linear(pair[mode]))) for row in matrix])
            for pair in PALETTE]
    assert min(math.dist(one, two) for place, one in enumerate(seen) for two in seen[:place]) >= 20.0
