"""No template can leave a text from a file or a user unescaped, and an installed walkerlab contains all templates."""

import ast
import re
from importlib import resources
from pathlib import Path

import pytest
from jinja2 import UndefinedError, meta, nodes

import walkerlab
from tests.text.test_html import HOSTILE as MARKUP
from tests.text.test_html import Seen, assert_harmless
from walkerlab.text.templates import environment, render

HOSTILE = f"{MARKUP}</style></title>"

PACKAGE = Path(walkerlab.__file__).parent
TEMPLATES = {path.relative_to(PACKAGE).as_posix(): path for path in PACKAGE.rglob("*.html")}
UNTEMPLATED = {"view/replay/unavailable.html"}
"""HTML that is not rendered."""

MARKUP_MAKERS = {"text/templates.py", "text/html.py"}
"""Modules that declare a text to be HTML: the result of a template, and pictures that we drew."""

STYLES = {"text/output.css", "view/snapshot.css", "view/live.css", "view/report/report.css", "view/replay/player.css"}

each_template = pytest.mark.parametrize("name", sorted(TEMPLATES))


def unescaped(source):
    """Return what a template leaves unescaped on purpose."""
    tree = environment().parse(source)
    filters = {node.name for node in tree.find_all(nodes.Filter)} & {"safe", "forceescape", "tojson", "xmlattr"}
    marked = {type(node).__name__ for node in tree.find_all((nodes.MarkSafe, nodes.MarkSafeIfAutoescape))}
    switched = {type(node).__name__ for node in tree.find_all(nodes.EvalContextModifier)}
    return filters | marked | switched


@each_template
def test_no_template_leaves_a_text_unescaped(name):
    assert not unescaped(TEMPLATES[name].read_text(encoding="utf-8"))


def test_unescaped_texts_in_a_template_are_found():
    assert unescaped("<p>{{ name|safe }}</p>") == {"safe"}


def test_only_templates_and_drawings_are_declared_to_be_html():
    makers = set()
    for path in PACKAGE.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            match node:
                case ast.Call(func=ast.Name(id="Markup") | ast.Attribute(attr="Markup")):
                    makers.add(path.relative_to(PACKAGE).as_posix())
                case ast.Name(id="__html__") | ast.FunctionDef(name="__html__") | ast.Attribute(attr="__html__"):
                    makers.add(path.relative_to(PACKAGE).as_posix())
                case _:
                    pass
    assert makers == MARKUP_MAKERS


def test_html_and_styles_are_in_files_of_their_own():
    for path in PACKAGE.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                assert not re.search(r"</?(p|div|table|tr|td|span|style|img)\\b[^>]*>", node.value), (
                    f"{path}: {node.value}"
                )


@each_template
def test_a_template_compiles_and_uses_attributes_in_quotes(name):
    source = TEMPLATES[name].read_text(encoding="utf-8")
    environment().get_template(name)
    assert not re.search(r"=\s*\{\{", re.sub(r"\{%.*?%\}|\{#.*?#\}", "", source, flags=re.DOTALL)), (
        "attribute without quotes"
    )


def test_every_template_is_used():
    code = "".join(path.read_text(encoding="utf-8") for path in PACKAGE.rglob("*.py"))
    included = set()
    for path in TEMPLATES.values():
        included |= set(meta.find_referenced_templates(environment().parse(path.read_text(encoding="utf-8"))))
    unused = {name for name in TEMPLATES if f'"{name}"' not in code and name not in included}
    assert unused == UNTEMPLATED


RENDERED_ALONE = (
    *("simulation/confirmation.html", "simulation/rollout.html", "settings/settings.html"),
    *("view/image.html", "view/snapshot.html", "view/replay/head.html", "view/film/film.html"),
    *("view/report/notebook.html", "widgets/curve.html", "widgets/editor.html"),
    *(f"widgets/panel/{name}.html" for name in ("robot", "lab", "runs", "transport", "drawer")),
)
"""Templates whose variables are texts, or lists of texts."""


@pytest.mark.parametrize("name", RENDERED_ALONE)
def test_hostile_values_of_a_template_stay_texts(name):
    source = TEMPLATES[name].read_text(encoding="utf-8")
    variables = meta.find_undeclared_variables(environment().parse(source))
    lists = {"tables", "pictures", "messages", "notes", "components", "size"} & variables
    values = dict.fromkeys(variables, HOSTILE) | {key: [HOSTILE, HOSTILE] for key in lists}
    values |= {"pictures": [(HOSTILE, HOSTILE)]} if "pictures" in lists else {}
    page = render(name, **values)
    assert "<script" not in page
    assert "onerror=alert(2)>" not in page
    seen = Seen(page)
    assert HOSTILE in seen.text or HOSTILE in {text for _, attributes in seen.elements for text in attributes.values()}


def test_a_variable_without_a_value_is_an_error():
    with pytest.raises(UndefinedError, match="title"):
        render("view/replay/head.html")


def test_templates_and_styles_are_resources_of_the_package():
    for name in {*TEMPLATES, *STYLES}:
        assert resources.files("walkerlab").joinpath(name).read_text(encoding="utf-8")
    assert set(environment().list_templates(extensions=["html"])) == set(TEMPLATES)
    assert_harmless(render("text/output.html", content=[]))
