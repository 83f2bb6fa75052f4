"""The tables of options in the docs are those of the code."""
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / 'tools'))
import write_options  # noqa: E402


@pytest.mark.parametrize('page', write_options.TABLES)
def test_a_page_has_the_options_of_the_code(page):
    assert (Path(write_options.DOCS) / page).read_text(encoding='utf-8') == write_options.make_page(page), (
        'run tools/write_options.py')
