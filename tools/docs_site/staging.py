"""Prepares the repository's pages for Sphinx: drawings become part of the page, terms become a glossary."""
import re
import shutil

PICTURE = re.compile(r'^!\[([^\]]*)\]\((images/[\w./-]+\.svg)\)$', re.MULTILINE)
TERM = re.compile(r'^\| \*\*([^|*]+)\*\* \| ([^|]*) \| ([^|]*) \|$', re.MULTILINE)


def stage(root, names, source):
    """Copy the files and folders ``names`` of ``root`` into the new folder ``source``, and prepare them for Sphinx."""
    source.mkdir(parents=True)
    for name in names:
        path = root / name
        if path.is_dir():
            shutil.copytree(path, source / name, ignore=shutil.ignore_patterns('__pycache__', '*.pyc'))
        else:
            shutil.copy(path, source / name)
    for name in ('conf.py', 'index.md'):
        shutil.move(str(source / 'docs' / 'site' / name), str(source / name))
    for path in [*source.glob('*.md'), *(source / 'docs').rglob('*.md')]:
        text = path.read_text(encoding='utf-8')
        made = with_drawings(text)
        made = with_glossary(made) if path.name == 'terms.md' else made
        if made != text:
            path.write_text(made, encoding='utf-8')


def with_drawings(text):
    """Return the text of a page that contains its SVG drawings, so that they have the colours of the theme."""
    return PICTURE.sub(lambda match: '```{{raw}} html\n:file: {}\n```'.format(match.group(2)), text)


def with_glossary(text):
    """Return the text of the page of terms, with each table as a glossary."""
    def entry(term, meaning, not_so):
        return '{}\n  {}{}'.format(term, meaning, ' Not called: {}.'.format(not_so) if not_so.strip() else '')

    def glossary(match):
        return '```{{glossary}}\n{}\n```\n'.format('\n\n'.join(
            entry(*(cell.strip() for cell in row)) for row in TERM.findall(match.group(0))))
    return re.sub(r'^\| term \|.*\n\|[-|]+\|\n(?:\|.*\n)+', glossary, text, flags=re.MULTILINE)
