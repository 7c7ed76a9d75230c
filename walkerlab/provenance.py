"""With what a run is made: all that a number in its table may depend on, beside the settings."""

import platform
from collections.abc import Mapping
from functools import cache
from importlib.metadata import version

from walkerlab.markup import printable

PACKAGES = ("walkerlab", "mujoco", "dm-control", "numpy")


@cache
def here() -> Mapping[str, str]:
    """Name the versions, the system, its mathematical library and the processor's features, as they are here."""
    import numpy as np

    kinds = np.show_config(mode="dicts")["SIMD Extensions"]  # type: ignore[index]
    return {
        **{name: version(name) for name in PACKAGES},
        "python": platform.python_version(),
        "system": platform.system(),
        "libc": " ".join(platform.libc_ver()).strip(),
        "processor": " ".join([platform.machine(), *kinds["baseline"], *kinds["found"]]),
    }


def differences(then: Mapping[str, str], now: Mapping[str, str]) -> str:
    """Say in words what is not as it was, as in ``mujoco 3.17.0 (here 3.18.0)``; nothing if all that is known is."""
    return ", ".join(
        f"{name} {printable(then[name])} (here {value})"
        for name, value in now.items()
        if then.get(name, value) != value
    )
