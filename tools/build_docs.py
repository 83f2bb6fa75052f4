"""Build the documentation site: stage the repository's pages, write pages from sources and runs, and run Sphinx.

usage: build_docs.py OUTPUT    (in the built environment: source .ws/setup.sh)

The pages of the repository do not change. Other pages are generated from the sources (public names, their docstrings,
messages) and from runs that are made now (replays, reports). Warnings are errors: a link to a page or heading that does
not exist, or a docstring that cannot be read. A broken link within the finished site is an error, too.
"""
import shutil
import subprocess
import sys
from pathlib import Path

from docs_site import links, live, reference, staging

ROOT = Path(__file__).resolve().parent.parent
STAGED = ('docs', 'examples', 'config', 'README.md', 'CONTRIBUTING.md', 'CHANGELOG.rst', 'LICENSE', 'CITATION.cff')


def main(words):
    """Build the site into the folder of the command line; return the exit code."""
    if len(words) != 1:
        print(__doc__, file=sys.stderr)
        return 2
    output = Path(words[0]).resolve()
    source = output / 'source'
    if source.exists():
        shutil.rmtree(source)  # from an earlier run of this program
    staging.stage(ROOT, STAGED, source)
    _write(source / 'docs' / 'reference_interfaces.md', reference.interfaces())
    _write(source / 'docs' / 'reference_python.md', reference.python())
    try:
        _write(source / 'look.md', live.page(live.make(output / 'live', source / 'extra' / 'live')))
    except live.LiveError as error:
        print('docs: {}'.format(error), file=sys.stderr)
        return 1
    html = output / 'html'
    command = [sys.executable, '-m', 'sphinx', '-b', 'html', '-W', '--keep-going', '-q', '-j', 'auto', '-d',
               str(output / 'doctrees'), str(source), str(html)]
    code = subprocess.run(command, check=False).returncode
    lost = links.lost(html) if code == 0 else []
    print(*['docs: {}: {} is a broken link'.format(*one) for one in lost], sep='\n', end='\n' if lost else '')
    print('docs: there are errors, see above' if code or lost else 'the site: {}'.format(html / 'index.html'))
    return code or int(bool(lost))


def _write(path, text):
    path.write_text(text, encoding='utf-8')


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
