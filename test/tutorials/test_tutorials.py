"""The commands of each tutorial show what its page says, where only what the page asks for is installed."""
import sys

import pytest
from typing_of_pages import ROOT, as_readers_type, differences, needs, run, tutorials

sys.path.append(str(ROOT / 'test' / 'prerequisites'))
import bare  # noqa: E402 - from this folder


@pytest.mark.night
@pytest.mark.parametrize('page', tutorials(), ids=lambda path: path.stem)
def test_a_tutorial_shows_what_it_says(page, tmp_path):
    folders = folder, outputs, machine = [tmp_path / name for name in ('tutorial', 'outputs', 'machine')]
    for each in folders:
        each.mkdir()
    text = page.read_text(encoding='utf-8')
    done = run(as_readers_type(text), folder, outputs, bare.environment(machine, *needs(text)))
    assert sum(told is not None for _, told, _ in done) >= 3
    assert '\n'.join(differences(done)) == ''
