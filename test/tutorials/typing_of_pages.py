"""Runs the commands of a page, and compares their output with the text of the page.

All ``sh`` blocks of a page run in one shell and in one folder, which is empty at first. If a ``text`` block comes next,
it is the expected output. In it, ``...`` stands for any text, and on a line of its own for any lines. The first command
that fails ends the page. Blocks of other kinds do not run, since they need a screen, the network or much time. Only
where a page asks for no target of the Makefile, its first ``console`` block is typed before: it asks pip.

usage: typing_of_pages.py PAGE    type the commands of a page, and print what differs; exit code 1 if something does
"""
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
LIMIT = 1500.0  # wall s; only ends a page that would never end
NEED = re.compile(r'^You need: (.*?)(?:\.\s|\.$)', re.DOTALL | re.MULTILINE)
CODE = re.compile(r'`([^`]+)`')
FENCE = re.compile(r'^```(\w*)\n(.*?)^```$', re.DOTALL | re.MULTILINE)
COLOUR = re.compile(r'\x1b\[[0-9;]*m|\x1b\][^\x07]*\x07')


def tutorials():
    """Return the tutorials in the order of the site's navigation."""
    index = (ROOT / 'docs' / 'site' / 'index.md').read_text(encoding='utf-8')
    [group] = re.findall(r'^:caption: Tutorials\n(.*?)^```', index, re.DOTALL | re.MULTILINE)
    return [ROOT / (line + '.md') for line in group.split() if line.startswith('docs/')]


def needs(text):
    """Return ([targets of the Makefile], [Debian packages]) that a page says are needed, or None if it says nothing.

    They are the code in the sentence that begins with "You need: ".
    """
    said = NEED.search(text)
    if said is None:
        return None
    targets, packages = [], []
    for code in CODE.findall(said.group(1)):
        for begin, found in (('make ', targets), ('apt-get install ', packages)):
            if code.startswith(begin):
                found.extend(code[len(begin):].split())
    return targets, packages


def as_readers_type(text):
    """Return the text of a page whose ``sh`` blocks are all that readers type in the environment that it asks for."""
    if needs(text)[0]:
        return text
    first = next(words for kind, words in FENCE.findall(text) if kind == 'console')
    return '```sh\n{}```\n'.format(first.replace('PATH_OF_THE_SOURCES', str(ROOT))) + text


def steps(text):
    """Return [(commands, expected output or None)] for a page."""
    blocks = FENCE.findall(text)
    return [(words, after[1] if after[0] == 'text' else None)
            for (kind, words), after in zip(blocks, [*blocks[1:], ('', '')]) if kind == 'sh']


def pattern(told):
    """Return the regular expression for the expected output of a page."""
    lines = [r'(?:.*\n)*?' if line.strip() == '...' else '.*?'.join(map(re.escape, line.split('...'))) + r'\n'
             for line in told.splitlines()]
    return re.compile(''.join(lines))


def shown(folder, number):
    """Return the output of a step as a terminal shows it, without colours and spaces at the ends of lines."""
    text = COLOUR.sub('', (folder / str(number)).read_text(encoding='utf-8'))
    return ''.join(line.rpartition('\r')[2].rstrip() + '\n' for line in text.splitlines())


def run(page, folder, outputs, environment=None):
    """Run the commands of a page in a folder; return [(commands, expected, shown)] for the steps that began."""
    todo = steps(page)
    script = ['set -e', *(f'exec >{outputs / str(number)} 2>&1\n{words}' for number, (words, _) in enumerate(todo))]
    environment = dict(environment or os.environ, ROS_LOG_DIR=str(outputs / 'log'))
    code = subprocess.run(['bash', '-c', '\n'.join(script)], cwd=folder, env=environment, stdin=subprocess.DEVNULL,
                          timeout=LIMIT, check=False).returncode
    done = [(words, told, shown(outputs, number)) for number, (words, told) in enumerate(todo)
            if (outputs / str(number)).exists()]
    assert code == 0, f'exit code {code} of\n{done[-1][0]}\nwhich shows\n{done[-1][2]}'
    return done


def differences(done):
    """Return a text for each step whose output differs from its page."""
    return [f'{words}\nshows\n{seen}\ninstead of\n{told}' for words, told, seen in done
            if told is not None and not pattern(told).fullmatch(seen)]


def main(words):
    """Type a page in new folders; return the exit code."""
    if len(words) != 1:
        print(__doc__, file=sys.stderr)
        return 2
    with tempfile.TemporaryDirectory() as base:
        folder, outputs = Path(base, 'tutorial'), Path(base, 'outputs')
        folder.mkdir()
        outputs.mkdir()
        found = differences(run(as_readers_type(Path(words[0]).read_text(encoding='utf-8')), folder, outputs))
    print(*found, sep='\n', end='\n' if found else '')
    return int(bool(found))


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
