# SPDX-License-Identifier: Apache-2.0
"""What the library throws, as exceptions. Numbers are those of stein.h."""

from enum import IntEnum


class ErrorCode(IntEnum):
    INVALID_ARGUMENT = 1
    INVALID_FRAME = 2
    IO = 3
    UNSUPPORTED = 4
    CANCELLED = 5


class Error(Exception):
    """Of the library; the message says what is wrong where, and what to do about it."""

    code: ErrorCode


class InvalidArgument(Error, ValueError):
    """An argument or option: unknown, or out of its range."""

    code = ErrorCode.INVALID_ARGUMENT


class InvalidFrame(Error, ValueError):
    """Planes are missing, or hold values that cannot be used."""

    code = ErrorCode.INVALID_FRAME


class FileError(Error, OSError):
    """A file cannot be opened, read or written."""

    code = ErrorCode.IO


class Unsupported(Error):
    """Well-formed, but not something stein can read or do."""

    code = ErrorCode.UNSUPPORTED


class Cancelled(Error):
    """The progress callback asked to stop."""

    code = ErrorCode.CANCELLED


def of_code(code: int) -> type[Error]:
    kinds: list[type[Error]] = [InvalidArgument, InvalidFrame, FileError, Unsupported, Cancelled]
    return next(kind for kind in kinds if kind.code == code)
