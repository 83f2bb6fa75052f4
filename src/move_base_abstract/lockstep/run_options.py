"""Options of a run that an experiment's file and the command lines of lockstep_launch and verify have in common.

To add an option, add a field here. Then all three read it, the time master gets its ``parameter``, and the schema and
the table in docs/experiments.md have the text that it ``says``.
"""
from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Tuple, Union

from ..common.errors import ConfigurationError
from ..common.kinds import Kind, list_of, number, one_of, option, pattern, text
from ..runs import built_in
from . import stored_topics

OF_NODES = ('launch', 'command')  # the systems of an experiment that have nodes
FAIL, ALLOW = 'fail', 'allow'  # a crash makes the run fail, or it is only reported


def _stored_topic(where: str, value: Any) -> str:
    try:
        return stored_topics.checked(value)
    except ConfigurationError as problem:
        raise ConfigurationError(f'{where}: {problem}'.lstrip(': ')) from None


_STORED = Kind(_stored_topic, pattern('/?[A-Za-z][A-Za-z0-9_]*(/[A-Za-z0-9_]+)*(=/?[A-Za-z][A-Za-z0-9_]*'
                                      '(/[A-Za-z0-9_]+)*)?', '').schema)


@dataclass(frozen=True)
class RunOptions:
    """How a system runs in lockstep."""

    sleep: str = option(
        one_of('wall', 'simulated'), 'wall', 'which time `time.sleep` takes in [programs](lockstep_launcher.md): '
        '`wall`, while simulated time stands still, or `simulated`')
    stored_topics: Tuple[str, ...] = option(
        list_of(_STORED), [], '`TOPIC` or `NODE=TOPIC`: nodes [only store](lockstep.md#topics-that-nodes-only-store) '
        'these messages, and get them together with the next thing that they '
        'do', systems=OF_NODES, is_part=True, parameter='stored_topics',
        flag='stored_topic')
    lookahead: Union[float, str] = option(
        number(1e-6, 1000, or_zero=True, unit='s, simulated', or_word='network'), 0, 's, simulated: messages '
        'between nodes take this time, and the nodes work at once ([windows](lockstep_windows.md)); `network`: the '
        'least delay of the links of the `network`; 0: no time', systems=OF_NODES, is_part=True, parameter='lookahead')
    network: str = option(
        text(), None, "`'FILE [NAME:=VALUE ...]'`: messages between nodes of different hosts go over the "
        "[radio](radio.md) that this file describes; the values replace its `$(arg NAME)`", systems=OF_NODES,
        is_part=True, parameter='network')
    chaos_seed: int = option(
        number(0, 2147483647, whole=True), 0, 'the seed of [another legal order](chaos.md) of equal events; 0: the '
        'stated order', systems=OF_NODES, is_part=True, parameter='chaos_seed')
    chaos_delay: float = option(
        number(1e-9, 1000, or_zero=True, unit='s, simulated'), 0, 's, simulated: with a `chaos_seed`, messages '
        'take up to this time; 0: no time', systems=OF_NODES, is_part=True, parameter='chaos_delay')
    chaos_only: Tuple[str, ...] = option(
        list_of(pattern('[0-9a-f]{12}|none', 'names of decisions, 12 hexadecimal digits each, or none')), [],
        'the names, as `chaos` prints them, of the decisions of `chaos_seed` that apply; `none`: none, `[]`: all',
        systems=OF_NODES, is_part=True, parameter='chaos_only')
    cores: str = option(
        one_of('one', 'all', 'auto'), None, 'the [cores](time_master.md#cores) on which nodes run: `one` (also the '
        'default if the launch file sets nothing), with a lookahead one for each node, or `all`; `auto` is an old word '
        'for `one`. The events are the same in each case', systems=OF_NODES, parameter='cores')
    crashes: str = option(
        one_of(FAIL, ALLOW), FAIL, 'what happens if a node [crashes](lockstep_launch.md#crashes): the run fails '
        '(`fail`), or the crash is reported and the run counts if it comes to its end (`allow`)')
    properties: Tuple[str, ...] = option(
        list_of(built_in.KIND), [], 'the [properties](properties.md) that are checked when a run is over: `all`, or '
        'names', systems=OF_NODES)
