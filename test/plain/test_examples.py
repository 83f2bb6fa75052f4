"""Each example in plain Python prints what its docstring says."""
import ast
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = sorted((ROOT / 'examples' / 'plain').glob('*.py'))
LIMIT = 600.0  # s, wall; only ends a program that would never end


@pytest.mark.parametrize('path', EXAMPLES, ids=[path.stem for path in EXAMPLES])
def test_an_example_prints_what_it_says(path):
    told = ast.get_docstring(ast.parse(path.read_text())).split('\n\n')[1]
    done = subprocess.run([sys.executable, str(path)], stdout=subprocess.PIPE, universal_newlines=True, timeout=LIMIT,
                          check=True, env=dict(os.environ, PYTHONPATH=str(ROOT / 'src')))
    assert done.stdout.splitlines() == told.splitlines()


def test_there_are_ten_of_them_and_the_page_names_each():
    page = (ROOT / 'docs' / 'processes.md').read_text()
    assert len(EXAMPLES) >= 10
    assert [path.name for path in EXAMPLES if path.name not in page] == []
