"""The commands of each tutorial show what its page says."""
import pytest
from typing_of_pages import ENVIRONMENTS, differences, run, tutorials


@pytest.mark.parametrize('page', tutorials(), ids=lambda path: path.stem)
def test_a_tutorial_shows_what_it_says(page, tmp_path):
    folder, outputs = tmp_path / 'tutorial', tmp_path / 'outputs'
    folder.mkdir()
    outputs.mkdir()
    done = run(page.read_text(encoding='utf-8'), folder, outputs, ENVIRONMENTS.get(page.stem))
    assert sum(told is not None for _, told, _ in done) >= 3
    assert '\n'.join(differences(done)) == ''
