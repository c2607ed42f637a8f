"""What the operating system's refusal to write a file means, and what a person can do about it.

Either the place was chosen badly (there is no such folder, it may not be written to, its name is too long): that is
input, and another place helps. Or the disk fails, because it is full, say: that is a part, and no other input helps.
"""

import errno
from contextlib import suppress
from io import FileIO
from pathlib import Path

from reasoned_explorer.model.errors import Fault, InputError, PartError

_BADLY_CHOSEN = frozenset(
    {
        errno.EACCES,
        errno.EEXIST,
        errno.EINVAL,
        errno.EISDIR,
        errno.ELOOP,
        errno.ENAMETOOLONG,
        errno.ENOENT,
        errno.ENOTDIR,
        errno.ENOTEMPTY,
        errno.EPERM,
        errno.EROFS,
    }
)
_FULL = frozenset({errno.ENOSPC, errno.EDQUOT})


def is_badly_chosen(error: OSError) -> bool:
    """Return whether a file could be written in another place."""
    return error.errno in _BADLY_CHOSEN


def in_words(path: Path | str, error: OSError) -> str:
    """Return what happened to a file and what to do about it, in one line."""
    what = f"{path} cannot be written: {error.strerror or error}"
    if error.errno in _FULL:
        return f"{what}; make room on that disk, or write to another one"
    if error.errno == errno.EFBIG:
        return f"{what}; allow larger files (ulimit -f)"
    return what


def disk_error(
    subject: str, path: Path, error: OSError, *, kind: type[InputError] = InputError
) -> InputError | PartError:
    """Return the error to raise when a file cannot be written.

    Args:
        subject: What was to be written, e.g. ``"map picture"``.
        path: Where.
        error: What the operating system says.
        kind: What it is where the place was chosen badly.
    """
    if is_badly_chosen(error):
        expected = "a folder that exists and may be written to, and a name that is not too long"
        return kind(subject, [Fault(in_words(path, error), expected, "choose another place")])
    return PartError("disk", in_words(path, error))


def append_line(file: FileIO, line: bytes, at_bytes: int) -> int:
    """Write a line whole at the end of an unbuffered file, or, whatever happens, not at all.

    Args:
        file: Open for writing.
        line: With its line break.
        at_bytes: How long the file is.

    Returns:
        How long it is then, bytes.

    Raises:
        OSError: If the disk refuses; the file is as it was.
    """
    rest = memoryview(line)
    try:
        while rest:
            rest = rest[file.write(rest) :]
    except BaseException:
        # Making a file shorter takes no room.
        with suppress(OSError):
            file.truncate(at_bytes)
            file.seek(at_bytes)
        raise
    return at_bytes + len(line)
