"""Reads YAML files of users: plain data only, bounded in size and depth, without duplicate keys.

A few hundred bytes of YAML can stand for more than any machine can hold (aliases of aliases), and a few kilobytes can
exhaust the reader (nesting, long numbers). Here each of these is an error that says what was got, what is allowed, and
where. Maps, scenarios, missions and services use this module, so that all of them allow the same.
"""
from __future__ import annotations

import math
import re
from typing import TYPE_CHECKING, Any, Dict, Hashable, NamedTuple, Optional, Tuple, Union

import yaml

from .errors import ConfigurationError
from .input_files import open_input
from .shown import shown, shown_text

if TYPE_CHECKING:
    from yaml.events import Event
    from yaml.nodes import MappingNode, Node, ScalarNode

    from .type_names import StrPath

MAX_DEPTH = 32  # the deepest nesting of lists and mappings
MAX_DIGITS = 100  # the most characters of a number
_MERGE_TAG = 'tag:yaml.org,2002:merge'
_NUMBER = re.compile(r'[-+]?((0|[1-9][0-9]*)?(\.[0-9]*)?(e[-+]?[0-9]+)?|\.inf|\.nan)\Z', re.IGNORECASE)
_NUMBER_TAGS = ('tag:yaml.org,2002:int', 'tag:yaml.org,2002:float')
#: the errors that SafeLoader does not catch if a value does not fit its tag: !!int x, 2001-13-40
_CONSTRUCTION_ERRORS = (ValueError, TypeError, KeyError, IndexError, AttributeError, OverflowError)


class Bounds(NamedTuple):
    """The bounds of a document. The value of an alias counts each time the alias is used."""

    size: int  # bytes of its text
    values: int
    characters: int  # of all values


FILE = Bounds(8 * 1024 * 1024, 500_000, 16 * 1024 * 1024)
REQUEST = Bounds(64 * 1024, 10_000, 256 * 1024)  # for a request of a service, because others wait meanwhile


def load_yaml_file(path: StrPath) -> Any:
    """Return the document in the YAML file ``path``.

    :raises ConfigurationError: if it cannot be read, is not YAML, or is out of bounds; the text begins with the path.
    """
    with open_input(path, FILE.size, what='file of YAML') as stream:
        data = stream.read(FILE.size + 1)
    return load_yaml_text(data, str(path))


def load_yaml_text(text: Union[bytes, str], where: str, bounds: Bounds = FILE) -> Any:
    """Return the document in ``text`` (str, or bytes in UTF-8); error texts begin with ``where``.

    :raises ConfigurationError: if it is not YAML, or is out of bounds.
    """
    if len(text) > bounds.size:
        raise ConfigurationError('{0}: got more than {1} bytes of YAML; allowed: at most {1}'.format(
            where, bounds.size))
    try:
        loader = _Loader(text.decode('utf-8') if isinstance(text, bytes) else text, bounds)
        try:
            return loader.get_single_data()
        finally:
            loader.dispose()
    except ConfigurationError as error:
        raise ConfigurationError('{}: {}'.format(where, error)) from None
    except (yaml.YAMLError, UnicodeDecodeError, RecursionError) as error:
        raise ConfigurationError('{}: is not YAML of plain values: {}'.format(where, _told(error))) from None


def yaml_line(value: Any) -> str:
    """Return plain data as YAML in one line, which load_yaml_text() reads as the same data."""
    def dump(allow_unicode: bool) -> str:
        return str(yaml.safe_dump(value, default_flow_style=True, width=math.inf, allow_unicode=allow_unicode))
    dumped = dump(True)
    if any(mark in dumped for mark in '\x85\u2028\u2029'):  # ends of lines in YAML, which would be read as blanks
        dumped = dump(False)
    return dumped.replace('\n...\n', '').rstrip('\n')


def _told(error: Any) -> str:
    """Return an error of the library as one line, without the text that the library quotes at length."""
    mark = getattr(error, 'problem_mark', None)
    if mark is None:
        return shown_text(' '.join(str(error)[:1000].split()) or type(error).__name__)
    parts = [part for part in (error.context, error.problem) if part]
    return '{}, line {}, column {}'.format(shown_text(', '.join(parts)), mark.line + 1, mark.column + 1)


class _Loader(yaml.SafeLoader):
    """Counts values and characters while it composes the tree, before Python objects are made from it."""

    def __init__(self, text: str, bounds: Bounds) -> None:
        super().__init__(text)
        self._bounds = bounds
        self._depth = 0
        self._total = (0, 0)  # values, characters
        self._sizes: Dict[Optional[str], Tuple[int, int]] = {}  # {anchor: (values, characters)}

    def compose_node(self, parent: Optional[Node], index: Any) -> Optional[Node]:
        """Compose a node, or take the node of an alias, and count its values and characters."""
        event: Any = self.peek_event()
        if isinstance(event, yaml.AliasEvent):
            if event.anchor in self.anchors and event.anchor not in self._sizes:
                raise _error(event, "the alias '*{}' lies in its own value".format(shown_text(event.anchor)))
            self._count(event, *self._sizes.get(event.anchor, (1, 0)))
            return super().compose_node(parent, index)
        values, characters = self._total
        self._depth += 1
        if self._depth > MAX_DEPTH and isinstance(event, yaml.CollectionStartEvent):
            raise _error(event, 'lists and mappings lie more than {} deep in one another'.format(MAX_DEPTH))
        self._count(event, 1, len(getattr(event, 'value', '')))
        node = super().compose_node(parent, index)
        self._depth -= 1
        if event.anchor is not None:
            self._sizes[event.anchor] = self._total[0] - values, self._total[1] - characters
        return node

    def compose_scalar_node(self, anchor: Any) -> ScalarNode:
        """Refuse numbers that take long to read, and forms that are numbers in YAML 1.1 only: 1_0, 1:30, 010, 0xa."""
        node = super().compose_scalar_node(anchor)
        if node.tag in _NUMBER_TAGS and len(node.value) > MAX_DIGITS:
            raise _error(node, 'a number of {} characters; allowed: at most {}'.format(len(node.value), MAX_DIGITS))
        if node.tag in _NUMBER_TAGS and not _NUMBER.match(node.value):
            raise _error(node, 'got {}; allowed: a number in digits, as 10, or a text in quotes'.format(
                shown_text(node.value)))
        return node

    def construct_object(self, node: Any, deep: bool = False) -> Any:
        """Make the object of a node; if the value does not fit its tag, the error says where it is."""
        try:
            return super().construct_object(node, deep)
        except ConfigurationError:
            raise
        except _CONSTRUCTION_ERRORS:
            raise _error(node, 'got {}; this is not a value of the kind {}'.format(
                shown(getattr(node, 'value', None) if isinstance(node, yaml.ScalarNode) else node.id),
                shown_text(node.tag.rsplit(':', 1)[-1]))) from None

    def construct_mapping(self, node: MappingNode, deep: bool = False) -> Dict[Hashable, Any]:
        """Refuse a key that is there twice, even if it is written differently (1, 1.0); merged keys may be replaced."""
        is_mapping = isinstance(node, yaml.MappingNode)
        written = [key for key, _ in node.value if key.tag != _MERGE_TAG] if is_mapping else []
        mapping = super().construct_mapping(node, deep)
        seen = set()
        for key_node in written:
            key = self.construct_object(key_node, deep)
            if key in seen:
                raise _error(key_node, 'the key {} is there twice'.format(shown(key)))
            seen.add(key)
        return mapping

    def _count(self, event: Event, values: int, characters: int) -> None:
        self._total = self._total[0] + values, self._total[1] + characters
        if self._total[0] > self._bounds.values or self._total[1] > self._bounds.characters:
            raise _error(event, 'more than {} values or {} characters, those behind aliases counted each time'.format(
                self._bounds.values, self._bounds.characters))


def _error(place: Any, text: str) -> ConfigurationError:
    mark = place.start_mark
    return ConfigurationError('line {}, column {}: {}'.format(mark.line + 1, mark.column + 1, text))
