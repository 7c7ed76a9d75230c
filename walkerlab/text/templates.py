"""HTML from Jinja2 templates, which escape every string from a file or a user.

A template is a ``.html`` or ``.css`` file of this package and is named by its path in the package, such as
``view/report/report.html``. ``text/elements.html`` contains the elements that several templates share, and
``text/output.html`` and ``text/standalone.html`` the frames of notebook outputs and of complete pages.
"""

from functools import cache
from typing import TYPE_CHECKING

from markupsafe import Markup as Markup

if TYPE_CHECKING:
    from jinja2 import Environment


def render(template: str, **values: object) -> Markup:
    """Render a template.

    Args:
        template: Path of the template in the package.
        **values: Variables of the template. All are escaped except ``Markup``, which other templates returned.

    Raises:
        jinja2.UndefinedError: If the template uses a variable that has no value.
    """
    return Markup(environment().get_template(template).render(values))


@cache
def environment() -> "Environment":
    """Return the environment that loads, compiles and caches the templates."""
    from jinja2 import Environment, PackageLoader, StrictUndefined  # here because it is slow to import

    return Environment(
        loader=PackageLoader("walkerlab", ""),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
