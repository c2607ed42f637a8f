from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.model import SettingsError
from reasoned_explorer.vehicles.positioning.source import (
    GpsdSource,
    NtripSource,
    SerialSource,
    parse_ntrip,
    parse_source,
)


@pytest.mark.parametrize(
    ("text", "source"),
    [
        ("gpsd://rover", GpsdSource("rover", 2947)),
        ("gpsd://192.168.123.161:3000", GpsdSource("192.168.123.161", 3000)),
        ("gpsd://[::1]:3000/", GpsdSource("::1", 3000)),
        ("serial:/dev/ttyUSB1", SerialSource("/dev/ttyUSB1", 38400)),
        ("serial:/dev/ttyUSB1:115200", SerialSource("/dev/ttyUSB1", 115200)),
        ("serial:COM3:9600", SerialSource("COM3", 9600)),
        ("serial:/dev/serial/by-id/usb-u-blox_AG-if00", SerialSource("/dev/serial/by-id/usb-u-blox_AG-if00")),
        ("serial:socket://127.0.0.1:7000", SerialSource("socket://127.0.0.1:7000")),
    ],
)
def test_sources_are_read(text, source):
    assert parse_source(text) == source


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "gpsd://HOST"),
        ("/dev/ttyUSB1", "serial:DEVICE"),
        ("gpsd://", "the host is ''"),
        ("gpsd:rover", "gpsd://HOST"),
        ("gpsd://rover:99999", "1 to 65535"),
        ("gpsd://rover:0", "1 to 65535"),
        ("gpsd://rover/there", "goes on after the port"),
        ("gpsd://[::1", "address"),
        ("serial:", "the device is ''"),
        ("serial:/dev/ttyUSB1:38401", "38400"),
        ("serial:/dev/ttyUSB1:fast", "'fast' bits a second"),
        ("serial:/dev/tty USB1", "without spaces"),
    ],
)
def test_what_is_written_wrongly_is_said(text, says):
    with pytest.raises(SettingsError) as caught:
        parse_source(text)
    assert says in str(caught.value)


def test_all_faults_are_said_at_once():
    with pytest.raises(SettingsError) as caught:
        parse_source("serial: :1")
    assert len(caught.value.faults) == 2
    with pytest.raises(SettingsError) as caught:
        parse_ntrip("http://me:secret@:99999")
    assert len(caught.value.faults) == 5
    assert "secret" not in str(caught.value)
    assert "NTRIP_PASSWORD" in str(caught.value)


def test_casters_are_read():
    assert parse_ntrip("ntrip://caster.example/NEAREST") == NtripSource("caster.example", "NEAREST", 2101)
    assert parse_ntrip("ntrip://10.0.0.1:8000/A1") == NtripSource("10.0.0.1", "A1", 8000)


@pytest.mark.parametrize("text", ["ntrip://caster", "ntrip://caster/a/b", "ntrip:///A", "ntrip://c/A?x=1", "c/A"])
def test_casters_that_are_written_wrongly_are_refused(text):
    with pytest.raises(SettingsError):
        parse_ntrip(text)


@given(st.text(max_size=30) | st.text(max_size=20).map("gpsd://".__add__) | st.text(max_size=20).map("serial:".__add__))
def test_any_text_is_a_source_or_refused(text):
    for parse in (parse_source, parse_ntrip):
        with suppress(SettingsError):
            parse(text)
