"""The checksum at the end of Unitree's packets.

A command carries it as it is; a state carries it scrambled, and the vendor's library of 3.8 takes no other. Nothing
else of high-level packets is scrambled or encrypted.
"""

import zlib

#: Each byte with its bits in reverse order.
_REVERSED = bytes(int(f"{byte:08b}"[::-1], 2) for byte in range(256))
_WORD = 4
_MASK = 0xEDCAB9DE


def packet_crc(packet: bytes) -> int:
    """Return the checksum of a whole packet, whose last four bytes are where it stands.

    The polynomial is that of Ethernet (0x04C11DB7) with nothing reversed or inverted at the end, taken over whole
    little-endian words, the highest bit of each first. As many words count as fit in the packet, less one; of a packet
    whose length is no multiple of four the bytes between the last such word and the checksum are therefore not covered
    (one of HighCmd, three of HighState, all of them reserved).

    Args:
        packet: At least eight bytes.
    """
    covered = packet[: (len(packet) // _WORD - 1) * _WORD]
    swapped = bytearray(len(covered))
    for place in range(_WORD):
        swapped[place::_WORD] = covered[_WORD - 1 - place :: _WORD]
    # zlib's is the same sum with all bits in reverse and the result inverted; it is a hundred times as fast as a loop.
    mirrored = zlib.crc32(bytes(swapped).translate(_REVERSED)) ^ 0xFFFFFFFF
    return int(f"{mirrored:032b}"[::-1], 2)


def scrambled(crc: int) -> int:
    """Return a checksum as it stands in a state: inverted here and there, its four bytes in another order."""
    first, second, third, fourth = (crc ^ _MASK).to_bytes(_WORD, "little")
    return int.from_bytes(bytes((second, third, fourth, first)), "little")
