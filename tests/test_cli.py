"""Whatever goes wrong with a request is one sentence, never a traceback."""

from pathlib import Path

import pytest
from typer.testing import CliRunner

import sonar_tracking
from sonar_tracking import cli
from tests.ros_domain import ros_domain


def refused(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, *arguments: str
) -> str:
    monkeypatch.setenv("ROS_DOMAIN_ID", str(ros_domain()))  # not that of the tests beside
    monkeypatch.setattr("sys.argv", ["sonar-tracking", *arguments])
    assert cli.main() == cli.REFUSED
    said = capsys.readouterr().err
    assert said.count("\n") == 1
    return said


def test_a_folder_that_cannot_be_made_is_named(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    (tmp_path / "file").touch()
    pictures = str(tmp_path / "file" / "pictures")

    class Plotter:
        @staticmethod
        def plot_bag(bag: Path, output: Path, names: object) -> None:
            output.mkdir(parents=True)

    monkeypatch.setattr(cli, "_needs", lambda module: Plotter)
    said = refused(capsys, monkeypatch, "plot", "bag", "--output", pictures)
    assert pictures in said and "another path" in said


def test_a_bag_that_cannot_be_made_is_refused_before_the_run(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    (tmp_path / "file").touch()
    bag = str(tmp_path / "file" / "bag")
    said = refused(capsys, monkeypatch, "run", "--record", bag)
    assert f"--record: {bag} cannot be made" in said


def test_the_version_is_that_of_the_package(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.argv", ["sonar-tracking", "--version"])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    assert not ended.value.code
    assert capsys.readouterr().out == f"sonar-tracking {sonar_tracking.__version__}\n"


def test_the_shell_completes_verbs(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.argv", ["sonar-tracking"])
    monkeypatch.setenv("_SONAR_TRACKING_COMPLETE", "complete_bash")
    monkeypatch.setenv("COMP_WORDS", "sonar-tracking re")
    monkeypatch.setenv("COMP_CWORD", "1")
    with pytest.raises(SystemExit):
        cli.main()
    assert capsys.readouterr().out.split() == ["replay"]


@pytest.mark.parametrize("verb", ["replay", "import", "none"])
def test_a_verb_by_itself_is_that_of_the_whole_command(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch, verb: str
) -> None:
    words = [verb, "--help"]
    whole = CliRunner().invoke(cli.app, words, prog_name="sonar-tracking")
    monkeypatch.setattr("sys.argv", ["sonar-tracking", *words])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    said = capsys.readouterr()
    assert (ended.value.code, said.out, said.err) == (whole.exit_code, whole.stdout, whole.stderr)
