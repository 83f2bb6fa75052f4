"""Topics whose messages nodes only store, as a user has declared: 'TOPIC', or 'NODE=TOPIC' for one node."""
from __future__ import annotations

import re
from typing import Optional, Union

from ..common.errors import ConfigurationError
from ..common.shown import shown

_NAME = re.compile('/?[A-Za-z][A-Za-z0-9_]*(/[A-Za-z0-9_]+)*')


def checked(text: Optional[Union[int, str]]) -> str:
    """Return an entry with resolved names: a name without a leading slash is below the root.

    :raises ConfigurationError: if ``text`` is not such an entry.
    """
    parts = text.split('=') if isinstance(text, str) else []
    if not 1 <= len(parts) <= 2 or not all(_NAME.fullmatch(part) for part in parts):
        raise ConfigurationError("a stored topic must be 'TOPIC' or 'NODE=TOPIC', such as /positions or "
                                 "/robot_1/agent=/map, got {}".format(shown(text)))
    return '='.join('/' + part.lstrip('/') for part in parts)
