"""Protects the documentation as a whole: it builds without a warning, and without network."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

from tests.docs.code_blocks import DOCS, PROJECT

NO_NETWORK = dict.fromkeys(("http_proxy", "https_proxy", "all_proxy"), "http://127.0.0.1:9")


def test_documentation_builds_without_a_warning(tmp_path: Path) -> None:
    options = ["-W", "--keep-going", "-q", "-b", "html", "-d", str(tmp_path / "doctrees")]
    done = subprocess.run(
        [sys.executable, "-m", "sphinx", *options, str(DOCS), str(tmp_path / "html")],
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
