"""Tables of STEP entities (ISO 10303-21, AP214), each formatted at once."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import datetime
from typing import TextIO, TypeAlias

import numpy as np

from scaffold_cad.base.arrays import Floats, Ints
from scaffold_cad.base.blocks import blocks

CELL_BYTES = 1024
"""What a cell of a table takes where it is formatted: its text, as Python's object and in a row."""

REFERENCES_PER_LINE = 16
"""References on a line of a long list."""

HEADER = """\
ISO-10303-21;
HEADER;
FILE_DESCRIPTION(('{name}'),'2;1');
FILE_NAME('{name}','{time}',(''),(''),'scaffold_cad','scaffold_cad','');
FILE_SCHEMA(('AUTOMOTIVE_DESIGN {{ 1 0 10303 214 1 1 1 1 }}'));
ENDSEC;
DATA;
#1=APPLICATION_CONTEXT('core data for automotive mechanical design processes');
#2=APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,#1);
#3=PRODUCT_CONTEXT('',#1,'mechanical');
#4=PRODUCT('{name}','{name}','',(#3));
#5=PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,(#4));
#6=PRODUCT_DEFINITION_FORMATION('','',#4);
#7=PRODUCT_DEFINITION_CONTEXT('part definition',#1,'design');
#8=PRODUCT_DEFINITION('design','',#6,#7);
#9=PRODUCT_DEFINITION_SHAPE('','',#8);
#10=(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT(.MILLI.,.METRE.));
#11=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));
#12=(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT());
#13=UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-07),#10,'distance_accuracy_value',\
'confusion accuracy');
#14=(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#13))\
GLOBAL_UNIT_ASSIGNED_CONTEXT((#10,#11,#12))REPRESENTATION_CONTEXT('',''));
#15=CARTESIAN_POINT('',(0.,0.,0.));
#16=DIRECTION('',(0.,0.,1.));
#17=DIRECTION('',(1.,0.,0.));
#18=AXIS2_PLACEMENT_3D('',#15,#16,#17);
"""
HEADER_ENTITIES = 18
PRODUCT_SHAPE, CONTEXT, PLACEMENT = 9, 14, 18  # entities of the header that others refer to

POINT = "CARTESIAN_POINT('',(%s,%s,%s))"
DIRECTION = "DIRECTION('',(%s,%s,%s))"


Column: TypeAlias = Ints | Floats | list[str]
"""References, real numbers or texts, one per row."""


@dataclass
class Tables:
    """A file being written, entity after entity."""

    file: TextIO
    count: int = HEADER_ENTITIES
    """Number of entities written so far, which is the number of the last one."""

    def add(self, template: str, *columns: Column) -> Ints:
        """Write an entity for each row of `columns`, (n,) each; return their numbers, (n,)."""
        numbers = np.arange(len(columns[0])) + self.count + 1
        width = len(columns) + 1
        for block in blocks(len(numbers), CELL_BYTES * width):
            rows = len(numbers[block])
            cells: list[object] = [None] * (rows * width)
            for i, column in enumerate((numbers, *columns)):
                cells[i::width] = _cells(column[block])
            self.file.write(f"#%d={template};\n" * rows % tuple(cells))
        self.count += len(numbers)
        return numbers

    def add_list(self, before: str, members: Ints, after: str) -> int:
        """Write one entity around the list of `members`; return its number."""
        texts = [f"#{member}" for member in members.tolist()]
        rows = range(0, len(texts), REFERENCES_PER_LINE)
        body = ",\n".join(",".join(texts[i : i + REFERENCES_PER_LINE]) for i in rows)
        self.count += 1
        self.file.write(f"#{self.count}={before}({body}){after};\n")
        return self.count


def references(count: int) -> str:
    """Return a template of `count` references to entities."""
    return ",".join(["#%d"] * count)


def columns(points: Floats) -> Floats:
    """Return the x, y and z of `points` (..., 3), shape (3, n)."""
    return points.reshape(-1, 3).T


def _cells(column: Column) -> Sequence[object]:
    """Return what a template takes: whole numbers as such, and real ones as text."""
    if isinstance(column, list):
        return column
    if column.dtype == np.float64:
        return _real_texts(np.asarray(column, dtype=np.float64))
    numbers: list[int] = column.tolist()
    return numbers


def _real_texts(values: Floats) -> list[str]:
    """Return the shortest decimals that give `values` (n,) back; STEP asks for a point in each."""
    texts = list(map(repr, values.tolist()))
    size = np.abs(values)
    for i in np.flatnonzero((size > 0) & (size < 1e-4) | (size >= 1e16)).tolist():
        texts[i] = f"{values[i]:.16E}"
    return texts


def escaped(text: str) -> str:
    """Return `text` as a string of ISO 10303-21, which is ASCII."""
    return "".join(map(_escaped_character, text))


def _escaped_character(character: str) -> str:
    code = ord(character)
    if character in "'\\":
        return 2 * character
    if " " <= character <= "~":
        return character
    return f"\\X2\\{code:04X}\\X0\\" if code < 0x10000 else f"\\X4\\{code:08X}\\X0\\"


def write_header(file: TextIO, name: str) -> Tables:
    """Write what stands before the shapes of a file with one product; return its tables."""
    time = datetime.now().replace(microsecond=0).isoformat()
    file.write(HEADER.format(name=escaped(name), time=time))
    return Tables(file)


def write_end(tables: Tables, solids: Ints) -> None:
    """Write what stands behind the solids."""
    shape = tables.add_list(
        "ADVANCED_BREP_SHAPE_REPRESENTATION('',", np.append(PLACEMENT, solids), f",#{CONTEXT})"
    )
    tables.add(f"SHAPE_DEFINITION_REPRESENTATION(#{PRODUCT_SHAPE},#%d)", np.asarray([shape]))
    tables.file.write("ENDSEC;\nEND-ISO-10303-21;\n")
