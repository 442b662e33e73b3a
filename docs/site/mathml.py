"""Write mathematics as MathML, which browsers show without a script and without a network."""

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.application import Sphinx


def show_inline(translator: nodes.NodeVisitor, node: nodes.math) -> None:
    """Write a formula within a line of text."""
    translator.body.append(convert(node.astext()))
    raise nodes.SkipNode


def show_block(translator: nodes.NodeVisitor, node: nodes.math_block) -> None:
    """Write a formula in a paragraph of its own, which the keyboard can scroll if it is wide."""
    translator.body.append('<div class="math" tabindex="0" role="group" aria-label="equation">')
    translator.body.append(convert(node.astext(), display="block") + "</div>\n")
    raise nodes.SkipNode


def setup(app: Sphinx) -> dict:
    """Register the renderer."""
    app.add_html_math_renderer("mathml", (show_inline, None), (show_block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
