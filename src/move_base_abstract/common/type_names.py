"""Names of types that several packages use in annotations; they are not imported while a program runs."""
from __future__ import annotations

import os
from typing import Union

#: the path of a file
StrPath = Union[str, 'os.PathLike[str]']
