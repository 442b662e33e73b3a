"""Steps of the workflow: one module for each rule.

Each module has a function ``run(files, outputs, settings)``, which reads the input files, calls the
code that does the work, and writes the output files. ``files`` and ``outputs`` have paths, or lists
of paths, by the names that the rule gives them. A job depends on its step and on every module that
the step imports.
"""
