"""The section about properties: in how many trials each held, was broken, or was not judged; and its first break."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any, Dict, List, NamedTuple, Optional, Tuple, Type, TypeVar, Union

from move_base_abstract.common.shown import listed
from move_base_abstract.properties.statements import BROKEN, HELD, KINDS
from move_base_abstract.runs.built_in import ALL, BUILT_IN, SOMETIMES

from .. import notable_trials
from ..listings import listing
from ..parts import Cell, Section, there
from ..wording import UNKNOWN, counted, whole

if TYPE_CHECKING:
    from ..outcome import Experiment, Trial

HEADING = 'Properties'
#: what `all` meant in trials that do not say by which properties they were judged
_ALL_OF_1_0 = ('no_crash', 'no_exception', 'no_standstill', 'no_zero_delay_loop', 'every_goal_ends', 'capacities_kept',
               'charged')
MOST_TOLD = 6
#: (name, node, text) of a property; a built-in one has no node and no text
Key = Tuple[str, str, str]
_Kind = TypeVar('_Kind')
_NOTE = 'Not judged: the trial has not run, has left no event log, or has never made the statement. The first break ' \
        'is the first in the order of the plan; instants are in simulated time. All breaks are in trials/*/trial.json.'


class Break(NamedTuple):
    """The first break of a property in a trial: its instant [ns] (None: it has none), and what happened, in words."""

    instant_ns: Optional[int]
    words: str


class Judged(NamedTuple):
    """What a trial says about properties. Keys are (property, node, text); (property, '', '') if it is built in."""

    names: frozenset  # the names of the built-in properties by which the trial was judged
    broken: dict  # key: Break
    statements: dict  # key: the outcome of the statement


def read(told: Any) -> Optional[Judged]:
    """Return the Judged of the 'properties' of a trial.json, or None if there are none. Wrong parts are left out."""
    if not isinstance(told, dict) or not told:
        return None
    broken = {}
    for one in _rows(told.get('broken'), dict):
        key = _key(one.get('property'), one.get('node'), one.get('text'))
        if key is not None and key not in broken:
            instant = one.get('instant_ns')
            instant = instant if isinstance(instant, int) and not isinstance(instant, bool) else None
            details = ', '.join(map(str, _rows(one.get('details'), str)))
            words = f"{one.get('node')}: {one.get('text')}" if key[0] in BUILT_IN else ''
            broken[key] = Break(instant, ' '.join(filter(None, (words, f'({details})' if details else ''))))
    statements: List[Any] = [row for row in _rows(told.get('statements'), list) if len(row) == 4]
    stated = {_key(kind, node, text): outcome for node, kind, text, outcome in statements}
    stated.pop(None, None)
    names = _rows(told.get('judged'), str)
    return Judged(frozenset(_ALL_OF_1_0 if ALL in names else names) & frozenset(BUILT_IN), broken, stated)


def _rows(value: Any, kind: Type[_Kind]) -> List[_Kind]:
    return [one for one in value if isinstance(one, kind)] if isinstance(value, list) else []


def _key(name: Any, node: Any, text: Any) -> Optional[Key]:
    """Return the key of a property, or None if there is no property of this name."""
    if not isinstance(name, str):  # anybody may have written it
        return None
    if name in BUILT_IN:
        return name, '', ''
    return (name, str(node), str(text)) if name in KINDS else None


class Count(NamedTuple):
    """The numbers of trials in which a property held and in which it was broken, and its first break."""

    key: Key
    held: int
    broken: int
    first: Optional[Tuple[Trial, Break]]


def _known(experiment: Experiment) -> List[Tuple[Trial, Judged]]:
    """Return (Trial, Judged) for each Trial that was judged, in the order of the plan."""
    if 'properties' not in experiment.known:
        found = [(trial, read(trial.properties)) for trial in experiment.trials]
        experiment.known['properties'] = [(trial, judged) for trial, judged in found if judged is not None]
    return experiment.known['properties']


def counts(experiment: Experiment) -> List[Count]:
    """Return the Count of each property by which a trial was judged: the built-in ones, then statements."""
    known = _known(experiment)
    keys: Dict[Key, None] = {(name, '', ''): None for name in BUILT_IN if any(
        name in judged.names or (name, '', '') in judged.broken for _, judged in known)}
    for _, judged in known:
        keys.update(dict.fromkeys((*judged.statements, *judged.broken)))
    found = []
    for key in keys:
        broken = [(trial, judged.broken[key]) for trial, judged in known if key in judged.broken]
        held = sum(_has_held(judged, key) for _, judged in known)
        found.append(Count(key, held, len(broken), broken[0] if broken else None))
    return found


def _has_held(judged: Judged, key: Key) -> bool:
    outcome = judged.statements.get(key)
    if key[0] in BUILT_IN:
        return key[0] in judged.names and key not in judged.broken
    return outcome == HELD if key[0] == SOMETIMES else outcome not in (None, BROKEN)


def warning(experiment: Experiment) -> Optional[str]:
    """Return the warning about broken properties, or None if none was broken."""
    broken = [f'{_title(each.key)} (in {counted(each.broken, "trials")})' for each in counts(experiment) if each.broken]
    if not broken:
        return None
    more = [f'{whole(len(broken) - MOST_TOLD)} more'] if len(broken) > MOST_TOLD else []
    return f'Properties were broken: {listed(broken[:MOST_TOLD] + more)}: see {HEADING}.'


def section(experiment: Experiment) -> Optional[Section]:
    """Return the section, or None if no trial was judged."""
    found = counts(experiment)
    if not found:
        return None
    found.sort(key=lambda one: not one.broken)
    rows: Any = [_row(experiment, each) for each in found if each.key[0] != SOMETIMES]
    seen: Any = [(_title(each.key), whole(each.held), whole(_stated(experiment, each.key) - each.held))
            for each in found if each.key[0] == SOMETIMES]
    never = [each[0] for each in seen if each[1] == whole(0)]
    return Section(HEADING, tuple(there((
        listing('What must hold', ('property', 'held in', 'broken in', 'not judged', 'first broken in', 'seed',
                                   'at [s]', 'details'), rows, 'properties.csv', _NOTE, is_open=True),
        f'Came true in no trial: {listed(never[:MOST_TOLD])}{" and others" if len(never) > MOST_TOLD else ""}. '
        'No trial tests what depends on it.' if never else '',
        listing('What should come true now and then', ('statement', 'came true in', 'did not come true in'), seen,
                'properties.csv', 'Only trials in which the statement was made count.', is_open=True)))))


def _row(experiment: Experiment, count: Count) -> Tuple[Union[str, Cell], ...]:
    rest = len(experiment.trials) - count.held - count.broken
    row = (_title(count.key), whole(count.held), whole(count.broken), whole(rest))
    if count.first is None:
        return (*row, UNKNOWN, UNKNOWN, UNKNOWN, '')
    trial, first = count.first
    at = UNKNOWN if first.instant_ns is None else f'{first.instant_ns * 1e-9:.9g}'
    return (*row, Cell(trial.id, notable_trials.link(experiment, trial)), str(trial.seed), at, first.words)


def _stated(experiment: Experiment, key: Key) -> int:
    return sum(key in judged.statements for _, judged in _known(experiment))


def _title(key: Key) -> str:
    name, node, text = key
    return f'{name}: {BUILT_IN[name].sentence}' if name in BUILT_IN else f'{name}: {text} ({node})'
