"""Fit the section ``encounters`` of a calibration to recordings of several robots, and judge it on other maps."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Dict, Iterator, List, NamedTuple, Sequence, Tuple

import numpy as np

from move_base_abstract.common.bounded_yaml import load_yaml_file
from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.motion.calibration import ENCOUNTERS, calibration_file, read_calibration

from .encounter_fit import fit_encounters, log_likelihoods, mean_seconds
from .law import Durations
from .meetings import met_legs

if TYPE_CHECKING:
    from .encounter_fit import Fitted
    from .law import Values
    from .meetings import MetLeg

RADIUS = 3.0  # m; the radius of an encounter, if the calibration has no such section yet


class MapScore(NamedTuple):
    """How well the legs of a map that met a robot are predicted by a fit to all other maps."""

    map: str
    legs: int  # the number of these legs
    gain: float  # by how much encounters raise the sum of the logarithms of the densities
    ratio: float  # the sum of durations, measured by predicted, with encounters
    ratio_without: float  # the same without encounters


def calibrate_encounters(folders: Sequence[str], name: str,
                         robot_radius: float) -> Tuple[Dict[str, Any], Fitted, List[MapScore], List[MetLeg]]:
    """Return (values of the calibration ``name`` with the section, the Fitted, [MapScore], legs).

    ``folders``: those of the recordings; ``robot_radius`` [m]: the distance of ways from occupied cells.

    :raises ConfigurationError: if a file cannot be read, or too few legs met a robot.
    """
    calibration = read_calibration(name, 'calibrate')
    raw = load_yaml_file(calibration_file(name, 'calibrate'))
    radius = RADIUS if calibration.encounters is None else calibration.encounters.radius
    legs: List[MetLeg] = []
    for folder in folders:
        legs += met_legs(folder, calibration, radius, robot_radius, len(legs))
    fitted = fit_encounters(legs, raw, radius)
    values = {key: value for key, value in raw.items() if key not in ('format', 'source')}
    values[ENCOUNTERS] = {**fitted.values, 'source': _source(legs, fitted)}
    return {'source': raw['source'], **values}, fitted, map_scores(legs, raw, radius), legs


def _source(legs: Sequence[MetLeg], fitted: Fitted) -> str:
    met = sum(any(one.may_yield for one in leg.meetings) for leg in legs)
    return '{} encounters on {} of {} legs of {} maps'.format(
        sum(fitted.counts.values()), met, len(legs), len({leg.map for leg in legs}))


def map_scores(legs: Sequence[MetLeg], calibration: Values, radius: float) -> List[MapScore]:
    """Return a MapScore for each map if all other maps together have enough legs that met a robot."""
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


def _renumbered(chosen: Sequence[MetLeg], legs: Sequence[MetLeg]) -> List[MetLeg]:
    """Return ``chosen`` of the list ``legs``, with the numbers of the legs that they met counted in ``chosen``."""
    numbers = {id(leg): number for number, leg in enumerate(chosen)}
    return [leg._replace(meetings=tuple(one._replace(
        other=None if one.other is None else numbers.get(id(legs[one.other]))) for one in leg.meetings))
        for leg in chosen]


def lines(fitted: Fitted, scores: Sequence[MapScore]) -> Iterator[str]:
    """Yield the lines of the result: the values with their intervals, and how well maps are predicted by others."""
    yield 'encounters: {}'.format(', '.join('{} {}'.format(count, kind) for kind, count in fitted.counts.items()))
    yield from (row.line() for row in fitted.rows)
    for one in scores:
        yield ('{}, by all other maps: {} legs that met, measured / predicted {:.3f} (without encounters {:.3f}), '
               'logarithm of the likelihood {:+.1f}'.format(
                   one.map, one.legs, one.ratio, one.ratio_without, one.gain))
