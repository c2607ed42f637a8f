import errno
import os
from pathlib import Path

import pytest

from reasoned_explorer.model import PartError, RecordError
from reasoned_explorer.model.disk import disk_error

PATH = Path("runs/map.png")


def _refusal(number: int) -> OSError:
    return OSError(number, os.strerror(number))


@pytest.mark.parametrize("number", [errno.ENOENT, errno.EACCES, errno.ENAMETOOLONG, errno.EROFS, errno.ENOTDIR])
def test_a_place_that_was_chosen_badly_is_input(number: int) -> None:
    error = disk_error("map picture", PATH, _refusal(number), kind=RecordError)
    assert isinstance(error, RecordError)
    assert os.strerror(number) in str(error)
    assert "choose another place" in str(error)


@pytest.mark.parametrize(
    ("number", "remedy"),
    [(errno.ENOSPC, "make room"), (errno.EDQUOT, "make room"), (errno.EFBIG, "ulimit -f"), (errno.EIO, "")],
)
def test_a_disk_that_fails_is_a_part(number: int, remedy: str) -> None:
    error = disk_error("map picture", PATH, _refusal(number))
    assert isinstance(error, PartError)
    assert str(error).startswith(f"disk: runs/map.png cannot be written: {os.strerror(number)}")
    assert remedy in str(error)
