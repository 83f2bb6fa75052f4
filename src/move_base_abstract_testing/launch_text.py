"""The launch file of a test. It starts the robots, includes the test's own launch file, and starts its nodes."""
from xml.sax.saxutils import quoteattr

from .settings import Settings

TEST = '/test'  # the name of the test's own node


def launch_text(settings: Settings) -> str:
    """Return the launch file as XML."""
    lines = ['<launch>']
    if settings.scenario:
        lines += ['  <node pkg="move_base_abstract" type="fleet" name="fleet">',
                  '    <param name="scenario" value={}/>'.format(quoteattr(settings.scenario)), '  </node>']
    for number, words in enumerate(settings.nodes):
        kind, _, args = words.partition(' ')
        package, name = kind.split('/')
        others = [one for one in settings.nodes[:number] if one.split()[0] == kind]
        lines.append('  <node pkg={} type={} name={}{}/>'.format(
            quoteattr(package), quoteattr(name),
            quoteattr(name.partition('.')[0] + ('_{}'.format(len(others) + 1) if others else '')),
            ' args=' + quoteattr(args) if args.strip() else ''))
    if settings.launch:
        lines.append('  <include file={}>'.format(quoteattr(settings.launch)))
        lines += ['    <arg name={} value={}/>'.format(quoteattr(name), quoteattr(_word(value)))
                  for name, value in settings.args.items()]
        lines.append('  </include>')
    return '\n'.join([*lines, '</launch>', ''])


def _word(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)
