"""Tools of all packages that are not about robots: errors, units, texts, careful reading and writing of files."""
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .bounded_yaml import Bounds as Bounds, load_yaml_file as load_yaml_file, load_yaml_text as load_yaml_text
    from .errors import (
        ConfigurationError as ConfigurationError,
        FrameError as FrameError,
        SimulatorError as SimulatorError,
        TimeError as TimeError,
    )
    from .own_files import (
        OutputError as OutputError,
        check_file as check_file,
        create_file as create_file,
        whole_file as whole_file,
    )
    from .parameter_table import Parameter as Parameter, read_table as read_table
    from .units import seconds_to_ns as seconds_to_ns
else:
    from .lazy_exports import lazy_exports

    __getattr__ = lazy_exports(__name__)
