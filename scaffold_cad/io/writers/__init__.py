"""One module per file format: arrays in, a file out. `export.write` chooses among them."""
