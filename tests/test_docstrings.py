"""Protects: whatever takes, returns or holds arrays in public states their shapes and units.

A parameter is looked up by its name under Parameters, a field of a class under Attributes, a result
under Returns or Yields; a parameter or result without an entry must be described in the summary.
Yes-or-no and index arrays need no unit.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator

import pytest

from tests.package_source import FILES, PACKAGE, parsed

ARRAYS = re.compile(r"\b(Float|Complex|Bool|Int|Index|Id|Code|Row|ND)Array\b|\bArrayLike\b")
NUMBERS = re.compile(r"\b(Float|Complex)Array\b|\bNDArray\[(Any|np\.float)|\bArrayLike\b")
SHAPE = re.compile(r"\bshape\b|\((\.\.\.|\*?\w[\w ]*),[^)]*\)")
UNIT = re.compile(
    r"(?<![\w.])(rad|m|s|ns|Hz|dB|deg)(\^-?\d)?(?![\w'])|[1m]/|\bPa\b|[Pp]ure numbers?|[Ll]inear"
    r"|[Rr]adians|[Pp]robabilit|\b[Uu]nits?\b|in bins|[Cc]ounts?\b|[Ii]dentifiers?"
    r"|[Ll]og[ -]likelihood|\bdecibel"
)
PLAIN = "summary"


def public_definitions(node: ast.AST) -> Iterator[ast.FunctionDef | ast.ClassDef]:
    """Yield the public functions and classes of a module, and the public methods of these."""
    for child in ast.iter_child_nodes(node):
        if not isinstance(child, ast.FunctionDef | ast.ClassDef) or child.name.startswith("_"):
            continue
        if not any(ast.unparse(each).endswith("overload") for each in child.decorator_list):
            yield child
        if isinstance(child, ast.ClassDef):
            yield from public_definitions(child)


def sections(docstring: str) -> dict[str, str]:
    """Return the numpydoc sections of a docstring by their headings."""
    parts = re.split(r"^(\w[\w ]*)\n-{3,}\n", docstring, flags=re.MULTILINE)
    return dict(zip([PLAIN, *parts[1::2]], parts[::2], strict=True))


def entry(section: str, name: str) -> str:
    """Return the entry of a parameter, without its name; empty if there is none."""
    for text in re.split(r"\n(?=\S)", section):
        names, _, rest = text.partition(" : ")
        if name in re.split(r"[\s,*]+", names):
            return rest
    return ""


def said_of_function(function: ast.FunctionDef) -> Iterator[tuple[str, ast.expr | None, str]]:
    """Yield name, annotation and description of each parameter and of the result."""
    parts = sections(ast.get_docstring(function) or "")
    arguments = [*function.args.posonlyargs, *function.args.args, *function.args.kwonlyargs]
    for each in arguments:
        text = entry(parts.get("Parameters", ""), each.arg)
        yield each.arg, each.annotation, text or parts[PLAIN]
    result = parts.get("Returns", parts.get("Yields", parts[PLAIN]))
    yield "its result", function.returns, result


def said_of_class(node: ast.ClassDef) -> Iterator[tuple[str, ast.expr | None, str]]:
    """Yield name, annotation and description of each field."""
    attributes = sections(ast.get_docstring(node) or "").get("Attributes", "")
    for each in node.body:
        if isinstance(each, ast.AnnAssign) and isinstance(each.target, ast.Name):
            yield each.target.id, each.annotation, entry(attributes, each.target.id)


def missing(node: ast.FunctionDef | ast.ClassDef) -> Iterator[str]:
    """Yield what a docstring does not say of arrays."""
    said = said_of_class(node) if isinstance(node, ast.ClassDef) else said_of_function(node)
    for name, annotation, text in said:
        kind = ast.unparse(annotation) if annotation else ""
        if not ARRAYS.search(kind) or "Callable" in kind:
            continue
        if not SHAPE.search(text):
            yield f"{node.name}: the shape of {name}"
        if NUMBERS.search(kind) and not UNIT.search(text):
            yield f"{node.name}: the unit of {name}"


def test_arrays_have_shapes_and_units() -> None:
    unsaid = [
        f"{path.relative_to(PACKAGE)}: {what}"
        for path in FILES
        for node in public_definitions(parsed(path))
        for what in missing(node)
    ]
    assert not unsaid, "\n".join(unsaid)


SECTIONS = """Return x.

    Parameters
    ----------
    x : ndarray, shape (n,)
        m.

    Returns
    -------
    ndarray, shape (n,)
        Of each.
    """


@pytest.mark.parametrize(
    ("docstring", "expected"),
    [
        ("Return x.", ["shape of x", "unit of x", "shape of its", "unit of its"]),
        ("Return x, shape (n,), rad.", []),
        (SECTIONS, ["unit of its"]),
    ],
)
def test_what_is_not_said_is_found(docstring: str, expected: list[str]) -> None:
    source = f'def f(x: FloatArray) -> FloatArray:\n    """{docstring}"""\n'
    (function,) = public_definitions(ast.parse(source))
    found = [what.split("the ")[1] for what in missing(function)]
    assert [what.removesuffix(" result") for what in found] == expected
