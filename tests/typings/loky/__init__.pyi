from concurrent.futures import Executor
from typing import Any

def get_reusable_executor(max_workers: int | None = None, **options: Any) -> Executor: ...
