"""Read the JUnit XML files of a test run, and print which tests failed and how many passed.

usage: test_summary.py RESULTS_FOLDER    (exit code 1 if a test failed, or none passed)
"""
import sys
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass, replace
from pathlib import Path

LOG_NAME = 'output.log'
LOG_TAIL_LINES = 40
PASSED, FAILED, SKIPPED = 'passed', 'failed', 'skipped'


@dataclass(frozen=True)
class Case:
    """One test: its name, its outcome, and its text if it failed."""

    name: str
    outcome: str
    text: str = ''


def read_cases(folder):
    """Return the cases of all result files below a folder, in the order of the files."""
    cases = []
    for path in sorted(Path(folder).rglob('*.xml')):
        step = path.relative_to(folder).parts[0]
        cases.extend(replace(case, name=f'{step}: {case.name}') for case in _read_file(path))
    return cases


def _read_file(path):
    try:
        root = ElementTree.parse(path).getroot()
    except ElementTree.ParseError as error:
        text = f'it died before it had written its results: {path}: {error}\n{log_tail(path.parent.parent)}'
        return [Case(path.stem, FAILED, text)]
    cases = [_read_case(element) for element in root.iter('testcase')]
    if path.name.startswith('rostest-'):
        # rostest's own file repeats each test file as one case. Only its failures are needed: no
        # other file says that a test file timed out or died.
        tail = log_tail(path.parent.parent)
        return [replace(case, text=f'{case.text}\n{tail}') for case in cases if case.outcome == FAILED]
    # For example, rostest writes no case if setUpClass fails; only the log says why.
    return cases or [Case(path.stem, FAILED, f'{path} holds no test\n{log_tail(path.parent.parent)}')]


def log_tail(folder):
    """Return the last lines that a step printed; '' if there is no log in its folder."""
    path = Path(folder) / LOG_NAME
    return '\n'.join(path.read_text(errors='replace').splitlines()[-LOG_TAIL_LINES:]) if path.exists() else ''


def _read_case(element):
    name = f'{element.get("classname", "")}.{element.get("name", "")}'.strip('.')
    for tag in ('failure', 'error'):
        found = element.find(tag)
        if found is not None:
            return Case(name, FAILED, (found.text or found.get('message') or '').strip())
    if element.find('skipped') is not None or element.get('status') == 'notrun':
        return Case(name, SKIPPED)
    return Case(name, PASSED)


def closing_line(cases):
    """Return 'N passed, N failed', with ', N skipped' if there are any."""
    counts = {outcome: sum(case.outcome == outcome for case in cases) for outcome in (PASSED, FAILED, SKIPPED)}
    line = f'{counts[PASSED]} passed, {counts[FAILED]} failed'
    return f'{line}, {counts[SKIPPED]} skipped' if counts[SKIPPED] else line


def summarise(folder):
    """Print each failure with its text and the closing line; return the exit code."""
    cases = read_cases(folder)
    for case in cases:
        if case.outcome == FAILED:
            print(f'\nFAILED {case.name}\n{case.text}')
    if not cases:
        print(f'no test was run: {folder} holds no result')
    print(f'\n{closing_line(cases)}' if any(case.outcome == FAILED for case in cases) else closing_line(cases))
    return 0 if any(case.outcome == PASSED for case in cases) and all(case.outcome != FAILED for case in cases) else 1


if __name__ == '__main__':
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(summarise(sys.argv[1]))
