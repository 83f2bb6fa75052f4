"""The files that a trial reads, identified by their content: if a file was changed, it is another trial."""
from __future__ import annotations

import hashlib
from typing import Any, Dict

from move_base_abstract.common.csv_files import MAX_BYTES, open_csv
from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.input_files import open_input

from .readings import MEUSE_FILE


def inputs_of(field: str, charge: str = 'none') -> Dict[Any, Any]:
    """Return {'field': SHA-256, 'charge': SHA-256} of the files that a TrialConfig's field and a charge name.

    A key is left out if no file is read for it. Call this before the files are used: if a file is changed in between,
    the trial is then run again, and does not count as one with the new content.

    :raises ConfigurationError: if a file cannot be read.
    """
    found = {}
    kind, _, path = field.partition(':')
    if field == 'meuse' or (kind == 'csv' and path):
        with open_csv(MEUSE_FILE if field == 'meuse' else path) as stream:
            found['field'] = hashlib.sha256(stream.buffer.read()).hexdigest()  # type: ignore[attr-defined]
    kind, _, path = charge.partition(':')
    if kind == 'replay':
        with open_input(path, MAX_BYTES, lambda text: ConfigurationError(f'charge replay: {text}')) as stream:
            found['charge'] = hashlib.sha256(stream.read()).hexdigest()
    return found
