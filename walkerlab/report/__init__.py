"""A run on paper: every picture, every table, and a page that a teacher can read and a student can hand in."""

from walkerlab.report.page import save as save
from walkerlab.report.page import write as write
from walkerlab.report.panel import panel as panel
