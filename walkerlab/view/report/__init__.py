"""A run on paper: every picture, every table, and a page that a teacher can read and a student can hand in."""

from walkerlab.view.report.notebook import panel as panel
from walkerlab.view.report.page import save as save
from walkerlab.view.report.page import write as write
