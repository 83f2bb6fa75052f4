"""Tables that anybody may have written: opened only if they are files, and of a bounded size."""

import contextlib
import csv
import os
import stat

from .errors import ConfigurationError

MAX_BYTES = 64 * 1024 * 1024


@contextlib.contextmanager
def open_csv(path, error_type=ConfigurationError):
    """Open a CSV file as text; what its reader complains of in the with block becomes an error that names the file.

    :raises error_type: (a kind of ConfigurationError) if it is a folder or a device, too large, or cannot be read.
    """
    try:
        about = os.stat(path)
        if not stat.S_ISREG(about.st_mode) or about.st_size > MAX_BYTES:
            what = f'{about.st_size} bytes' if stat.S_ISREG(about.st_mode) else 'a folder or a device'
            raise error_type(f'{path}: must be a file of at most {MAX_BYTES} bytes, got {what}')
        with open(path, newline='', encoding='utf-8-sig') as stream:
            yield stream
    except ConfigurationError:
        raise
    except (OSError, ValueError, csv.Error) as error:  # ValueError: no text, or a name with a zero in it
        raise error_type(f'{path}: cannot be read as CSV: {error}') from None
