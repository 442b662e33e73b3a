"""One module a rule of the workflow: ``run(files, outputs, settings)`` reads, calls and writes; what it imports, at its
top or inside, is what its rule depends on, and data files of the package that it reads, named in its ``FILES``."""
