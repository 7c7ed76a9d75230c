"""The process that makes a film: it is told by a line of JSON, and tells by lines of its own how it goes.

First of all it looks for a GL. Only when it has said that there is one does it load all that drawing needs.
"""

import signal
import sys
from typing import Any

SOFTWARE = ("llvmpipe", "softpipe", "swrast", "SwiftShader")
"""Names by which a GL says that it is a processor's."""


def find_gl() -> str:
    """Make a GL context, and return the name of what draws."""
    import mujoco

    context = mujoco.GLContext(64, 64)
    context.make_current()
    from OpenGL import GL

    name: Any = GL.glGetString(GL.GL_RENDERER)
    context.free()
    return name.decode()


def main() -> None:
    """Make one film."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # a terminal sends Ctrl-C here too; who started this ends it
    renderer = find_gl()
    print("gl", renderer, flush=True)
    from walkerlab.cinema.job import Job
    from walkerlab.cinema.reel import record
    from walkerlab.cinema.studio import Picture, frames

    job, path = Job.from_json(sys.stdin.readline())

    def told(picture: Picture) -> Picture:
        print("frame", flush=True)  # fails if nobody listens any more
        return picture

    pictures = frames(job, sketch=any(name in renderer for name in SOFTWARE))
    try:
        record(map(told, pictures), path, job.suffix, job.size, job.fps)
        print("done", flush=True)
    except BaseException:
        path.unlink(missing_ok=True)
        raise


if __name__ == "__main__":
    main()
