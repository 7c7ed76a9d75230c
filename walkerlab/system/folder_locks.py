"""Lock a folder, so that one process at a time uses it; the system releases the lock when the process dies."""

import os
import shutil
import sys
import time
from contextlib import suppress
from pathlib import Path

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl

LOCK_FILE = "lock"
SECONDS_BETWEEN_TRIES = 0.05


def acquire(folder: Path, timeout: float) -> int | None:
    """Lock a folder; create it if it does not exist, and delete a symbolic link in its place.

    Args:
        folder: Absolute path of the folder.
        timeout: Time to wait for another process, in seconds.

    Returns:
        Descriptor of the open lock file, or None if another process has the lock.
    """
    deadline = time.monotonic() + timeout
    while True:
        if folder.is_symlink():
            folder.unlink()
        folder.mkdir(exist_ok=True)
        path = folder / LOCK_FILE
        try:
            file = os.open(path, os.O_RDWR | os.O_CREAT | getattr(os, "O_NOFOLLOW", 0), 0o666)
        except FileNotFoundError:  # another process has just deleted the folder
            continue
        with suppress(OSError):
            if _lock_file(file) and os.path.samestat(os.fstat(file), os.lstat(path)):
                return file
        os.close(file)
        if time.monotonic() >= deadline:
            return None
        time.sleep(SECONDS_BETWEEN_TRIES)


def _lock_file(file: int) -> bool:
    """Lock an open file for this process, until it is closed or the process dies; return False if another has it."""
    try:
        if sys.platform == "win32":
            msvcrt.locking(file, msvcrt.LK_NBLCK, 1)
        else:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError as error:  # other errors mean that the file system has no locks
        return not isinstance(error, BlockingIOError | PermissionError)
    return True


def release(folder: Path, lock: int, *, keep_contents: bool) -> None:
    """Unlock a folder, and delete it unless its contents are still required.

    Args:
        folder: Locked folder.
        lock: Descriptor that ``acquire`` returned.
        keep_contents: Whether to keep the folder.
    """
    with suppress(OSError):
        if not keep_contents:
            clear(folder)
            if sys.platform != "win32":
                (folder / LOCK_FILE).unlink()  # before it is unlocked; later the file may belong to another process
    os.close(lock)
    if sys.platform == "win32":
        with suppress(OSError):
            (folder / LOCK_FILE).unlink()  # fails while another process has it open
    with suppress(OSError):
        folder.rmdir()


def clear(folder: Path) -> None:
    """Delete everything in a locked folder except the lock file."""
    for path in folder.iterdir():
        if path.is_dir() and not path.is_symlink():
            shutil.rmtree(path)
        elif path.name != LOCK_FILE:
            path.unlink()
