"""The secret of a run, which keeps other users of the machine out."""
from __future__ import annotations

import os
import stat
from typing import TYPE_CHECKING, Any

from ..common.errors import ConfigurationError

if TYPE_CHECKING:
    from os import stat_result

    from ..common.type_names import StrPath

LONGEST = 1024  # bytes


def run_secret(text: Any, path: Any) -> bytes:
    """Return the secret as bytes, from the parameter ``text`` or from the file ``path``; b'' if there is none.

    :raises ConfigurationError: if both are given; if the file is missing, empty or too long; if another user owns it or
        may read or write it.
    """
    for key, value in (('lockstep_secret', text), ('lockstep_secret_file', path)):
        if not isinstance(value, str):
            raise ConfigurationError('parameter /time_master/{}: got {!r}; allowed: a text'.format(key, value))
    if text and path:
        raise ConfigurationError('parameters /time_master/lockstep_secret and lockstep_secret_file: both are set; '
                                 'set one of them')
    secret: bytes = _read(path) if path else text.encode('utf-8').strip()
    if len(secret) > LONGEST or (path or text) and not secret:
        raise ConfigurationError('parameter /time_master/lockstep_secret{}: got {}; allowed: 1 to {} bytes'.format(
            '_file' if path else '', 'more' if secret else 'none', LONGEST))
    return secret


def _read(path: StrPath) -> bytes:
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_CLOEXEC | os.O_NONBLOCK)
        with open(descriptor, 'rb') as stream:
            why = _objection(os.fstat(descriptor))
            secret = stream.read(LONGEST + 3).strip() if not why else b''
    except (OSError, ValueError) as error:
        why = getattr(error, 'strerror', None) or str(error)
    if why:
        raise ConfigurationError('parameter /time_master/lockstep_secret_file: got {!r}; allowed: a file that only its '
                                 'owner can read: {}'.format(path, why))
    return secret


def _objection(status: stat_result) -> str:
    if not stat.S_ISREG(status.st_mode):
        return 'it is no ordinary file'
    if status.st_uid != os.geteuid():
        return 'it belongs to another user'
    return 'others may use it too; chmod 600 changes that' if status.st_mode & (stat.S_IRWXG | stat.S_IRWXO) else ''
