"""The schema of scenario files, for editors: what the code's tables make of it, and what the code takes."""
import json
import sys
from pathlib import Path

import jsonschema
import pytest
import yaml

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.scenario import make_scenario

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / 'tools'))

import write_scenario_keys  # noqa: E402
import write_schema  # noqa: E402

SCHEMA = jsonschema.Draft7Validator(json.loads((ROOT / write_schema.FILE).read_text()))
PARAMETERS = [parameter for _, parameters, _ in write_scenario_keys.sections() for parameter in parameters]
ROBOT = {'name': 'bot'}


def test_the_file_is_up_to_date():
    assert (ROOT / write_schema.FILE).read_text() == json.dumps(write_schema.make_schema(), indent=1) + '\n', (
        'run tools/write_schema.py')
    jsonschema.Draft7Validator.check_schema(SCHEMA.schema)


@pytest.mark.parametrize('name', ['config/scenario.yaml', 'config/soil_robots.yaml', 'config/lanes_scenario.yaml',
                                  'config/tasks_scenario.yaml', 'test/data/twenty_robots.yaml'])
def test_scenarios_that_ship_are_valid(name):
    SCHEMA.validate(yaml.safe_load((ROOT / name).read_text()))


@pytest.mark.parametrize('document', [
    {}, {'robots': [ROBOT]}, {'seed': 0}, {'robots': [{**ROBOT, 'count': 2, 'step_x': -1}]}, {'deadlock': 'abort'},
    {'defaults': {'max_speed': 2, 'use_map': True, 'footprint': [[0, 0], [1, 0], [0, 1]]}},
    {'places': [{'name': 'dock', 'x': 1.0, 'y': 0}], 'arrivals': [{'place': 'dock', 'rate': 0.1, 'duration': 2}]},
    {'zones': [{'name': 'z', 'rectangle': [0, 0, 1, 1], 'capacity': 1, 'charger': 2.5}]}])
def test_what_the_code_takes_is_valid(document):
    make_scenario(document)
    SCHEMA.validate(document)


@pytest.mark.parametrize('document', [
    {'robot': []}, {'robots': ROBOT}, {'robots': [{}]}, {'seed': -1}, {'seed': 'x'}, {'deadlock': 'waits'},
    {'robots': [{**ROBOT, 'count': 0}]}, {'robots': [{**ROBOT, 'max_sped': 1.0}]}, {'defaults': {'max_speed': 'fast'}},
    {'defaults': {'max_speed': -1.0}}, {'defaults': {'use_map': 1}}, {'defaults': {'failure_kind': 'explode'}},
    {'places': [{'name': 'dock', 'capacity': 0}]}, {'zones': [{'name': 'z', 'kapacity': 1}]},
    {'arrivals': [{'rates': 1.0}]}, {'robots': [{**ROBOT, 'count': 'two'}]}, {'defaults': []}, {'zones': [{}]},
    {'lanes': 1}, {'robots': [{**ROBOT, 'scan_rate': 'often'}]}])
def test_what_the_code_refuses_is_not(document):
    with pytest.raises(ConfigurationError):
        make_scenario(document)
    assert not SCHEMA.is_valid(document)


@pytest.mark.parametrize('parameter', [parameter for parameter in PARAMETERS if parameter.kind.schema],
                         ids=lambda parameter: parameter.name)
def test_kinds_and_bounds_are_those_of_the_converter(parameter):
    one = jsonschema.Draft7Validator(parameter.kind.schema)
    for value in (None, True, -1, 0, 1, 2, 1.5, -0.5, 1e12, 'x', 'wait', 'stall', [], [1.0, 2.0], {}):
        try:
            parameter.kind(value)
        except (ValueError, TypeError):
            assert not one.is_valid(value), value
        else:
            assert one.is_valid(value), value


def test_most_keys_have_a_kind():
    assert sum(bool(parameter.kind.schema) for parameter in PARAMETERS) > 0.7 * len(PARAMETERS)
