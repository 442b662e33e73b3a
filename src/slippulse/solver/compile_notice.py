"""A notice on standard error when the kernels are compiled, which takes half a minute once."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager

from numba.core import event

NOTICE_TEXT = (
    "slippulse: compiling the kernels of the lattice takes about half a minute;"
    " later calls load the compiled kernels"
)
PACKAGE_NAME = __name__.partition(".")[0]


class CompileNotice(event.Listener):
    """Listener that prints the notice when a process compiles the first kernel of this package."""

    def __init__(self) -> None:
        self.printed = False

    def on_start(self, compile_event: event.Event) -> None:
        """Print the notice if a function of this package begins to be compiled.

        Loading machine code from the cache does not start such an event.
        """
        function = getattr(compile_event.data["dispatcher"], "py_func", None)
        module = getattr(function, "__module__", "")
        if not self.printed and module.startswith(f"{PACKAGE_NAME}."):
            self.printed = True
            print(NOTICE_TEXT, file=sys.stderr, flush=True)

    def on_end(self, compile_event: event.Event) -> None:
        """Do nothing at the end of a compilation."""


COMPILE_LISTENER = CompileNotice()


@contextmanager
def announced_compilation() -> Iterator[None]:
    """Announce the first compilation of a kernel inside this context, if there is one."""
    with event.install_listener("numba:compile", COMPILE_LISTENER):
        yield
