"""How Sphinx builds the documentation: ./scripts/docs.sh, without network."""

from __future__ import annotations

import gc
import sys
from importlib import import_module
from pathlib import Path
from typing import Any

import sonar_tracking

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent))

project = "sonar_tracking"
author = "The sonar_tracking developers"
project_copyright = "The sonar_tracking developers"
version = release = sonar_tracking.__version__

extensions = [
    "myst_parser",
    "numpydoc",
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx.ext.viewcode",
    "sphinx_copybutton",
    "sphinx_design",
    "sphinx-mathjax-offline",
]
exclude_patterns = ["_build", "_written", "reference_writer"]
nitpicky = False

myst_enable_extensions = ["amsmath", "attrs_inline", "colon_fence", "deflist", "dollarmath"]
myst_heading_anchors = 4
suppress_warnings = ["myst.header"]  # pieces that are included begin below their page's heading

autodoc_member_order = "bysource"
autodoc_typehints = "none"  # types and shapes are in the docstrings
autosummary_generate = False  # each package is one page
numpydoc_show_class_members = False
numpydoc_xref_param_type = False

mathjax3_config = {"chtml": {"scale": 0.95}}

html_theme = "pydata_sphinx_theme"
html_title = f"{project} {version}"
html_static_path = ["_static"]
html_css_files = ["style.css"]
WITHOUT_SECTION = ("get_started", "which_method", "limits", "troubleshooting")
html_sidebars: dict[str, list[str]] = {page: [] for page in WITHOUT_SECTION}
html_show_sourcelink = False
html_copy_source = False
html_theme_options: dict[str, Any] = {
    "logo": {"text": project},
    "show_prev_next": True,
    "secondary_sidebar_items": ["page-toc"],
    "navigation_with_keys": False,
    "footer_start": ["copyright"],
    "footer_end": [],
    "header_links_before_dropdown": 7,
    "navbar_align": "left",
    "navbar_persistent": ["search-button"],
    "show_nav_level": 2,
}
copybutton_prompt_text = r"\$ "
copybutton_prompt_is_regexp = True


def compile_template_once() -> None:
    """Let numpydoc compile its template once, and not for each docstring."""
    numpydoc: Any = import_module("numpydoc.docscrape_sphinx")
    made: list[Any] = []
    make = numpydoc.SandboxedEnvironment

    def first(loader: Any) -> Any:
        if not made:
            made.append(make(loader=loader))
        return made[0]

    numpydoc.SandboxedEnvironment = first


def setup(application: Any) -> None:
    """Write what is made from the code before the pages are read."""
    from docs.reference_writer.pages import write_fragments

    compile_template_once()
    gc.disable()  # what is made of the pages stays to the end: there is little to find
    application.connect("builder-inited", lambda _: write_fragments(HERE / "_written"))
