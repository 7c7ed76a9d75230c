"""The panel: evolution in a notebook, assembled from the components and its own parts."""
