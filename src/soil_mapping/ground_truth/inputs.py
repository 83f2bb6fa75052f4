"""What a trial reads besides its parameters, by content: a file that was changed makes another trial."""

import hashlib

from move_base_abstract.common.csv_files import MAX_BYTES, open_csv
from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.common.input_files import open_input

from .readings import MEUSE_FILE


def inputs_of(field, charge='none'):
    """Return {'field': SHA-256, 'charge': SHA-256} of the files that a TrialConfig's field and a charge name.

    What is not read from a file is left out. To be called before the files are used: if one is changed in between, the
    trial is run again, not taken for one of the new content. :raises ConfigurationError: if one cannot be read.
    """
    found = {}
    kind, _, path = field.partition(':')
    if field == 'meuse' or (kind == 'csv' and path):
        with open_csv(MEUSE_FILE if field == 'meuse' else path) as stream:
            found['field'] = hashlib.sha256(stream.buffer.read()).hexdigest()
    kind, _, path = charge.partition(':')
    if kind == 'replay':
        with open_input(path, MAX_BYTES, lambda text: ConfigurationError(f'charge replay: {text}')) as stream:
            found['charge'] = hashlib.sha256(stream.read()).hexdigest()
    return found
