# Included last: what is asked for on the command line is something that a rule makes, and affordable.

from slippulse.configuration.expand import expand as expand_sweep
from slippulse.configuration.limits import check_affordable
from slippulse.configuration.targets import check_folder, check_targets
from slippulse.data.records import changed_since_made, mark_outdated, remove_changed


def refuse_unknown_targets():
    """A misspelt target is refused with the nearest one that there is."""
    known = [str(file) for rule in workflow.rules for file in rule.output if not file.contains_wildcard()]
    known += [f"results/scenes/{name}.{ending}" for name in SCENES for ending in ("png", "html", "gif")]
    check_folder(Path("results"))
    names = {rule.name for rule in workflow.rules}
    check_targets(
        sys.argv[1:],
        lambda target: target in names or any(rule.is_producer(target) for rule in workflow.rules),
        [*names, *known],
    )


def simulations_behind(file):
    """Simulations that a file under results/ is made from; all of them where it may be any."""
    name = Path(file).stem
    if file.startswith("results/studies/"):
        return set()
    if name in NEEDS:
        return set(simulations_of([name]))
    if file == "results/scenes/index.html":
        return set(SCENES)
    found = {other for other in SIMULATIONS if name in (other, f"{other}_numbers", f"sweep_{other}")}
    return found or set(SIMULATIONS)


def refuse_dear_targets():
    """With `accuracy` the cost of what is asked for is checked, and not that of the whole paper."""
    if "promise" not in ACCURACY or config.get("allow_large", False) or not workflow.is_main_process:
        return
    files = [argument for argument in sys.argv[1:] if argument.startswith("results/")]
    if not files and "scenes" in sys.argv[1:]:
        files = ["results/scenes/index.html"]
    elif not files and not ACCURACY.get("whole", True) and "everything" not in sys.argv[1:]:
        files = FIRST
    names = {name for file in files or [""] for name in simulations_behind(file)}
    check_affordable({f"simulations.{name}": expand_sweep(sweep_of(name)) for name in sorted(names)})


def refuse_changed_files():
    """Nothing is built on a file that was changed since its job wrote it: it is made anew, with a word."""
    if not workflow.is_main_process or not Path("results").is_dir():
        return
    dry = any(argument in ("-n", "--dry-run", "--dryrun") for argument in sys.argv)
    for name in changed_since_made("results") if dry else remove_changed("results"):
        print(f"results/{name} was changed since it was made: it is made anew", file=sys.stderr)


def report_outdated():
    """Mark the pages that this run has left behind, and say which results are older than what they are made from."""
    stale = mark_outdated("results") if Path("results").is_dir() else {}
    if stale:
        print(
            f"{len(stale)} results are older than what they are made from, as {next(iter(stale))};"
            " pages among them are marked. Renew all: make replicate TARGET=everything",
            file=sys.stderr,
        )


try:
    refuse_unknown_targets()
    refuse_dear_targets()
    refuse_changed_files()
except ConfigError as error:
    refuse(str(error))
