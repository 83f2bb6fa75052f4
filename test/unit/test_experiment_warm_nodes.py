"""Nodes of a trial as forks: what they are told beside what a launch file says."""
import pytest

from move_base_abstract_ros.launching import warm_nodes


@pytest.mark.parametrize('name', ['python_logging.conf', 'python_logging.yaml'])
def test_nodes_are_told_where_log_settings_are_unless_they_have_their_own(name, tmp_path, monkeypatch):
    monkeypatch.setattr(warm_nodes, 'log_settings', lambda: '/etc/ros/python_logging.conf')
    environment = {'ROS_HOME': str(tmp_path)}
    told = {**environment, 'ROS_PYTHON_LOG_CONFIG_FILE': '/etc/ros/python_logging.conf'}
    assert warm_nodes.with_log_settings(environment) == told
    others = {**environment, 'ROS_PYTHON_LOG_CONFIG_FILE': '/mine.conf'}
    assert warm_nodes.with_log_settings(others) == others
    (tmp_path / 'config').mkdir()
    (tmp_path / 'config' / name).touch()
    assert warm_nodes.with_log_settings(environment) == environment


def test_without_log_settings_for_all_nodes_are_told_nothing(tmp_path, monkeypatch):
    monkeypatch.setattr(warm_nodes, 'log_settings', lambda: '')
    assert warm_nodes.with_log_settings({'ROS_HOME': str(tmp_path)}) == {'ROS_HOME': str(tmp_path)}
