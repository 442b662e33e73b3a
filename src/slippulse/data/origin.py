"""By which configuration the files are made that a job writes."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar

_configuration: ContextVar[str] = ContextVar("configuration", default="")


@contextmanager
def configured_by(digest: str) -> Iterator[None]:
    """Let every file that is written inside carry the digest of its configuration."""
    token = _configuration.set(digest)
    try:
        yield
    finally:
        _configuration.reset(token)


def configuration() -> str:
    """Digest of the configuration behind what is being written; empty outside a job of the workflow."""
    return _configuration.get()
