"""Definition of every key of the configuration: type, range, default, meaning, [unit] and (origin).

The messages of refusals follow from these definitions. The script docs/describe.py writes the JSON
Schema and the tables of config/README.md from them. A class without a docstring is explained by the
description of its key.
"""

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self, TypeVar

import numpy as np
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, create_model, model_validator
from pydantic_core import PydanticCustomError

from slippulse.model.checks import short_repr
from slippulse.model.friction import LAW_NAMES, friction_from
from slippulse.model.layer_material import BOUNDARY_OF_TOP
from slippulse.model.layer_units import Layer
from slippulse.model.measured_columns import RECORD_FOR
from slippulse.model.prestress import Prestress
from slippulse.model.rough_prestress import rough
from slippulse.model.scene import EXTRA_TERMS
from slippulse.model.si_quantities import PROFILE_QUANTITIES

from ..text.markdown import harmless
from .problems import spelling_hint
from .profiles import rough_lists

T = TypeVar("T")
# Names in pydantic of the limits that `check_number` takes.
LIMITS = {"above": "gt", "at_least": "ge", "at_most": "le", "below": "lt"}


class Block(BaseModel):
    """A mapping of the configuration.

    A block has only known keys, no value is converted to another type, and all numbers are finite.
    """

    model_config = ConfigDict(
        extra="forbid", strict=True, allow_inf_nan=False, defer_build=True, serialize_by_alias=True
    )

    def given(self) -> dict[str, Any]:
        """Return the values that the configuration sets, without defaults, as plain data."""
        return self.model_dump(mode="json", exclude_unset=True)

    def plain(self) -> dict[str, Any]:
        """Return the values that are set, and the defaults, as plain data without None."""
        return self.model_dump(mode="json", exclude_none=True)


def key(description: str, default: Any = ..., words: str | None = None, **limits: Any) -> Any:
    """Return the definition of a key for pydantic. A key without a default is required.

    words : the allowed values in words, for refusals; the type and the limits describe them if it
        is None
    limits : limits of a number or a text, and other arguments of pydantic's `Field`
    """
    if words:
        limits["json_schema_extra"] = {"allowed": words}
    return Field(default, description=description, **limits)


def require(condition: bool, given: str, allowed: str) -> None:
    """Raise ValueError unless a condition holds.

    given : key and value, for the message
    allowed : the allowed values in words
    """
    if not condition:
        raise ValueError(f"{given}; allowed: {allowed}")


def check_name(key: str, name: str, names: Iterable[str], allowed: str) -> None:
    """Raise ValueError if a name is not among ``names``, with a hint at the most similar one."""
    require(name in names, f"{key}: {short_repr(name)}{spelling_hint(name, names)}", allowed)


def _all_different(values: list[T]) -> list[T]:
    """Return a list unchanged, or raise an error if it has an entry twice."""
    # Entries may be lists or mappings, which a set cannot hold. Their texts are compared instead.
    if len({*map(repr, values)}) < len(values):
        raise PydanticCustomError("different", "an entry twice")
    return values


# A list of different entries, at least one.
Distinct = Annotated[
    list[T],
    Field(min_length=1, json_schema_extra={"uniqueItems": True}),
    AfterValidator(_all_different),
]
Positive = Annotated[float, Field(gt=0.0)]
NonNegative = Annotated[float, Field(ge=0.0)]
Fraction = Annotated[float, Field(gt=0.0, lt=1.0)]
Seed = Annotated[int, Field(ge=0)]
Hurst = Annotated[float, Field(ge=0.0, le=1.0)]
Spacing = Annotated[float, Field(gt=0.0, le=1.0)]
Ratio = Annotated[float, Field(ge=1e-6, le=1e6)]
Boundary = Literal["displacement", "stress"]
Top = Literal["held", "stress"]
TOP_OF_BOUNDARY: Mapping[str, str] = {value: name for name, value in BOUNDARY_OF_TOP.items()}
Switch = Annotated[bool, Field(strict=False)]
Release = Literal["total", "elastic"]
Scheme = Literal["localised", "fixed_step", "continuum"]
LAW = f"a mapping with law ({', '.join(LAW_NAMES)}) and its parameters"


def _known_law(mapping: dict[str, Any]) -> dict[str, Any]:
    """Return the mapping of a friction law unchanged, or raise ValueError if it is not allowed."""
    # Making the law raises the error if the mapping is not allowed.
    friction_from(mapping)
    return mapping


Friction = Annotated[
    dict[str, str | float], Field(json_schema_extra={"allowed": LAW}), AfterValidator(_known_law)
]
# A text for pages and the report. It may contain formulas and links, but no HTML or scripts.
Statement = Annotated[str, AfterValidator(harmless)]
# Rows of numbers. They are lists in YAML and tuples here.
Step = Annotated[tuple[float, float], Field(strict=False)]
Bump = Annotated[tuple[float, float, Positive], Field(strict=False)]
NAME_WORDS = "a name of lower-case letters, digits and underscores that begins with a letter"
Name = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]{0,60}$")]
LABEL_WORDS = "a name of letters, digits, underscores and dashes"
Label = Annotated[str, Field(pattern=r"^[A-Za-z0-9_-]{1,60}$")]
PRINTABLE = r"^[^\x00-\x1f\x7f-\x9f]*[^\s\x00-\x1f\x7f-\x9f][^\x00-\x1f\x7f-\x9f]*$"

TITLE = "one line of at most 120 printable characters, not blank"
STEPS, BUMPS = "a list of [position, level]", "a list of [centre, amplitude, width > 0]"
POINTS = "a list of [x, tau] from left to right, at least two"
ROUGH = "a mapping with level, deviation, correlation_length, hurst, start, stop, spacing and seed"
SEEDS = "a whole number >= 0, a list of different whole numbers, or {from: A, to: B} with A < B"
RELEASED = "total, elastic, or a list of both"
STUDIES = "a list of different names, at least one"
FACTORS = "two factors >= 1.2, one at least 1.1 times the other"
UNITS = "one of `time`, `half_periods`, `balance_distances`"
RULE = "`fixed`, or `scale`, `width_power` and `gamma_power`"
GAMMA = "elasticity ratio 2G/(lambda + 2G) (paper: near 2/3); not with `boundary: stress`"
ALPHA = "deprecated; use `friction: {law: linear_rate, alpha: ...}` [c/H]"
LAWS = "friction law of sliding blocks, explained below; default: the value in `model`"
IN_SI = (
    "properties of a layer in SI units. Lengths, stresses and times of the scene are then also in "
    "SI units"
)
# Quantities of the numbers of a scene that are in SI units if the scene has a layer.
SI_KEYS = {"left": "stress", "right": "stress", "peak": "stress", "width": "length"}
SI_KEYS |= {"dx": "length", "duration": "time"}
KEPT = (
    "recorded data: `fronts` (release and stick times), `fields` (slip, slip velocity and slip "
    "acceleration at the end) and `samples` (slip and slip velocity at the times and positions "
    "under the key `samples`)"
)
RECORDED = "a list with `fronts` (always required), and optionally `fields` and `samples`"


def check_rising(first: float, last: float) -> None:
    """Raise ValueError unless the last value of a range is above the first one."""
    require(last > first, f"to: {last}", f"> from = {first}")


class Seeds(Block):
    from_: Seed = key("first seed", alias="from")
    to: Seed = key("last seed, larger than the first")

    @model_validator(mode="after")
    def _check_order(self) -> Self:
        """Raise ValueError if the last seed is not above the first one."""
        check_rising(self.from_, self.to)
        return self


class Rough(Block):
    """Parameters of a rough background, as in `sp.rough`; some may be lists in a simulation."""

    level: float | Distinct[float] = key("mean of the pre-stress, below 1 [S]")
    deviation: NonNegative | Distinct[NonNegative] = key(
        "standard deviation of the pre-stress. Values of the pre-stress above 0.95 are set to 0.95 "
        "[S]"
    )
    correlation_length: Positive | Distinct[Positive] = key(
        "distance beyond which values of the pre-stress are not correlated [H]"
    )
    hurst: Hurst | Distinct[Hurst] = key(
        "Hurst exponent: 0 gives the roughest profile at short lengths, 1 the smoothest"
    )
    start: float = key(
        "first position of the random values; to its left the pre-stress is constant [H]"
    )
    stop: float = key(
        "last position of the random values; to its right the pre-stress is constant [H]"
    )
    spacing: Positive = key(
        "distance between the positions at which the random values are drawn [H]"
    )
    seed: Seed | Distinct[Seed] | Seeds = key(
        "seed of the random field; each seed gives one profile", words=SEEDS
    )

    def check(self) -> None:
        """Raise ValueError if one of the levels is not possible in a rough background.

        Only the first value of each other list is checked, since all combinations may be many.
        """
        lists = rough_lists(self.plain())
        first_values = {name: values[0] for name, values in lists.items()}
        for level in lists["level"]:
            # Drawing the background raises the error if a value is not allowed.
            rough(**(self.plain() | first_values | {"level": level}))


class Profile(Block):
    """One pre-stress profile."""

    left: float | None = key(
        "level of the pre-stress far to the left; required unless `points`, `file` or"
        " `rough` is given [S]",
        None,
    )
    right: float | None = key(
        "level of the pre-stress far to the right; required unless `points`, `file` or"
        " `rough` is given [S]",
        None,
    )
    width: Positive | None = key(
        "standard deviation W of the Gaussian at x = 0, at least dx. With `points` or `file` there "
        "is a Gaussian only if `width` is given [H] (paper)",
        1.0,
    )
    peak: float = key(
        "pre-stress at x = 0. At some position the pre-stress must reach 1 [S] (paper)", 1.0
    )
    steps: list[Step] = key(
        "steps of the pre-stress: from each position outwards, away from x = 0, the pre-stress has "
        "the new level [H, S]",
        [],
        STEPS,
    )
    bumps: list[Bump] = key("Gaussians that are added to the pre-stress [H, S, H]", [], BUMPS)
    points: list[Step] | None = key(
        "instead of `left` and `right`: points of the pre-stress. The pre-stress is linear between "
        "the points, constant outside, and jumps at a position that appears twice [H, S]",
        None,
        POINTS,
    )
    file: str | None = key(
        "instead of `left` and `right`: CSV or netCDF file with points of the pre-stress. Its path "
        "is relative to the folder of the overlay",
        None,
    )
    rough: Rough | None = key(
        "instead of `left` and `right`: parameters of a random pre-stress, explained below",
        None,
        ROUGH,
    )

    @model_validator(mode="after")
    def _check_background(self) -> Self:
        """Raise ValueError unless a profile has either levels or one table.

        A table is a file, a list of points, or a rough background. The width of a profile with
        points becomes None if it is not given. The pre-stress then has no Gaussian.
        """
        tables = self._keys_with_value("file", "points", "rough")
        if tables == ["file", "points"]:
            # The points were read from the file.
            tables = ["file"]
        levels = self._keys_with_value("left", "right")
        if not tables:
            missing = [name for name in ("left", "right") if name not in levels]
            allowed = "`left` and `right`, or one of `points`, `file` and `rough`"
            require(not missing, f"{', '.join(missing)}: missing", allowed)
            return self
        # A profile with a table may have no other table, no levels and no steps.
        given = [*tables, *levels]
        if self.steps:
            given.append("steps")
        require(len(given) == 1, f"{given[0]}: given with {', '.join(given[1:])}", "one of them")
        if self.points is not None and "width" not in self.model_fields_set:
            # Pydantic would mark the width as given if it were assigned as usual.
            self.__dict__["width"] = None
        if self.file is not None:
            # A file is read only if an overlay names it.
            require(self.points is not None, f"file: {short_repr(self.file)}", "in an overlay")
        # The numbers of a scene with a layer are checked after their conversion from SI units.
        if getattr(self, "layer", None) is None:
            self.check_table()
        return self

    def _keys_with_value(self, *names: str) -> list[str]:
        """Return those of the names whose key has a value."""
        return [name for name in names if getattr(self, name) is not None]

    def check_table(self) -> None:
        """Raise ValueError if the points or the rough background are not allowed."""
        if self.points is not None:
            try:
                # Making the pre-stress raises the error if the points are not allowed.
                Prestress.through([x for x, _ in self.points], [tau for _, tau in self.points])
            except ValueError as error:
                raise ValueError(str(error).removeprefix("prestress.")) from None
        if self.rough is not None:
            try:
                self.rough.check()
            except ValueError as error:
                raise ValueError(f"rough.{error}") from None


class Beyond(Block):
    position: float = key(
        "position, other than 0, beyond which the pre-stress has the second level [H]"
    )
    levels: Distinct[float] = key(
        "values of the second level. Each value is combined with all values of the other lists [S]"
    )


class Duration(Block):
    time: Positive | None = key("the duration [H/c]", None)
    half_periods: Positive | None = key(
        "the duration in half periods of the leaf springs, pi/sqrt(gamma); only with "
        "`boundary: displacement`",
        None,
    )
    balance_distances: Positive | None = key(
        "the duration in units of the balance distance; only if the left"
        " level is < 0 and the right level is 0",
        None,
    )


class SpacingRule(Block):
    """A fixed block spacing, or the preset's dx times scale W^width_power gamma^gamma_power."""

    fixed: Spacing | None = key(
        "one spacing for all presets and for the grid study; it excludes the other keys of "
        "`spacing` [H]",
        None,
    )
    scale: Positive = key("factor by which the dx of the preset is multiplied", 1.0)
    width_power: float = key(
        "dx is proportional to this power of W, the width of the Gaussian", 0.0
    )
    gamma_power: float = key(
        "dx is proportional to this power of gamma; only with `boundary: displacement`", 0.0
    )


class Recording(Block):
    times: int = key("number of times, evenly spaced over the duration", ge=2, le=100_000)
    positions: int = key(
        "number of positions, evenly spaced; 1 means x = 0 alone", ge=1, le=100_000
    )
    extent: NonNegative = key("largest distance of the sampled positions from x = 0 [H]")


class Physics(Block):
    """Keys that simulations and scenes have in common."""

    boundary: Boundary = key(
        "what is held at the top of the layer: the displacement (Gamma = 1) or the stress "
        "(Gamma = 0)"
    )
    scheme: Scheme | None = key("numerical scheme; default: the value in `model`", None)
    resolved_blocks: int | None = key(
        "a run is flagged if its pulse is narrower than this width; default: the value in `model` "
        "[dx]",
        None,
        ge=1,
    )
    max_step: Positive | None = key(
        "largest time step; default: the smaller of the preset's step and the largest stable step "
        "[dx]",
        None,
    )

    def refuse_together(self, key: str, *others: str) -> None:
        """Raise ValueError if a key is given together with one of the others."""
        given_others = [other for other in others if other in self.model_fields_set]
        are_together = key in self.model_fields_set and bool(given_others)
        problem = f"{key}: given with {', '.join(given_others)}"
        require(not are_together, problem, "only one of these keys; set the other keys to null")

    @model_validator(mode="after")
    def _check_physics(self) -> Self:
        """Raise ValueError if a key is excluded by the boundary condition or by another key."""
        # In a scene with a layer, gamma follows from the properties of the layer.
        if getattr(self, "layer", None) is None:
            self._check_gamma()
        self.refuse_together("beta", "damping_ratio")
        self.refuse_together("rate_strengthening", "friction")
        return self

    def _check_gamma(self) -> None:
        """Raise ValueError if gamma is missing, or given although there are no leaf springs."""
        gamma = getattr(self, "gamma", None)
        if self.boundary == "displacement":
            require(gamma is not None, "gamma: missing", "> 0 under boundary 'displacement'")
        else:
            allowed = "no value under boundary 'stress', which has no leaf springs"
            require(gamma is None, f"gamma: {gamma!r}", f"{allowed} (gamma: null removes it)")


def _with_extra_terms(lists: bool) -> type[Physics]:
    """Return a subclass of `Physics` with a key for each extra term of the equation of motion.

    The value of a key is a number, or a list of numbers if ``lists`` is set.
    """
    keys: dict[str, Any] = {}
    for name, term in EXTRA_TERMS.items():
        # `LIMITS` has pydantic's name of each limit. The bound "integer" is a type, not a limit.
        limits = {LIMITS[kind]: limit for kind, limit in term.bounds.items() if kind in LIMITS}
        number: Any = int if "integer" in term.bounds else float
        value: Any = Annotated[number, Field(**limits)]
        value_or_list: Any = Distinct[value] if lists else value
        meaning = f"{term.meaning}; by default {term.default:g}"
        # Pydantic takes the type and the definition of each key.
        keys[name] = (value_or_list | None, key(meaning, None))
    return create_model("PhysicsWithExtraTerms", __base__=Physics, **keys)


# The type checker does not know the keys of extra terms. It does not need them, since nothing uses
# them by name.
if TYPE_CHECKING:
    PhysicsOfSweep = Physics
    PhysicsOfScene = Physics
else:
    PhysicsOfSweep, PhysicsOfScene = _with_extra_terms(True), _with_extra_terms(False)


class Simulation(PhysicsOfSweep):
    """A sweep: one run for each combination of the entries of its lists."""

    left: Distinct[float] | None = key("pre-stress levels on the left, below 1 [S]", None)
    right: Literal["same"] | Distinct[float] | None = key(
        "pre-stress levels on the right; `same` means the level on the left [S]", None
    )
    width: Distinct[Positive] = key("widths W of the Gaussian at x = 0, at least dx [H]", [1.0])
    profiles: Distinct[Profile] | None = key(
        "instead of `left`, `right` and `width`: list of complete profiles of the pre-stress", None
    )
    beyond: Beyond | None = key(
        "second level of the pre-stress, beyond a position on one side of x = 0",
        None,
    )
    gamma: Distinct[Positive] | None = key(GAMMA, None)
    damping_ratio: Distinct[NonNegative] | None = key(
        "damping ratio beta/dx; default: the value in `model`", None
    )
    beta: Distinct[NonNegative] | None = key("instead of `damping_ratio`: damping beta [H]", None)
    friction: Distinct[Friction] | None = key(LAWS, None, f"a list; each entry {LAW}")
    rate_strengthening: Distinct[float] | None = key(ALPHA, None)
    duration: Duration = key("duration of each run, in one of three units", words=UNITS)
    spacing: SpacingRule = key("rule for the block spacing", SpacingRule(), RULE)
    dx: Distinct[Spacing] | None = key("instead of `spacing`: block spacings [H]", None)
    release: Release | Distinct[Release] | None = key(
        "release rule; default: the value in `model`", None, RELEASED
    )
    friction_ratio: NonNegative | None = key(
        "ratio r = mu_k/(mu_s - mu_k) of friction coefficients; default: the value in `model`", None
    )
    record: Distinct[Literal["fronts", "fields", "samples"]] = key(KEPT, words=RECORDED)
    samples: Recording | None = key(
        "times and positions of the samples, if `record` contains samples", None
    )
    chunks: int = key(
        "number of jobs among which the runs are split, at most one job per run", 1, ge=1, le=1000
    )

    @model_validator(mode="after")
    def _check_together(self) -> Self:
        """Raise ValueError for keys that are missing or exclude each other."""
        self.refuse_together("profiles", "left", "right", "width", "beyond")
        self.refuse_together("dx", "spacing")
        self._check_lists_and_units()
        self._check_record()
        return self

    def _check_lists_and_units(self) -> None:
        """Raise ValueError unless pre-stress, spacing and duration are given, in one way each.

        The pre-stress is given by levels or by profiles, the spacing is fixed or follows a rule,
        and the duration is given in one unit.
        """
        has_levels = self.left is not None and self.right is not None
        has_prestress = has_levels or self.profiles is not None
        require(has_prestress, "left, right: missing", "lists, or profiles")
        spacing_keys = self.spacing.model_fields_set
        # A fixed spacing excludes the keys of the rule.
        is_one_way = "fixed" not in spacing_keys or spacing_keys == {"fixed"}
        require(is_one_way, "spacing.fixed: given with other keys", "no other key")
        units = sorted(self.duration.model_fields_set)
        require(len(units) == 1, f"duration: {units}", f"{UNITS}; set the other units to null")
        # These two keys use gamma, which is zero if the stress is held.
        if self.boundary == "stress":
            only = "only under boundary 'displacement'"
            require("half_periods" not in units, "duration.half_periods: given", only)
            require("gamma_power" not in spacing_keys, "spacing.gamma_power: given", only)

    def _check_record(self) -> None:
        """Raise ValueError if fronts are not recorded, or if samples are incomplete."""
        require("fronts" in self.record, f"record: {self.record}", RECORDED)
        if "samples" in self.record:
            allowed = "times, positions and extent, since record contains samples"
            require(self.samples is not None, "samples: missing", allowed)
        else:
            problem = "samples: given, but record does not contain samples"
            require(self.samples is None, problem, "record: [..., samples], or samples: null")


class LayerKeys(Block):
    """A layer in SI units; see `Layer` of the library for details."""

    thickness: Positive = key("thickness H, from the interface to the top [m]")
    shear_modulus: Positive = key("shear modulus G [Pa]")
    lame_parameter: float | None = key("first Lame parameter lambda, > -2G/3 [Pa]", None)
    poisson_ratio: float | None = key(
        "instead of `lame_parameter`: Poisson ratio, between -1 and 0.5", None
    )
    density: Positive = key("density [kg/m3]")
    static_friction: Positive = key(
        "coefficient of static friction, larger than `kinetic_friction`"
    )
    kinetic_friction: NonNegative = key("coefficient of kinetic friction")
    normal_stress: Positive = key("normal stress on the interface [Pa]")
    top: Top | None = key(
        "condition at the top of the layer: fixed displacement (`held`) or fixed stress (`stress`);"
        " by default it follows from `boundary`",
        None,
    )

    @model_validator(mode="after")
    def _check_layer(self) -> Self:
        """Raise ValueError if the library does not accept the properties of the layer."""
        # Any boundary condition will do.
        self.layer("displacement")
        return self

    def layer(self, boundary: str) -> Layer:
        """Return the layer of the library. If ``top`` is not set, it follows from ``boundary``."""
        given = {"top": TOP_OF_BOUNDARY[boundary]} | self.plain()
        return Layer(**given)


class NamedScene(Profile, PhysicsOfScene):
    """One run with a name, non-dimensional, or in SI units if it has a layer."""

    title: str = key(
        "title of the figure and the page", words=TITLE, max_length=120, pattern=PRINTABLE
    )
    gamma: Positive | None = key(GAMMA, None)
    damping_ratio: NonNegative | None = key(
        "damping ratio beta/dx; default: the value in `model`", None
    )
    beta: NonNegative | None = key("instead of `damping_ratio`: damping beta [H]", None)
    friction: Friction | None = key(LAWS, None, LAW)
    rate_strengthening: float | None = key(ALPHA, None)
    dx: Positive | None = key(
        "block spacing, at most 1; default: the spacing of the preset [H]", None
    )
    release: Release | None = key("release rule; default: the value in `model`", None)
    duration: Positive = key("duration of the run [H/c]")
    layer: LayerKeys | None = key(IN_SI, None)

    @model_validator(mode="before")
    @classmethod
    def _boundary_of_layer(cls, given: Any) -> Any:
        """Set the boundary condition from the top of the layer if it is not given.

        ``given`` has not been checked yet, and is returned unchanged if it is not valid.
        """
        layer = given.get("layer") if isinstance(given, dict) else None
        if not isinstance(layer, dict) or "boundary" in given:
            return given
        top = layer.get("top") or "held"
        is_known = isinstance(top, str) and top in BOUNDARY_OF_TOP
        return given | {"boundary": BOUNDARY_OF_TOP[top]} if is_known else given

    @model_validator(mode="after")
    def _check_one_background(self) -> Self:
        """Raise ValueError if a scene has several rough backgrounds, since it is one run."""
        background = self.rough.plain() if self.rough is not None else {}
        for name, value in background.items():
            is_single = not isinstance(value, list | dict)
            require(is_single, f"rough.{name}: {short_repr(value)}", "one value in a scene")
        return self

    @model_validator(mode="after")
    def _check_in_model_units(self) -> Self:
        """Raise ValueError if the spacing, or a key of a scene with a layer, is not allowed.

        The pre-stress of a scene with a layer is converted from SI units before it is checked. It
        has been checked already if there is no layer.
        """
        if self.layer is None:
            too_large = self.dx is not None and self.dx > 1.0
            require(not too_large, f"dx: {self.dx}", "a number > 0 and <= 1")
            return self
        top = self.layer.top
        agree = top is None or BOUNDARY_OF_TOP[top] == self.boundary
        require(
            agree,
            f"boundary: {self.boundary!r}",
            f"the boundary that layer.top = {top!r} implies, or none",
        )
        require(
            self.gamma is None, f"gamma: {self.gamma}", "no value, since the layer determines gamma"
        )
        scene = self.in_model_units()
        try:
            scene.check_table()
        except ValueError as error:
            words = self.layer.layer(self.boundary).units_in_words
            raise ValueError(f"{error} ({words})") from None
        return self

    def layer_parameters(self) -> dict[str, Any] | None:
        """Return the parameters of the layer by name, or None if the scene has no layer."""
        return None if self.layer is None else self.layer.layer(self.boundary).mapping()

    def in_model_units(self) -> Self:
        """Return the scene in non-dimensional units, without its layer.

        Raises ValueError if a stress or the spacing is not allowed.
        """
        if self.layer is None:
            return self
        layer = self.layer.layer(self.boundary)
        gamma = layer.gamma if self.boundary == "displacement" else None
        converted: dict[str, Any] = {"layer": None, "gamma": gamma}
        # Convert the keys with one number, such as dx.
        for name, quantity in SI_KEYS.items():
            value = getattr(self, name)
            # Defaults are non-dimensional already.
            if name not in self.model_fields_set or value is None:
                continue
            if quantity == "stress":
                converted[name] = layer.level_from_pascal(name, value)
            else:
                converted[name] = layer.convert_from_si(value, quantity)
        # The spacing, if the scene has one, is now in units of the thickness.
        allowed = f"a number > 0 and <= the thickness, {layer.thickness:g} m"
        require((converted.get("dx") or 0.0) <= 1.0, f"dx: {self.dx}", allowed)
        converted |= self._tables_and_steps_in_model_units(layer)
        # These are the quantities of the three numbers of a bump: position, amplitude and width.
        quantities = PROFILE_QUANTITIES["bumps"]
        converted["bumps"] = [
            tuple(map(layer.convert_from_si, row, quantities)) for row in self.bumps
        ]
        return self.model_copy(update=converted)

    def _tables_and_steps_in_model_units(self, layer: Layer) -> dict[str, Any]:
        """Return the steps, points and rough background of a scene in non-dimensional units."""
        steps = []
        for x, stress in self.steps:
            # A refused stress is reported under the key.
            level = layer.level_from_pascal(key="steps", stress=stress)
            steps.append((layer.convert_from_si(x, "length"), level))
        tables: dict[str, Any] = {"steps": steps}
        if self.points is not None:
            x_in_metres, stresses = np.array(self.points, dtype=float).reshape(-1, 2).T
            x = layer.convert_from_si(x_in_metres, "length")
            tau = layer.table_from_pascal(key="points", stress=stresses)
            tables["points"] = [*zip(x.tolist(), tau.tolist(), strict=True)]
        if self.rough is not None:
            background = self.rough.plain()
            deviation = layer.convert_from_si(background["deviation"], "stress_difference")
            converted = {
                "level": layer.level_from_pascal(key="rough.level", stress=background["level"]),
                "deviation": deviation,
            }
            for name in ("correlation_length", "start", "stop", "spacing"):
                converted[name] = layer.convert_from_si(background[name], "length")
            tables["rough"] = self.rough.model_copy(update=converted)
        return tables


class Preset(Block):
    dx: Spacing = key("block spacing; a simulation can change it with `spacing` or `dx` [H]")
    max_step: Positive = key(
        "largest time step; with strong damping a smaller step may be used [dx]"
    )
    order: int = key(
        "order of the Taylor series with which the scheme `localised` computes a time step",
        ge=3,
        le=8,
    )
    coarser: Annotated[Distinct[float], Field(min_length=2, max_length=2)] = key(
        "factors by which the spacing is multiplied on the two coarser lattices of a grid study",
        words=FACTORS,
    )
    whole: bool = key(
        "true if studies, claims and report are made by default, false if only figures are made",
        True,
    )

    @model_validator(mode="after")
    def _check_factors(self) -> Self:
        """Raise ValueError if spacings of the grid study are too close to each other.

        The spacing of the preset is multiplied by each of the two factors in ``coarser``.
        """
        # At nearly equal spacings a number is nearly the same, even if its error is large.
        first, second = sorted(self.coarser)
        # The margin 1e-9 is for rounding errors.
        is_far_apart = first >= 1.2 and second >= (1.1 - 1e-9) * first
        require(is_far_apart, f"coarser: {self.coarser}", FACTORS)
        return self


class Model(Block):
    damping_ratio: NonNegative = key(
        "damping ratio beta/dx. The paper does not state dx. Under the release rule `total`, the "
        "left panel of the paper's figure 4 agrees with ratios from 0.06 to 0.09"
    )
    release: Release = key(
        "stress that must reach 1 to release a block. The stress `total` includes the damping "
        "force, as in the authors' code. The stress `elastic` does not include the damping force, "
        "as in the printed paper"
    )
    scheme: Scheme = key(
        "numerical scheme. `localised` computes the exact time of every release and stick. "
        "`fixed_step` is the textbook scheme. `continuum` is the exact solution, which needs no "
        "lattice, `max_step` or `order`"
    )
    friction: Friction | None = key(
        "friction law; by default `coulomb`, the law of the paper", None, LAW
    )
    friction_ratio: NonNegative = key(
        "ratio r = mu_k/(mu_s - mu_k) of friction coefficients. A run is flagged if a block would "
        "slide backwards, which happens at the stress -(1 + 2 r)"
    )
    resolved_blocks: int = key(
        "a run is flagged if its pulse is narrower than this width. If the stress is held, a run "
        "is also flagged if its Gaussian is narrower than this width [dx]",
        ge=1,
    )


class Measure(Block):
    fraction: Fraction = key(
        "if the stress is held, T_trans is the time at which the left front has covered"
        " this fraction of the balance distance"
    )
    front_window: float = key(
        "the front speed is measured over this last fraction of the front's path",
        ge=0.05,
        lt=1.0,
    )
    steady_tolerance: Fraction = key(
        "a pulse is steady if its peak velocity changes by at most this fraction in the"
        " last third of a run"
    )
    trailing_times: Distinct[Positive] = key(
        "times at which the position of the trailing edge is measured [H/c] (figure)"
    )
    still: Fraction = key(
        "a point counts as at rest if its slip velocity is below this fraction of the"
        " largest slip velocity"
    )


class Sketch(Block):
    strip_width: float = key(
        "width of the strip over which the momentum balance in the sketch is integrated [H]",
        ge=0.01,
        le=2.0,
    )


class Steps(Block):
    from_: Ratio = key("first ratio", alias="from")
    to: Ratio = key("last ratio, larger than the first")
    count: int = key("number of ratios", ge=2, le=10_000)

    @model_validator(mode="after")
    def _check_order(self) -> Self:
        """Raise ValueError if the last value is not above the first one."""
        check_rising(self.from_, self.to)
        return self


class DamageZone(Block):
    stiffness_ratios: Steps = key("ratios G/G_r of the shear moduli of damage zone and host rock")
    thickness_ratios: Distinct[Ratio] = key(
        "ratios H_r/H of the thicknesses of host rock and damage zone. Each ratio"
        " is drawn as a curve"
    )


class LayerMap(Block):
    gamma: Distinct[Fraction] = key("elasticity ratios 2G/(lambda + 2G) of the map")
    fracture_energy: Distinct[Positive] = key(
        "fracture energies of slip weakening in the map [tau_0^2/(2 gamma)]"
    )
    cells: int = key(
        "number of grid cells over the height of the layer. A second grid has half as many cells",
        ge=10,
        le=200,
    )
    chunks: int = key(
        "number of jobs among which the points of the map (pairs of gamma and fracture_energy) are"
        " split, at most one job per point",
        1,
        ge=1,
        le=1000,
    )

    @model_validator(mode="after")
    def _check_chunks(self) -> Self:
        """Raise ValueError if there are more chunks than points of the map."""
        points = len(self.gamma) * len(self.fracture_energy)
        require(
            self.chunks <= points,
            f"chunks: {self.chunks}",
            f"at most {points}, one per point of the map",
        )
        return self


class Figures(Block):
    fig01_system_sketch: Sketch = key("settings of the sketch of the system")
    fig07_damage_zone: DamageZone = key("settings of the figure of the damage zone")
    study_layer: LayerMap = key("settings of the stability map of the two-dimensional layer")


class Claim(Block):
    tolerance: NonNegative | None = key("largest deviation that counts as agreement", None)
    tolerance_exponent: Positive | None = key(
        "largest difference between an exponent and 1 that counts as agreement", None
    )


class Reading(Block):
    simulation: str = key("simulation whose run is compared with the number that was read off")
    quantity: str = key("measured number: a column of the tables in results/measurements")
    statement: Statement = key("description of the number that was read off (figure)", min_length=1)
    value: float = key("the number that was read off (figure)")
    reading_error: Positive = key("uncertainty of the reading, from the pixel size")
    shared_error: NonNegative = key(
        "part of `reading_error` that all readings with a `shared_error` have in common", 0.0
    )
    arrow: bool = key(
        "true if the number was read off a drawn arrow. Fits are then made with and without this "
        "number",
        False,
    )


class Configuration(Block):
    """The whole configuration."""

    preset: str = key("name of the preset that is used", words="the name of a preset")
    presets: dict[Label, Preset] = key(
        "compromises between speed and accuracy, by name", min_length=1
    )
    accuracy: Annotated[float, Field(ge=1e-4, le=0.1)] | None = key(
        "largest relative numerical error that measured numbers may have. The program chooses the "
        "spacing and the time step for this error, instead of the values in the preset",
        None,
    )
    # Make and the command line may say yes, on or 1.
    allow_large: Switch = key("true if simulations above the limits of cost are allowed", False)
    model: Model = key("default values for all simulations and scenes")
    simulations: dict[Name, Simulation] = key(
        "sweeps by name, with one run for each combination of values"
    )
    scenes: dict[Name, NamedScene] = key("single runs by name", {})
    measure: Measure = key("settings that define the measured numbers")
    figures: Figures = key("settings of figures that show no simulation")
    claims: dict[str, Claim] = key(
        "tolerances that replace the tolerances in manuscript/claims.yaml", {}
    )
    published: dict[Label, Reading] = key("numbers read off a published figure, by name")
    studies: Distinct[Name] | None = key(
        "names of the studies that are run; by default all studies", None, STUDIES
    )

    def key_of(self, name: str) -> str:
        """Return the key of a simulation or a scene."""
        return f"scenes.{name}" if name in self.scenes else f"simulations.{name}"

    @model_validator(mode="after")
    def _check_names(self) -> Self:
        """Raise ValueError for names that are unknown or used twice.

        The key `accuracy` is refused unless the scheme is 'localised'.
        """
        check_name("preset", self.preset, self.presets, ", ".join(self.presets))
        if self.accuracy is not None:
            scheme = self.model.scheme
            allowed = "'localised' if accuracy is given"
            require(scheme == "localised", f"model.scheme: {scheme!r}", allowed)
        for name in self.scenes:
            self._check_scene_name(name)
        for name, reading in self.published.items():
            self._check_reading(f"published.{name}", reading)
        return self

    def _check_scene_name(self, name: str) -> None:
        """Raise ValueError if a scene has the name of a simulation or of another file."""
        problem = f"scenes.{name}: a simulation has the same name"
        require(name not in self.simulations, problem, "another name")
        # Files of a scene are NAME.html, NAME.csv, NAME_numbers.csv and so on. The page index.html
        # shows all scenes.
        other_names = {*self.scenes} - {name}
        is_taken = name == "index" or name.removesuffix("_numbers") in other_names
        problem = f"scenes.{name}: a file of this scene would have the name of another file"
        require(
            not is_taken,
            problem,
            "any name except `index` and the name of another scene followed by `_numbers`",
        )

    def _check_reading(self, key: str, reading: Reading) -> None:
        """Raise ValueError if the number that a reading is compared with is not measured.

        A reading is a number that was read off a published figure. ``key`` is its dotted key.
        """
        # The kind of data that each measured column needs. The trailing edge has a column for each
        # time of `measure.trailing_times`.
        record_for = dict(RECORD_FOR)
        for time in self.measure.trailing_times:
            record_for[f"trailing_edge_{time:g}"] = "fronts"
        quantity, simulation = reading.quantity, reading.simulation
        check_name(f"{key}.simulation", simulation, self.simulations, "a name under simulations")
        measured = "a measured number, which is a column of the tables in results/measurements"
        check_name(f"{key}.quantity", quantity, record_for, measured)
        needed, recorded = record_for[quantity], self.simulations[simulation].record
        # Every simulation records "fronts".
        allowed = (
            f"a number that simulations.{simulation} records, or record: [fronts, {needed}] there"
        )
        require(needed in recorded, f"{key}.quantity: {short_repr(quantity)}", allowed)
