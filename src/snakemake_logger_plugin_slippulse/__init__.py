"""Progress by rich, without a terminal one line a job. Snakemake finds it by the name of the package."""

import sys

from snakemake_logger_plugin_rich import LogHandler as Rich


class LogHandler(Rich):
    """Leaves out that a failed run is complete, and tracebacks of the parser of --config."""

    def emit(self, record):
        message = record.getMessage()
        if getattr(record, "done", None) and not sys.stderr.isatty():
            print(f"{record.done} of {record.total}", file=sys.stderr)
        if "Invalid config definition" in message:
            record.msg = message.strip().rpartition("\n")[2]
        if "Complete log" not in message:
            super().emit(record)
