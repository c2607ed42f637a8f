import pytest

from reasoned_explorer.calls.endpoint import AskingSettings, endpoint_at
from reasoned_explorer.calls.pacing import Limits
from reasoned_explorer.model import SettingsError

KEY = "sk-planted-0123456789"


@pytest.fixture(autouse=True)
def clean_environment(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("OPENAI_API_KEY", "OPENAI_BASE_URL"):
        monkeypatch.delenv(name, raising=False)


def test_without_an_address_it_is_openai(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OPENAI_API_KEY", KEY)
    endpoint = endpoint_at()
    assert endpoint.base_url == "https://api.openai.com/v1"
    assert endpoint.is_openai
    assert not endpoint.is_local
    assert endpoint.key() == KEY
    assert KEY not in repr(endpoint)


def test_openai_without_a_key_is_refused_at_once() -> None:
    with pytest.raises(SettingsError, match=r"no key for api\.openai\.com; expected one in OPENAI_API_KEY"):
        endpoint_at()


@pytest.mark.parametrize(
    "url", ["http://localhost:8000/v1", "http://127.0.0.1:1234/v1/", "http://[::1]:80/v1", "http://127.8.9.1/v1"]
)
def test_this_machine_needs_no_key(url: str) -> None:
    endpoint = endpoint_at(url)
    assert endpoint.is_local
    assert endpoint.key() is None
    assert not endpoint.base_url.endswith("/")


@pytest.mark.parametrize(
    "url", ["https://example.org/v1", "http://192.168.0.7/v1", "http://localhost.example.org/v1", "http://0x7f.org/v1"]
)
def test_other_machines_are_other_machines(url: str) -> None:
    assert not endpoint_at(url).is_local


def test_the_key_does_not_go_in_the_clear_to_another_machine_unless_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OPENAI_API_KEY", KEY)
    monkeypatch.setenv("LAB_KEY", "lab")
    assert endpoint_at("http://192.168.0.7:8000/v1").key() is None
    assert endpoint_at("http://192.168.0.7:8000/v1", key_variable="LAB_KEY").key() == "lab"
    assert endpoint_at("https://example.org/v1").key() == KEY


def test_a_named_variable_must_hold_a_key() -> None:
    with pytest.raises(SettingsError, match="LAB_KEY"):
        endpoint_at("http://localhost/v1", key_variable="LAB_KEY")


@pytest.mark.parametrize("url", ["localhost:8000", "ftp://example.org", "http://", "http://host:99999/v1", "http://[1"])
def test_what_is_no_address_is_refused(url: str) -> None:
    with pytest.raises(SettingsError, match="expected an address such as"):
        endpoint_at(url)


@pytest.mark.parametrize("url", ["https://me:hunter2@example.org/v1", "https://example.org/v1?key=hunter2"])
def test_a_secret_in_the_address_is_refused_and_not_repeated(url: str) -> None:
    with pytest.raises(SettingsError) as caught:
        endpoint_at(url)
    assert "hunter2" not in str(caught.value)


def test_what_a_server_says_back_is_scrubbed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("LAB_KEY", "correct horse")
    endpoint = endpoint_at("http://localhost/v1", key_variable="LAB_KEY")
    said = "wrong key: correct horse, sk-proj-abcdefgh1234 or Bearer abc"
    assert endpoint.scrub(said) == "wrong key: ***, *** or ***"


def test_all_settings_out_of_range_are_told_at_once() -> None:
    with pytest.raises(SettingsError) as caught:
        AskingSettings(deadline_s=0.0, tries=0, limits=Limits(requests_per_minute=-1.0), structure="xml")  # type: ignore[arg-type]
    assert len(caught.value.faults) == 4


def test_the_environment_may_name_another_address_and_an_option_goes_before_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("OPENAI_BASE_URL", "http://localhost:8000/v1")
    assert endpoint_at().base_url == "http://localhost:8000/v1"
    assert endpoint_at("http://localhost:9/v1").base_url == "http://localhost:9/v1"
