#!/usr/bin/env python3
"""Copy the sources of lockstep, with each rule as a thing that a test can break.

usage: make_mutants.py FOLDER_OF_SOURCES FOLDER_TO_WRITE TABLE

TABLE has one entry for each place: a line '== RULE FILE' (its name, or the end of its path), the text of the source, a
line '--', and what stands in its place. There '@' is isBroken("RULE") and '%' the text itself. Each text must be in its
file exactly once: a source that has changed ends the build, not the test of a rule.
"""
import sys
from pathlib import Path


def entries(table):
    """Yield (rule, file, text, replacement) of each entry."""
    for block in table.split('\n== ')[1:]:
        head, _, body = block.partition('\n')
        rule, file = head.split()
        text, _, replacement = body.rstrip('\n').partition('\n--\n')
        yield rule, file, text, replacement.replace('%', text).replace('@', f'isBroken("{rule}")')


def mutate(sources, table):
    """Return {path: text} of all sources; sources is {path: text} too.

    :raises ValueError: for a text that is not in its file exactly once
    """
    mutated = dict(sources)
    for rule, file, text, replacement in entries(table):
        path = next((path for path in sources if path.as_posix().endswith('/' + file)), None)
        if path is None or mutated[path].count(text) != 1:
            raise ValueError(f'{rule}: {file} must have this exactly once: {text!r}')
        mutated[path] = mutated[path].replace(text, replacement)
    return {path: text if text == sources[path] else '#include "broken.h"\n' + text for path, text in mutated.items()}


def main(folder, output, table):
    """Write what has changed."""
    paths = [path for path in sorted(folder.rglob('*')) if path.suffix in ('.h', '.cpp')]
    sources = {path: path.read_text(encoding='utf-8') for path in paths}
    for path, text in mutate(sources, table.read_text(encoding='utf-8')).items():
        target = output / path.relative_to(folder)
        target.parent.mkdir(parents=True, exist_ok=True)
        if not target.exists() or target.read_text(encoding='utf-8') != text:
            target.write_text(text, encoding='utf-8')


if __name__ == '__main__':
    try:
        main(*(Path(word) for word in sys.argv[1:]))
    except ValueError as error:
        sys.exit(f'make_mutants.py: {error}')
