"""What goes back from a trial: an archive of trial.json, the event log, recorded messages and files, nodes' prints.

Programs of users have made these files: whatever they are called and are, they cost no other trial anything. Names are
escaped as in addresses of the web ('result 0.csv' is files-result%200.csv); folders are left out, and so is, with an
error that names it, what is no plain file or cannot be read.
"""
import hashlib
import json
import os
import stat
import tarfile
import urllib.parse

from . import run

OUTPUTS = 'outputs.tar'
MOST_BYTES = 512 * 1024 * 1024  # of a trial's outputs, before they are packed
_COMPRESSED_FROM = 8 * 1024 * 1024  # bytes: less than that travels faster as it is
_MOST_LOG_BYTES = 1 << 20  # the end of what a node has printed
_LONGEST_NAME = 200  # bytes of an escaped name; files get an end to it while they are written
_LONGEST_END = 20
_CUT = b'... (the beginning is left out)\n'


def safe_name(name):
    """Return a file's name (str) in letters, digits, '_', '.', '-' and '%'; different names stay different."""
    raw = os.fsencode(name)
    safe = urllib.parse.quote(raw, safe='').replace('~', '%7E')
    if safe[0] in '.-':
        safe = f'%{raw[0]:02X}{safe[1:]}'
    if len(safe) <= _LONGEST_NAME:
        return safe
    end = os.path.splitext(safe)[1][-_LONGEST_END:]
    return f'{safe[:_LONGEST_NAME - 60].rstrip("%")}-{hashlib.sha256(raw).hexdigest()[:16]}{end.lstrip("%")}'


def is_plain(path):
    """Return whether there is a plain file at a path, no link followed."""
    try:
        return stat.S_ISREG(os.lstat(path).st_mode)
    except OSError:
        return False


def _is_plain_and_not_empty(path):
    """Return whether there is a plain file at a path, and something in it: most of what is printed is nothing."""
    return is_plain(path) and os.lstat(path).st_size > 0


def pack(path, folders, patterns, about, has_all_logs):
    """Write OUTPUTS into a trial's folder. ``about``: trial.json's content, to which is added what was left out.

    folders: of the run, or None. patterns: of files to be kept. has_all_logs: or what nodes have printed alone.
    """
    members = [] if folders is None else _recorded(folders, patterns, about)
    if sum(os.lstat(source).st_size for source, _ in members) > MOST_BYTES:
        about.update(status='failed', error=f'its outputs are more than {MOST_BYTES} bytes; allowed: at most that')
        members, has_all_logs = [], True
    if folders is not None:
        ends = ('.txt', '.log') if has_all_logs else ('.txt',)
        for name in sorted(os.listdir(folders.logs)):
            if name.endswith(ends) and _is_plain_and_not_empty(os.path.join(folders.logs, name)):
                members.append((_cut(os.path.join(folders.logs, name)), 'logs/' + safe_name(name)))
    own = os.path.join(path, 'trial.txt')
    if has_all_logs and _is_plain_and_not_empty(own) and not any(name == 'logs/trial.txt' for _, name in members):
        members.append((_cut(own), 'logs/trial.txt'))
    with open(os.path.join(path, 'trial.json'), 'w', encoding='utf-8') as stream:
        stream.write(json.dumps(about, allow_nan=False))
    members = [(source, name) for source, name in members if source]
    size = sum(os.lstat(source).st_size for source, _ in members)
    part = os.path.join(path, OUTPUTS + '.part')
    with tarfile.open(part, **({'mode': 'w:gz', 'compresslevel': 1} if size > _COMPRESSED_FROM else {'mode': 'w'}),
                      format=tarfile.GNU_FORMAT) as archive:
        for source, name in [(os.path.join(path, 'trial.json'), 'trial.json'), *members]:
            with open(source, 'rb') as stream:
                about_file = tarfile.TarInfo(name)  # nobody looks at whose file it was, and when
                about_file.size = os.fstat(stream.fileno()).st_size
                archive.addfile(about_file, stream)
    os.rename(part, os.path.join(path, OUTPUTS))


def _recorded(folders, patterns, about):
    """Return [(path, name in the archive)] of what is recorded; what cannot be kept is told as an error."""
    found = [(os.path.join(folders.own, name), name) for name in (run.LOG, run.MESSAGES)]
    found = [(source, name) for source, name in found if os.path.lexists(source)]
    found += [(os.path.join(folders.files, name), 'files-' + safe_name(name))
              for name in run.names_to_keep(folders, patterns)]
    left_out = {name: why for source, name in found for why in [_problem(source)] if why}
    if left_out and about['error'] is None:
        name, why = sorted(left_out.items())[0]
        about['error'] = f'{len(left_out)} of its files are not kept; {name}: {why}'
    return [(source, name) for source, name in found if name not in left_out]


def _problem(path):
    """Return why a file cannot be kept, or None."""
    if not is_plain(path):
        return 'it is no plain file'
    try:
        with open(path, 'rb'):
            return None
    except OSError as problem:
        return f'it cannot be read: {problem.strerror}'


def _cut(path):
    """Leave the end of a long output; return the path, or None if it cannot be read."""
    try:
        with open(path, 'rb') as stream:
            size = os.fstat(stream.fileno()).st_size
            stream.seek(max(0, size - _MOST_LOG_BYTES))
            end = stream.read(_MOST_LOG_BYTES) if size > _MOST_LOG_BYTES else None
        if end is not None:
            with open(path, 'wb') as stream:
                stream.write(_CUT + end)
    except OSError:
        return None
    return path
