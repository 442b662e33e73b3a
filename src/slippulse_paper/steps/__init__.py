"""One module a rule of the workflow: ``run(files, outputs, settings)`` reads, calls and writes.

A rule depends on all modules that its step imports, and on the data files that these name in FILES.
"""
