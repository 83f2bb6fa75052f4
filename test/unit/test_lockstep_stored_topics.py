"""Topics that a user declares as stored: what may be said."""
import pytest

from move_base_abstract.common.errors import ConfigurationError
from move_base_abstract.lockstep.run_options import STORED_TOPIC


@pytest.mark.parametrize('text, entry', [
    ('/positions', '/positions'), ('positions', '/positions'), ('/a/b=/c_1/d', '/a/b=/c_1/d'), ('a=b', '/a=/b')])
def test_names_are_those_below_the_root(text, entry):
    assert STORED_TOPIC.check('x', text) == entry


@pytest.mark.parametrize('text', ['', '=', '/a=', '=/a', '/a=/b=/c', '/a b', '/a//b', '/', '~a', '/a/', 3, None])
def test_what_is_no_topic_is_refused(text):
    with pytest.raises(ConfigurationError, match='TOPIC'):
        STORED_TOPIC.check('x', text)
