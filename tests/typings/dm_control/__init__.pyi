# dm_control ships no types: to the checker, all of it may be anything.
from typing import Any

def __getattr__(name: str) -> Any: ...
