"""Pages on which robots walk live, simulated in the browser by MuJoCo compiled to WebAssembly."""
