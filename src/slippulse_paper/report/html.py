"""Pages from templates; every value is escaped unless it is HTML already."""

import hashlib
from base64 import b64encode
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from slippulse.data.files import configuration

from ..text.markdown import markup_of as markup_of
from ..text.numerals import FILTERS

TEMPLATES = Path(__file__).with_name("templates")
PAGES = Environment(loader=FileSystemLoader(TEMPLATES), autoescape=True, undefined=StrictUndefined)
PAGES.trim_blocks = PAGES.lstrip_blocks = True
PAGES.filters |= FILTERS
# A page runs its own script and no other, and loads nothing but the pictures beside it.
POLICY = "default-src 'none'; img-src 'self' file: data:; style-src 'unsafe-inline'; "
POLICY += "base-uri 'none'; form-action 'none'; script-src "


def policy(script: str) -> str:
    """Content-Security-Policy of a page with this script, which may be empty."""
    digest = b64encode(hashlib.sha256(script.encode()).digest()).decode()
    return POLICY + (f"'sha256-{digest}'" if script else "'none'")


PAGES.globals["policy"] = policy


def page(template: str, **data: object) -> str:
    """A whole page: a file in `TEMPLATES`, filled with what it shows."""
    return PAGES.get_template(template).render(data, configuration=configuration()) + "\n"
