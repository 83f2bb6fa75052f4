"""The section about where robots waited for room: places, zones, lanes, chargers; per trial, all robots together."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Optional

from .. import frames
from ..listings import listing
from ..parts import Section
from ..wording import UNKNOWN, Scale, estimate_texts, whole

if TYPE_CHECKING:
    from ..outcome import Experiment

HEADING = 'Where robots waited'
_SECONDS = Scale(1.0, 's')


def section(experiment: Experiment) -> Optional[Section]:
    """Return the section, or None if no robot waited for room in any trial."""
    frame = frames.waits(experiment)
    if frame.empty:
        return None
    factors = [name for name in frame.columns if name.startswith('factor.')]
    rows: Any = []
    for record in frame.to_dict('records'):
        value, low, high = estimate_texts(frames.estimate_of(record), _SECONDS)
        levels = ', '.join(str(record[name]) for name in factors if record[name] != '')
        rows.append((levels or UNKNOWN, record['where'], whole(record['n']), value,
                     f'{low} to {high}' if low else UNKNOWN))
    table = listing('Waiting by place, zone and lane', (
        'configuration', 'where', 'trials', 'mean per trial', '95 % interval'), rows, 'tables/waits.csv',
        'Means over the complete trials; a trial in which no robot waited there counts as 0 s. '
        'A robot that waits for two areas at once counts at each of them.', is_open=len(rows) <= 24)
    return Section(HEADING, ('The time for which robots stood and waited for room, summed over all robots.', table))
