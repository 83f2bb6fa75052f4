"""Refuses unknown keys in users' files, with an error that names the most similar known key."""
from __future__ import annotations

import difflib
from typing import Any, Mapping, Sequence

from .errors import ConfigurationError
from .shown import shown_text


def check_keys(raw: Mapping[str, Any], known: Sequence[str], where: str, prefix: str) -> None:
    """Check that all keys of the mapping ``raw`` are among ``known``; an error shows the key with ``prefix`` before it.

    :raises ConfigurationError: if one is not; the text begins with ``where``, and names the most similar known key.
    """
    for key in raw:
        if key not in known:
            close = difflib.get_close_matches(shown_text(key), known, n=1)
            hint = "; did you mean '{}'?".format(close[0]) if close else '; allowed: ' + ', '.join(known[:12])
            raise ConfigurationError('{}: {}{}: unknown key{}'.format(where, prefix, shown_text(key), hint))
