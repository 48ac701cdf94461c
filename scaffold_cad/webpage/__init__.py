"""Pages for browsers and notebooks that need nothing else: models in layers, drawn with WebGL.

The script that draws is our own and takes some 10 kB per page: a notebook keeps one page per cell.
"""

from scaffold_cad.base.notebook import register_drawer
from scaffold_cad.webpage.page import for_notebook, model_page, write_page

__all__ = ["for_notebook", "model_page", "write_page"]

register_drawer(for_notebook)
