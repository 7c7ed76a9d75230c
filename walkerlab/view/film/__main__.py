"""Child process that renders a film: reads a job as one line of JSON, and reports its progress line by line.

It creates an OpenGL context first, and imports what rendering needs only after it has reported success.

    gl RENDERER     an OpenGL context was created; the job may be sent
    frame           a frame was rendered
    done            the film is complete
"""

import signal
import sys
from typing import Any

SOFTWARE_RENDERERS = ("llvmpipe", "softpipe", "swrast", "SwiftShader")
"""Parts of the names of OpenGL renderers that run on the CPU."""


def renderer_name() -> str:
    """Create an OpenGL context and return the name of its renderer."""
    import mujoco

    context = mujoco.GLContext(64, 64)
    context.make_current()
    from OpenGL import GL

    name: Any = GL.glGetString(GL.GL_RENDERER)
    context.free()
    return name.decode()


def main() -> None:
    """Render one film."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # a terminal sends Ctrl-C here too, but the parent ends this process
    renderer = renderer_name()
    print("gl", renderer, flush=True)
    from walkerlab.view.film.encoding import encode
    from walkerlab.view.film.job import Job
    from walkerlab.view.film.rendering import Picture, render_frames

    job, path = Job.from_json(sys.stdin.readline())

    def report_frame(picture: Picture) -> Picture:
        print("frame", flush=True)  # raises BrokenPipeError if the parent has died
        return picture

    is_software = any(name in renderer for name in SOFTWARE_RENDERERS)
    pictures = map(report_frame, render_frames(job, software=is_software))
    try:
        encode(pictures, path, job.suffix, job.size, job.fps)
        print("done", flush=True)
    except BaseException:
        path.unlink(missing_ok=True)
        raise


if __name__ == "__main__":
    main()
