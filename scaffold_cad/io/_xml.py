"""XML of other programs: no document types, no entities, nothing fetched."""

from __future__ import annotations

from pathlib import Path
from xml.etree.ElementTree import Element, ParseError

from defusedxml.common import DefusedXmlException
from defusedxml.ElementTree import fromstring

from scaffold_cad.errors import FormatError
from scaffold_cad.io._text import line_error


def xml_root(path: Path, text: bytes) -> Element:
    """Return the root element of the XML `text`, which is from the file at `path`.

    Raises
    ------
    FormatError
        If it is not well-formed, or declares a document type or entities.
    """
    try:
        root: Element = fromstring(text, forbid_dtd=True)
    except ParseError as error:
        line, _ = error.position
        raise line_error(path, line, str(error), "well-formed XML") from None
    except DefusedXmlException:
        raise FormatError(f"{path} declares a document type or entities; need none") from None
    except (LookupError, ValueError) as error:
        raise FormatError(f"{path} cannot be read: {error}; need XML in UTF-8") from None
    return root
