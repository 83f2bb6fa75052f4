"""Read the JUnit XML files of a test run, and print which tests failed and how many passed.

usage: test_summary.py RESULTS_FOLDER    (exit code 1 if a test failed, or none passed)
"""
import re
import sys
import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass, replace
from pathlib import Path

LOG_NAME = 'output.log'
LOG_TAIL_LINES = 40
LOG_OF_A_PROCESS = re.compile(r'^-+ \S+\.out -+$', re.MULTILINE)  # as test/systems/conftest.py shows it
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
    return cases or [Case(path.stem, FAILED, f'{path} holds no test\n{log_tail(path.parent.parent)}')]


def log_tail(folder):
    """Return the last lines that a step printed; '' if there is no log in its folder."""
    path = Path(folder) / LOG_NAME
    return '\n'.join(path.read_text(errors='replace').splitlines()[-LOG_TAIL_LINES:]) if path.exists() else ''


def logs_of_processes(folder):
    """Return what the processes of a step printed last, as it stands in its log if a test failed; otherwise ''."""
    path = Path(folder) / LOG_NAME
    text = path.read_text(errors='replace') if path.exists() else ''
    found = LOG_OF_A_PROCESS.search(text)
    return text[found.start():] if found else ''


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
    for step in sorted({case.name.partition(':')[0] for case in cases if case.outcome == FAILED}):
        said = logs_of_processes(Path(folder) / step)
        if said:
            print(f'\nWhat the processes of {step} printed last\n{said}')
    if not cases:
        print(f'no test was run: {folder} holds no result')
    print(f'\n{closing_line(cases)}' if any(case.outcome == FAILED for case in cases) else closing_line(cases))
    return 0 if any(case.outcome == PASSED for case in cases) and all(case.outcome != FAILED for case in cases) else 1


if __name__ == '__main__':
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    sys.exit(summarise(sys.argv[1]))
