"""A fake of `unitree_sdk2py`, as far as the driver of a Go2 uses it, with a fake Go2 behind it."""

import math
import sys
import threading
import time
from importlib import metadata
from importlib.machinery import ModuleSpec
from types import ModuleType, SimpleNamespace
from typing import Any, Self

PERIOD_S = 0.01
_MODULES = (
    "unitree_sdk2py",
    "unitree_sdk2py.core",
    "unitree_sdk2py.core.channel",
    "unitree_sdk2py.go2",
    "unitree_sdk2py.go2.sport",
    "unitree_sdk2py.go2.sport.sport_client",
    "unitree_sdk2py.idl",
    "unitree_sdk2py.idl.unitree_go",
    "unitree_sdk2py.idl.unitree_go.msg",
    "unitree_sdk2py.idl.unitree_go.msg.dds_",
)


class FakeGo2:
    """Walks as it is told, exactly; its frame is x ahead, y left, as the real one's."""

    def __init__(self) -> None:
        self.calls: list[str] = []
        self.handlers: dict[str, Any] = {}
        self.velocity = (0.0, 0.0, 0.0)
        self.x = self.y = self.yaw = 0.0
        self.mode = 1
        self.is_silent = False
        self.code = 0
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._run, daemon=True)

    def install(self, monkeypatch: Any, *, cyclonedds: str = "0.10.2") -> None:
        """Stand in for the SDK until the test is over."""
        modules = {name: ModuleType(name) for name in _MODULES}
        for name, module in modules.items():
            module.__spec__ = ModuleSpec(name, None)
            monkeypatch.setitem(sys.modules, name, module)
        channel: Any = modules["unitree_sdk2py.core.channel"]
        channel.ChannelFactoryInitialize = lambda *arguments: self.calls.append("ChannelFactoryInitialize")
        channel.ChannelSubscriber = lambda topic, kind: _Subscriber(self, topic)
        client: Any = modules["unitree_sdk2py.go2.sport.sport_client"]
        client.SportClient = lambda: _SportClient(self)
        messages: Any = modules["unitree_sdk2py.idl.unitree_go.msg.dds_"]
        messages.SportModeState_ = messages.LowState_ = object
        real = metadata.version
        monkeypatch.setattr(metadata, "version", lambda name: cyclonedds if name == "cyclonedds" else real(name))

    def move(self, vx: float, vy: float, vyaw: float) -> int:
        """Take a velocity; return the code that the SDK answers with, which does not wait for the robot's."""
        self.velocity = (vx, vy, vyaw)
        return self.code

    def posture(self, mode: int | None) -> int:
        """Stand still, in another posture or the same; return the robot's code."""
        self.velocity = (0.0, 0.0, 0.0)
        self.mode = self.mode if mode is None else mode
        return self.code

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(self, *error: object) -> None:
        self._over.set()
        self._thread.join()

    def _run(self) -> None:
        last_s = time.monotonic()
        while not self._over.wait(PERIOD_S):
            now_s = time.monotonic()
            dt_s, last_s = now_s - last_s, now_s
            forward, left, turn = self.velocity
            self.yaw += turn * dt_s
            self.x += (forward * math.cos(self.yaw) - left * math.sin(self.yaw)) * dt_s
            self.y += (forward * math.sin(self.yaw) + left * math.cos(self.yaw)) * dt_s
            if self.is_silent:
                continue
            for topic, handler in tuple(self.handlers.items()):
                handler(self._sport_state() if topic == "rt/sportmodestate" else self._low_state())

    def _sport_state(self) -> Any:
        imu = SimpleNamespace(
            rpy=[0.0, 0.0, math.remainder(self.yaw, math.tau)], gyroscope=[0.0, 0.0, self.velocity[2]]
        )
        return SimpleNamespace(position=[self.x, self.y, 0.3], imu_state=imu, mode=self.mode)

    def _low_state(self) -> Any:
        motors = [SimpleNamespace(temperature=30 + number) for number in range(20)]
        return SimpleNamespace(bms_state=SimpleNamespace(soc=64), motor_state=motors)


class _Subscriber:
    def __init__(self, robot: FakeGo2, topic: str) -> None:
        self._robot, self._topic = robot, topic

    def Init(self, handler: Any, queue_length: int) -> None:  # noqa: N802 - the SDK's names
        self._robot.handlers[self._topic] = handler

    def Close(self) -> None:  # noqa: N802
        self._robot.handlers.pop(self._topic, None)


class _SportClient:
    def __init__(self, robot: FakeGo2) -> None:
        self._robot = robot

    def SetTimeout(self, seconds: float) -> None:  # noqa: N802
        self._robot.calls.append("SetTimeout")

    def Init(self) -> None:  # noqa: N802
        self._robot.calls.append("Init")

    def Move(self, vx: float, vy: float, vyaw: float) -> int:  # noqa: N802
        self._robot.calls.append("Move")
        return self._robot.move(vx, vy, vyaw)

    def StopMove(self) -> int:  # noqa: N802
        return self._posture("StopMove", None)

    def BalanceStand(self) -> int:  # noqa: N802
        return self._posture("BalanceStand", 1)

    def StandUp(self) -> int:  # noqa: N802
        return self._posture("StandUp", 6)

    def StandDown(self) -> int:  # noqa: N802
        return self._posture("StandDown", 5)

    def _posture(self, call: str, mode: int | None) -> int:
        self._robot.calls.append(call)
        return self._robot.posture(mode)
