"""The panel, and the pieces that it is made of, each of use on its own in a cell: sliders, pictures, a run that goes on."""
