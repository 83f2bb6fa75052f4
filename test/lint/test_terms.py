"""One term for one thing: the page of terms, and words that the documentation does not use."""
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
DOCS = ROOT / 'docs'
TERMS = (DOCS / 'terms.md').read_text(encoding='utf-8')
ROWS = re.findall(r'^\| \*\*([^|*]+)\*\* \| ([^|]+) \| ([^|]*) \|$', TERMS, re.MULTILINE)
PAGES = [ROOT / 'README.md', ROOT / 'CONTRIBUTING.md', *sorted(DOCS.glob('*.md')),
         *sorted((DOCS / 'nodes').glob('*.md'))]
NOT_SO = sorted({word.strip() for _, _, words in ROWS for word in words.split(',')} - {''})
#: pages that speak of other programs, or of other standards, in their words
ABOUT_OTHERS = {('why_preloading.md', 'virtual time'), ('compatibility.md', 'waypoint')}
CODE = re.compile(r'^```.*?^```|`[^`\n]*`', re.DOTALL | re.MULTILINE)


def used(text, words=NOT_SO):
    """Return the words among ``words`` that a text uses; code does not count."""
    plain = CODE.sub('', text)
    return [word for word in words if re.search(r'\b{}s?\b'.format(re.escape(word)), plain, re.IGNORECASE)]


@pytest.mark.parametrize('page', [page for page in PAGES if page.name != 'terms.md'], ids=lambda page: page.name)
def test_no_page_uses_another_word_for_a_term(page):
    found = used(page.read_text(encoding='utf-8'))
    assert [word for word in found if (page.name, word) not in ABOUT_OTHERS] == []


def test_another_word_is_noticed_but_not_in_code():
    assert used('An Observer and two way points; `virtual time`.\n```\nfederate\n```\n') == ['observer', 'way point']


def test_every_term_has_one_row_and_one_sentence():
    names = [name for name, _, _ in ROWS]
    assert len(names) > 40 and len(set(names)) == len(names)
    assert TERMS.count('\n| **') == len(names)
    for name, meaning, _ in ROWS:
        assert meaning.endswith('.') and meaning.count('. ') == 0, name


def test_a_term_is_no_other_word_for_another():
    assert {name for name, _, _ in ROWS} & set(NOT_SO) == set()
