"""The page in a real browser: what a person does with it, by hand, by keyboard and by touch."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest

from reasoned_explorer.viewer.app import create_app, guarded
from reasoned_explorer.viewer.library import Library
from reasoned_explorer.viewer.security import Guard
from reasoned_explorer.viewer.serving import Server
from tests.viewer.page_runs import MARKUP, Tab, bench_run, browser, full_of_markup, mission_of, write_record

Open = Callable[..., Tab]
FIRST = "document.querySelector('.rows .line .c-goal').textContent"
STEP = "document.querySelector('.step-head h2').textContent"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("runs")
    bench_run(folder / "bench")
    write_record(folder / "alone", full_of_markup(mission_of(folder / "alone")))
    return folder


@pytest.fixture(scope="module")
def url(folder: Path) -> Iterator[str]:
    guard = Guard()
    with Server(guarded(create_app(Library(folder), guard=guard), guard)) as server:
        yield server.url


@pytest.fixture(scope="module")
def chromium(url: str) -> Iterator[Any]:
    # After the runs were made: Playwright keeps an event loop in this thread, and missions have theirs.
    with browser() as made:
        yield made


@pytest.fixture
def tab(chromium: Any, url: str) -> Iterator[Open]:
    """Open a browser's page of a size; when the test is over nothing may have gone wrong in it."""
    with ExitStack() as stack:
        tabs = []

        def make(width: int = 1280, height: int = 720, **options: Any) -> Tab:
            context = chromium.new_context(viewport={"width": width, "height": height}, **options)
            stack.callback(context.close)
            tabs.append(Tab(context.new_page(), url))
            return tabs[-1]

        yield make
        for each in tabs:
            assert each.faults == []
            assert each.strangers == []


def _open_bench(tab: Tab) -> Any:
    page = tab.open()
    page.click("a.run:has-text('bench')")
    page.wait_for_selector(".rows .line")
    return page


def _open_replay(tab: Tab, method: str = "llm-rrt") -> Any:
    page = _open_bench(tab)
    page.select_option("select[aria-label=Method]", method)
    page.click(".rows .line >> nth=0")
    page.wait_for_selector(".step-words")
    return page


def _text(page: Any, of: str) -> str:
    return str(page.inner_text(of))


def test_runs_are_listed_with_how_many_missions_they_have(tab: Open) -> None:
    page = tab().open()
    page.wait_for_selector("a.run")
    assert page.locator("a.run").count() == 2
    assert "8 missions" in _text(page, "a.run:has-text('bench')")


def test_a_list_is_filtered_counted_and_sorted(tab: Open) -> None:
    page = _open_bench(tab())
    assert _text(page, "output.count") == "8 missions"
    page.select_option("select[aria-label=Method]", "nearest-frontier")
    assert _text(page, "output.count") == "4 of 8 missions"
    # What can still be chosen is counted within what the other filters leave over.
    levels = page.locator("select[aria-label=Level] option").all_inner_texts()
    assert sum(int(level.rsplit("(")[-1].rstrip(")")) for level in levels[1:]) == 4
    page.fill("input[type=search]", "plaza")
    assert _text(page, "output.count") == "2 of 8 missions"
    page.fill("input[type=search]", "no such thing")
    assert "No mission fits" in _text(page, ".grid")
    page.click("button:has-text('Show all')")
    assert _text(page, "output.count") == "8 missions"
    page.click(".heads button:has-text('Path')")
    paths = [float(text.split()[0]) for text in page.locator(".rows .line .c-path").all_inner_texts()]
    assert len(paths) == 8
    order = page.evaluate(
        "[...document.querySelectorAll('.rows .line')].map(l => Number(l.getAttribute('aria-rowindex')))"
    )
    assert [path for _, path in sorted(zip(order, paths, strict=True))] == sorted(paths)


def test_a_filter_outlives_a_look_at_a_replay(tab: Open) -> None:
    page = _open_replay(tab())
    page.click("a.back")
    page.wait_for_selector(".rows .line")
    assert _text(page, "output.count") == "4 of 8 missions"


def test_a_replay_goes_to_its_end_step_by_step(tab: Open) -> None:
    each = tab()
    page = _open_replay(each)
    total = int(page.evaluate(STEP).split(" of ")[1])
    seen = [page.evaluate(STEP)]
    for _ in range(2 * total):
        page.keyboard.press("ArrowRight")
        page.wait_for_timeout(160)
        if (now := page.evaluate(STEP)) != seen[-1]:
            seen.append(now)
    assert seen == [f"Step {number} of {total}" for number in range(1, total + 1)]
    page.keyboard.press("End")
    each.wait("document.querySelector('.ending') !== null", "how it ended")
    assert "Not found" in _text(page, ".ending") or "Found" in _text(page, ".ending")
    assert page.get_attribute(".strip", "aria-valuenow") == page.get_attribute(".strip", "aria-valuemax")
    page.keyboard.press("Home")
    each.wait(f"{STEP}.startsWith('Step 1 ')", "the first step again")


def test_a_replay_plays_and_stops(tab: Open) -> None:
    each = tab()
    page = _open_replay(each)
    page.select_option("select[aria-label=Speed]", "5")
    page.click("button[aria-label=Play]")
    each.wait("Number(document.querySelector('.strip').getAttribute('aria-valuenow')) > 2", "the time going on")
    page.click("button[aria-label=Pause]")
    page.wait_for_selector("button[aria-label=Play]")
    now = page.get_attribute(".strip", "aria-valuenow")
    page.wait_for_timeout(300)
    assert page.get_attribute(".strip", "aria-valuenow") == now


def test_the_time_line_is_dragged_through(tab: Open) -> None:
    each = tab()
    page = _open_replay(each)
    box = page.locator(".strip").bounding_box()
    page.mouse.move(box["x"] + 20, box["y"] + 10)
    page.mouse.down()
    page.mouse.move(box["x"] + box["width"] - 2, box["y"] + 10, steps=20)
    page.mouse.up()
    end = page.get_attribute(".strip", "aria-valuemax")
    each.wait(f"document.querySelector('.strip').getAttribute('aria-valuenow') === '{end}'", "the end")


def test_the_views_of_a_step_have_pictures_and_words(tab: Open) -> None:
    each = tab()
    page = _open_replay(each)
    each.wait(
        "[...document.querySelectorAll('.view img')].filter(i => i.complete && i.naturalWidth).length === 3",
        "pictures",
        90,
    )
    assert page.locator(".view .caption").count() == 3
    assert all(page.locator(".view .caption").all_inner_texts())
    assert "Q" in _text(page, ".step-words")


def test_the_imagined_tree_unfolds_by_mouse_and_by_keyboard(tab: Open) -> None:
    each = tab()
    page = _open_replay(each)
    page.click("button:has-text('Fold') >> nth=-1")
    folded = page.locator("[role=treeitem]").count()
    assert folded == 3
    page.click("[role=treeitem] >> nth=0 >> .node")
    assert page.locator("[role=treeitem]").count() > folded
    assert page.get_attribute("[role=treeitem] >> nth=0", "aria-expanded") == "true"
    page.focus("[role=treeitem] >> nth=0")
    page.keyboard.press("ArrowLeft")
    assert page.locator("[role=treeitem]").count() == folded
    page.keyboard.press("ArrowRight")
    page.keyboard.press("ArrowDown")
    each.wait("document.activeElement.getAttribute('aria-level') === '2'", "the first imagined scene is at hand")
    page.keyboard.press("ArrowUp")
    # As one task of the page, which draws nothing in between: no key acts on a tree as it was before the last one.
    page.evaluate(
        """() => {
          for (const key of ["ArrowLeft", "ArrowRight", "ArrowDown"])
            document.activeElement.dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
        }"""
    )
    each.wait("document.activeElement.getAttribute('aria-level') === '2'", "it is so however fast keys come")
    page.click("button:has-text('Unfold all')")
    said = int(_text(page, ".tree-tools span").split()[0])
    assert page.locator("[role=treeitem]").count() == folded + said


def test_frontiers_are_listed_by_what_they_are_worth(tab: Open) -> None:
    page = _open_replay(tab())
    page.keyboard.press("ArrowRight")
    page.keyboard.press("2")
    page.wait_for_selector(".frontiers tbody tr")
    values = [float(text) for text in page.locator(".frontiers td:last-child").all_inner_texts() if text != "–"]
    assert values == sorted(values, reverse=True)
    assert values


def test_two_missions_of_an_episode_are_compared(tab: Open) -> None:
    each = tab()
    page = _open_bench(each)
    page.click(".rows .line >> nth=0 >> button[aria-label=Compare]")
    page.click("dialog.peers a >> nth=0")
    page.wait_for_selector(".side >> nth=1")
    assert page.locator(".side .map").count() == 2
    for _ in range(3):
        page.keyboard.press("ArrowRight")
        page.wait_for_timeout(200)
    heads = page.locator(".side-head h2").all_inner_texts()
    assert len(set(heads)) == 2
    page.keyboard.press("End")
    each.wait("document.querySelectorAll('.side-words b')[0].textContent.startsWith('Over')", "the end of one")
    # Both maps show the same place.
    page.focus(".map >> nth=0")
    page.keyboard.press("+")
    scales = page.locator(".leaflet-control-scale-line").all_inner_texts()
    assert scales[0] == scales[1]


def test_everything_is_reached_by_keyboard_alone(tab: Open) -> None:
    each = tab()
    page = each.open()
    page.wait_for_selector("a.run")
    page.locator("a.run:has-text('bench')").focus()
    page.keyboard.press("Enter")
    page.wait_for_selector(".rows .line")
    page.keyboard.press("/")
    page.keyboard.type("park")
    assert _text(page, "output.count") == "4 of 8 missions"
    for _ in range(40):
        page.keyboard.press("Tab")
        if page.evaluate("document.activeElement.className") == "rows":
            break
    page.keyboard.press("ArrowDown")
    assert page.get_attribute(".rows", "aria-activedescendant") == "row-1"
    page.keyboard.press("c")
    page.wait_for_selector("dialog.peers[open]")
    page.keyboard.press("Escape")
    page.locator(".rows").focus()
    page.keyboard.press("Enter")
    page.wait_for_selector(".step-words")
    page.keyboard.press("ArrowRight")
    each.wait("Number(document.querySelector('.strip').getAttribute('aria-valuenow')) > 0", "a step on")
    page.keyboard.press("?")
    page.wait_for_selector("dialog.help[open]")
    page.keyboard.press("Escape")
    assert page.locator("dialog[open]").count() == 0


def test_markup_is_shown_as_the_text_that_it_is(tab: Open) -> None:
    each = tab()
    page = each.open()
    page.click("a.run:has-text('one mission')") if page.locator(
        "a.run:has-text('one mission')"
    ).count() else page.click("a.run:not(:has-text('bench'))")
    page.wait_for_selector(".rows .line")
    assert _text(page, ".rows .line .c-goal") == MARKUP
    page.click(".rows .line")
    page.wait_for_selector(".view")
    page.keyboard.press("End")
    each.wait("document.querySelectorAll('.leaflet-container').length === 1", "the map")
    assert MARKUP in _text(page, ".caption")
    page.click("button:has-text('Unfold all')")
    assert MARKUP in _text(page, ".tree")
    page.keyboard.press("3")
    assert MARKUP in _text(page, ".facts")
    page.wait_for_selector(".map-credit")
    shown = 0
    box = page.locator(".map").bounding_box()
    for column in range(4, 40):  # over the map, until tooltips with names of things have come up
        for row in range(4, 24):
            page.mouse.move(box["x"] + box["width"] * column / 44, box["y"] + box["height"] * row / 28)
            if page.locator(".map-tip").count() and MARKUP in page.locator(".map-tip").first.inner_text():
                shown += 1
                break
        if shown >= 3:
            break
    assert shown >= 1
    assert page.locator("img[src=x]").count() == 0
    assert page.title() == "Reasoned Explorer"


def test_light_and_dark_follow_the_system_until_somebody_chooses(tab: Open) -> None:
    paper = "getComputedStyle(document.body).backgroundColor"
    light, dark = tab(color_scheme="light").open(), tab(color_scheme="dark").open()
    assert light.evaluate(paper) != dark.evaluate(paper)
    dark.click("button[aria-label='Take the light colours']")
    assert dark.evaluate(paper) == light.evaluate(paper)
    dark.reload()
    dark.wait_for_selector("main > *")
    assert dark.evaluate(paper) == light.evaluate(paper)


@pytest.mark.parametrize(("width", "height"), [(1280, 720), (1024, 768), (820, 1180)])
def test_two_maps_stand_side_by_side(tab: Open, width: int, height: int) -> None:
    page = _open_bench(tab(width, height))
    page.click(".rows .line >> nth=0 >> button[aria-label=Compare]")
    page.click("dialog.peers a >> nth=0")
    page.wait_for_selector(".side >> nth=1")
    first, second = (page.locator(".side .stage").nth(place).bounding_box() for place in range(2))
    assert first["x"] + first["width"] <= second["x"]
    assert second["x"] + second["width"] <= width
    assert page.locator(".strip").bounding_box()["y"] < height


@pytest.mark.parametrize(("width", "height"), [(1280, 720), (1024, 768), (820, 1180)])
def test_nothing_is_wider_or_higher_than_the_screen(tab: Open, width: int, height: int) -> None:
    each = tab(width, height, has_touch=width < 1280)
    page = _open_replay(each)
    beyond = "[document.documentElement.scrollWidth - innerWidth, document.documentElement.scrollHeight - innerHeight]"
    assert page.evaluate(beyond) == [0, 0]
    inner = (
        "[...document.querySelectorAll('.replay > *')].every(e => e.getBoundingClientRect().right <= innerWidth + 1)"
    )
    assert page.evaluate(inner)
    assert page.locator(".strip").bounding_box()["y"] < height
    page.click("a.back")
    page.wait_for_selector(".rows .line")
    assert page.evaluate(beyond) == [0, 0]


def test_a_touch_opens_a_mission_and_moves_the_time(tab: Open) -> None:
    each = tab(820, 1180, has_touch=True)
    page = _open_bench(each)
    page.tap(".rows .line >> nth=1 >> .c-goal")
    page.wait_for_selector(".strip")
    box = page.locator(".strip").bounding_box()
    page.touchscreen.tap(box["x"] + box["width"] / 2, box["y"] + 10)
    each.wait(
        "Number(document.querySelector('.strip').getAttribute('aria-valuenow')) > 20", "the middle of the mission"
    )


def test_what_is_not_there_is_said_in_one_sentence(tab: Open, url: str) -> None:
    each = tab()
    page = each.open("#/missions/no-such-run/no-such-mission")
    page.wait_for_selector(".trouble")
    assert _text(page, ".trouble").startswith("run: there is no such run") or "no such" in _text(page, ".trouble")
    page.goto(f"{url}#/nonsense")
    page.wait_for_selector(".trouble:has-text('no such view')")
    each.faults[:] = [fault for fault in each.faults if "404" not in fault]  # the browser's own line for the answer 404


def test_still_pictures_are_kept_still(tab: Open) -> None:
    page = tab(reduced_motion="reduce").open()
    page.wait_for_selector("a.run")
    assert page.evaluate("document.getAnimations().length") == 0
