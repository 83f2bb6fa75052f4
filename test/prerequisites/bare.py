"""An environment in which only what some targets of the Makefile install can be found, on a machine that has more.

Programs: PATH is a folder of links. Modules of Python: ``usercustomize.py`` hides files of other packages. Found are
those of the targets' lists, of a minimal Debian, git and make, with all that they depend on. What is built stays.
"""
import os
import re
import shutil
import subprocess
import sys
from functools import lru_cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
WS = ROOT / '.ws'
BEGIN = ('apt', 'ca-certificates', 'git', 'make')  # what users have, besides Debian's own choice
NAME = re.compile(r'(?:^|[|,]) *([a-z0-9][a-z0-9+.-]*)')  # in a field of Debian's, without version and architecture
PROGRAMS = ('/usr/bin', '/usr/sbin', '/bin', '/sbin')
PYTHON = Path('/usr/lib/python3'), Path(f'/usr/lib/python3.{sys.version_info[1]}')
NOT_OF_DEBIAN = f'/usr/local/lib/python3.{sys.version_info[1]}'


class NotInstalled(Exception):
    """This machine itself has not all that the targets install. The text says what, and what to do."""


def purposes(targets):
    """Return the words that the targets of the Makefile give to tools/install_deps, in their order."""
    done = _run('make', '--no-print-directory', '-n', '-C', str(ROOT), *targets)
    return [word for words in re.findall(r'\btools/install_deps(.*)$', done, re.MULTILINE) for word in words.split()]


def packages(targets, more=()):
    """Return the Debian packages that are there after the targets have run, and those of ``more``, with all they need.

    :raises NotInstalled: if the targets have not run on this machine.
    """
    wanted = {*more, *BEGIN}
    if targets:
        wanted |= set(_run('bash', str(ROOT / 'tools' / 'install_deps'), '--list', *purposes(targets)).split())
    lost = sorted(wanted - set(_installed()[0]))
    if lost:
        raise NotInstalled(f'not installed: {", ".join(lost)}; type make {" ".join(targets)}')
    return _with_what_they_need(wanted | _installed()[2])


def environment(folder, targets, more=()):
    """Return the environment of processes that find only what the targets install. ``folder``: an empty one for it."""
    names = packages(targets, more)
    files = _files(tuple(sorted(names)))
    home, programs = folder / 'home', folder / 'programs'
    own = home / '.local' / 'lib' / 'python3.{}'.format(sys.version_info[1]) / 'site-packages'
    own.mkdir(parents=True)
    shutil.copy(str(Path(__file__).with_name('usercustomize.py')), str(own))
    (own / 'hidden').write_text('\n'.join([NOT_OF_DEBIAN, *_hidden(files)]), encoding='utf-8')
    programs.mkdir()
    for name, target in _programs(files):
        (programs / name).symlink_to(target)
    path = [str(WS / 'bin'), str(programs)] if targets else [str(programs)]
    if 'study' in purposes(targets) if targets else False:
        path.insert(0, str(WS / 'venv' / 'bin'))
    kept = {name: value for name, value in os.environ.items() if targets or 'ROS' not in name and name not in (
        'PYTHONPATH', 'CMAKE_PREFIX_PATH', 'LD_LIBRARY_PATH', 'PKG_CONFIG_PATH')}
    return dict(kept, HOME=str(home), PATH=os.pathsep.join(path))


def _run(*words):
    return subprocess.run(words, stdout=subprocess.PIPE, check=True, text=True).stdout


@lru_cache(maxsize=None)
def _installed():
    """Return ({installed package: [its dependencies, each a list of names]}, {virtual name: packages}, minimal ones).

    Minimal is what each Debian has: debootstrap's smallest choice.
    """
    form = '${db:Status-Status}\t${Package}\t${Pre-Depends}, ${Depends}\t${Provides}\t${Essential} ${Priority}\n'
    needs, virtual, minimal = {}, {}, set()
    for line in _run('dpkg-query', '-W', '-f', form).splitlines():
        status, name, wanted, provided, kind = line.split('\t')
        if status == 'installed':
            needs[name] = [NAME.findall(clause) for clause in wanted.split(',') if clause.strip()]
            minimal |= {name} if kind.startswith('yes') or kind.endswith('required') else set()
            for other in NAME.findall(provided):
                virtual.setdefault(other, []).append(name)
    return needs, virtual, minimal


def _with_what_they_need(names):
    """Return the packages and all that they depend on; of alternatives the first that is there, as apt takes it."""
    needs, virtual, _ = _installed()
    seen, waiting = set(), sorted(names)
    while waiting:
        name = waiting.pop()
        if name not in seen:
            seen.add(name)
            for choice in needs[name]:
                there = [one for other in choice for one in ([other] if other in needs else virtual.get(other, []))]
                waiting += there[:1]
    return seen


@lru_cache(maxsize=None)
def _files(names):
    """Return the files and folders of those of the packages that are installed, in their true folders."""
    done = subprocess.run(['dpkg-query', '-L', *names], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=False,
                          text=True)
    folders = {}

    def true(path):
        folder, name = os.path.split(path)
        if folder not in folders:
            folders[folder] = os.path.realpath(folder)
        return os.path.join(folders[folder], name)
    return {true(line) for line in done.stdout.splitlines() if line.startswith('/')}


def _programs(files):
    """Yield (name, path) of the programs that are among ``files``, also by a link of update-alternatives."""
    seen = set()
    for folder in PROGRAMS:
        for name in sorted(os.listdir(folder)):
            path = os.path.join(os.path.realpath(folder), name)
            if name not in seen and (path in files or os.path.realpath(path) in files):
                seen.add(name)
                yield name, path


def _hidden(files):
    """Return the files and folders of Python's modules that are not among ``files``, a folder for all that it holds."""
    waiting, found = [path for path in PYTHON if path.is_dir()], []
    while waiting:
        for path in sorted(waiting.pop().iterdir()):
            if str(path) not in files:
                found += [str(path)] if path.name != '__pycache__' else []
            elif path.is_dir() and not path.is_symlink():
                waiting.append(path)
    return found
