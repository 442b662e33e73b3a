"""One line that says that kernels are being compiled, which takes a while once."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager

from numba.core import event

NOTICE = (
    "slippulse: compiling the kernels of the lattice, once and for about half a minute;"
    " later calls load them"
)
PACKAGE = __name__.partition(".")[0]


class CompileNotice(event.Listener):
    """Prints the notice when the first kernel of this package is compiled in a process."""

    def __init__(self) -> None:
        self.printed = False

    def on_start(self, event: event.Event) -> None:
        """Print the notice; machine code that is loaded from the cache starts no such event."""
        function = getattr(event.data["dispatcher"], "py_func", None)
        if not self.printed and getattr(function, "__module__", "").startswith(f"{PACKAGE}."):
            self.printed = True
            print(NOTICE, file=sys.stderr, flush=True)

    def on_end(self, event: event.Event) -> None:
        """Do nothing."""


LISTENER = CompileNotice()


@contextmanager
def announced_compilation() -> Iterator[None]:
    """Announce the first compilation of a kernel, if there is one inside."""
    with event.install_listener("numba:compile", LISTENER):
        yield
