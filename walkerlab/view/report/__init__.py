"""The report of a run: a page with all pictures and tables, and the display of a run in a notebook."""

from walkerlab.view.report.notebook import run_html as run_html
from walkerlab.view.report.page import save_report as save_report
from walkerlab.view.report.page import write_report as write_report
