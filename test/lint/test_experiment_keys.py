"""The page with all keys of an experiment is what the tables of the code make of it."""
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / 'tools'))

import write_experiment_keys  # noqa: E402


def test_the_page_is_up_to_date():
    page = Path(write_experiment_keys.PAGE).read_text(encoding='utf-8')
    assert page == write_experiment_keys.make_page(), 'run tools/write_experiment_keys.py'
