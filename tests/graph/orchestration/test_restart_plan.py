"""Protects with what a node is started again: a source with the stamp after which it goes on."""

from pathlib import Path

from sonar_tracking.graph.catalogue.resumption import VARIABLE
from sonar_tracking.graph.orchestration.finished_stamps import FinishedStamps
from sonar_tracking.graph.orchestration.restart_plan import restarted_process
from sonar_tracking.graph.verbs.run_options import RunOptions
from sonar_tracking.graph.verbs.run_scenario import plan_scenario, read_scenario


def test_a_source_goes_on_behind_what_all_that_live_have_received(tmp_path: Path) -> None:
    graph = plan_scenario(read_scenario("active", None), RunOptions(), tmp_path, "active")
    finished = FinishedStamps()
    source = "contact_simulator"

    def environment(name: str, absent: tuple[str, ...] = ()) -> dict[str, str]:
        plan = restarted_process(graph, name, tmp_path, 1, absent, finished)
        return dict(plan.environment)

    assert VARIABLE not in environment(source)
    for topic in ("/active/contacts", "/own_ship/odometry"):
        finished.finished("orchestration", topic, 30)
    assert VARIABLE not in environment(source), "the tracker may have nothing"
    assert environment(source, ("hpda_tracker",))[VARIABLE] == "30"
    for topic, stamp in (("/active/contacts", 20), ("/own_ship/odometry", 10)):
        finished.finished("hpda_tracker", topic, stamp)
    assert environment(source)[VARIABLE] == "20"
    assert environment("world_simulator")[VARIABLE] == "10"
    assert VARIABLE not in environment("hpda_tracker")
