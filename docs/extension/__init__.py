"""Sphinx extensions of the documentation site: pages made from the declarations, notebooks and parsers of walkerlab."""
