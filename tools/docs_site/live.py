"""The live pages of the site: replays and reports of runs that are made now. Readers need not install anything."""
import re
import shutil
import subprocess
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
PLAIN = ROOT / '.ws' / 'plain' / 'bin' / 'python'  # with SimPy, of which Debian has an old version only
LIMIT = 1800  # s, wall: longest time of one command
#: changes of the ranking's file, so that it takes seconds: (line of the file, its replacement)
SHORTER = ((r'replications: \d+', 'replications: 5'), (r'  robots: \[2, 3\]', '  robots: [3]'),
           (r'  map: \[farm_yard, aisles_5\]', '  map: [{}]'.format(ROOT / 'maps' / 'farm_yard.yaml')))
MBA = ('rosrun', 'move_base_abstract')


class LiveError(Exception):
    """A run failed. The text has its command and its output."""


def make(folder, out):
    """Make all live pages below ``out``, with ``folder`` for intermediate files; return [(title, file, text)].

    :raises LiveError: if a run fails.
    """
    for path in (folder, out):
        if path.exists():
            shutil.rmtree(path)  # from an earlier run of this program
        path.mkdir(parents=True)
    return [one(folder, out) for one in (_demo, _warehouse, _encounter, _patrol, _ranking)]


def page(made):
    """Return the page with links to the live pages; ``made``: the result of :func:`make`."""
    lines = ['# Look '
             'before you install', '', 'These pages were made with this site, from runs that are made anew each time. '
                                       'They work '
             'in your browser and load nothing.', '']
    for title, file, text in made:
        lines += ['## ' + title, '', text, '', '```{raw} html',
                  f'<p><a class="live" href="live/{file}">Open: {title}</a></p>']
        if file == made[0][1]:
            lines += [f'<iframe class="live" src="live/{file}" title="{title}" loading="lazy"></iframe>']
        lines += ['```', '']
    pictures = (('docs/images/rviz.png', 'RViz', 'Five robots on the map of a farm yard in RViz '
                                                 '([more](docs/rviz.md)).'),
                ('docs/images/soil_mapping.png', 'The soil study in RViz', 'A study that maps soil compaction '
                 '([more](docs/soil_study.md)).'),
                ('docs/images/radio_auction.png', 'The radio in RViz', 'An auction over a radio that walls weaken '
                 '([more](docs/radio.md)).'))
    for file, title, text in pictures:
        lines += ['## ' + title, '', text, '', f'![{title}]({file})', '']
    return '\n'.join(lines)


def _run(*words, cwd=None):
    """Run a command. :raises LiveError: if it fails, with its output."""
    done = subprocess.run([str(word) for word in words], cwd=cwd, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          timeout=LIMIT, check=False, text=True)
    if done.returncode != 0:
        raise LiveError('{} ended with {}:\n{}'.format(' '.join(map(str, words)), done.returncode, done.stdout[-4000:]))


def _replay(log, chart, out):
    _run(*MBA, 'replay', log, '--map', chart, '-o', out)


def _demo(folder, out):
    log = folder / 'demo.jsonl'
    _run(*MBA, 'demo', '--event-log', log)
    _replay(log, ROOT / 'maps' / 'farm_yard.yaml', out / 'demo.html')
    return ('Replay of the demo', 'demo.html', 'Five robots drive a mission of 36 goals in a farm yard, under ROS in '
                                               'lockstep. '
            'Press play, click a robot, or drag on the rows of the timeline.\n\n'
            '```\nrosrun move_base_abstract demo --event-log RUN.jsonl\n'
            'rosrun move_base_abstract replay RUN.jsonl --map maps/farm_yard.yaml\n```')


def _warehouse(folder, out):
    site, log = folder / 'warehouse', folder / 'warehouse.jsonl'
    _run(*MBA, 'scenario', 'make', 'warehouse', '--out', site, '--robots', 20)
    _run(PLAIN, ROOT / 'examples' / 'warehouse.py', site / 'scenario.yaml', log)
    _replay(log, site / 'map.yaml', out / 'warehouse.html')
    return ('Replay of '
            'a warehouse', 'warehouse.html', 'Twenty robots carry goods along one-way lanes from bays to stations, in '
            'plain Python without ROS.\n\n'
            '```\nrosrun move_base_abstract scenario make warehouse --out my_warehouse --robots 20\n'
            'python3 examples/warehouse.py my_warehouse/scenario.yaml RUN.jsonl\n'
            'rosrun move_base_abstract replay RUN.jsonl --map my_warehouse/map.yaml\n```')


def _encounter(folder, out):
    log = folder / 'encounter.jsonl'
    _run(PLAIN, ROOT / 'examples' / 'plain' / 'encounter.py', log)
    _replay(log, ROOT / 'maps' / 'farm_yard.yaml', out / 'encounter.html')
    return ('Replay '
            'of an encounter', 'encounter.html', 'Two robots that are calibrated to recordings of `move_base` on '
                                                 'Stage come '
            'towards each other, and it costs them time ([encounters](docs/encounters.md)).\n\n'
            '```\npython3 examples/plain/encounter.py RUN.jsonl\n'
            'rosrun move_base_abstract replay RUN.jsonl --map maps/farm_yard.yaml\n```')


def _patrol(folder, out):
    done = folder / 'patrol'
    _run(*MBA, 'experiment', 'run', ROOT / 'config' / 'experiments' / 'patrol.yaml', '-o', done)
    _take_report(done, out, 'patrol')
    return ('Report on an experiment', 'patrol/report.html', 'One and three robots patrol with two pauses, three '
                                                             'replications of each: '
            'a launch file as it is, twelve runs, one report ([how to read it](docs/statistics.md)).\n\n'
            '```\nrosrun move_base_abstract experiment run config/experiments/patrol.yaml -o OUT\n```')


def _ranking(folder, out):
    files, done = folder / 'ranking_files', folder / 'ranking'
    shutil.copytree(ROOT / 'examples' / 'ranking', files, ignore=shutil.ignore_patterns('__pycache__'))
    plan = files / 'ranking.yaml'
    text = plan.read_text(encoding='utf-8')
    for line, here in SHORTER:
        text, found = re.subn('^{}$'.format(line), here, text, flags=re.MULTILINE)
        if not found:
            raise LiveError(f'{plan}: has no line {line}')
    plan.write_text(text, encoding='utf-8')
    _run(PLAIN, '-m', 'move_base_abstract_experiments', 'run', plan, '-o', done)
    _take_report(done, out, 'ranking')
    return ('Report on the '
            'ranking of '
            'coordinators', 'ranking/report.html', 'Five coordinators on four kinds of abstract robots, from '
            'the plainest to those calibrated to recordings: 3 robots, one set of tasks, 5 replications; the file '
            'that ships has 200 '
            '([what the ranking is worth](docs/reality.md)).\n\n'
            '```\nrosrun move_base_abstract experiment run examples/ranking/ranking.yaml -o OUT\n```')


def _take_report(done, out, name):
    """Copy the report of an experiment, and the files to which it links."""
    (out / name).mkdir()
    shutil.copy(done / 'report.html', out / name / 'report.html')
    for part in ('tables', 'replays'):
        if (done / part).is_dir():
            shutil.copytree(done / part, out / name / part)
