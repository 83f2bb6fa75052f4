"""Names that users' programs call and that have another name now: the old ones work for one release."""
import warnings


def warn_of_old(old: str, new: str) -> None:
    """Warn the caller's caller, once at each place, that ``old`` is ``new`` now and goes with the next release."""
    warnings.warn('{} is {} now; the old name goes with the next release'.format(old, new), FutureWarning, stacklevel=3)
