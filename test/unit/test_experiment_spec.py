"""What an experiment's file may say, and what is told of one that cannot be used."""
import dataclasses

import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract_experiments.carrying import jobs
from move_base_abstract_experiments.description import placeholders, plan, spec
from move_base_abstract_experiments.trials import run_folders, run_plan
from move_base_abstract_ros.launching import conditions

BASE = {'experiment': 'x', 'launch': 'x.launch'}


def read(**others):
    return spec.checked({**BASE, **others}, '/folder')


def read_used(factors, **others):
    """Return an Experiment whose launch file gets all factors."""
    return read(factors=factors, args={name: '{' + name + '}' for name in factors}, **others)


@pytest.mark.parametrize('others, text', [
    ({'replication': 3}, "did you mean 'replications'"),
    ({'until': {'second': 3}}, "did you mean 'seconds'"),
    ({'record': {'message': []}}, "did you mean 'messages'"),
    ({'factors': {'robots': [1]}, 'args': {'robots': '{robot}'}}, "did you mean 'robots'"),
    ({'factors': {'robots': [1, 1]}}, 'each value once'),
    ({'factors': {'robots': [1, 2]}}, "factors.robots: nothing of the system depends on it.* args: robots: '{robots}'"),
    ({'factors': {'a': [1], 'b': [2]}, 'args': {'x': 'of {a}'}}, 'factors.b: nothing of the system'),
    ({'factors': {'robots': []}}, 'a list'),
    ({'factors': {'seed': [1]}}, 'name of a column'),
    ({'factors': {'goals': [1]}}, 'name of a column'),
    ({'factors': {'a': [float('nan')]}}, 'a number'),
    ({'args': {'a;b': 1}}, 'letters, digits'),
    ({'replications': 0}, 'in 1..'),
    ({'replications': True}, 'in 1..'),
    ({'verify': 1.5}, 'in 0..1'),
    ({'command': ['x']}, 'got launch, command'),
    ({'function': 'a:b'}, 'got launch, function'),
    ({'prepare': 'a:b'}, "'prepare' is an option for a function"),
    ({'isolation': 'batch'}, 'each trial has a process of its own; take this line out'),
    ({'stored_topics': ['/a b']}, 'NODE=TOPIC'),
    ({'stored_topics': ['/a'], 'lookahead': 0.1}, 'all takes time'),
    ({'lookahead': 1e-9}, 'in 1e-6..1000'),
    ({'lookahead': 'network'}, "without a 'network'"),
    ({'lookahead': 'radio'}, 'or 0, or network'),
    ({'cores': 'alternate'}, "allowed: 'one', 'all' or 'auto'"),
    ({'cores': 2}, "allowed: 'one', 'all' or 'auto'"),
    ({'replications': {'all': 3, 'robot': {}}, 'factors': {'robots': [1]}}, "did you mean 'robots'"),
    ({'replications': {'all': 3, 'robots': {2: 1}}, 'factors': {'robots': [1]}}, "the value '2' is unknown"),
    ({'replications': {'robots': {1: 0}}, 'factors': {'robots': [1]}}, 'in 1..'),
    ({'replications': {'all': 2, 'robots': {1: 3}}, 'factors': {'robots': [1]}}, "at most 'all', which is 2"),
    ({'replications': {'robots': {1: 3}}, 'factors': {'robots': [1]}}, "at most 'all', which is 1"),
    ({'replications': {'robots': 3}, 'factors': {'robots': [1]}}, 'a mapping'),
    ({'primary': 'makespam'}, "did you mean 'makespan'"),
    ({'primary': 3}, 'a letter'),
    ({'smallest_difference': {'goal': 1}}, "did you mean 'goals'"),
    ({'smallest_difference': {'goals': 0}}, 'a number in'),
    ({'smallest_difference': {'goals': True}}, 'a number in'),
    ({'at_limit': {'goals': 'bound'}}, "'lower_bound' or 'value'"),
    ({'baseline': {'robot': 1}, 'factors': {'robots': [1]}}, "did you mean 'robots'"),
    ({'baseline': {'robots': 2}, 'factors': {'robots': [1]}}, "the value '2' is unknown"),
    ({'baseline': {'robots': True}, 'factors': {'robots': [1]}}, "the value 'True' is unknown"),
    ({'metrics': 'import os; os.system(1)'}, 'module:function'),
    ({'metrics': {'columns': {'a': {}}}}, 'no metrics.function'),
    ({'report': ['maps']}, 'module:function'),
    ({'report': 3}, 'a list'),
    ({'record': {'files': ['../x']}}, 'without a folder'),
    ({'until': {'topic': 'a b'}}, 'name of a topic'),
    ({'participants': 'some'}, 'or all'),
    ({'replace': {'a': 'b/c'}}, 'PACKAGE/TYPE'),
    ({'factors': {'a': list(range(2000))}, 'replications': 1000}, '2000000 trials, more than 1000000'),
])
def test_what_cannot_be_used_is_told_with_what_is_allowed(others, text):
    with pytest.raises(ConfigurationError, match=text.replace('(', r'\(')):
        read(**others)


def test_what_the_report_compares_by_is_in_the_plan_and_makes_no_trial_another_one():
    about = {'factors': {'robots': [1, 2]}, 'args': {'r': '{robots}'},
             'metrics': {'function': 'm:f', 'columns': {'wait': {'unit': 's'}}}}
    told = {'primary': 'wait', 'baseline': {'robots': 2}, 'smallest_difference': {'wait': 2, 'goals': 1.5},
            'at_limit': {'wait': 'lower_bound'}}
    one, other = read(**about), read(**about, **told)
    described = plan.describe(other, plan.trials(other), b'')
    assert {key: getattr(described, key) for key in told} == told
    assert described.metrics['makespan']['at_limit'] == 'to_last_goal'
    assert [plan.made_of(each) for each in plan.trials(one)] == [plan.made_of(each) for each in plan.trials(other)]


def test_a_command_names_who_takes_part():
    with pytest.raises(ConfigurationError, match='name them'):
        spec.checked({'experiment': 'x', 'command': ['run']}, '/folder')
    assert spec.checked({'experiment': 'x', 'command': ['run', '{seed}'], 'participants': ['a']},
                        '/').participants == ('/a',)


def test_a_file_says_where_it_is_wrong(tmp_path):
    path = tmp_path / 'x.yaml'
    path.write_text('experiment: x\nlaunch: x.launch\nfactor: {a: [1]}\n')
    with pytest.raises(ConfigurationError, match=f"{path}: .*did you mean 'factors'"):
        spec.read(str(path))


def test_replication_k_has_the_same_seed_in_every_configuration():
    experiment = read_used({'a': [1, 2], 'b': ['x', 'y']}, replications=3, seed=7)
    trials = plan.trials(experiment)
    assert len(trials) == 12
    for replication in range(3):
        same = [one for one in trials if one.replication == replication]
        assert len(same) == 4
        assert {one.seed for one in same} == {7 + replication}


def test_more_replications_change_no_trial_that_was_there():
    few = plan.trials(read_used({'a': [1, 2]}, replications=2))
    many = plan.trials(read_used({'a': [1, 2]}, replications=5))
    assert [one.id for one in many[:4]] == [one.id for one in few]
    assert len({one.id for one in many}) == 10


def conditions_of(**others):
    """Return the condition under which each trial runs twice, by its configuration and replication."""
    return {(tuple(one.configuration.values()), one.replication): one.verified_by
            for one in plan.trials(read_used(**others))}


@pytest.mark.parametrize('more', [
    {'replications': 60}, {'factors': {'a': [1, 2, 3]}}, {'factors': {'a': [1, 2, 3]}, 'replications': 31}])
def test_a_plan_that_grows_runs_the_same_trials_twice_under_the_same_conditions(more):
    few = {'factors': {'a': [1, 2]}, 'replications': 30, 'verify': 0.2}
    before, after = conditions_of(**few), conditions_of(**{**few, **more})
    assert len(after) > len(before) and {key: after[key] for key in before} == before


def test_a_larger_share_has_the_trials_of_a_smaller_one():
    few, many = (conditions_of(factors={'a': [1, 2]}, replications=50, verify=share) for share in (0.1, 0.3))
    assert 0 < sum(map(bool, few.values())) < sum(map(bool, many.values()))
    assert all(many[key] == condition for key, condition in few.items() if condition)


def test_the_share_that_runs_twice_holds_on_average_under_each_condition():
    chosen = [condition for condition in conditions_of(factors={'a': [1, 2]}, replications=5000, verify=0.1).values()
              if condition]
    assert len(chosen) == pytest.approx(1000, abs=5 * 30)  # five standard deviations of 10,000 draws
    for condition in plan.CONDITIONS:
        assert chosen.count(condition) == pytest.approx(250, abs=5 * 14)


@pytest.mark.parametrize('share, first', [(0, False), (1e-9, True)])
def test_the_first_trial_runs_twice_if_any_does(share, first):
    found = conditions_of(factors={'a': [1, 2]}, replications=20, verify=share)
    assert [bool(each) for each in found.values()] == [first] + [False] * 39


def test_trials_run_twice_under_all_conditions_of_verify_that_disturb_no_trial_beside_them():
    assert set(plan.CONDITIONS) == {one.name for one in conditions.CONDITIONS if one.options or one.environment} - {
        'split'}  # in which names differ


def test_values_stand_in_arguments_as_a_launch_file_has_them():
    experiment = read(factors={'flag': [True], 'x': [0.1], 'name': ['a b']},
                      args={'a': '{flag}', 'b': 'x{x}y', 'c': '{name}', 'd': '{seed}', 'e': 3})
    assert plan.trials(experiment)[0].arguments == [
        'a:=true', 'b:=x0.1y', 'c:=a b', 'd:=0', 'e:=3']


def first(experiment):
    return plan.trials(experiment)[0]


def parameters_of(experiment):
    run = run_plan.Run(jobs.make_job(first(experiment)), run_folders.Folders('/o', '/f', '/l'))
    return run_plan.parameters_of(run, 1.0)


def test_options_of_the_time_master_are_its_parameters_and_its_own_are_left_to_it_by_default():
    fixed = {'event_log': '/o/events.jsonl', 'note_of_start': '/o/started'}
    assert parameters_of(read()) == fixed
    assert parameters_of(read(cores='all', stored_topics=['a'], until={'idle': True, 'seconds': 2.5},
                              record={'hashes': True})) == {
        **fixed, 'cores': 'all', 'stored_topics': ['/a'], 'end_when_idle': True, 'end_at': 3.5, 'log_messages': True}
    assert parameters_of(read(lookahead=0.5)) == {**fixed, 'lookahead': 0.5}
    assert parameters_of(read(until=7)) == {**fixed, 'end_at': 7.0}
    assert parameters_of(read(until={'seconds': 2, 'at': 7})) == {**fixed, 'end_at': 3.0}


def test_a_trial_has_the_options_of_a_run_with_its_factors_filled_in():
    experiment = read_used({'speed': [0.5], 'x': [3]}, param={'robot/max_speed': '{speed}', '/all': ['{x}', 'a{x}']},
                           start={'robot': ['{x}', 0, 1.5], '/other': '1,2,3'}, leave_out=['rviz'], seed=4)
    run = first(experiment).run_options
    assert (run.param, run.seed, run.leave_out) == ({'/robot/max_speed': 0.5, '/all': [3, 'a3']}, 4, ('/rviz',))
    assert run.start == {'/robot': (3.0, 0.0, 1.5), '/other': (1.0, 2.0, 3.0)}
    with pytest.raises(ConfigurationError, match='start./robot: got .a,0,0.; allowed: X,Y,YAW'):
        assert first(read_used({'x': ['a']}, start={'robot': ['{x}', 0, 0]})).run_options
    assert read(factors={'x': [1]}, param={'/a': '{x}'}).factors  # what a parameter uses is used
    with pytest.raises(ConfigurationError, match="param./a: the factor 'y' is unknown"):
        read(param={'/a': '{y}'})


def test_options_of_the_command_line_take_precedence_over_the_files_keys(tmp_path):
    path = tmp_path / 'a.yaml'
    path.write_text('experiment: x\nlaunch: x.launch\nsleep: simulated\nparam: {/a: 1}\n')
    given = {'sleep': 'wall', 'param': {'/b': [1, 2]}, 'start': {'/r': '1,2,0'}}
    experiment = spec.read(str(path), given=given)
    assert (experiment.sleep, experiment.param, experiment.start) == ('wall', {'/a': 1, '/b': [1, 2]}, {'/r': '1,2,0'})
    (tmp_path / 'b.yaml').write_bytes(spec.changed_text(path.read_bytes(), given))
    assert spec.read(str(tmp_path / 'b.yaml')) == experiment


def test_on_which_cores_nodes_run_makes_no_trial_another_one():
    assert plan.made_of(first(read(cores='all'))) == plan.made_of(first(read()))


def test_a_value_with_braces_is_not_filled_again():
    assert placeholders.filled('{a}', {'a': '{b}', 'b': 'no'}) == '{b}'


def test_a_complete_trial_counts_only_if_what_it_is_made_of_is_the_same():
    one = first(read())
    digest = plan.made_of(one)
    assert digest == plan.made_of(first(read()))
    for others in ({'args': {'a': 1}}, {'until': {'seconds': 3}}, {'sleep': 'simulated'}, {'metrics': 'a:b'},
                   {'lookahead': 0.05}, {'stored_topics': ['/a']}, {'launch': 'y.launch'}, {'record': {'hashes': True}},
                   {'participants': ['/a']}, {'leave_out': ['/a']}, {'replace': {'a/b': 'c/d'}}, {'param': {'/a': 1}},
                   {'start': {'/a': '1,2,3'}}, {'tolerant': True}, {'add': {'/a': 'b/c'}}, {'onlooker': ['/a']},
                   {'until': {'at': 3}}):
        assert plan.made_of(first(read(**others))) != digest, others
    assert plan.made_of(dataclasses.replace(one, seed=1)) != digest


@pytest.mark.parametrize('given, told', [('a.b:c', ['a.b:c']), (['a:b', 'c:d'], ['a:b', 'c:d']), ([], [])])
def test_the_plan_tells_the_report_which_sections_to_add(given, told):
    assert plan.describe(read(report=given), [], b'').report == told


def function(**others):
    return spec.checked({'experiment': 'x', 'function': 'model:run', **others}, '/folder')


@pytest.mark.parametrize('others, text', [
    ({'function': 'model.run'}, 'module:function'), ({'until': {'seconds': 3}}, 'ends by itself'),
    ({'replace': {'a/b': 'c/d'}}, "'replace' is an option for a launch file"),
    ({'record': {'messages': ['/a']}}, 'ends by itself'), ({'lookahead': 0.1}, 'has no participants'),
    ({'stored_topics': ['/a']}, 'has no participants'),
    ({'cores': 'one'}, "'cores' is an option for a launch file or a command")])
def test_a_function_has_no_nodes(others, text):
    with pytest.raises(ConfigurationError, match=text):
        function(**others)


def test_a_function_gets_values_as_they_are_and_texts_filled_in():
    experiment = function(factors={'n': [3], 'on': [True]},
                          args={'n': '{n}', 'on': '{on}', 'text': 'a{n}', 'x': 0.5})
    assert first(experiment).function_arguments == {
        'n': 3, 'on': True, 'text': 'a3', 'x': 0.5}


def test_of_a_function_only_its_own_metrics_are_told():
    assert list(function(metrics={'columns': {'a': {'unit': 'm'}}}).known_metrics) == ['a']


def test_a_factors_value_may_have_fewer_replications_and_leaves_the_others_ids_as_they_are():
    fewer = plan.trials(read_used({'a': [1, 2]}, replications={'all': 3, 'a': {2: 1}}))
    whole = plan.trials(read_used({'a': [1, 2]}, replications=3))
    assert [one.configuration['a'] for one in fewer] == [1, 2, 1, 1]
    assert {one.id for one in fewer} < {one.id for one in whole}


def test_what_a_launch_file_includes_makes_it_another_one(tmp_path):
    (tmp_path / 'x.launch').write_text('<launch><include file="$(dirname)/sub/y.launch"/>'
                                       '<include file="$(arg z)"/></launch>')
    (tmp_path / 'sub').mkdir()
    inner = tmp_path / 'sub' / 'y.launch'
    inner.write_text('<launch><rosparam file="$(dirname)/../p.yaml"/></launch>')
    (tmp_path / 'p.yaml').write_text('a: 1')
    experiment = spec.checked(BASE, str(tmp_path))
    one = plan.trials(experiment)[0]
    seen = {plan.made_of(one)}
    for path, text in ((tmp_path / 'p.yaml', 'a: 2'), (inner, '<launch/>')):
        path.write_text(text)
        plan.forget()
        seen.add(plan.made_of(one))
    assert len(seen) == 3


def test_a_package_and_the_kind_of_an_argument_make_it_another_trial(tmp_path):
    (tmp_path / 'model').mkdir()
    given = {'experiment': 'x', 'function': 'model:run', 'args': {'n': 1}}
    seen = set()
    for text, n in (('1', 1), ('2', 1), ('2', '1')):
        (tmp_path / 'model' / '__init__.py').write_text(text)
        experiment = spec.checked({**given, 'args': {'n': n}}, str(tmp_path))
        plan.forget()
        seen.add(plan.made_of(first(experiment)))
    assert len(seen) == 3


def test_a_functions_own_file_and_its_inputs_make_it_another_trial(tmp_path):
    for name in ('model.py', 'data.csv'):
        (tmp_path / name).write_text('1')
    experiment = spec.checked({'experiment': 'x', 'function': 'model:run', 'inputs': ['data.csv']}, str(tmp_path))
    one = plan.trials(experiment)[0]
    seen = {plan.made_of(one)}
    for name in ('model.py', 'data.csv'):
        (tmp_path / name).write_text('2')
        plan.forget()
        seen.add(plan.made_of(one))
    assert len(seen) == 3
