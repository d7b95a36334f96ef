"""The program ``asperity``, which comes with the package."""

from __future__ import annotations

import os
import signal
import sys

from ._asperity import program


def main() -> None:
    """Runs it with the arguments of this process, and ends with its exit code."""
    # The program has answers of its own to Ctrl-C, where it is not ignored.
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    # A layer of Mesa's would complain that there is no display.
    os.environ.setdefault("NODEVICE_SELECT", "1")
    code = program(sys.argv)
    # Threads of the program may still wait for signals.
    os._exit(code)
