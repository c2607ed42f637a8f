import struct

from hypothesis import given
from hypothesis import strategies as st

from reasoned_explorer.vehicles.unitree.checksum import packet_crc, scrambled


def slow_crc(packet: bytes) -> int:
    """Bit by bit, the plain way."""
    crc = 0xFFFFFFFF
    for (word,) in struct.iter_unpack("<I", packet[: (len(packet) // 4 - 1) * 4]):
        for bit in range(31, -1, -1):
            top = crc >> 31
            crc = (crc << 1) & 0xFFFFFFFF
            if top:
                crc ^= 0x04C11DB7
            if word >> bit & 1:
                crc ^= 0x04C11DB7
    return crc


@given(st.binary(min_size=8, max_size=200))
def test_it_is_what_a_plain_loop_gives(packet):
    assert packet_crc(packet) == slow_crc(packet)


@given(st.integers(0, 2**32 - 1))
def test_scrambling_loses_nothing(crc):
    first, second, third, fourth = scrambled(crc).to_bytes(4, "little")
    assert int.from_bytes(bytes((fourth, first, second, third)), "little") ^ 0xEDCAB9DE == crc
