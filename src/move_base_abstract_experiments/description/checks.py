"""Checks of what an experiment's file holds; each error says where, what was got, and what is allowed."""
import difflib
import math
import re

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.shown import shown, shown_text

_PLACE = re.compile(r'\{([^{}]*)\}')
_NAME = re.compile(r'[A-Za-z][A-Za-z0-9_]{0,63}\Z', re.ASCII)
SCALARS = 'a text, a number, true or false'


def error(where, value, allowed):
    """Return the error of a value that cannot be used."""
    return ConfigurationError(f'{where}: got {shown(value)}; allowed: {allowed}')


def mapping(where, value, keys=None):
    """Return a mapping with texts as keys; ``keys``: those that are allowed."""
    if not isinstance(value, dict):
        raise error(where, value, 'a mapping' + (f' with {", ".join(keys)}' if keys else ''))
    for key in value:
        if not isinstance(key, str):
            raise error(where, key, 'texts as keys')
        if keys is not None and key not in keys:
            raise unknown(f'{where}: the key', key, keys)
    return value


def unknown(what, name, known):
    """Return the error of a name that is not known, with the known one that is like it."""
    near = difflib.get_close_matches(name, list(known), n=1)
    hint = f'; did you mean {near[0]!r}?' if near else ''
    return ConfigurationError(f'{what} {shown_text(name)!r} is unknown{hint} (known: {", ".join(known) or "none"})')


def identifier(where, value):
    """Return the name of a factor or a metric: a letter, then letters, digits, underscores."""
    if not isinstance(value, str) or not _NAME.match(value):
        raise error(where, value, 'a letter, then at most 63 letters, digits and underscores')
    return value


def text(where, value, longest=4096):
    """Return a text of one line that is not empty."""
    if not isinstance(value, str) or not value or len(value) > longest or not value.isprintable():
        raise error(where, value, f'a text of one line, 1 to {longest} characters')
    return value


def texts(where, value, most=10_000):
    """Return a list of texts as a tuple."""
    if not isinstance(value, list) or len(value) > most:
        raise error(where, value, f'a list of at most {most} texts')
    return tuple(text(f'{where}[{k}]', item) for k, item in enumerate(value))


def scalar(where, value):
    """Return a value that can stand in a table: a text, a finite number, true or false."""
    if isinstance(value, str) and len(value) <= 4096 and (value.isprintable() or not value):
        return value
    if isinstance(value, bool) or isinstance(value, int) and abs(value) < 10**18:
        return value
    if isinstance(value, float) and math.isfinite(value):
        return value
    raise error(where, value, SCALARS)


def number(where, value, lowest, highest, whole=False):
    """Return a finite number of lowest..highest."""
    kinds = (int,) if whole else (int, float)
    if isinstance(value, bool) or not isinstance(value, kinds) or not lowest <= value <= highest:
        raise error(where, value, f'a {"whole " if whole else ""}number in {lowest:g}..{highest:g}')
    return value


def one_of(where, value, allowed):
    """Return a text that is one of some."""
    if not isinstance(value, str) or value not in allowed:
        raise error(where, value, ', '.join(allowed))
    return value


def flag(where, value):
    """Return true or false."""
    if not isinstance(value, bool):
        raise error(where, value, 'true or false')
    return value


def shown_scalar(value):
    """Return a scalar as a launch file's argument or a word of a command has it."""
    if isinstance(value, bool):
        return 'true' if value else 'false'
    return value if isinstance(value, str) else repr(value)


def check_places(where, value, known):
    """Complain of a {NAME} in a text that stands for nothing."""
    for name in _PLACE.findall(value) if isinstance(value, str) else ():
        if name not in known:
            raise unknown(f'{where}: the factor', name, known)


def filled(value, values):
    """Return a text with the values in the place of {NAME}."""
    return _PLACE.sub(lambda found: shown_scalar(values[found.group(1)]), shown_scalar(value))
