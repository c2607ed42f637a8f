"""A fake Go1: it answers each command with a state, on the loopback, and walks as it is told."""

import asyncio
from dataclasses import replace
from typing import Self

from reasoned_explorer.vehicles.unitree import (
    HighCommand,
    HighState,
    ImuReading,
    Mode,
    PacketError,
    decode_command,
    encode_state,
)


class FakeGo1(asyncio.DatagramProtocol):
    """Remembers what it was told; what it answers can be spoilt by a test."""

    def __init__(self) -> None:
        self.commands: list[HighCommand] = []
        self.garbage = 0
        self.is_dumb = False
        self.answers_with: list[bytes] | None = None
        self.port = 0

    async def start(self) -> None:
        loop = asyncio.get_running_loop()
        self._transport, _ = await loop.create_datagram_endpoint(lambda: self, local_addr=("127.0.0.1", 0))
        self.port = self._transport.get_extra_info("sockname")[1]

    def close(self) -> None:
        self._transport.close()

    async def __aenter__(self) -> Self:
        await self.start()
        return self

    async def __aexit__(self, *error: object) -> None:
        self.close()

    def datagram_received(self, data: bytes, addr: tuple[str, int]) -> None:
        try:
            command = decode_command(data)
        except PacketError:
            self.garbage += 1
            return
        self.commands.append(command)
        if self.is_dumb:
            return
        answers = self.answers_with
        for answer in [encode_state(self.state_of(command))] if answers is None else answers:
            self._transport.sendto(answer, addr)

    @staticmethod
    def state_of(command: HighCommand) -> HighState:
        walks = command.mode == Mode.WALK
        rate = command.yaw_rate_left_radps if walks else 0.0
        return HighState(
            imu=replace(ImuReading(), gyroscope_radps=(0.0, 0.0, rate)),
            mode=command.mode,
            gait=command.gait,
            velocity_mps=(command.forward_mps, command.left_mps, 0.0) if walks else (0.0, 0.0, 0.0),
            yaw_rate_left_radps=rate,
        )
