"""What is bundled with the page is what its makers published, and the page's own files keep to the house's rules."""

import re
from hashlib import sha256
from importlib.resources import files
from pathlib import Path

import pytest

PAGES = Path(str(files("reasoned_explorer.viewer") / "pages"))
VENDOR = PAGES / "vendor"
SCRIPTS = sorted(PAGES.glob("*.js"))


def test_every_bundled_file_is_the_published_one() -> None:
    listed = dict(reversed(line.split()) for line in (VENDOR / "SHA256SUMS").read_text().splitlines())
    found = {
        path.relative_to(VENDOR).as_posix(): sha256(path.read_bytes()).hexdigest()
        for path in VENDOR.rglob("*")
        if path.is_file() and path.parent != VENDOR
    }
    assert found == listed


def test_every_bundled_part_has_its_licence_and_its_line() -> None:
    said = (VENDOR / "README.md").read_text()
    for part in (path for path in VENDOR.iterdir() if path.is_dir()):
        assert (part / "LICENSE").is_file()
        for path in part.iterdir():
            assert f"`{part.name}/{path.name}`" in said or f"({path.name}" in said or path.name in said


@pytest.mark.parametrize("path", SCRIPTS, ids=lambda path: path.name)
def test_no_script_of_ours_writes_markup(path: Path) -> None:
    text = path.read_text()
    assert len(text.splitlines()) <= 400
    for word in ("innerHTML", "outerHTML", "insertAdjacentHTML", "document.write", "dangerouslySetInnerHTML", "eval("):
        assert word not in text


@pytest.mark.parametrize("path", [*SCRIPTS, *PAGES.glob("*.html"), *PAGES.glob("*.css")], ids=lambda path: path.name)
def test_no_file_of_ours_names_another_machine(path: Path) -> None:
    addresses = set(re.findall(r"https?://[^\s\"'`)]+", path.read_text()))
    assert addresses <= {"http://www.w3.org/2000/svg"}


@pytest.mark.parametrize("path", sorted(PAGES.glob("*.html")), ids=lambda path: path.name)
def test_no_page_has_scripts_or_styles_in_its_markup(path: Path) -> None:
    text = path.read_text()
    assert not re.search(r"\sstyle=|\son\w+=|<style|<script(?![^>]*\ssrc=)", text)
