"""Options that are defined once, with their check, their JSON Schema and their arguments of a command line.

An Option is a field of a dataclass. It is used to read files, to make schemas, to write pages of the docs and to parse
command lines. An error says where, what was got, and what is allowed.
"""
from __future__ import annotations

import argparse
import dataclasses
import difflib
import functools
import math
import re
from typing import Any, Callable, Dict, Iterable, List, NamedTuple, Tuple, Type, TypeVar

from .errors import ConfigurationError
from .shown import shown, shown_text

Schema = Dict[str, Any]
T = TypeVar('T')
OPTION = 'option'  # the key of an Option in the metadata of a dataclass's field
_PRINTABLE = r'^[^\x00-\x1f\x7f-\x9f]*$'
_LONGEST_TEXT = 4096
_LARGEST_WHOLE = 10**18


class Kind(NamedTuple):
    """One kind of value. ``check(where, value)`` returns the value for the code, or raises a ConfigurationError.

    ``of_word(word)`` converts a word of a command line to the value that a file would have, or raises a ValueError.
    """

    check: Callable[[str, Any], Any]
    schema: Schema
    of_word: Callable[[str], Any] = str


class Option(NamedTuple):
    """All that is known of one key of a mapping in a file, or of one option of a command line.

    ``default``: the default as in a file; None: there is none. ``says``: its description, one sentence of Markdown.
    ``initial``: the default as the code has it. ``systems``: the kinds of systems for which an experiment may have it;
    empty: all. ``is_part``: whether a change of it makes a trial another one. ``parameter``: the parameter of the time
    master that gets the value, or ''. ``flag``: its name on a command line, if it is not the field's name; for a list,
    the flag is given once for each value. ``key``: its name in a file, if it is not the field's name. ``field``: the
    name of the dataclass's field.
    """

    kind: Kind
    default: Any
    says: str
    initial: Any
    systems: Tuple[str, ...] = ()
    is_part: bool = False
    parameter: str = ''
    flag: str = ''
    key: str = ''
    is_required: bool = False
    field: str = ''

    @property
    def plain(self) -> str:
        """The description ``says``, without the marks of Markdown."""
        return re.sub(r'\[([^\]]*)\]\([^)]*\)', r'\1', self.says).replace('`', '')


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
    return {one.key or one.field: one for one in found}


def error(where: str, value: object, allowed: str) -> ConfigurationError:
    """Return the error for a value that cannot be used: where, what was got, and what is allowed."""
    return ConfigurationError(f'{where}: got {shown(value)}; allowed: {allowed}'.lstrip(': '))


def unknown(what: str, name: str, known: Iterable[str]) -> ConfigurationError:
    """Return the error for an unknown name, with the most similar known one."""
    known = list(known)
    near = difflib.get_close_matches(name, known, n=1)
    hint = f'; did you mean {near[0]!r}?' if near else ''
    return ConfigurationError(f'{what} {shown_text(name)!r} is unknown{hint} (known: {", ".join(known) or "none"})')


def text(longest: int = _LONGEST_TEXT) -> Kind:
    """Return the kind of texts of one line that are not empty, with at most ``longest`` characters."""
    def check(where: str, value: Any) -> str:
        if not isinstance(value, str) or not value or len(value) > longest or not value.isprintable():
            raise error(where, value, f'a text of one line, 1 to {longest} characters')
        return value
    return Kind(check, {'type': 'string', 'minLength': 1, 'maxLength': longest, 'pattern': _PRINTABLE})


def pattern(expression: str, allowed: str, made: Callable[[str], str] = str) -> Kind:
    """Return the kind of texts that match a regular expression; ``made(text)`` returns the value for the code."""
    form = re.compile(f'(?:{expression})\\Z', re.ASCII)

    def check(where: str, value: Any) -> str:
        if not isinstance(value, str) or not form.match(value):
            raise error(where, value, allowed)
        return made(value)
    return Kind(check, {'type': 'string', 'pattern': f'^(?:{expression})$'})


def number(lowest: float, highest: float, whole: bool = False, or_zero: bool = False, unit: str = '',
           or_word: str = '') -> Kind:
    """Return the kind of finite numbers in ``lowest`` .. ``highest``; with ``whole``, 2.0 is allowed, too.

    ``or_zero``: 0 is allowed, too. ``unit``: the unit in error texts, for example 's, simulated'. ``or_word``: a text
    that is allowed instead of a number; '': none.
    """
    allowed = f'a {"whole " if whole else ""}number in {lowest:g}..{highest:g}' + (f' [{unit}]' if unit else '') + (
        ', or 0' if or_zero else '') + (f', or {or_word}' if or_word else '')

    def check(where: str, value: Any) -> Any:
        if or_word and value == or_word:
            return value
        if whole and isinstance(value, float) and value.is_integer():
            value = int(value)
        if isinstance(value, bool) or not isinstance(value, int if whole else (int, float)) or not (
                lowest <= value <= highest or or_zero and value == 0):
            raise error(where, value, allowed)
        return value if whole else float(value)
    schema = {'type': 'integer' if whole else 'number', 'minimum': lowest, 'maximum': highest}
    others = [{'type': 'number', 'enum': [0]}] * or_zero + [{'enum': [or_word]}] * bool(or_word)
    return Kind(check, {'anyOf': [*others, schema]} if others else schema,
                lambda word: word if or_word and word == or_word else int(word) if whole else float(word))


def one_of(*allowed: str) -> Kind:
    """Return the kind of texts that are among ``allowed``."""
    def check(where: str, value: Any) -> str:
        if not isinstance(value, str) or value not in allowed:
            raise error(where, value, ', '.join(allowed))
        return value
    return Kind(check, {'enum': list(allowed)})


def _flag(where: str, value: Any) -> bool:
    if not isinstance(value, bool):
        raise error(where, value, 'true or false')
    return value


def _scalar(where: str, value: Any) -> Any:
    if isinstance(value, str) and len(value) <= _LONGEST_TEXT and (value.isprintable() or not value):
        return value
    if isinstance(value, bool) or isinstance(value, int) and abs(value) < _LARGEST_WHOLE:
        return value
    if isinstance(value, float) and math.isfinite(value):
        return value
    raise error(where, value, 'a text, a number, true or false')


FLAG = Kind(_flag, {'type': 'boolean'})
#: the kind of values that can be in a table
SCALAR = Kind(_scalar, {'type': ['string', 'number', 'boolean'], 'maxLength': _LONGEST_TEXT, 'pattern': _PRINTABLE})
#: the name of a factor or a metric
NAME = pattern('[A-Za-z][A-Za-z0-9_]{0,63}', 'a letter, then at most 63 letters, digits and underscores')


def list_of(kind: Kind, allowed: str = '', least: int = 0, distinct: bool = False, most: int = 10_000) -> Kind:
    """Return the kind of lists of values of ``kind``, which the code gets as tuples; ``allowed``: words for errors."""
    allowed = allowed or f'a list of at most {most} texts'

    def check(where: str, value: Any) -> Tuple[Any, ...]:
        if not isinstance(value, list) or not least <= len(value) <= most:
            raise error(where, value, allowed)
        found = tuple(kind.check(f'{where}[{place}]', one) for place, one in enumerate(value))
        if distinct and len({(type(one), one) for one in found}) < len(found):
            raise error(where, value, 'each value once')
        return found
    schema = {'type': 'array', 'items': kind.schema, 'maxItems': most, **({'minItems': least} if least else {}),
              **({'uniqueItems': True} if distinct else {})}
    return Kind(check, schema)


def map_of(kind: Kind, names: Kind = NAME) -> Kind:
    """Return the kind of mappings from ``names`` to values of ``kind``."""
    def check(where: str, value: Any) -> Dict[Any, Any]:
        if not isinstance(value, dict):
            raise error(where, value, 'a mapping')
        return {names.check(where, name): kind.check(f'{where}.{name}', one) for name, one in value.items()}
    schema = {'type': 'object', 'additionalProperties': kind.schema}
    return Kind(check, {**schema, 'propertyNames': names.schema} if names is not SCALAR else schema)


def mapping_of(cls: Type[Any]) -> Kind:
    """Return the kind of mappings that the code gets as an instance of a dataclass of Options."""
    return Kind(lambda where, value: read(cls, where, value), schema_of(cls))


def either(others: Kind, *kinds: Tuple[type, Callable[[Any], Any], Kind]) -> Kind:
    """Return the kind of values of several types.

    ``kinds``: (type, made, kind), ...: a value of that type is checked by ``kind``, and the code gets ``made(value)``.
    Values of all other types are checked by ``others``.
    """
    def check(where: str, value: Any) -> Any:
        for type_, made, kind in kinds:
            if isinstance(value, type_):
                return made(kind.check(where, value))
        return others.check(where, value)
    return Kind(check, {'anyOf': [*(kind.schema for _, _, kind in kinds), others.schema]})


def or_null(kind: Kind) -> Kind:
    """Return the kind of values of ``kind``, or null."""
    return either(kind, (type(None), lambda _: None, Kind(lambda _where, _value: None, {'type': 'null'})))


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


def add_arguments(parser: argparse.ArgumentParser, cls: Type[Any]) -> None:
    """Add an argument for each Option of a dataclass to ``parser``; :func:`of_arguments` reads them."""
    for one in options_of(cls).values():
        how: Dict[str, Any] = {'choices': one.kind.schema['enum']} if 'enum' in one.kind.schema else {
            'type': _of_word(one), 'metavar': 'X'}
        how['default'] = [] if _is_list(one) else one.initial or None  # argparse would check a text, even ''
        how.update({'action': 'append'} if _is_list(one) else {})
        parser.add_argument(_flag_of(one), dest=one.field, help=one.plain.replace('%', '%%') + (
            '' if one.default in (None, [], 0) else f' (default: {one.default})'), **how)


def of_arguments(cls: Type[T], found: argparse.Namespace) -> T:
    """Return an instance of the dataclass ``cls`` from the arguments that :func:`add_arguments` has added."""
    return cls(**{one.field: tuple(value) if isinstance(value, list) else one.initial if value is None else value
                  for one in options_of(cls).values() for value in [getattr(found, one.field)]})


def words_of(record: Any) -> List[str]:
    """Return the words of a command line that mean the same as the Options in ``record``."""
    return [word for one, value in collected(record, bool) for each in (value if _is_list(one) else (value,))
            for word in (_flag_of(one), str(each))]


def _is_list(one: Option) -> bool:
    return isinstance(one.initial, tuple)


def _flag_of(one: Option) -> str:
    return '--' + (one.flag or one.field).replace('_', '-')


def _of_word(one: Option) -> Callable[[str], Any]:
    def convert(word: str) -> Any:
        try:
            value: Any = one.kind.of_word(word)
        except ValueError:
            value = word  # the check refuses it with an error that says what is allowed
        try:
            return one.kind.check('', [word])[0] if _is_list(one) else one.kind.check('', value)
        except ConfigurationError as problem:
            raise argparse.ArgumentTypeError(str(problem)) from None
    return convert
