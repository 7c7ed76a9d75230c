"""How values are written as text: HTML, numbers, JSON."""
