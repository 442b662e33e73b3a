"""Steps of the workflow: one module for each rule.

Each module has a function ``run(files, outputs, settings)``. It reads the input ``files``, calls
the code that does the work, and writes the ``outputs``. Both have paths, or lists of paths, by the
names that the rule gives them. A job runs again if the module of its step changes, or a module that
the step imports.
"""
