"""Protects the documentation as a whole: it builds without a warning, and without network."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from docs.conf import extensions
from tests.docs.code_blocks import DOCS, PROJECT

SOURCE_PAGES = "sphinx.ext.viewcode"
"""Makes a page of every module, which takes a third of the time and warns of nothing."""

WITHOUT_LUXURY = """
import sys
from sphinx.builders.html import StandaloneHTMLBuilder
from sphinx.cmd.build import main
from sphinx.pycode.parser import Parser
from sphinx.transforms import SphinxSmartQuotes
StandaloneHTMLBuilder.search = False
Parser.parse_definition = lambda self: None
SphinxSmartQuotes.is_available = lambda self: False
sys.exit(main(sys.argv[1:]))
"""
"""So do the index of the search, the places of members in the source, and curly quotes."""

NO_NETWORK = dict.fromkeys(("http_proxy", "https_proxy", "all_proxy"), "http://127.0.0.1:9")


def test_documentation_builds_without_a_warning(tmp_path: Path) -> None:
    options = ["-W", "--keep-going", "-q", "-b", "html", "-d", str(tmp_path / "doctrees")]
    used = ",".join(each for each in extensions if each != SOURCE_PAGES)
    options += ["-D", f"extensions={used}"]
    done = subprocess.run(
        [sys.executable, "-c", WITHOUT_LUXURY, *options, str(DOCS), str(tmp_path / "html")],
        cwd=PROJECT,
        env={**os.environ, **NO_NETWORK},
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    pages = "".join(page.read_text() for page in (tmp_path / "html").rglob("*.html"))
    assert 'src="http' not in pages, "a page fetches a script or picture from elsewhere"
    assert 'rel="stylesheet" type="text/css" href="http' not in pages
