"""python3 -m move_base_abstract_experiments.report OUT."""
import sys

try:
    from .command import main
except ModuleNotFoundError as error:
    sys.exit(f'experiment report: {error.name} is not installed; on Debian: apt install python3-jinja2 python3-numpy '
             'python3-pandas python3-scipy')

sys.exit(main())
