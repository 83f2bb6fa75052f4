"""Shows values in error texts, shortened without first building the whole text."""
from __future__ import annotations

import math
import re
import reprlib
import shlex
from typing import List, Sequence

MAX_LENGTH = 120  # the most characters of the text for a value
_EXPONENT = re.compile(r'[-+]?[0-9]{1,20}(\.[0-9]{0,20})?[eE][-+]?[0-9]{1,5}\Z')
_YAML_NOTE = ' (a text: in YAML a number with an exponent has a point and a sign, as 1.0e+3)'
_MAX_BITS = 200  # the most bits of a whole number that is written out


class _Shortener(reprlib.Repr):
    """Looks at a few parts of a value only, so that a list of a million lists costs no more than a short one."""

    def __init__(self) -> None:
        super().__init__()
        self.maxlevel = 3
        self.maxstring = self.maxother = MAX_LENGTH - 10
        self.maxlong = 70
        self.maxlist = self.maxtuple = self.maxdict = self.maxset = 6

    def repr_int(self, value: int, level: int) -> str:
        """Show only the size of a long number: Python takes long to write it, and refuses beyond 4,300 digits."""
        if value.bit_length() <= _MAX_BITS:
            return super().repr_int(value, level)
        return 'a whole number of about {} digits'.format(int(value.bit_length() * math.log10(2.0)) + 1)


_SHORTENER = _Shortener()


def shown(value: object) -> str:
    """Return ``repr(value)``, shortened to at most 120 characters of one line.

    A text like '1e3' gets a note, because its writer meant a number, but YAML 1.1 reads this form as a text.
    """
    text = cut(_SHORTENER.repr(value))
    return text + _YAML_NOTE if isinstance(value, str) and _EXPONENT.match(value) else text


def shown_text(value: object) -> str:
    """Return the text ``value``, with control characters escaped, in at most 120 characters of one line."""
    text = str(value) if isinstance(value, (str, float, bool)) or value is None else shown(value)
    text = text[:MAX_LENGTH + 1]
    return cut(printable(text))


def printable(text: str) -> str:
    """Return ``text`` with the codes of all characters that end a line, control a terminal, or cannot be seen."""
    return ''.join(sign if sign.isprintable() else repr(sign)[1:-1] for sign in text)


def first_of(names: Sequence[str], most: int) -> str:
    """Return the first ``most`` names as a text: 'a, b and 3 more'."""
    more = len(names) - most
    return ', '.join(names[:most]) + (' and {} more'.format(more) if more > 0 else '')


def first_lines(lines: Sequence[str], most: int, rest: str = '... and {} more') -> List[str]:
    """Return the first ``most`` lines; if there are more, one more line says how many: ``rest``."""
    more = len(lines) - most
    return [*lines[:most], *([rest.format(more)] if more > 0 else [])]


def listed(words: Sequence[str]) -> str:
    """Return 'a', 'a and b', 'a, b and c'."""
    return ' and '.join([', '.join(words[:-1]), words[-1]] if len(words) > 1 else words)


def pasted(*words: str) -> str:
    """Return words of a command as people paste them into a shell (bash): what cannot be seen is written as codes."""
    return ' '.join(shlex.quote(word) if word.isprintable() else "$'{}'".format(''.join(map(_code, word)))
                    for word in words)


def _code(sign: str) -> str:
    if sign.isprintable():
        return '\\' + sign if sign in "\\'" else sign
    number = ord(sign)
    if 0xdc80 <= number <= 0xdcff:  # a byte of a path that is not UTF-8
        return '\\x{:02x}'.format(number - 0xdc00)
    return '\\u{:04x}'.format(number) if number < 0x10000 else '\\U{:08x}'.format(number)


def cut(text: str, most: int = MAX_LENGTH) -> str:
    """Return ``text``, cut to ``most`` characters if it is longer."""
    return text if len(text) <= most else text[:most - 3] + '...'
