"""Reads JSON files of users. Only regular files of a bounded size are opened."""
from __future__ import annotations

import json
import math
import os
from typing import TYPE_CHECKING, Any, Dict, Optional

from .errors import ConfigurationError
from .input_files import open_input
from .shown import shown

if TYPE_CHECKING:
    from .type_names import StrPath

MAX_BYTES = 64 * 1024 * 1024
_HALF = b'\\ud'  # begins half of a surrogate pair, which JSON may hold but no text file can


def load_json_mapping(path: StrPath, most: int = MAX_BYTES) -> Dict[str, Any]:
    """Return the mapping in a JSON file of at most ``most`` bytes.

    :raises FileNotFoundError: if there is no such file.
    :raises ConfigurationError: if it is not a regular file, too large, or not a mapping; the text names the path.
    """
    if not os.path.lexists(path):
        raise FileNotFoundError(f'{path}: is not there')
    with open_input(path, most) as stream:
        data = stream.read()
    try:
        content = json.loads(data.decode('utf-8'))
    except (ValueError, RecursionError) as error:
        raise ConfigurationError(f'{path}: cannot be read as JSON: {error}') from None
    if _HALF in data or b'\\uD' in data:
        content = cleaned(content)
    if not isinstance(content, dict):
        raise ConfigurationError(f'{path}: must be a mapping, got {shown(content)}')
    return content


def loads_cleaned(data: bytes) -> Any:
    """Return the value in ``data`` (JSON in UTF-8), as :func:`cleaned` returns it.

    :raises ValueError: if it is not JSON.
    """
    content = json.loads(data.decode('utf-8'), parse_float=_finite, parse_constant=lambda _name: None)
    return cleaned(content) if _HALF in data or b'\\uD' in data else content


def _finite(text: str) -> Optional[float]:
    number = float(text)
    return number if math.isfinite(number) else None


def cleaned(value: Any) -> Any:
    """Return a value of JSON such that any text file can hold it.

    Halves of surrogate pairs are escaped, and numbers that are not finite become None.
    """
    if isinstance(value, str):
        return value.encode('utf-8', 'backslashreplace').decode()
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if isinstance(value, list):
        return [cleaned(one) for one in value]
    if isinstance(value, dict):
        return {cleaned(key): cleaned(one) for key, one in value.items()}
    return value
