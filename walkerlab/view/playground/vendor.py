"""Copy of MuJoCo's official WebAssembly build in this package, and the command that updates it.

    python -m walkerlab.view.playground.vendor

The command requires npm, which checks the download. The files are compressed, because browsers decompress them; their
licence is in ``mujoco/LICENSE``, and their version and checksums are in ``mujoco/version.json``.
"""

import gzip
import hashlib
import json
import subprocess
import tarfile
import tempfile
from base64 import b64encode
from pathlib import Path

PACKAGE = "@mujoco/mujoco"
VERSION = "3.14.0"
FILES = ("mujoco.js", "mujoco.wasm")
"""Files of the single-threaded build, which does not require special HTTP headers."""

FOLDER = Path(__file__).parent / "mujoco"


def encoded_file(name: str) -> str:
    """Return one of ``FILES`` as base64 of gzip."""
    return b64encode((FOLDER / f"{name}.gz").read_bytes()).decode("ascii")


def decompressed_file(name: str) -> bytes:
    """Return the content of one of ``FILES``."""
    return gzip.decompress((FOLDER / f"{name}.gz").read_bytes())


def renew() -> None:
    """Download the npm package and replace the files in ``FOLDER``."""
    with tempfile.TemporaryDirectory() as folder:
        pack = subprocess.run(
            ["npm", "pack", f"{PACKAGE}@{VERSION}"], cwd=folder, check=True, capture_output=True, text=True
        )
        with tarfile.open(Path(folder) / pack.stdout.strip().splitlines()[-1]) as archive:
            archive.extractall(folder, filter="data")
        checksums: dict[str, str] = {}
        for name in FILES:
            content = (Path(folder) / "package" / name).read_bytes()
            checksums[name] = hashlib.sha256(content).hexdigest()
            (FOLDER / f"{name}.gz").write_bytes(gzip.compress(content, 9, mtime=0))
        declared = json.loads((Path(folder) / "package" / "package.json").read_text(encoding="utf-8"))
    description = {
        "package": PACKAGE,
        "version": VERSION,
        "licence": declared["license"],
        "source": declared["homepage"],
        "sha256": checksums,
    }
    (FOLDER / "version.json").write_text(json.dumps(description, indent=2) + "\n", encoding="utf-8")


if __name__ == "__main__":
    renew()
