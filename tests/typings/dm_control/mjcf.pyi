from typing import Any

class Element:
    def __getattr__(self, name: str) -> Any: ...
    def __setattr__(self, name: str, value: Any) -> None: ...

class RootElement(Element):
    def __init__(self, model: str) -> None: ...

class Physics:
    legacy_step: bool
    data: Any
    model: Any
    @classmethod
    def from_model(cls, model: Any) -> Physics: ...
