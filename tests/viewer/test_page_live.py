"""The page of a mission that is being written, in a real browser, over connections that are lost and come back."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from reasoned_explorer.evaluation.record_file import RecordWriter
from reasoned_explorer.model.record import EpisodeRecord
from reasoned_explorer.viewer.app import create_app, guarded
from reasoned_explorer.viewer.library import Library
from reasoned_explorer.viewer.live import LiveFeed
from reasoned_explorer.viewer.security import Guard
from reasoned_explorer.viewer.serving import Server
from tests.viewer.page_runs import Tab, browser, mission_of

STEP = "document.querySelector('.step-head h2')?.textContent"
LOST = ("ERR_CONNECTION_REFUSED", "ERR_INCOMPLETE_CHUNKED_ENCODING", "ERR_EMPTY_RESPONSE", "ERR_CONNECTION_RESET")


class LiveSite:
    """A server of a mission that is written line by line; it can be stopped and started again at the same address."""

    def __init__(self, folder: Path, record: EpisodeRecord) -> None:
        self.folder, self.record = folder, record
        self.guard = Guard()
        self._server = self._make(0)
        self._server.start()
        self.url = self._server.url

    def _make(self, port: int) -> Server:
        self.feed = LiveFeed(self.folder / "now" / "record.jsonl")
        return Server(
            guarded(create_app(Library(self.folder), guard=self.guard, live=self.feed), self.guard), port=port
        )

    def stop(self) -> None:
        self.feed.close()
        self._server.stop()

    def start_again(self) -> None:
        self._server = self._make(self._server.port)
        self._server.start()


@pytest.fixture
def site(tmp_path: Path) -> Iterator[LiveSite]:
    record = mission_of(tmp_path / "now")
    site = LiveSite(tmp_path, record)
    yield site
    site.stop()


@pytest.fixture
def tab(site: LiveSite) -> Iterator[Tab]:
    with browser() as made:
        tab = Tab(made.new_page(viewport={"width": 1280, "height": 720}), site.url)
        yield tab
        assert [fault for fault in tab.faults if not any(lost in fault for lost in LOST)] == []
        assert tab.strangers == []


def _at(tab: Tab, words: str) -> None:
    tab.wait(f"{STEP} === '{words}'", words)


def test_a_mission_is_followed_while_it_is_written(site: LiveSite, tab: Tab) -> None:
    page: Any = tab.open("#/live")
    page.wait_for_selector("text=Waiting for the first line")
    record = site.record
    with RecordWriter(site.folder / "now") as file:
        file.header(record.header)
        page.wait_for_selector("text=there is no step yet")
        file.step(record.steps[0])
        _at(tab, "Step 1 of 1")
        file.step(record.steps[1])
        _at(tab, "Step 2 of 2")
        page.wait_for_selector(".chip:has-text('live')")
        # Who looks back is not pulled away, and gets the new step all the same.
        page.keyboard.press("Home")
        _at(tab, "Step 1 of 2")
        file.step(record.steps[2])
        _at(tab, "Step 1 of 3")
        page.click("button:has-text('Follow')")
        _at(tab, "Step 3 of 3")
        for step in record.steps[3:]:
            file.step(step)
        assert record.summary is not None
        file.summary(record.summary)
    page.wait_for_selector(".chip:has-text('ended')")
    page.wait_for_selector(".ending")


def test_silence_is_told_and_what_was_missed_comes_later(site: LiveSite, tab: Tab) -> None:
    page: Any = tab.open("#/live")
    record = site.record
    with RecordWriter(site.folder / "now") as file:
        file.header(record.header)
        file.step(record.steps[0])
        _at(tab, "Step 1 of 1")
        drawn = "[...document.querySelectorAll('.view img')].filter(i => i.complete).length === 3"
        tab.wait(drawn, "the pictures, so that the server is not stopped while it draws them", 90.0)
        asked: list[str] = []
        page.on("request", lambda request: asked.append(request.url.removeprefix(site.url)))
        site.stop()
        page.wait_for_selector(".chip:has-text('stale since')", timeout=15_000)
        file.step(record.steps[1])
        file.step(record.steps[2])
        site.start_again()
        _at(tab, "Step 3 of 3")
        page.wait_for_selector(".chip:has-text('live')")
    # Nothing is loaded whole again: neither page nor map nor the steps that were there.
    assert [url for url in asked if not url.startswith("api/live") and "/views/" not in url] == []
