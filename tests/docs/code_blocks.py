"""The code blocks of README.md, CONTRIBUTING.md and the pages below docs/."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[2]
DOCS = PROJECT / "docs"
PAGES = [
    PROJECT / "README.md",
    PROJECT / "CONTRIBUTING.md",
    *sorted(
        page
        for page in DOCS.rglob("*.md")
        if page.relative_to(DOCS).parts[0] not in {"_build", "_written"}
    ),
]
FENCE = re.compile(
    r"^```(?P<info>[^\n`]*)\n(?P<options>(?::[^\n]*\n)*)(?P<text>.*?)^```$",
    flags=re.MULTILINE | re.DOTALL,
)


@dataclass(frozen=True)
class CodeBlock:
    """One block of a page.

    Attributes
    ----------
    page : str
        Relative to the project.
    language : str
        ``console``, ``python``, ``yaml`` or ``text``; others are directives of Sphinx, e.g.
        ``{include}``.
    caption : str
        Name of the file that the reader is to make of it; empty = none.
    text : str
        What is in it.
    """

    page: str
    language: str
    caption: str
    text: str

    @property
    def commands(self) -> list[str]:
        """Lines of a console block without comments."""
        if self.language != "console":
            return []
        text = self.text.replace("\\\n", " ")  # a command that goes on in the next line
        lines = (re.sub(r"(^|\s)#.*", "", line).strip() for line in text.splitlines())
        return [line for line in lines if line]


def blocks_of(page: Path) -> list[CodeBlock]:
    """Return the blocks of one page, in order."""
    blocks = []
    for fence in FENCE.finditer(page.read_text(encoding="utf-8")):
        directive, _, argument = fence["info"].strip().partition(" ")
        caption = re.search(r"^:caption: (\S+)$", fence["options"], flags=re.MULTILINE)
        blocks.append(
            CodeBlock(
                page=str(page.relative_to(PROJECT)),
                language=argument if directive == "{code-block}" else directive,
                caption=caption[1] if caption else "",
                text=fence["text"].lstrip("\n"),
            )
        )
    return blocks


def all_blocks() -> list[CodeBlock]:
    """Return the blocks of all pages."""
    return [block for page in PAGES for block in blocks_of(page)]
