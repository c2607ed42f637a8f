"""A server that is not ours and speaks OpenAI's chat completions: ``transformers serve``."""

import os
import re
import subprocess
import sys
import time
from pathlib import Path
from types import TracebackType
from typing import Self

INSTALL = "pip install 'reasoned-explorer[local,served]' (see docs/models.md for a torch without CUDA)"
#: What it takes beside torch and transformers themselves.
PACKAGES = ("openai", "aiohttp", "torch", "transformers", "fastapi", "uvicorn", "accelerate")

# Its own command line, and a thread that ends it where whoever started it is gone without a goodbye.
_START = """
import os, threading, time
def follow(parent):
    while os.getppid() == parent:
        time.sleep(1.0)
    os._exit(1)
threading.Thread(target=follow, args=(os.getppid(),), daemon=True).start()
from transformers.cli.transformers import main
main()
"""
_WITHIN_S, _GOODBYE_S = 120.0, 10.0
_READY = re.compile(r"Uvicorn running on (http://127\.0\.0\.1:\d+)")


class TransformersServe:
    """``transformers serve`` on a port of this machine that is free, from entering to leaving.

    Args:
        folder: It runs there, so that a model in a folder beneath has that folder's name, and writes there.

    Attributes:
        base_url: Where it is.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._log = folder / "server.log"
        self._process: subprocess.Popen[bytes] | None = None
        self.base_url = ""

    def __enter__(self) -> Self:
        # Nothing is fetched, a person's own models are not looked at, and the tests need the processor, too.
        house = {"HF_HUB_OFFLINE": "1", "HF_HOME": str(self._folder / "hub"), "OMP_NUM_THREADS": "1"}
        command = [sys.executable, "-c", _START, "serve", "--host", "127.0.0.1", "--port", "0", "--device", "cpu"]
        with self._log.open("wb") as log:
            self._process = subprocess.Popen(
                command, cwd=self._folder, env=os.environ | house, stdin=subprocess.DEVNULL, stdout=log, stderr=log
            )
        try:
            self.base_url = f"{self._address()}/v1"
        except BaseException:
            self._end()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._end()

    @property
    def said(self) -> str:
        """What it wrote so far."""
        return self._log.read_text(errors="replace")

    def _address(self) -> str:
        assert self._process is not None
        until_s = time.monotonic() + _WITHIN_S
        while time.monotonic() < until_s:
            ready = _READY.search(self.said)
            if ready is not None:
                return ready[1]
            if self._process.poll() is not None:
                break
            time.sleep(0.1)
        raise RuntimeError(f"transformers serve does not run: {self.said[-2000:]}")

    def _end(self) -> None:
        process = self._process
        if process is None:
            return
        process.terminate()
        try:
            process.wait(_GOODBYE_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
