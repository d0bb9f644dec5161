"""Runs the tutorials as a reader would: page by page, block by block, in an empty folder."""

from __future__ import annotations

import os
import re
import shlex
import shutil
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import pytest

from tests.docs.code_blocks import DOCS, CodeBlock, all_blocks, blocks_of
from tests.system.command_line import PATIENCE, RunningCommand, environment, run_words
from tests.system.shown_runs import shown_run

NOT_RUN = {
    r"\./scripts/": "sets an environment up and runs for minutes; tests/system/test_set_up*.py",
    r"pip install": "changes the environment",
    r"python examples/": "tests/examples runs all of them",
    r"(git clone|for n in|done$|python docs/reference/extracts/)": (
        "needs the data of others; test_extracts.py runs the scripts on files like theirs"
    ),
    r"(ros2|rosdep|colcon|source|export) ": "needs an installation of ROS 2",
    r"sonar-tracking (evaluate|bench|chaos)": "takes minutes; the studies have tests of their own",
    r"sonar-tracking run (crossing_targets|tma|cross_fix|tonals|active) --rate": (
        "minutes of data; tests/system runs these scenarios"
    ),
    r"sonar-tracking run doa_fusion --duration 20 --rate max": "recorded_run of tests/system is it",
    r"sonar-tracking run doa_fusion .* --record seen": "record_and_replay.md makes the same bag",
    r"sonar-tracking replay ship_bag": "needs a bag of others; tests/system/test_replay.py has one",
    r"sonar-tracking replay my_bag --loop": "does not end; tests/system/test_replay.py ends it",
    r"sonar-tracking show": "does not end; tests/display/page/test_show_bag.py shows recordings",
    r"sonar-tracking run harbour_watch$": "minutes of data; tests/system/test_page.py has a page",
    r"sonar-tracking doctor": "tells of the machine; tests/graph/verbs/test_doctor.py",
    r"sonar-tracking import samples .* --own-ship": "needs own ship's track; tests/system runs it",
    r"python listener\.py": "does not end; test_listener_prints_the_bearings runs it",
    r"python -m sonar_tracking.graph.nodes": "does not end; test_publish_contacts.py runs it",
    r"python publisher\.py": "speaks to it, likewise",
    r"sonar-tracking run doa_fusion --duration 10 --no-display": (
        "what the listener listens to, likewise"
    ),
}
"""Lines of console blocks that are not run here, and why; they are parsed all the same."""

NOT_RUN_PAGES = {
    "README.md": "one screen of the commands that the tutorials run",
    "docs/get_started.md": "the two commands",
    "docs/tutorials/several_machines.md": "two machines; tests/system/test_network_namespaces.py",
    "docs/tutorials/publish_contacts.md": "test_publish_contacts.py runs it from top to bottom",
    "CONTRIBUTING.md": "a release by hand; tests/system/test_packaging.py makes one",
}


FROM_NOTHING = "docs/tutorials/record_and_replay.md"
"""Page whose first run is typed into a shell; other commands are copies, which load less."""


RECORDED = "sonar-tracking run tma --duration 540 --rate max --no-display --record tma_bag"
"""Run that tests/system/test_tma.py and test_scene.py look at, too: it is recorded once."""


def is_run(line: str) -> bool:
    """Whether a line of a console block is run here."""
    return not any(re.match(pattern, line) for pattern in NOT_RUN)


TUTORIALS = [
    page
    for page in sorted({block.page for block in all_blocks()} - set(NOT_RUN_PAGES))
    if any(
        block.language == "python" or any(map(is_run, block.commands))
        for block in blocks_of(DOCS.parent / page)
    )
]


def reader_environment(folder: Path) -> dict[str, str]:
    """Return the environment of a reader who has activated the virtual environment."""
    programs = Path(sys.executable).parent
    return {**environment(folder), "PATH": f"{programs}{os.pathsep}{os.environ['PATH']}"}


def run_block(block: CodeBlock, folder: Path, factory: pytest.TempPathFactory) -> None:
    """Do what a reader does with a block."""
    if block.caption:
        (folder / block.caption).write_text(block.text, encoding="utf-8")
        return
    commands = [line for line in block.commands if is_run(line)]
    if block.language == "python":
        (folder / "block.py").write_text(block.text, encoding="utf-8")
        commands = ["python -W error block.py"]
    first = block == blocks_of(DOCS.parent / FROM_NOTHING)[0]
    for line in commands:
        if line == RECORDED:
            shutil.copytree(shown_run(factory, "tma") / "bag", folder / "tma_bag")
            continue
        program, *words = shlex.split(line)
        typed = first and words[0] == "run"
        if program == "sonar-tracking" and not typed:
            done = run_words(words, reader_environment(folder), folder)
            assert done.returncode == 0, f"{line}\n{done.stdout}"
        else:
            run_line(line, folder)


def run_line(line: str, folder: Path) -> None:
    """Type a command."""
    done = subprocess.run(
        ["bash", "-c", line],
        cwd=folder,
        env=reader_environment(folder),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        timeout=PATIENCE,
        check=False,
    )
    assert done.returncode == 0, f"{line}\n{done.stdout}"


@pytest.mark.parametrize("page", TUTORIALS)
def test_page_works_from_top_to_bottom(
    page: str, tmp_path: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    for block in blocks_of(DOCS.parent / page):
        run_block(block, tmp_path, tmp_path_factory)


def test_every_file_a_page_makes_is_used_by_it() -> None:
    """A file that no command reads would not be tested."""
    for page in (*TUTORIALS, "docs/tutorials/publish_contacts.md"):
        blocks = blocks_of(DOCS.parent / page)
        lines = " ".join(line for block in blocks for line in block.commands)
        for block in blocks:
            assert not block.caption or block.caption in lines, f"{page}: {block.caption}"
            assert block.language != "yaml" or block.caption, f"{page}: {block.text}"


def test_every_reason_not_to_run_a_line_is_needed() -> None:
    lines = [line for block in all_blocks() for line in block.commands]
    unused = [pattern for pattern in NOT_RUN if not any(re.match(pattern, each) for each in lines)]
    assert not unused
    assert RECORDED in lines


def listener_blocks() -> list[CodeBlock]:
    """Return the listener as README.md and as the tutorial show it."""
    return [block for block in all_blocks() if "create_subscription" in block.text]


def test_readme_shows_the_listener_of_the_tutorial() -> None:
    first, *others = listener_blocks()
    assert others
    assert all(block.text == first.text for block in others)
    assert len(first.text.splitlines()) <= 12


def end_foreign(program: subprocess.Popen[bytes]) -> None:
    """End a program that leaves signals to rclpy.

    One that comes when rclpy is about to wait is lost (3 of 240 times on a busy machine): the
    program waits on, and ends at the next.
    """
    code = None
    while code is None:
        program.terminate()
        with suppress(subprocess.TimeoutExpired):
            code = program.wait(5.0)


def test_listener_prints_the_bearings(tmp_path: Path) -> None:
    (tmp_path / "listener.py").write_text(listener_blocks()[0].text, encoding="utf-8")
    heard = tmp_path / "heard.txt"
    with heard.open("w") as output:
        listener = subprocess.Popen(
            [sys.executable, "-u", "listener.py"],
            cwd=tmp_path,
            env=reader_environment(tmp_path),
            stdout=output,
        )
    run = RunningCommand(tmp_path, *shlex.split("run doa_fusion --duration 10 --no-display"))
    try:
        run.wait_for(lambda: re.search(r"\{1: -?\d\.\d+", heard.read_text()) is not None)
        run.interrupt()
        assert run.wait() == 130, run.output
    finally:
        run.clean_up()
        end_foreign(listener)
