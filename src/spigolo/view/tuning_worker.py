"""Worker thread that calls a function on request. Requests that wait at the same time are combined, so that the page
responds quickly.
"""

from __future__ import annotations

import threading
from collections.abc import Callable


class Latest:
    """Worker thread that calls a function on request. If several requests arrive during a call, the function is called
    only once more.

    work: function that is called. If the function returns True, it is called once more.
    """

    def __init__(self, work: Callable[[], bool]) -> None:
        self._work = work
        self._changed = threading.Condition()
        self._wanted = False
        self._busy = False
        self._closed = False
        self._thread = threading.Thread(target=self._loop, name="spigolo tuning", daemon=True)
        self._thread.start()

    def ask(self) -> None:
        """Request a call of the function, and return at once."""
        with self._changed:
            self._wanted = True
            self._changed.notify_all()

    def idle(self, timeout_s: float | None = None) -> bool:
        """Wait until no call is requested or running. Return False if a call is still requested or running when the
        timeout ends.
        """
        with self._changed:
            return self._changed.wait_for(lambda: not (self._wanted or self._busy), timeout_s)

    def close(self) -> None:
        """Stop the thread after the current call."""
        with self._changed:
            self._closed = True
            self._changed.notify_all()
        self._thread.join()

    def _loop(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._wanted or self._closed)
                if self._closed:
                    return
                self._wanted, self._busy = False, True
            again = False
            try:
                again = self._work()
            finally:
                with self._changed:
                    self._busy = False
                    self._wanted = self._wanted or again
                    self._changed.notify_all()
