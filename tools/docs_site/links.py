"""Checks links within the finished site: each must lead to an existing file, and to an anchor in it."""
import re
from pathlib import Path
from urllib.parse import unquote

LINK = re.compile(r'(?:href|src)="([^"]+)"')
ANCHOR = re.compile(r'\bid="([^"]+)"')


def lost(html):
    """Return [(page, link)] of broken links of the site in folder ``html``; links to other sites are not checked."""
    html = Path(html)
    pages = {path.resolve(): path.read_text(encoding='utf-8') for path in sorted(html.rglob('*.html'))
             if 'live' not in path.relative_to(html).parts}
    anchors = {path: set(ANCHOR.findall(text)) for path, text in pages.items()}
    found = []
    for path, text in pages.items():
        for link in sorted(set(LINK.findall(text))):
            target, _, anchor = link.partition('#')
            target = unquote(target.partition('?')[0])
            if re.match(r'[a-z]+:|//', link):
                continue
            there = (path.parent / target).resolve() if target else path
            if not there.exists() or anchor and there in anchors and unquote(anchor) not in anchors[there]:
                found.append((str(path.relative_to(html.resolve())), link))
    return found
