"""The report of a result, for files and notebooks."""
from __future__ import annotations

import html
import os
from typing import Optional, Union

Path = Union[str, "os.PathLike[str]"]


class HasReport:
    """Base of results with a report.html."""

    def _page(self) -> str:
        raise NotImplementedError

    def report(self, path: Optional[Path] = None) -> str:
        """Returns report.html as text, and writes it to `path` if given."""
        page = self._page()
        if path is not None:
            with open(path, "w", encoding="utf-8") as file:
                file.write(page)
        return page

    def _repr_html_(self) -> str:
        return ('<iframe style="width: 100%; height: 40em; border: 0" srcdoc="'
                + html.escape(self.report()) + '"></iframe>')
