"""The section ``encounters`` of a calibration, fitted to recordings of several robots, and judged on maps left out."""
from typing import NamedTuple

import numpy as np

from move_base_abstract.common.bounded_yaml import load_yaml_file
from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.motion.calibration import ENCOUNTERS, calibration_file, read_calibration

from .encounter_fit import fit_encounters, log_likelihoods, mean_seconds
from .law import Durations
from .meetings import met_legs
from .recordings import read_recordings

RADIUS = 3.0  # m, of an encounter, where the calibration has no section yet


class MapScore(NamedTuple):
    """How well the legs of a map that met are predicted by a fit to all other maps, with encounters and without.

    Sums of logarithms of densities, and sums of durations, measured by predicted.
    """

    map: str
    legs: int
    gain: float
    ratio: float
    ratio_without: float


def calibrate_encounters(folders, name, robot_radius):
    """Return (values of the calibration ``name`` with the section, the Fitted, [MapScore], legs).

    ``folders`` have the recordings, ``robot_radius`` [m] is how far ways stay off what is occupied.

    :raises ConfigurationError: if one of them cannot be read, or there are too few legs that met.
    """
    calibration = read_calibration(name, 'calibrate')
    raw = load_yaml_file(calibration_file(name, 'calibrate'))
    radius = RADIUS if calibration.encounters is None else calibration.encounters.radius
    legs = []
    for folder in folders:
        legs += _numbered_from(len(legs), met_legs(read_recordings(folder), folder, calibration, radius, robot_radius))
    fitted = fit_encounters(legs, raw, radius)
    values = {key: value for key, value in raw.items() if key not in ('format', 'source')}
    values[ENCOUNTERS] = {**fitted.values, 'source': _source(legs, fitted)}
    return {'source': raw['source'], **values}, fitted, map_scores(legs, raw, radius), legs


def _source(legs, fitted):
    met = sum(any(one.may_yield for one in leg.meetings) for leg in legs)
    return '{} encounters on {} of {} legs of {} maps'.format(
        sum(fitted.counts.values()), met, len(legs), len({leg.map for leg in legs}))


def map_scores(legs, calibration, radius):
    """Return a MapScore of each map whose others have enough legs that met."""
    found = []
    for name in sorted({leg.map for leg in legs}):
        known = _renumbered([leg for leg in legs if leg.map != name], legs)
        asked = [leg for leg in legs if leg.map == name and leg.succeeded
                 and any(one.may_yield for one in leg.meetings)]
        try:
            fitted = fit_encounters(known, calibration, radius)
        except ConfigurationError:
            continue
        if asked:
            with_them, without = log_likelihoods(asked, calibration, fitted, radius)
            measured = sum(leg.duration for leg in asked)
            alone = float(np.sum(Durations(calibration, [leg.way for leg in asked]).mean()))
            more = sum(mean_seconds(leg, fitted.values, radius) for leg in asked)
            found.append(MapScore(name, len(asked), with_them - without, measured / (alone + more), measured / alone))
    return found


def _numbered_from(first, legs):
    """Return ``legs`` with the others that they met by their numbers in a list in which they begin at ``first``."""
    return [leg._replace(meetings=tuple(one._replace(other=None if one.other is None else first + one.other)
                                        for one in leg.meetings)) for leg in legs]


def _renumbered(chosen, legs):
    """Return ``chosen`` of the list ``legs`` with the others that they met by their numbers among themselves."""
    numbers = {id(leg): number for number, leg in enumerate(chosen)}
    return [leg._replace(meetings=tuple(one._replace(
        other=None if one.other is None else numbers.get(id(legs[one.other]))) for one in leg.meetings))
        for leg in chosen]


def lines(fitted, scores):
    """Yield what is to be said, line by line: the values with their intervals, and how maps left out are predicted."""
    yield 'encounters: {}'.format(', '.join('{} {}'.format(count, kind) for kind, count in fitted.counts.items()))
    for row in fitted.rows:
        yield '  {:18s} {:8.3g}   95 %: {:.3g} to {:.3g}{}'.format(
            row.name, row.value, row.low, row.high, '   held by the prior' if row.held else '')
    for one in scores:
        yield ('{}, by all other maps: {} legs that met, measured / predicted {:.3f} (without encounters {:.3f}), '
               'logarithm of the likelihood {:+.1f}'.format(
                   one.map, one.legs, one.ratio, one.ratio_without, one.gain))
