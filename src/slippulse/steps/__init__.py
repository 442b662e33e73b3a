"""One module a rule of the workflow: ``run(files, outputs, settings)`` reads, calls and writes.

What a module imports, at its top or inside, is what its rule depends on. ``FILES`` names the data files of the package
that it reads, relative to the package.
"""
