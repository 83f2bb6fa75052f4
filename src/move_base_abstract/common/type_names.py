"""Names of types that several rooms use; who reads annotations needs them, nobody imports them while a program runs."""
from __future__ import annotations

import os
from typing import Union

#: the path of a file
StrPath = Union[str, 'os.PathLike[str]']
