"""Tools of all packages that are not about robots: errors, units, texts, careful reading and writing of files."""
from .handed_on import handed_on

__getattr__ = handed_on(__name__, {
    'errors': 'ConfigurationError FrameError SimulatorError TimeError',
    'bounded_yaml': 'Bounds load_yaml_file load_yaml_text',
    'own_files': 'OutputError check_file create_file whole_file', 'parameter_table': 'Parameter read_table',
    'units': 'seconds_to_ns'})
