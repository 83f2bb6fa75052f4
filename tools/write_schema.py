#!/usr/bin/python3
"""Write the schemas of scenario and experiment files in config/, for editors that complete and check YAML.

usage: python3 tools/write_schema.py

They are made from the tables of the code, like docs/scenario_keys.md. Unit tests compare them with the tables.
"""
import json
import os
import sys

import write_scenario_keys
from output_file import ROOT

from move_base_abstract_experiments.description import spec

FILE = os.path.join('config', 'scenario.schema.json')
EXPERIMENT_FILE = os.path.join('config', 'experiment.schema.json')


def of_parameter(parameter):
    """Return the schema of a Parameter: the allowed values in words, and their type if the code knows it."""
    schema = {'description': parameter.allowed, **parameter.kind.schema}
    if isinstance(parameter.default, (bool, int, float)) or parameter.default and isinstance(parameter.default, str):
        schema['default'] = parameter.default
    return schema


def of_table(parameters, required=()):
    """Return the schema of a mapping with these Parameters and no others."""
    schema = {'type': 'object', 'additionalProperties': False,
              'properties': {parameter.name: of_parameter(parameter) for parameter in parameters}}
    return {**schema, 'required': list(required)} if required else schema


def make_schema():
    """Return the schema of a scenario, a mapping."""
    tables = {heading.split(':')[0]: parameters for heading, parameters, _ in write_scenario_keys.sections()}
    settings = of_table(tables['Settings'])
    robot = of_table([*tables['Settings'], *tables['A robot']], ['name'])
    parts = {'robots': robot, 'zones': of_table(tables['A zone'], ['name']),
             'places': of_table(tables['A place'], ['name']), 'arrivals': of_table(tables['Arrivals']),
             'orders': of_table(tables['Orders'], ['name'])}
    parts['orders']['properties']['stops'].update(type='array', items=of_table(tables['A stop of an order']))
    schema = of_table(tables['Top level'])
    for key, part in parts.items():
        schema['properties'][key].update(type='array', items=part)
    schema['properties']['defaults'].update(settings)
    schema['properties']['dispatcher'].update(of_table(tables['The dispatcher']))
    for key in ('lanes', 'travel_matrix'):
        schema['properties'][key]['type'] = 'string'
    return {'$schema': 'http://json-schema.org/draft-07/schema#', 'title': 'a scenario of move_base_abstract', **schema}


if __name__ == '__main__':
    if len(sys.argv) > 1:
        sys.exit(__doc__)
    for name, made in ((FILE, make_schema()), (EXPERIMENT_FILE, spec.schema())):
        (ROOT / name).write_text(json.dumps(made, indent=1) + '\n', encoding='utf-8')
