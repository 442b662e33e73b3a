"""Fill the templates of the pages. Every value is escaped, unless it is marked as HTML."""

import hashlib
from base64 import b64encode
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined

from slippulse.data.files import configuration_digest

from ..text.markdown import markup_of as markup_of
from ..text.numerals import FILTERS

TEMPLATES = Path(__file__).with_name("templates")
PAGES = Environment(loader=FileSystemLoader(TEMPLATES), autoescape=True, undefined=StrictUndefined)
PAGES.trim_blocks = PAGES.lstrip_blocks = True
PAGES.filters |= FILTERS
# A page may run only its own script. It may load only pictures: from its site, from local files, or
# from data in the page itself.
POLICY = "default-src 'none'; img-src 'self' file: data:; style-src 'unsafe-inline'; "
POLICY += "base-uri 'none'; form-action 'none'; script-src "


def policy(script: str) -> str:
    """Return the Content-Security-Policy of a page, which allows only its own script.

    script : text of the script; empty for a page without one
    """
    digest = b64encode(hashlib.sha256(script.encode()).digest()).decode()
    return POLICY + (f"'sha256-{digest}'" if script else "'none'")


PAGES.globals["policy"] = policy


def page(template: str, **data: object) -> str:
    """Return a whole page as HTML.

    template : name of a file in the folder `TEMPLATES`
    data : values that the template uses, by name
    """
    return PAGES.get_template(template).render(data, configuration=configuration_digest()) + "\n"
