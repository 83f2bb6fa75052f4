"""What the pages of the documentation point to is there: links, pictures, commands, launch files and their args."""

import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
import pytest

from move_base_abstract.fleet import Fleet
from move_base_abstract.maps.occupancy import OccupancyMap
from move_base_abstract.scenario import read_scenario
from move_base_abstract_ros.nodes.help import scripts

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / 'README.md', ROOT / 'CONTRIBUTING.md', *sorted((ROOT / 'docs').glob('*.md')),
         *sorted((ROOT / 'docs' / 'nodes').glob('*.md')),
         *sorted((ROOT / 'src').rglob('*.md'))]
LINK = re.compile(r'!?\[[^\]]*\]\(([^()\s]+)\)')
FENCE = re.compile(r'^```.*?^```', re.DOTALL | re.MULTILINE)
PROGRAMS = [*(name.rpartition('/')[2] for name in scripts()), 'time_master', 'PROGRAM']
README_LINES = 130  # what it is, two commands, ten lines, pictures, links; what is longer has a page of its own


def name(path):
    return str(path.relative_to(ROOT))


def text_of(path):
    return path.read_text(encoding='utf-8')


def links(path):
    """Return the targets of a page's links, those in code left out."""
    return LINK.findall(re.sub(r'`[^`\n]*`', '``', FENCE.sub('', text_of(path))))


def anchors(path):
    """Return the anchors that GitHub gives to a page's headings."""
    found = []
    for heading in re.findall(r'^#+ +(.*?) *$', FENCE.sub('', text_of(path)), re.MULTILINE):
        words = re.sub(r'\[([^\]]*)\]\([^)]*\)', r'\1', heading)
        anchor = re.sub(r'[^\w\- ]', '', words.lower()).replace(' ', '-')
        found.append(anchor if anchor not in found else f'{anchor}-{sum(each.startswith(anchor) for each in found)}')
    return found


def broken(path):
    """Return the links of a page that lead nowhere. Those to other sites are not looked at."""
    lost = []
    for link in links(path):
        target, _, anchor = link.partition('#')
        if re.match(r'[a-z]+:', target):
            continue
        there = (path.parent / target).resolve() if target else path
        if not there.exists() or anchor and (there.suffix != '.md' or anchor not in anchors(there)):
            lost.append(link)
    return lost


@pytest.mark.parametrize('page', PAGES, ids=name)
def test_every_link_leads_somewhere(page):
    assert broken(page) == []


def test_a_link_that_leads_nowhere_is_noticed(tmp_path):
    page = tmp_path / 'page.md'
    page.write_text('# One `two`\n[a](#one-two) [b](#three) [c](none.md) ![d](page.md#one-two) [e](https://x.org)\n'
                    '```\n[f](none.md)\n```\n')
    assert broken(page) == ['#three', 'none.md']


def test_every_page_is_reached_from_the_readme():
    seen, waiting = set(), [ROOT / 'README.md']
    while waiting:
        page = waiting.pop()
        if page not in seen:
            seen.add(page)
            targets = [(page.parent / link.partition('#')[0]).resolve() for link in links(page)]
            waiting += [target for target in targets if target.suffix == '.md' and target.is_file()]
    assert {page for page in PAGES if (ROOT / 'docs') in page.parents} - seen == set()


def kinds():
    """Return the kinds of pages and their pages, {kind: [names]}: the groups of the site's navigation."""
    trees = re.findall(r'^```{toctree}\n:caption: ([^\n]*)\n(.*?)^```', text_of(ROOT / 'docs' / 'site' / 'index.md'),
                       re.DOTALL | re.MULTILINE)
    return {kind: [line for line in body.split() if not line.startswith(':')] for kind, body in trees}


def test_each_page_is_of_one_kind():
    named = [page for pages in kinds().values() for page in pages]
    generated = ['docs/reference_python', 'docs/reference_interfaces', 'docs/nodes/*', 'look']
    there = [name(path)[:-len('.md')] for path in (ROOT / 'docs').glob('*.md')]
    assert sorted(named) == sorted([*there, *generated, 'README', 'CONTRIBUTING', 'CHANGELOG'])
    assert list(kinds()) == ['Tutorials', 'How to', 'Explanation', 'Reference', 'Reference of the nodes',
                             'Reference for those who change it']


def test_the_changelog_has_up_to_15_lines_a_release_for_users():
    releases = re.split(r'^.*\n-{5,}\n', text_of(ROOT / 'CHANGELOG.rst'), flags=re.MULTILINE)[1:]
    lines = [[line for line in release.splitlines() if line] for release in releases]
    assert releases and [release for release in lines if len(release) > 15] == [], 'git has the rest: condense'
    assert [line for release in lines for line in release if len(line) > 170] == []


def test_the_page_to_begin_with_names_each_tutorial():
    page = text_of(ROOT / 'docs' / 'start.md')
    assert [each for each in kinds()['Tutorials'] if each != 'look' and f'(../{each}.md)' not in page] == []


def test_every_picture_is_shown():
    shown = {(page.parent / link).resolve() for page in PAGES for link in links(page)}
    assert set((ROOT / 'docs' / 'images').iterdir()) - shown == set()


def test_the_readme_is_short():
    assert len(text_of(ROOT / 'README.md').splitlines()) <= README_LINES


def test_the_architecture_and_each_house_have_up_to_150_lines():
    pages = [ROOT / 'docs' / 'architecture.md', *sorted((ROOT / 'docs').glob('house_*.md'))]
    assert len(pages) == 6
    assert [name(page) for page in pages if len(text_of(page).splitlines()) > 150] == []


def test_programs_launch_files_and_targets_that_are_named_are_there():
    rules = re.findall(r'^([a-z][a-z -]*):(?!=)', text_of(ROOT / 'Makefile'), re.MULTILINE)
    targets = {target for rule in rules for target in rule.split()}
    lost = []
    for page in PAGES:
        code = '\n'.join([*FENCE.findall(text_of(page)), *re.findall(r'`([^`\n]+)`', text_of(page)),
                          *re.findall(r'^    (.*)$', text_of(page), re.MULTILINE)])
        lost += [(name(page), word) for word in re.findall(r'\brosrun move_base_abstract (\w+)', code)
                 if word not in PROGRAMS and not (ROOT / 'examples' / word).exists()]
        lost += [(name(page), word) for word in re.findall(r'^make ([a-z][a-z-]*)', code, re.MULTILINE)
                 if word not in targets]
    assert lost == []


def rows_of_words():
    """Return the cells of each row of the page of the product's words: word, where, promise, what is done, test."""
    rows = [re.split(r'(?<!\\) \| ', line.strip('| ')) for line in text_of(ROOT / 'docs' / 'words.md').splitlines()
            if line.startswith('| ')]
    return [row for row in rows if row[0] != 'word']


def text_of_tests():
    """Return the text of all tests, and the names of their files."""
    files = [path for path in (ROOT / 'test').rglob('*') if path.suffix in ('.py', '.cpp', '.test')]
    return '\n'.join(map(text_of, files)), {path.name for path in files}


def test_each_word_has_one_row_and_a_test_that_is_there():
    text, files = text_of_tests()
    rows = rows_of_words()
    assert len(rows) > 40 and len({(row[0], row[1]) for row in rows}) == len(rows)
    for word, *_, tests in rows:
        names = re.findall(r'`([^`]+)`', tests)
        assert names, word
        for named in names:
            group, _, last = named.rpartition('.') if not named.endswith(('.py', '.test')) else ('', '', '')
            assert named in files or f'def {named}(' in text or re.search(rf'TEST\w*\({group}, ' if last == '*' else (
                rf'TEST\w*\({group or "[A-Za-z]+"}, {last}\)|\b{last.rpartition("/")[2]}\b'), text), (word, named)


def launch_lines():
    """Return (page, launch file, names of the args given) of every roslaunch of this package in the pages."""
    for page in PAGES:
        for file, rest in re.findall(r'roslaunch move_base_abstract ([\w/]+\.launch)([^\n`]*)', text_of(page)):
            yield name(page), file, re.findall(r'(\w+):=', rest.partition(' # ')[0])


def test_launch_files_that_are_named_take_the_args_that_are_given():
    lines = list(launch_lines())
    assert len(lines) > 10
    for page, file, given in lines:
        [path] = (ROOT / 'launch').rglob(Path(file).name)
        args = {arg.get('name') for arg in ElementTree.parse(path).getroot().findall('arg')}
        assert set(given) <= args, (page, file)


def test_the_scenario_of_the_readme_is_one(tmp_path):
    file = tmp_path / 'world.yaml'
    file.write_text(re.search('```yaml\n(.*?)```', text_of(ROOT / 'README.md'), re.DOTALL).group(1), encoding='utf-8')
    fleet = Fleet(read_scenario(file), occupancy=OccupancyMap(np.zeros((400, 600), np.int8), 0.1))
    for robot in fleet.names:
        fleet.robot(robot).send(30.0, 20.0)
    fleet.run_for(3600.0)
    assert {'departed', 'entered', 'held', 'charging_began'} <= {entry.kind for entry in fleet.trace}
