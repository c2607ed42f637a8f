"""The rating page in a real browser: rated by hand and by keyboard, reloaded, started anew."""

import socket
from collections.abc import Iterator
from contextlib import ExitStack, closing, contextmanager
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

import pytest

from reasoned_explorer.evaluation.ratings import Answer, RatingStore
from reasoned_explorer.viewer.rating_desk import RatingDesk
from reasoned_explorer.viewer.rating_routes import create_rating_app
from reasoned_explorer.viewer.security import Guard
from reasoned_explorer.viewer.serving import Server
from tests.viewer.page_runs import MARKUP, Tab, browser
from tests.viewer.rating_runs import copied, counting_in, rating, said_in

GOAL = "main.rate:not(.waits) .goal h1"


@pytest.fixture(scope="module")
def chromium(bench: Path) -> Iterator[Any]:
    # After the runs were made: Playwright keeps an event loop in this thread, and missions have theirs.
    with browser() as made:
        yield made


@pytest.fixture
def run(bench: Path, tmp_path: Path) -> Path:
    return copied(bench, tmp_path / "run")


@contextmanager
def tab(chromium: Any, url: str, *, faults: bool = False, **options: Any) -> Iterator[Tab]:
    """Open a page; when it is closed nothing may have gone wrong in it."""
    options.setdefault("viewport", {"width": 1280, "height": 720})
    with ExitStack() as stack:
        context = chromium.new_context(**options)
        stack.callback(context.close)
        made = Tab(context.new_page(), url)
        yield made
        assert made.strangers == []
        assert faults or made.faults == []


def begin(made: Tab, name: str = "Ann") -> Any:
    page = made.page
    page.goto(made.url)
    page.fill("input[type=text]", name)
    page.keyboard.press("Enter")
    page.wait_for_selector(GOAL)
    return page


def at(made: Tab, place: int) -> None:
    """Wait until the mission of a place (from 1) is shown, ready to be rated."""
    made.wait(
        f"location.hash === '#{place}' && document.querySelector('.bar b')?.textContent === '{place}' "
        f"&& !!document.querySelector('{GOAL}')",
        f"mission {place} is shown",
    )


def chosen(page: Any) -> tuple[str, str, str]:
    """Return what stands in the form."""
    found = page.evaluate("[...document.querySelectorAll('.form input:checked')].map((one) => one.value)")
    answer, how_well = found if len(found) == 2 else ("", "")
    return answer, how_well, page.input_value(".comment textarea")


def test_three_missions_are_rated_by_keyboard_and_are_there_after_a_reload_and_a_restart(
    chromium: Any, run: Path
) -> None:
    with rating(run) as server, tab(chromium, server.url) as made:
        page = begin(made)
        for place, keys in enumerate((("y", "5"), ("p", "3"), ("n", "1")), start=1):
            at(made, place)
            for key in (*keys, "Enter"):
                page.keyboard.press(key)
            made.wait(f"location.hash === '#{place + 1}'", "it goes on by itself")
        at(made, 4)
        assert page.inner_text(".status") == "Mission 3 is saved."
        page.reload()
        at(made, 4)
        assert "3 rated" in page.inner_text(".bar")
        for expected in (("no", "1", ""), ("partly", "3", ""), ("yes", "5", "")):
            page.keyboard.press("PageUp")
            made.wait("!!document.querySelector('main.rate:not(.waits) .chip')", "it says that this one is rated")
            made.wait("document.querySelectorAll('.form input:checked').length === 2", "the answer is there")
            assert chosen(page)[1] in {"1", "3", "5"}
            made.wait(
                f"document.querySelector('.form input:checked').value === '{expected[0]}'",
                "it is that mission's answer",
            )
            assert chosen(page) == expected
    assert [said.answer for said in said_in(run)] == [Answer.YES, Answer.PARTLY, Answer.NO]
    with rating(run) as server, tab(chromium, server.url) as made:
        begin(made)
        at(made, 4)
        assert "3 rated" in made.page.inner_text(".bar")


def test_what_is_not_sent_yet_survives_a_reload(chromium: Any, run: Path) -> None:
    with rating(run) as server, tab(chromium, server.url) as made:
        page = begin(made)
        at(made, 1)
        page.keyboard.press("p")
        page.keyboard.press("2")
        page.keyboard.press("c")
        page.keyboard.type("It is a bin, no bench: yes? 5 of 5")
        assert said_in(run) == [], "nothing is sent before it is said"
        page.reload()
        at(made, 1)
        made.wait("document.querySelectorAll('.form input:checked').length === 2", "the draft is there")
        assert chosen(page) == ("partly", "2", "It is a bin, no bench: yes? 5 of 5"), "letters in a comment are letters"
        page.click("text=Save and go on")
        at(made, 2)
    (said,) = said_in(run)
    assert said.comment == "It is a bin, no bench: yes? 5 of 5"


def test_an_earlier_answer_can_be_changed_by_hand(chromium: Any, run: Path) -> None:
    with rating(run) as server, tab(chromium, server.url) as made:
        page = begin(made)
        at(made, 1)
        for key in ("y", "5", "Enter"):
            page.keyboard.press(key)
        at(made, 2)
        page.click("text=Back")
        at(made, 1)
        made.wait("document.querySelectorAll('.form input:checked').length === 2", "the answer is there")
        page.click(".choice.no")
        page.click(".grades .choice >> nth=0")
        page.click("text=Save the change")
        at(made, 2)
    assert [(said.answer, said.how_well) for said in said_in(run)] == [(Answer.YES, 5), (Answer.NO, 1)]
    assert [said.answer for said in counting_in(run)] == [Answer.NO]


def test_markup_in_goals_and_comments_does_nothing(chromium: Any, bench: Path, tmp_path: Path) -> None:
    run = copied(bench, tmp_path / "run", markup=True)
    with rating(run) as server, tab(chromium, server.url) as made:
        page = begin(made, MARKUP[:60])
        at(made, 1)
        assert page.inner_text(".goal h1") == f"“{MARKUP}”"
        page.fill(".comment textarea", MARKUP)
        page.click(".choice.yes")
        page.click(".grades .choice >> nth=4")
        page.click("text=Save and go on")
        at(made, 2)
        page.keyboard.press("PageUp")
        at(made, 1)
        made.wait("document.querySelectorAll('.form input:checked').length === 2", "the answer is there")
        assert page.input_value(".comment textarea") == MARKUP
        assert page.evaluate("document.querySelectorAll('main b, h1 img, .bar img, .bar b').length") <= 2
        assert page.evaluate("document.querySelectorAll('[onerror]').length") == 0
        assert page.title() == "Rate missions"
    (said,) = said_in(run)
    assert (said.comment, said.rater) == (MARKUP, MARKUP[:60])


def test_a_server_that_is_gone_loses_nothing_and_one_that_comes_back_takes_it(chromium: Any, run: Path) -> None:
    with closing(socket.socket()) as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]

    @contextmanager
    def serving() -> Iterator[Server]:
        guard = Guard()  # each with a secret of its own
        with RatingStore(run) as store:
            desk = RatingDesk(store, now=lambda: datetime(2026, 3, 1, tzinfo=UTC), secret=b"k")
            with Server(guard.protects(create_rating_app(desk, guard=guard)), port=port) as server:
                yield server

    with ExitStack() as stack:
        with serving() as server:
            made = stack.enter_context(tab(chromium, server.url, faults=True))
            page = begin(made)
            at(made, 1)
        page.keyboard.press("y")
        page.keyboard.press("4")
        page.keyboard.press("Enter")
        made.wait("document.querySelector('.status').textContent.startsWith('Not saved')", "it says so")
        assert chosen(page)[:2] == ("yes", "4")
        assert said_in(run) == []
        with serving():
            page.keyboard.press("Enter")
            at(made, 2)
        assert len(said_in(run)) == 1


def test_another_site_cannot_rate(chromium: Any, run: Path) -> None:
    """A page of another origin posts as such pages can: as a form, and by script with and without asking first."""
    with rating(run) as server, rating(run) as stranger, tab(chromium, stranger.url, faults=True) as made:
        page = made.page
        page.goto(stranger.url)
        page.wait_for_selector("input[type=text]")
        page.context.add_init_script("")  # nothing of ours
        sent = page.evaluate(
            """async (url) => {
                const body = JSON.stringify({rater: "Eve", answer: "yes", how_well: 5, comment: ""});
                const tried = [];
                for (const options of [
                    {method: "POST", mode: "no-cors", body},
                    {method: "PUT", headers: {"Content-Type": "application/json", "X-Rex-CSRF": "the secret"}, body},
                ]) {
                    try {
                        tried.push((await fetch(url, options)).status);
                    } catch {
                        tried.push("refused");
                    }
                }
                return tried;
            }""",
            f"{server.url}api/rate/items/{'0' * 32}",
        )
        # Our own policy already keeps a page of ours from asking elsewhere.
        assert set(sent) <= {"refused", 0, 403}
        made.strangers.clear()
        # One without such a policy: the request arrives, and is refused.
        plain = chromium.new_context()
        try:
            other = plain.new_page()
            answers: list[int] = []
            other.on("response", lambda answer: answers.append(answer.status))
            other.goto("data:text/html,<form method=post enctype=text/plain></form>")
            other.evaluate(
                "(url) => { const form = document.forms[0]; form.action = url; form.submit(); }",
                f"{server.url}api/rate/rater",
            )
            other.wait_for_url(f"{server.url}**")
            assert 403 in answers
            assert "only the page of this server may change something" in other.inner_text("body")
        finally:
            plain.close()
    assert said_in(run) == []


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("size", [(1280, 720), (768, 1024), (390, 844)])
def test_everything_fits_on_a_screen_and_on_a_tablet(
    chromium: Any, run: Path, scheme: str, size: tuple[int, int]
) -> None:
    viewport = {"width": size[0], "height": size[1]}
    options = {"viewport": viewport, "color_scheme": scheme, "has_touch": size[0] < 1280}
    with rating(run) as server, tab(chromium, server.url, **options) as made:
        page = begin(made)
        at(made, 1)
        assert page.evaluate("document.documentElement.scrollWidth") <= size[0], "nothing sticks out"
        made.wait("document.querySelectorAll('.strip img').length === 5", "all pictures are asked for")
        page.click(".strip button >> nth=3")
        assert "72° right" in page.inner_text(".large figcaption")
        page.click(".choice.partly")
        page.click(".grades .choice >> nth=2")
        assert page.is_enabled(".send button")
        if size[0] >= 768:
            box = page.locator(".send button").bounding_box()
            assert box is not None
            assert box["y"] + box["height"] <= size[1], "the answer can be sent without scrolling"


def test_looking_round_by_arrow_keys(chromium: Any, run: Path) -> None:
    with rating(run) as server, tab(chromium, server.url) as made:
        page = begin(made)
        at(made, 1)
        page.keyboard.press("ArrowRight")
        made.wait("document.querySelector('.large figcaption b').textContent === '72° right'", "it turned")
        for _ in range(2):
            page.keyboard.press("ArrowRight")
        made.wait("document.querySelector('.large figcaption b').textContent === '144° left'", "all the way round")
