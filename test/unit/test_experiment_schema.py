"""The schema of experiment files, for editors: what the code's options make of it, and what the code takes."""
import json
import sys
from pathlib import Path

import jsonschema
import pytest
import yaml

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract_experiments.description import spec

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / 'tools'))

import write_schema  # noqa: E402

SCHEMA = jsonschema.Draft7Validator(json.loads((ROOT / write_schema.EXPERIMENT_FILE).read_text()))
LAUNCH = {'experiment': 'x', 'launch': 'x.launch'}
COMMAND = {'experiment': 'x', 'command': ['run'], 'participants': ['/a']}
FUNCTION = {'experiment': 'x', 'function': 'a.b:c'}
SHIPPED = [*sorted((ROOT / 'config' / 'experiments').glob('*.yaml')), ROOT / 'examples' / 'ranking' / 'ranking.yaml']


def test_the_file_is_up_to_date():
    assert (ROOT / write_schema.EXPERIMENT_FILE).read_text() == json.dumps(spec.schema(), indent=1) + '\n', (
        'run tools/write_schema.py')
    jsonschema.Draft7Validator.check_schema(SCHEMA.schema)


@pytest.mark.parametrize('path', SHIPPED, ids=lambda path: path.stem)
def test_experiments_that_ship_are_valid(path):
    document = yaml.safe_load(path.read_text())
    spec.checked(document, str(path.parent))
    SCHEMA.validate(document)


@pytest.mark.parametrize('document', [
    LAUNCH, COMMAND, FUNCTION, {**LAUNCH, 'seed': 10**17, 'verify': 1, 'time_limit': 1.5, 'lookahead': 0},
    {**LAUNCH, 'until': {'seconds': 3, 'topic': 'a', 'idle': True}, 'record': {'messages': ['/a'], 'motion': False}},
    {**LAUNCH, 'factors': {'a': [1, 'x', True, 0.5]}, 'args': {'a': '{a}'}, 'replications': {'all': 3, 'a': {1: 2}}},
    {**LAUNCH, 'metrics': {'function': 'm:f', 'columns': {'a': {'better': None, 'unit': 1}}}, 'report': 'a:b'},
    {**LAUNCH, 'participants': ['a'], 'leave_out': ['b'], 'replace': {'a/b': 'c/d'}, 'crashes': 'allow'},
    {**LAUNCH, 'stored_topics': ['/a', 'b=/c'], 'cores': 'one', 'sleep': 'simulated', 'replications': 2.0},
    {**COMMAND, 'lookahead': 0.05, 'cores': 'auto'}, {**FUNCTION, 'prepare': 'a:b', 'inputs': ['x'], 'args': {'n': 1}},
    {**LAUNCH, 'lookahead': 'network', 'network': 'n.yaml'}, {**LAUNCH, 'chaos_seed': 2, 'chaos_delay': 0.1},
    {**LAUNCH, 'chaos_seed': 2, 'chaos_starts': 0.1},
    {**LAUNCH, 'lookahead': 0.1, 'network': 'n.yaml a:=1'},
    {**FUNCTION, 'participants': 'all', 'until': {}, 'record': {'files': ['*.csv'], 'messages': []}}])
def test_what_the_code_takes_is_valid(document):
    spec.checked(document, '/folder')
    SCHEMA.validate(document)


@pytest.mark.parametrize('document', [
    {}, [], {'experiment': 'x'}, {'launch': 'x'}, {**LAUNCH, 'command': ['x']}, {**LAUNCH, 'experiment': ''},
    {**LAUNCH, 'replication': 1}, {**LAUNCH, 'replications': 0}, {**LAUNCH, 'replications': 1.5},
    {**LAUNCH, 'replications': {'all': 0}}, {**LAUNCH, 'verify': 2}, {**LAUNCH, 'verify': True},
    {**LAUNCH, 'until': {'second': 1}}, {**LAUNCH, 'until': {'seconds': 0}}, {**LAUNCH, 'until': {'topic': 'a b'}},
    {**LAUNCH, 'until': {'idle': 1}}, {**LAUNCH, 'record': {'files': ['../x']}}, {**LAUNCH, 'record': {'motion': 0}},
    {**LAUNCH, 'factors': {'a': []}}, {**LAUNCH, 'factors': {'a': [1, 1]}}, {**LAUNCH, 'factors': {'a b': [1]}},
    {**LAUNCH, 'factors': {'a': [None]}}, {**LAUNCH, 'args': {'a;b': 1}}, {**LAUNCH, 'args': {'a': []}},
    {**LAUNCH, 'metrics': 'x'}, {**LAUNCH, 'metrics': {'columns': {'a': {'better': 'best'}}}},
    {**LAUNCH, 'participants': 'some'}, {**LAUNCH, 'participants': ['a b']}, {**LAUNCH, 'leave_out': 'a'},
    {**LAUNCH, 'replace': {'a': 'b/c'}}, {**LAUNCH, 'report': ['maps']}, {**LAUNCH, 'report': 3},
    {**LAUNCH, 'primary': 3}, {**LAUNCH, 'smallest_difference': {'goals': 0}}, {**LAUNCH, 'at_limit': {'goals': 'x'}},
    {**LAUNCH, 'cores': 'alternate'}, {**LAUNCH, 'sleep': 'never'}, {**LAUNCH, 'crashes': 'ignore'},
    {**LAUNCH, 'lookahead': 1e-9}, {**LAUNCH, 'lookahead': False}, {**LAUNCH, 'stored_topics': ['/a b']},
    {**LAUNCH, 'lookahead': 'network'}, {**LAUNCH, 'lookahead': 'radio', 'network': 'n.yaml'},
    {**LAUNCH, 'chaos_delay': 0.1}, {**LAUNCH, 'chaos_starts': 0.1},
    {**LAUNCH, 'chaos_only': ['none']}, {**LAUNCH, 'lookahead': 1, 'chaos_seed': 2},
    {**LAUNCH, 'lookahead': 0.1, 'stored_topics': ['/a']}, {**LAUNCH, 'prepare': 'a:b'}, {**LAUNCH, 'seed': -1},
    {**LAUNCH, 'time_limit': 0}, {'experiment': 'x', 'command': ['run']}, {**COMMAND, 'participants': 'all'},
    {**COMMAND, 'command': []}, {**COMMAND, 'args': {'a': 1}}, {**COMMAND, 'leave_out': ['/a']},
    {**FUNCTION, 'function': 'a.b'}, {**FUNCTION, 'until': {'seconds': 3}}, {**FUNCTION, 'participants': ['/a']},
    {**FUNCTION, 'record': {'messages': ['/a']}}, {**FUNCTION, 'lookahead': 0.1}, {**FUNCTION, 'cores': 'one'},
    {**FUNCTION, 'replace': {'a/b': 'c/d'}}])
def test_what_the_code_refuses_is_not(document):
    with pytest.raises(ConfigurationError):
        spec.checked(document, '/folder')
    assert not SCHEMA.is_valid(document)


@pytest.mark.parametrize('others', [
    {'factors': {'a': [1]}}, {'args': {'a': '{b}'}}, {'baseline': {'a': 1}}, {'primary': 'no_such'},
    {'replications': {'a': {1: 1}}}, {'metrics': {'columns': {'a': {}}}}])
def test_names_that_refer_to_other_keys_only_the_code_sees(others):
    with pytest.raises(ConfigurationError):
        spec.checked({**LAUNCH, **others}, '/folder')
    SCHEMA.validate({**LAUNCH, **others})


def test_every_option_says_what_it_is():
    assert all(len(one['description']) > 5 for one in SCHEMA.schema['properties'].values())
