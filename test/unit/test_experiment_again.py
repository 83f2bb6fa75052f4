"""A trial again: how it is looked at."""
import os
import shutil

from move_base_abstract_experiments import again


def test_rviz_shows_the_robots(monkeypatch):
    monkeypatch.setattr(shutil, 'which', lambda name: f'/bin/{name}')
    path, option, config = again._rviz_words()
    assert (path, option) == ('/bin/rviz', '-d')
    with open(config, encoding='utf-8') as stream:
        assert '/move_base_abstract/markers' in stream.read()
    assert os.path.basename(config) == 'simulator.rviz'
