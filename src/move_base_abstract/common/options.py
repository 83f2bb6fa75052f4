"""Options that are defined once, as fields of a dataclass, each with its kind, its default and its description.

They are used to read files, to make schemas, to write pages of the docs, and to read and write command lines.
"""
from __future__ import annotations

import argparse
import dataclasses
import functools
import re
import sys
from typing import Any, Callable, Dict, List, Mapping, NamedTuple, NoReturn, Optional, Sequence, Tuple, Type, TypeVar

from .errors import ConfigurationError
from .kinds import Kind, Schema, error, number, unknown

T = TypeVar('T')
OPTION = 'option'  # the key of an Option in the metadata of a dataclass's field


class Option(NamedTuple):
    """All that is known of one key of a mapping in a file, or of one option of a command line.

    ``default``: the default as in a file; None: there is none. ``says``: its description, one sentence of Markdown.
    ``initial``: the default as the code has it. ``systems``: the kinds of systems for which an experiment may have it;
    empty: all. ``in_digest``: whether a change of it makes a trial another one. ``parameter``: the parameter of the
    time master that gets the value, or ''. ``flag``: its name on a command line, if it is not the field's name; for a
    list or a mapping, the flag is given once for each value. ``was``: the flag's name in earlier releases, or ''.
    ``metavar``: the form of its word, for --help. ``key``: its name in a file, if it is not the field's name.
    ``field``: the name of the dataclass's field.
    """

    kind: Kind
    default: Any
    says: str
    initial: Any
    systems: Tuple[str, ...] = ()
    in_digest: bool = False
    parameter: str = ''
    flag: str = ''
    was: str = ''
    metavar: str = 'X'
    key: str = ''
    is_required: bool = False
    field: str = ''

    @property
    def plain(self) -> str:
        """The description ``says``, without the marks of Markdown."""
        return re.sub(r'\[([^\]]*)\]\([^)]*\)', r'\1', self.says).replace('`', '')

    @property
    def name(self) -> str:
        """Its name in a file."""
        return self.key or self.field

    @property
    def word(self) -> str:
        """Its name on a command line, --NAME."""
        return _flag(self.flag or self.field)

    @property
    def word_kind(self) -> Kind:
        """The kind of one word of it on a command line."""
        return self.kind.each or self.kind

    @property
    def is_switch(self) -> bool:
        """Whether it has no value on a command line."""
        return isinstance(self.initial, bool)


def option(kind: Kind, default: Any, says: str, absent: Any = '', **others: Any) -> Any:
    """Return a dataclass's field that is an Option; its default is that of the Option, or ``absent`` if it has none."""
    initial = absent if default is None else kind.check('', default)
    return dataclasses.field(default_factory=lambda: initial, metadata={
        OPTION: Option(kind, default, says, initial, **others)})


def options_of(cls: Any) -> Dict[str, Option]:
    """Return {key: Option} of a dataclass or of an instance of one: its own Options first, then those of its base."""
    return _options_of(cls if isinstance(cls, type) else type(cls))


@functools.lru_cache(maxsize=None)
def _options_of(cls: Any) -> Dict[str, Option]:
    own = vars(cls).get('__annotations__', {})
    fields = sorted(dataclasses.fields(cls), key=lambda one: one.name not in own)
    found = [one.metadata[OPTION]._replace(field=one.name) for one in fields if OPTION in one.metadata]
    return {one.name: one for one in found}


def mapping_of(cls: Type[Any]) -> Kind:
    """Return the kind of mappings that the code gets as an instance of a dataclass of Options."""
    return Kind(lambda where, value: read(cls, where, value), schema_of(cls))


def read(cls: Type[T], where: str, value: Any, **others: Any) -> T:
    """Return an instance of the dataclass ``cls`` from ``value``, a mapping of its Options.

    ``where``: the place in the file, for errors; '': the file itself. ``others``: fields that are not Options.

    :raises ConfigurationError: if a key is unknown or missing, or a value is not allowed.
    """
    options = options_of(cls)
    name = where or 'the file'
    if not isinstance(value, dict):
        raise error(name, value, f'a mapping with {", ".join(options)}')
    for key in value:
        if not isinstance(key, str):
            raise error(name, key, 'texts as keys')
        if key not in options:
            raise unknown(f'{name}: the key', key, options)
    for key, one in options.items():
        if one.is_required and key not in value:
            raise ConfigurationError(f'{key!r} is missing: {one.plain}')
    return cls(**others, **{options[key].field: options[key].kind.check(f'{where}.{key}' if where else key, given)
                            for key, given in value.items()})


def schema_of(cls: Type[Any]) -> Schema:
    """Return the JSON Schema of a mapping that has the Options of a dataclass and no other keys."""
    options = options_of(cls)
    required = [key for key, one in options.items() if one.is_required]
    return {'type': 'object', 'additionalProperties': False, 'properties': {
        key: {**one.kind.schema, 'description': one.plain,
              **({} if one.default is None else {'default': one.default})} for key, one in options.items()},
        **({'required': required} if required else {})}


def collected(record: Any, is_wanted: Callable[[Option], Any]) -> List[Tuple[Option, Any]]:
    """Return (Option, value) of all wanted Options in ``record``, and in dataclasses in it, if not the default."""
    found: List[Tuple[Option, Any]] = []
    for one in options_of(record).values():
        value = getattr(record, one.field)
        if dataclasses.is_dataclass(value):
            found += collected(value, is_wanted)
        elif is_wanted(one) and value != one.initial:
            found.append((one, value))
    return found


def parameters_of(record: Any) -> Dict[str, Any]:
    """Return {parameter: value} for the time master, of all Options in ``record`` that are not the default."""
    return {one.parameter: list(value) if isinstance(value, tuple) else value
            for one, value in collected(record, lambda one: one.parameter)}


def add_arguments(parser: argparse._ActionsContainer, cls: Type[Any],
                  refused: Optional[Mapping[str, str]] = None) -> None:
    """Add an argument for each Option of a dataclass to ``parser``; :func:`given` and :func:`of_arguments` read them.

    ``refused``: {field: why} of the Options that mean nothing in this program. To use one of them is an error.
    """
    for one in options_of(cls).values():
        if refused and one.field in refused:
            parser.add_argument(one.word, action=_Refused, nargs=0 if one.is_switch else None, help=argparse.SUPPRESS,
                                why=refused[one.field])
            continue
        how: Dict[str, Any] = {'dest': one.field, 'default': None}
        if one.is_switch:
            how['action'] = 'store_true'
        elif 'enum' in one.kind.schema:
            how['choices'] = one.kind.schema['enum']
        else:
            how.update(type=word_of(one.word_kind, one.metavar if isinstance(one.initial, dict) else ''),
                       metavar=one.metavar, action='append' if one.kind.each else 'store')
        parser.add_argument(one.word, help=one.plain.replace('%', '%%') + (
            '' if not one.default else f' (default: {one.default})'), **how)
        if one.was:
            parser.add_argument(_flag(one.was), help=argparse.SUPPRESS, **{**how, 'action': _Renamed, 'now': one.word})


def given(cls: Type[Any], found: argparse.Namespace) -> Dict[str, Any]:
    """Return {key: value} as in a file, of those arguments of :func:`add_arguments` that were given."""
    values = {one.name: (one, getattr(found, one.field, None)) for one in options_of(cls).values()}
    return {key: dict(value) if isinstance(one.initial, dict) else value
            for key, (one, value) in values.items() if value is not None}


def of_arguments(cls: Type[T], parser: argparse.ArgumentParser, found: argparse.Namespace) -> T:
    """Return an instance of the dataclass ``cls`` from the arguments that :func:`add_arguments` has added.

    If they cannot be used together, ``parser`` ends the program with an error.
    """
    try:
        return read(cls, '', given(cls, found))
    except ConfigurationError as problem:
        parser.error(str(problem))


def of_words(cls: Type[T], words: Sequence[str]) -> T:
    """Return an instance of the dataclass ``cls`` from words as :func:`words_of` returns them."""
    parser = argparse.ArgumentParser(allow_abbrev=False)
    add_arguments(parser, cls)
    return of_arguments(cls, parser, parser.parse_args(words))


def words_of(record: Any) -> List[str]:
    """Return the words of a command line that mean the same as the Options in ``record``."""
    words = []
    for one, value in collected(record, lambda one: not one.is_switch):
        values = [value] if not one.kind.each else list(value.items()) if isinstance(value, dict) else value
        words += [word for each in values for word in (one.word, one.word_kind.to_word(each))]
    return [*(one.word for one, _ in collected(record, lambda one: one.is_switch)), *words]


def _flag(name: str) -> str:
    return '--' + name.replace('_', '-')


def word_of(kind: Kind, metavar: str = '') -> Callable[[str], Any]:
    """Return the function that converts a word of a command line to the value of ``kind`` that a file would have.

    ``metavar``: the form NAME=VALUE of the word, for errors; '': it has no such form.
    """
    def convert(word: str) -> Any:
        try:
            if metavar and '=' not in word:
                raise error('', word, metavar)
            try:
                value = kind.of_word(word)
            except ConfigurationError:
                raise
            except ValueError:
                value = word  # the check refuses it with an error that says what is allowed
            kind.check('', value)
        except ConfigurationError as problem:
            raise argparse.ArgumentTypeError(str(problem)) from None
        return value
    return convert


#: converts words that are finite numbers > 0
POSITIVE = word_of(number(above=0.0))


class _Refused(argparse.Action):
    def __init__(self, why: str, **how: Any) -> None:
        super().__init__(**how)
        self._why = why

    def __call__(self, parser: argparse.ArgumentParser, _found: Any, _values: Any, word: Any = None) -> NoReturn:
        parser.error(f'{word}: not here; {self._why}')


class _Renamed(argparse.Action):
    """An argument of a list by its name of earlier releases."""

    def __init__(self, now: str, **how: Any) -> None:
        super().__init__(**how)
        self._now = now

    def __call__(self, parser: argparse.ArgumentParser, found: Any, value: Any, word: Any = None) -> None:
        print(f'{parser.prog}: {word} is called {self._now} now', file=sys.stderr)
        setattr(found, self.dest, [*(getattr(found, self.dest) or []), value])
