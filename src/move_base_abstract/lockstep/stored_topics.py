"""Topics that a user has declared as only stored by nodes: 'TOPIC', or 'NODE=TOPIC' for one node."""
from __future__ import annotations

import re
from typing import Optional, Union

from ..common.errors import ConfigurationError
from ..common.shown import shown

_NAME = re.compile('/?[A-Za-z][A-Za-z0-9_]*(/[A-Za-z0-9_]+)*')


def checked(text: Optional[Union[int, str]]) -> str:
    """Return an entry with resolved names: those without a leading slash are below the root.

    :raises ConfigurationError: if it is none.
    """
    parts = text.split('=') if isinstance(text, str) else []
    if not 1 <= len(parts) <= 2 or not all(_NAME.fullmatch(part) for part in parts):
        raise ConfigurationError("a stored topic must be 'TOPIC' or 'NODE=TOPIC', such as /positions or "
                                 "/robot_1/agent=/map, got {}".format(shown(text)))
    return '='.join('/' + part.lstrip('/') for part in parts)
