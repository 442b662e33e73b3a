# Included last: what is asked for on the command line is something that a rule makes.

import sys

from slippulse.configuration.limits import check_affordable
from slippulse.configuration.targets import check_folder, check_targets


def refuse_unknown_targets():
    """A misspelt file on the command line is refused with the nearest one that a rule makes."""
    known = [str(file) for rule in workflow.rules for file in rule.output if not file.contains_wildcard()]
    known += [f"results/scenes/{name}.{ending}" for name in SCENES for ending in ("png", "html", "gif")]
    try:
        check_folder(Path("results"))
        check_targets(
            sys.argv[1:], lambda file: any(rule.is_producer(file) for rule in workflow.rules), known
        )
    except ConfigError as error:
        raise WorkflowError(str(error)) from None


def refuse_dear_targets():
    """With `accuracy` the cost of what is asked for is checked, and not that of the whole paper."""
    if "promise" not in ACCURACY or config.get("allow_large", False) or not workflow.is_main_process:
        return
    try:
        check_affordable({key: expand_block(block) for key, block in blocks_behind(sys.argv[1:]).items()})
    except ConfigError as error:
        raise WorkflowError(f"The configuration is refused:\n{error}") from None


refuse_unknown_targets()
refuse_dear_targets()
