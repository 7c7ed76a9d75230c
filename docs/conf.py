"""Configuration of the documentation site; CONTRIBUTING.md contains the command that builds it.

The source folder is the root of the repository, so that README, notebooks and documents are pages without a copy, and
a link between two files is valid both in the repository and on the site.
"""

import sys
from importlib import metadata
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

project = "walkerlab"
author = "The walkerlab developers"
project_copyright = author
release = metadata.version("walkerlab")
language = "en"

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "extension.commands",
    "extension.notebooks",
    "extension.public_names",
    "extension.settings",
    "extension.docstrings",
]
root_doc = "docs/index"
include_patterns = [
    "README.md",
    "CHANGELOG.md",
    "CONTRIBUTING.md",
    "environment.md",
    "docs/*.md",
    "docs/api/*.md",
    "notebooks/[0-9]*.ipynb",
    "notebooks/beyond/*.ipynb",
    "notebooks/glossary.md",
]
exclude_patterns = [".*", "*venv*", "build", "site", "tests", "benchmarks", "walk"]

nitpicky = True
nitpick_ignore_regex = [
    # Other packages: links to their documentation would require the network.
    ("py:.*", r"(anywidget|av|collections|concurrent|dm_control|dm_env|gymnasium|ipywidgets|k3d)\..*"),
    ("py:.*", r"(markupsafe|matplotlib|mujoco|numpy|os|pandas|pathlib|pydantic|traitlets|types|typing)\..*"),
    # Results and arguments that only walkerlab creates.
    (
        "py:class",
        r"walkerlab\..*\.(Bar|EvaluationRow|EvaluationT|EvolutionResult|Frame|Gait|Ground|HasRecords|Outcome|Questions|"
        r"Sources|StoredRun|Walk|WalkEnvironment|Walker)",
    ),
]

myst_enable_extensions = ["colon_fence"]
myst_heading_anchors = 4

autodoc_typehints = "signature"
autodoc_typehints_format = "short"
autodoc_preserve_defaults = True
autodoc_member_order = "bysource"
autodoc_default_options = {"members": True}
python_maximum_signature_line_length = 88

html_theme = "furo"
html_title = "walkerlab"
html_static_path = ["static"]
html_css_files = ["walkerlab.css"]
html_additional_pages = {"index": "redirect.html"}
templates_path = ["templates"]
html_copy_source = False
html_show_sphinx = False
html_show_search_summary = False  # browsers do not let a page that was opened from a file read other files
html_theme_options = {"navigation_with_keys": True}
pygments_style = "a11y-light"
pygments_dark_style = "a11y-dark"
