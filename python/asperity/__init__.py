"""Force-displacement laws for elastic-plastic spheres, computed instead of guessed.

``asperity.run`` simulates one :class:`Case`, ``asperity.study`` a grid of them, :class:`Law` makes of a study what a discrete-element code can use.
"""

from . import errors
from ._asperity import __version__
from ._table import Table
from .case import Case
from .errors import AsperityError, CaseError, Interrupted, MissingPackage, NotConverged
from .fields import Fields, Mesh
from .law import Check, Contacts, Law
from .picture import Picture
from .run import Run
from .study import Study

# The functions come after the modules of the same names: `asperity.run` is the function.
from ._compute import run, study  # isort: skip

__all__ = [
    "AsperityError",
    "Case",
    "CaseError",
    "Check",
    "Contacts",
    "Fields",
    "Interrupted",
    "Law",
    "Mesh",
    "MissingPackage",
    "NotConverged",
    "Picture",
    "Run",
    "Study",
    "Table",
    "__version__",
    "errors",
    "run",
    "study",
]
