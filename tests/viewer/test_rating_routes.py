"""What the rating page's server answers, asked over HTTP as anybody could ask it."""

import json
from pathlib import Path
from typing import Any

import pytest

from reasoned_explorer.evaluation.bench.store import RunStore
from reasoned_explorer.evaluation.ratings import Answer, RatingStore
from reasoned_explorer.model import InputError
from reasoned_explorer.viewer.rating_desk import Choice, RatingDesk
from reasoned_explorer.viewer.security import Guard
from reasoned_explorer.viewer.serving import Server
from tests.viewer.asking import Answer as Reply
from tests.viewer.asking import ask
from tests.viewer.page_runs import MARKUP
from tests.viewer.rating_runs import NOON, copied, counting_in, declared, rating, said_in, without_records

OURS = {"Sec-Fetch-Site": "same-origin", "X-Rex-CSRF": "the secret", "Content-Type": "application/json"}
TOKEN = "a-token-that-is-long-enough"  # noqa: S105 - of the tests
SAID = {"rater": "Ann", "answer": "partly", "how_well": 3, "comment": "nearly"}


@pytest.fixture
def run(bench: Path, tmp_path: Path) -> Path:
    return copied(bench, tmp_path / "run")


def put(server: Server, item: str, said: dict[str, Any], headers: dict[str, str] | None = None) -> Reply:
    path = f"/api/rate/items/{item}"
    return ask(server, path, method="PUT", headers=OURS if headers is None else headers, body=json.dumps(said).encode())


def items(server: Server, rater: str = "Ann") -> list[str]:
    found: list[str] = ask(server, f"/api/rate/items?rater={rater}").json["items"]
    return found


def finished(run: Path) -> set[tuple[str, str, str]]:
    with RunStore.read(run) as store:
        return store.finished()


def test_an_answer_is_kept_with_who_when_and_which_version(run: Path) -> None:
    with rating(run) as server:
        first = items(server)[0]
        kept = put(server, first, SAID)
        assert (kept.status, kept.json["saved"], kept.json["rated"]) == (200, True, 1)
        # Already while the server runs: whoever asks the run sees it.
        (said,) = said_in(run)
        assert (said.rater, said.answer, said.how_well, said.comment) == ("Ann", Answer.PARTLY, 3, "nearly")
        assert said.at > NOON
        assert said.version
        assert said.question == 1
        found = ask(server, f"/api/rate/items/{first}?rater=Ann").json
        assert found["mine"] == {"answer": "partly", "how_well": 3, "comment": "nearly"}
        assert ask(server, f"/api/rate/items/{first}?rater=Bob").json["mine"] is None, "others are not shown it"


def test_what_was_rated_is_there_after_a_restart_under_the_same_names(run: Path) -> None:
    with rating(run) as server:
        order = items(server)
        put(server, order[2], SAID)
    with rating(run) as server:
        found = ask(server, "/api/rate/items?rater=Ann").json
        assert found["items"] == order
        assert [place for place, done in enumerate(found["rated"]) if done] == [2]
        assert ask(server, "/api/rate/next?rater=Ann").json == {"item": order[0], "place": 0, "of": len(order)}


def test_raters_get_all_missions_each_in_an_order_of_their_own(run: Path) -> None:
    with rating(run) as server:
        ann, bob = items(server), items(server, "Bob")
        assert set(ann) == set(bob)
        assert len(set(ann)) == len(ann) == len(finished(run))
        assert ann != bob
    with rating(run, seed=1) as server:
        assert items(server) != ann


def test_nothing_of_the_method_the_scores_or_the_judge_is_told(run: Path) -> None:
    with RunStore.read(run) as store:
        rows = {(row.score.vehicle, row.method, row.mission_id): row for row in store.rows()}
        records = {key: store.record(row) for key, row in rows.items()}
    with rating(run) as server:
        told = [ask(server, f"/api/rate/items/{item}?rater=Ann") for item in items(server)]
        maps = [ask(server, f"/api/rate/items/{item}/map") for item in items(server)[:2]]
    for answer in told:
        said = answer.body.decode() + json.dumps(dict(answer.headers))
        for row in rows.values():
            for secret in (row.method, row.planner, row.minds, row.judge, row.mission_id, row.reason):
                assert secret not in said
        assert set(answer.json) == {"item", "goal", "way", "end", "attribution", "pictures", "captions", "mine"}
        assert answer.json["captions"] == []
    captions = {view.caption for record in records.values() if record for step in record.steps for view in step.views}
    assert captions, "there was something to be kept back"
    for answer in maps:
        assert answer.json["objects"] == []
        assert all(not building["name"] for building in answer.json["buildings"])
        assert answer.json["ground"], "but there is ground to stand on"


def test_the_list_of_missions_cannot_be_asked_for_beside_it(run: Path) -> None:
    with rating(run) as server:
        for path in ("/api/runs", "/api/about", "/run.sqlite", "/pages/../run.sqlite", "/api/rate/items"):
            assert ask(server, path).status in {404, 422}
        assert ask(server, "/").headers["location"] == "/pages/rate.html"
        assert b"/pages/rate.js" in ask(server, "/pages/rate.html").body


def test_pictures_show_all_round_where_it_ended(run: Path) -> None:
    with rating(run) as server:
        item = items(server)[0]
        labels = ask(server, f"/api/rate/items/{item}?rater=Ann").json["pictures"]
        assert labels == ["144° left", "72° left", "ahead", "72° right", "144° right"]
        seen = {ask(server, f"/api/rate/items/{item}/pictures/{place}.png").body for place in range(5)}
        assert len(seen) == 5
        assert all(picture.startswith(b"\x89PNG") for picture in seen)
        assert ask(server, f"/api/rate/items/{item}/pictures/5.png").status == 404
        assert ask(server, f"/api/rate/items/{item}/pictures/-1.png").status == 404


@pytest.mark.parametrize(
    "headers",
    [
        {**OURS, "Sec-Fetch-Site": "cross-site"},
        {**OURS, "Sec-Fetch-Site": "same-site"},
        {**OURS, "Origin": "http://evil.example"},
        {**OURS, "X-Rex-CSRF": "guessed"},
        {name: value for name, value in OURS.items() if name != "X-Rex-CSRF"},
        {"X-Rex-CSRF": "the secret", "Content-Type": "application/json"},
    ],
)
def test_no_other_page_can_rate(run: Path, headers: dict[str, str]) -> None:
    with rating(run) as server:
        item = items(server)[0]
        assert put(server, item, SAID, headers).status == 403
        body = json.dumps({"name": "Eve"}).encode()
        assert ask(server, "/api/rate/rater", method="POST", headers=headers, body=body).status == 403
    assert said_in(run) == []


@pytest.mark.parametrize(
    "change",
    [
        {"answer": "maybe"},
        {"how_well": 0},
        {"how_well": 6},
        {"how_well": "4"},
        {"how_well": True},
        {"how_well": 2.5},
        {"comment": "x" * 2001},
        {"comment": "bell\x07"},
        {"rater": ""},
        {"rater": "x" * 65},
        {"rater": "a\x00b"},
        {"method": "llm-rrt"},
    ],
)
def test_what_is_no_answer_is_refused_in_one_sentence(run: Path, change: dict[str, Any]) -> None:
    with rating(run) as server:
        refused = put(server, items(server)[0], {**SAID, **change})
        assert refused.status == 422
        assert refused.json["error"]
        assert put(server, items(server)[0], SAID).status == 200
    assert len(said_in(run)) == 1


@pytest.mark.parametrize("item", ["0" * 32, "..%2F..%2Frun.sqlite", "x" * 65, "ABC"])
def test_what_is_no_mission_is_not_found(run: Path, item: str) -> None:
    with rating(run) as server:
        assert put(server, item, SAID).status == 404
        assert ask(server, f"/api/rate/items/{item}?rater=Ann").status == 404


def test_two_raters_at_two_servers_of_one_run(run: Path) -> None:
    with rating(run) as one, rating(run) as other:
        order = items(one)
        assert items(other) == order, "names are the run's, not the server's"
        for place, item in enumerate(order):
            server, rater = ((one, "Ann"), (other, "Bob"))[place % 2]
            assert put(server, item, {**SAID, "rater": rater}).status == 200
        assert sum(ask(other, "/api/rate/items?rater=Ann").json["rated"]) == len(order) // 2
    assert len(counting_in(run)) == len(order)
    assert [path.name for path in run.glob("run.sqlite*")] == ["run.sqlite"]


def test_a_page_that_was_opened_for_one_person_takes_no_other(run: Path) -> None:
    with rating(run, rater="Ann") as server:
        assert ask(server, "/api/rate/about").json["rater"] == "Ann"
        item = items(server)[0]
        assert put(server, item, {**SAID, "rater": "Bob"}).status == 403
        assert put(server, item, SAID).status == 200


def test_missions_without_a_record_are_left_out_and_counted(run: Path) -> None:
    methods = [method for _, method, _ in finished(run)]
    lost = methods.count("llm-rrt")
    without_records(run, "llm-rrt")
    with rating(run) as server:
        assert len(items(server)) == len(methods) - lost
        assert ask(server, "/api/rate/about").json["left_out"] == lost
    with RatingStore(run) as store, pytest.raises(InputError, match=f"none of {lost} missions has a record"):
        RatingDesk(store, now=lambda: NOON, secret=b"k", choice=Choice(methods=("llm-rrt",)))


def test_methods_levels_and_declarations_can_be_chosen(run: Path) -> None:
    with RatingStore(run) as store:

        def count(**chosen: Any) -> int:
            return RatingDesk(store, now=lambda: NOON, secret=b"k", choice=Choice(**chosen)).count

        with RunStore.read(run) as read:
            rows = list(read.rows())
        level = rows[0].level
        assert count(methods=("llm-rrt",)) == sum(row.method == "llm-rrt" for row in rows)
        assert count(levels=(level,)) == sum(row.level == level for row in rows)
        assert count(count=5) == 5
        said = len(declared(run))
        if said:
            assert count(declared=True) == said


def test_a_token_is_asked_for_beyond_this_machine(run: Path) -> None:
    guard = Guard(token=TOKEN, csrf="the secret")
    with rating(run, guard=guard) as server:
        assert ask(server, "/api/rate/items?rater=Ann").status == 401
        assert ask(server, "/pages/rate.html").status == 401
        assert put(server, "0" * 32, SAID).status == 401
        welcome = ask(server, f"/?token={TOKEN}")
        assert welcome.status == 303
        assert "token" not in welcome.headers["location"]


def test_markup_is_told_as_text(bench: Path, tmp_path: Path) -> None:
    run = copied(bench, tmp_path / "run", markup=True)
    with rating(run) as server:
        found = ask(server, f"/api/rate/items/{items(server)[0]}?rater=Ann")
        assert found.json["goal"] == MARKUP
        assert found.headers["content-type"] == "application/json"
        assert found.headers["x-content-type-options"] == "nosniff"
        assert "unsafe-inline" not in found.headers["content-security-policy"]


def test_without_its_world_a_mission_is_told_in_the_captioner_s_words(bench: Path, tmp_path: Path) -> None:
    run = copied(bench, tmp_path / "run", elsewhere=True)
    with rating(run) as server:
        item = items(server)[0]
        found = ask(server, f"/api/rate/items/{item}?rater=Ann").json
        assert found["pictures"] == []
        assert found["captions"]
        assert ask(server, f"/api/rate/items/{item}/map").status == 404
        assert ask(server, f"/api/rate/items/{item}/pictures/0.png").status == 404
