"""What makes a trial the trial it is: digests of releases before stay, so that what has run does not run again."""
import platform

import pytest

from move_base_abstract_experiments.description import plan, spec

LAUNCH = {'experiment': 'x', 'launch': 'x.launch'}
#: documents, with how many trials there are, the last one's id and digest, as before options were in one table
KNOWN = [
    (LAUNCH, 1, '0001-64f0bf', '4c225d6d6799641894167f714836d34341784ec94f66de10ac777600bc853b4e'),
    ({'experiment': 'x', 'command': ['run', '{seed}'], 'participants': ['/a', 'b'], 'until': {'seconds': 3}},
     1, '0001-64f0bf', 'b6f2b1c8dddd33edfbe2528e917693c28ad2a0fdfc2407b923f4fe6b1b3a5216'),
    ({'experiment': 'x', 'function': 'a.b:c', 'prepare': 'p:q',
      'args': {'n': '{n}', 'm': 2, 't': True, 'x': 0.5, 's': 'a{n}b'}, 'factors': {'n': [1, 2.5, 'z', False]},
      'replications': 2, 'seed': 7, 'verify': 1},
     8, '0008-4b1c71', 'c522605b5cc7386b72976d21c30e66706ec0f3c3c94f5fb079f284dcad9c8fd9'),
    ({**LAUNCH, 'factors': {'robots': ['2', '4'], 'algorithm': ['greedy', 'auction']},
      'args': {'robots': '{robots}', 'algorithm': '{algorithm}', 'seed': '{seed}'},
      'replications': {'all': 3, 'robots': {'4': 1}}, 'until': {'seconds': 3600, 'topic': 'done', 'idle': True},
      'record': {'messages': ['idleness', '/b'], 'files': ['*.csv'], 'hashes': True, 'motion': False},
      'metrics': 'm.n:f', 'verify': 0.5, 'sleep': 'simulated'},
     8, '0010-b60e24', '5bc9aaa3d17d8904f8dd0a3f9f7599864f57d192e1a00f2ccd25017e0fad5488'),
    ({**LAUNCH, 'lookahead': 0.05, 'cores': 'one', 'crashes': 'allow', 'leave_out': ['a', '/b'],
      'replace': {'x/y': 'z/w', 'a/b': 'c/d'}, 'participants': ['n']},
     1, '0001-64f0bf', 'feb8a11ea5d4c702c7c0349c04a739a5dec5aed99608dfc6586fbb06e11978ab'),
    ({**LAUNCH, 'stored_topics': ['/a', 'n=/b'], 'primary': 'goals', 'baseline': {}, 'time_limit': 30,
      'smallest_difference': {'goals': 1}, 'at_limit': {'goals': 'value'}, 'report': 'r:s', 'inputs': ['f.csv'],
      'metrics': {'function': 'a:b', 'columns': {'c': {'unit': 's', 'better': 'lower'}}}},
     1, '0001-64f0bf', 'ce01a3bbe77222e243a59be54fd79aeee57cddf60e7c740927c2e7bcf380d23e'),
    ({**LAUNCH, 'until': {'idle': True}, 'record': {'motion': True}, 'lookahead': 0, 'participants': 'all'},
     1, '0001-64f0bf', '9b70e5161d00495146992e0278932a3f2d9570ac4efbc88908b85f9f72eca206')]
MADE = {'/w/a.py': 'aa', 'move_base_abstract': 'bb', 'parameters': 'cc'}


@pytest.fixture(autouse=True)
def versions(monkeypatch):
    monkeypatch.setattr(plan, 'package_version', lambda: '1.2.3')
    monkeypatch.setattr(platform, 'python_version', lambda: '3.9.2')


def last_of(document):
    trials = plan.trials(spec.checked(document, '/folder'))
    return len(trials), trials[-1].id, plan.made_of(trials[-1], MADE)


# Which trials run twice, and under which condition, was chosen in another way before; this lets no trial run again.
@pytest.mark.parametrize('document, count, name, digest', KNOWN)
def test_digests_are_those_of_before(document, count, name, digest):
    assert last_of(document)[:2] == (count, name)
    assert digest in plan.made_of_each(plan.trials(spec.checked(document, '/folder'))[-1], MADE).values()


@pytest.mark.parametrize('others, is_another', [
    ({'cores': 'one'}, False), ({'crashes': 'allow'}, False), ({'time_limit': 3}, False), ({'verify': 0}, False),
    ({'primary': 'goals'}, False), ({'sleep': 'simulated'}, True), ({'lookahead': 0.1}, True),
    ({'stored_topics': ['/a']}, True), ({'until': {'seconds': 1}}, True), ({'record': {'hashes': True}}, True),
    ({'seed': 1}, True), ({'leave_out': ['a']}, True), ({'replace': {'a/b': 'c/d'}}, True), ({'metrics': 'a:b'}, True),
    ({'participants': ['a']}, True), ({'args': {'a': 1}}, True)])
def test_what_changes_a_trial_changes_its_digest_and_nothing_else_does(others, is_another):
    assert (last_of({**LAUNCH, **others})[2] != last_of(LAUNCH)[2]) == is_another
