"""The replication of the paper: configuration, studies, claims, figures, report and workflow steps.

Data flow one way: the configuration makes scenes, the library simulates, measures and predicts
them, studies compute what is beyond single runs, claims and figures read the tables, and the report
quotes the claims. The library `slippulse` knows nothing of this package.
"""
