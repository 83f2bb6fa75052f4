"""The file of a network: hosts, links and wired topics; reads it, checks it, and converts it for the time master.

The page docs/radio.md explains each key. An error names the file, the key, what was got and what is allowed.
"""
from __future__ import annotations

import os
import re
from dataclasses import dataclass
from typing import Any, Dict, List, Optional, Tuple

from ..common.bounded_yaml import load_yaml_file, load_yaml_text
from ..common.errors import ConfigurationError
from ..common.kinds import Kind, error, list_of, map_of, number, one_of, one_of_types, pattern, text
from ..common.options import mapping_of, option, read
from ..common.units import seconds_to_ns

PARAMETER = 'network'  # a parameter of the time master
_LOOKAHEAD = 'lookahead'  # another one
_LEAST_LOOKAHEAD = 1e-6  # s, simulated
_FAR = 1e12
_MOST_STARS = 4
_HOST = pattern(r'[A-Za-z][A-Za-z0-9_]*\*?[A-Za-z0-9_]*|\*', 'a name of letters, digits and underscores, in which one '
                'star may stand')
_NAMES = r'/(?:[A-Za-z0-9_*]+/)*[A-Za-z0-9_*]+'
_SECONDS = number(0, 1000, unit='s')
_PROBABILITY = number(0, 1)
_METRES = number(0, _FAR, unit='m')
_DECIBELS = number(-1000, 1000, unit='dB')
_ROBOT = 'robot'


def _pattern(where: str, value: Any) -> str:
    found: str = pattern(_NAMES, 'an absolute name in which * stands for a part, and ** for any text').check(
        where, value)
    if len(re.findall(r'\*+', found)) > _MOST_STARS or '***' in found:
        raise error(where, value, f'at most {_MOST_STARS} stars')
    return found


_PATTERN = Kind(_pattern, {'type': 'string', 'pattern': f'^{_NAMES}$'})


def _place(where: str, value: Any) -> Optional[Tuple[float, float]]:
    if value == _ROBOT:
        return None
    if not isinstance(value, list) or len(value) != 2:
        raise error(where, value, "'robot', or a place [x, y] [m]")
    kind = number(-_FAR, _FAR, unit='m')
    return kind.check(f'{where}[0]', value[0]), kind.check(f'{where}[1]', value[1])


_PLACE = Kind(_place, {'anyOf': [{'enum': [_ROBOT]}, {'type': 'array', 'minItems': 2, 'maxItems': 2}]})


@dataclass(frozen=True)
class Host:
    """A host: the ``nodes`` that run on it, and its position ``at`` (x, y) [m], None: that of the robot of its name."""

    nodes: Tuple[str, ...] = option(list_of(_PATTERN, 'a list of names of nodes', least=1), None,
                                    'its nodes: names, where `*` matches a part, `**` any text', is_required=True)
    at: Optional[Tuple[float, float]] = option(_PLACE, None, "`robot`: where the robot of the host's name is; "
                                               "or `[x, y]` [m]", is_required=True)


@dataclass(frozen=True)
class Uniform:
    """Delays that are distributed uniformly."""

    uniform: Tuple[float, ...] = option(list_of(_SECONDS, 'two numbers [s], the smaller one first', 2, most=2), None,
                                        '`[least, most]` [s]', is_required=True)


@dataclass(frozen=True)
class PathLoss:
    """Log-distance path loss with log-normal shadowing: T. S. Rappaport, Wireless Communications, 2nd ed., 4.9."""

    power: float = option(_DECIBELS, None, 'dBm: the power sent, with the gains of both antennas', is_required=True)
    sensitivity: float = option(_DECIBELS, None, 'dBm: a message with less power is lost', is_required=True)
    exponent: float = option(number(0, 100), 2, 'rate of fading: 2 in free space, 3 to 5 among obstacles')
    reference: float = option(number(1e-6, _FAR, unit='m'), 1, 'm: the distance of `loss_at_reference`')
    loss_at_reference: float = option(_DECIBELS, 40, 'dB; 40 is the loss of 2.4 GHz at 1 m')
    shadowing: float = option(number(0, 1000, unit='dB'), 0, 'dB: standard deviation, drawn for each message')


@dataclass(frozen=True)
class ByPlace:
    """Loss that depends on the positions of both hosts; exactly one of the two keys is given."""

    distance: Dict[float, float] = option(
        map_of(_PROBABILITY, _METRES), {}, '`{M: PROBABILITY}`: interpolated linearly, constant outside')
    path_loss: Optional[PathLoss] = option(mapping_of(PathLoss), None, 'by the received power, [below](#path-loss)',
                                           absent=None)


_LOST = one_of('drop', 'retry', 'queue')


@dataclass(frozen=True)
class Link:
    """A link between two hosts. ``lost`` None: as the key of the file says."""

    between: Tuple[str, ...] = option(list_of(_HOST, 'two names of hosts, or patterns', 2, most=2), None,
                                      'two hosts, or patterns of hosts', is_required=True)
    delay: Any = option(one_of_types(_SECONDS, (dict, lambda one: one, mapping_of(Uniform))), 0, 's after the message '
                        'has been sent; or `{uniform: [least, most]}`')
    loss: Any = option(one_of_types(_PROBABILITY, (dict, lambda one: one, mapping_of(ByPlace))), 0, 'a probability; or '
                       '`{distance: {M: PROBABILITY, ...}}`; or `{path_loss: {...}}`')
    rate: int = option(number(1, 10**12, whole=True, or_zero=True, unit='bit/s'), 0, 'bit/s, in each direction; '
                       '0: unlimited')
    range: Optional[float] = option(_METRES, None, 'm: a host that is farther away hears nothing', absent=None)
    walls: float = option(number(0, _FAR), 0, 'the cost of each wall between both: additional distance [m], or '
                          'additional loss [dB] with a `path_loss`')
    buffer: int = option(number(1, 10**12, whole=True, or_zero=True, unit='bytes'), 0, 'bytes that may wait to be '
                         'sent in a direction; 0: unlimited')
    lost: Optional[str] = option(_LOST, None, 'as the key of the file, for this link', absent=None)
    retry: float = option(number(1e-6, 1000, unit='s'), 0.2, 's from a loss to the next attempt')
    attempts: int = option(number(1, 64, whole=True), 8, 'number of attempts with `retry`')


@dataclass(frozen=True)
class Network:
    """The checked content of a network's file."""

    hosts: Dict[str, Host] = option(map_of(mapping_of(Host), _HOST), None, '`{NAME: {nodes, at}}`: a node is on the '
                                    'first host that matches; a `*` in the name stands for the text that the first '
                                    '`*` of the pattern matches', is_required=True)
    links: Tuple[Link, ...] = option(list_of(mapping_of(Link), 'a list of links'), None, 'links between hosts: the '
                                     'first that matches counts; hosts without a link do not hear each other',
                                     is_required=True)
    seed: int = option(number(0, 2**53, whole=True), 0, 'seed of all random decisions')
    wired: Tuple[str, ...] = option(
        list_of(_PATTERN, 'a list of names of topics and services'),
        ['/clock', '/tf', '/tf_static', '/map', '/rosout', '/rosout_agg'], 'topics and services that are not on the '
        'air; patterns as for nodes')
    lost: str = option(_LOST, 'drop', 'what happens to a message that does not arrive: `drop`, nothing more; `retry`, '
                       'it is sent again as by TCP; `queue`, it is sent again until it arrives')
    map: str = option(text(), None, "a map's YAML file with the walls for `walls`, relative to the folder of this file")


def read_network(path: str, arguments: Optional[Dict[str, str]] = None) -> Network:
    """Return the Network in a YAML file, by itself or below the key ``network``.

    ``arguments``: {NAME: value} for each ``$(arg NAME)`` in the file.

    :raises ConfigurationError: if it is not allowed; the text names the file, the key and what is allowed.
    """
    document = load_yaml_file(path)
    try:
        used: Dict[str, str] = {}
        document = _filled(document, arguments or {}, used)
        for name in arguments or {}:
            if name not in used:
                raise ConfigurationError(f'{name}:= is given, but the file has no $(arg {name})')
        whole = document.get('network', document) if isinstance(document, dict) and len(document) == 1 else document
        found = read(Network, '', whole)
        _check(found)
        return found
    except ConfigurationError as problem:
        raise ConfigurationError(f'{path}: {problem}') from None


def _filled(value: Any, arguments: Dict[str, str], used: Dict[str, str]) -> Any:
    """Return a document in which the values of the arguments replace the texts $(arg NAME)."""
    if isinstance(value, dict):
        return {key: _filled(one, arguments, used) for key, one in value.items()}
    if isinstance(value, list):
        return [_filled(one, arguments, used) for one in value]
    found = re.fullmatch(r'\$\(arg ([A-Za-z][A-Za-z0-9_]*)\)', value) if isinstance(value, str) else None
    if found is None:
        return value
    name = found.group(1)
    if name not in arguments:
        raise ConfigurationError(f'$(arg {name}) is not given; {name}:=VALUE after the name of the file gives it')
    used[name] = arguments[name]
    return load_yaml_text(arguments[name], f'{name}:=')


def _check(network: Network) -> None:
    """Check the conditions that depend on several keys.

    :raises ConfigurationError: if one is not met.
    """
    for name, host in network.hosts.items():
        for place, one in enumerate(host.nodes):
            if '*' in name and not re.search(r'(?<!\*)\*(?!\*)', one):
                raise error(f'hosts.{name}.nodes[{place}]', one, "a name with one *, since the host's name has one")
    for place, link in enumerate(network.links):
        where = f'links[{place}]'
        if isinstance(link.delay, Uniform) and link.delay.uniform[0] > link.delay.uniform[1]:
            raise error(f'{where}.delay.uniform', list(link.delay.uniform), 'the smaller number first')
        if isinstance(link.loss, ByPlace) and bool(link.loss.distance) == (link.loss.path_loss is not None):
            raise error(f'{where}.loss', '{...}', "one of 'distance' and 'path_loss'")
        if link.walls and not network.map:
            raise ConfigurationError(f"{where}.walls: got {link.walls:g}, but there is no 'map' with walls")


def lines_of(network: Network, folder: str) -> List[str]:
    """Return the network as the time master reads it (src/lockstep/radio/network.h).

    ``folder``: that of the network's file, in which the path of the map begins.

    :raises ConfigurationError: if its map cannot be read.
    """
    lines = [f'seed {network.seed}']
    for name, host in network.hosts.items():
        place = _ROBOT if host.at is None else 'at {!r} {!r}'.format(*host.at)
        lines.append(' '.join(['host', name, place, *host.nodes]))
    if network.wired:
        lines.append(' '.join(['wired', *network.wired]))
    if any(link.walls for link in network.links):
        from .walls import wall_lines
        lines += wall_lines(os.path.join(folder, network.map))
    return lines + [' '.join(_words(link, network.lost)) for link in network.links]


def _words(link: Link, lost: str) -> List[str]:
    low, high = link.delay.uniform if isinstance(link.delay, Uniform) else (link.delay, link.delay)
    words = ['link', *link.between, 'delay', str(seconds_to_ns(low)), str(seconds_to_ns(high)), *_loss(link.loss)]
    for key, value in (('rate', link.rate), ('buffer', link.buffer), ('wall', link.walls)):
        words += [key, repr(value)] if value else []
    words += [] if link.range is None else ['range', repr(link.range)]
    return [*words, 'lost', link.lost or lost, 'retry', str(seconds_to_ns(link.retry)), 'attempts', str(link.attempts)]


def _loss(loss: Any) -> List[str]:
    if not isinstance(loss, ByPlace):
        return ['loss', repr(loss)]
    law = loss.path_loss
    if law is not None:
        return ['path', *map(repr, (law.power, law.sensitivity, law.exponent, law.reference, law.loss_at_reference,
                                    law.shadowing))]
    points = sorted(loss.distance.items())
    return ['table', str(len(points)), *(repr(one) for point in points for one in point)]


def least_delay_s(network: Network) -> float:
    """Return the least delay of all messages between hosts [s, simulated].

    :raises ConfigurationError: if that is too short for a lookahead.
    """
    delays = [link.delay.uniform[0] if isinstance(link.delay, Uniform) else link.delay for link in network.links]
    least: float = min(delays, default=0.0)
    if least < _LEAST_LOOKAHEAD:
        raise ConfigurationError(f"lookahead: 'network' is the least delay of its links, which is {least:g} s; "
                                 f'allowed: {_LEAST_LOOKAHEAD:g} s or more of each link, or a number')
    return least


def _network_of(given: str, folder: str) -> Tuple[Network, str]:
    """Return (the Network of 'FILE [NAME:=VALUE ...]', its folder); a relative path starts at ``folder``."""
    path, *words = given.split()
    arguments = dict(word.split(':=', 1) for word in words if ':=' in word)
    if len(arguments) < len(words):
        raise error('network', given, 'FILE, or FILE NAME:=VALUE ..., each name once')
    path = os.path.join(folder, path)
    return read_network(path, arguments), os.path.dirname(path)


def files_of(given: str, folder: str) -> List[str]:
    """Return the paths of the files of 'FILE [NAME:=VALUE ...]': its own, and those of its map if they can be read."""
    found = [os.path.join(folder, name) for name in given.split()[:1]]
    try:
        document = load_yaml_file(found[0]) if found else {}
        whole = document.get('network', document)
        if isinstance(whole, dict) and isinstance(whole.get('map'), str):
            found.append(os.path.join(os.path.dirname(found[0]), whole['map']))
            from ..common.map_files import read_description
            found.append(read_description(found[1]).image)
    except (ConfigurationError, AttributeError):
        pass  # the error is reported when the network is read for a run
    return found


def resolve(parameters: Dict[str, Any], folder: str = '') -> Dict[str, Any]:
    """Return the time master's parameters, in which the content of a network's file replaces its name.

    :raises ConfigurationError: if there is no such file, it is not the file of a network, or the lookahead should be
        that of the network but the network gives none.
    """
    given = parameters.get(PARAMETER)
    if given is None:
        if parameters.get(_LOOKAHEAD) == PARAMETER:
            raise ConfigurationError("lookahead: got 'network'; allowed: a number [s] if no network is given")
        return parameters
    network, where = _network_of(given, folder)
    found = {**parameters, PARAMETER: lines_of(network, where)}
    if found.get(_LOOKAHEAD) == PARAMETER:
        found[_LOOKAHEAD] = least_delay_s(network)
    return found
