# Included last: what is asked for on the command line is something that a rule makes, and affordable.

from snakemake.io import strip_wildcard_constraints

from slippulse.configuration.expand import expand as expand_sweep
from slippulse.configuration.limits import check_affordable
from slippulse.configuration.refusals import format_problems
from slippulse.configuration.targets import check_places, check_targets
from slippulse.data.records import changed_since_made, mark_outdated, remove_changed

# With these Snakemake only looks.
LOOKING = "-n --dry-run --dryrun -t --touch -S --summary -D --detailed-summary --rulegraph --dag --filegraph --lint --unlock"
OUTPUTS = [strip_wildcard_constraints(file) for rule in workflow.rules for file in rule.output]
# Everything that jobs of this configuration write.
MADE = sorted(
    set(
        expand(
            OUTPUTS,
            simulation=[*SIMULATIONS, *(chunk for chunks in CHUNKS.values() for chunk in chunks)],
            scene=SCENES,
            sweep=OWN_SIMULATIONS,
        )
    )
)


def refuse_places():
    """Where a folder or a file goes there is nothing of the other kind, and it may be written."""
    if not workflow.is_main_process:
        return
    records = [f"results/records/{file.removeprefix('results/')}.json" for file in MADE]
    logs = [file for rule in workflow.rules for file in rule.log]
    folders = {parent for file in [*MADE, *records, *logs] for parent in Path(file).parents[:-1]}
    check_places(Path("results"), [Path(".snakemake"), *sorted(folders)], map(Path, [*MADE, *records]))


def refuse_unknown_targets():
    """A misspelt target is refused with the nearest one that there is."""
    open_rules = [rule for rule in workflow.rules if rule.has_wildcards()]
    patterns = {rule.name: strip_wildcard_constraints(rule.output[0]) for rule in open_rules}
    names = [rule.name for rule in workflow.rules]
    check_targets(
        sys.argv[1:],
        lambda target: target in names or any(rule.is_producer(target) for rule in workflow.rules),
        [*names, *MADE],
        patterns,
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
    """Nothing is built on a file that was changed since its job wrote it, or that none wrote: it goes, with a word.

    Pages that a killed run has left behind are marked.
    """
    if not workflow.is_main_process or not Path("results").is_dir():
        return
    # Jobs of another run that is at work here may not have noted yet what they wrote.
    looking = any(argument in LOOKING.split() for argument in sys.argv) or any(
        Path(".snakemake/locks").glob("*")
    )
    changed = (changed_since_made if looking else remove_changed)(
        "results", expected=[file.removeprefix("results/") for file in MADE]
    )
    if changed:
        fate = f"it {'would be' if looking else 'is'} removed, and made anew where it is needed"
        lines = [
            f"results/{name} was changed since it was made, or has no record: {fate}" for name in changed
        ]
        print(format_problems(lines), file=sys.stderr)
    if not looking:
        mark_outdated("results")


def report_outdated():
    """Mark the pages that this run has left behind, and say which results are older than what they are made from."""
    stale = mark_outdated("results") if Path("results").is_dir() else {}
    if stale:
        print(
            f"{len(stale)} results are older than what they are made from, as {next(iter(stale))};"
            " pages among them are marked, the report's PDF is removed. Renew all: make replicate TARGET=everything",
            file=sys.stderr,
        )


try:
    refuse_places()
    refuse_unknown_targets()
    refuse_dear_targets()
    refuse_changed_files()
except ConfigError as error:
    refuse(str(error))
