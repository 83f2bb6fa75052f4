"""Find when the links of a radio were up, from the rows `link` and `host` of a log."""
import json

from .recording import is_number


def find_links(recording, robots):
    """Return [{'ends': [end, end], 'times': [ns], 'up': [bool]}] for the links whose ends can be shown.

    An end is {'robot': its number among ``robots`` (names)}, or {'name', 'x', 'y'} [m] for a host that stands still.
    Any program may write rows; those of another form are left out.
    """
    numbers = {name: number for number, name in enumerate(robots)}
    places, links = {}, {}
    for time_ns, name, kind, text in recording:
        if kind not in ('link', 'host'):
            continue
        values = json.loads(text)
        if kind == 'host' and len(values) == 2 and all(map(is_number, values)):
            places[name] = {'name': name, 'x': values[0], 'y': values[1]}
        elif kind == 'link' and len(values) == 3 and all(isinstance(one, str) for one in values):
            times, states = links.setdefault(tuple(values[:2]), ([], []))
            times.append(time_ns)
            states.append(values[2] == 'up')
    ends = {**places, **{name: {'robot': number} for name, number in numbers.items()}}
    return [{'ends': [ends[one] for one in pair], 'times': times, 'up': states}
            for pair, (times, states) in links.items() if all(one in ends for one in pair)]
