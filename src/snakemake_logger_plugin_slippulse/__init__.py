"""Progress bars in a terminal, else one line a job. Snakemake finds the plugin by its name."""

import logging
import re
import sys

from snakemake_logger_plugin_rich import LogHandler as Rich


class LogHandler(Rich):
    """Logger without the line that a run is complete, and without tracebacks of what users give."""

    def emit(self, record):
        if "all" in map(str, self.common_settings.quiet or ()) and record.levelno < logging.ERROR:
            return
        message = record.getMessage()
        if getattr(record, "done", None) and not sys.stderr.isatty():
            print(f"{record.done} of {record.total}", file=sys.stderr)
        # A wrong --config, or a folder of caches that cannot be written.
        if "Invalid config definition" in message or re.search(
            r"^\w+Error: \[Errno", message, re.M
        ):
            record.msg = message.strip().rpartition("\n")[2]
        if "Complete log" not in message:
            super().emit(record)
