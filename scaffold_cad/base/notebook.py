"""What notebooks show of the library's types."""

from __future__ import annotations


class Shown:
    """A type that notebooks show as a page; see `webpage.for_notebook`."""

    def _repr_html_(self) -> str:
        """Return it as a notebook shows it."""
        # Imported here: pages know of everything that they show.
        from scaffold_cad.webpage import for_notebook

        return for_notebook(self)
