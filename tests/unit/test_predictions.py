"""Predictions of theory for runs under every friction law."""

import pytest
from pytest import approx
from verification.test_friction_laws import EXAMPLES

from slippulse import Prestress, friction, theory
from slippulse.model.run import Run
from slippulse.prediction.measured_run import MEASURE_SETTINGS
from slippulse_paper.steps.predict import TOPICS, predictions

# Theory knows the others.
OTHERS = EXAMPLES.keys() - {"coulomb", "linear_rate"}


def predicted(*laws):
    """Return predictions for two equal levels, with one row for each friction law."""
    layer = Prestress(0.6, 0.6)
    laws = [law.mapping() for law in laws]
    runs = [Run("displacement", layer, 0.65, 0.02, 0.002, "total", law) for law in laws]
    return predictions(TOPICS, runs, MEASURE_SETTINGS)


@pytest.mark.parametrize("law", sorted(OTHERS))
def test_no_prediction_ignores_the_friction_law_of_a_run(law):
    table = predicted(friction("coulomb"), friction(law, **EXAMPLES[law]))
    assert table.loc[0].equals(predicted(friction("coulomb")).loc[0])
    assert table.loc[1].isna().all()
    assert predicted(friction(law, **EXAMPLES[law])).isna().all(axis=None)


def test_linear_rate_friction_changes_predicted_pulses_but_not_fronts():
    row = predicted(friction("linear_rate", alpha=0.3)).loc[0]
    speed = theory.front_speed(0.6, 0.1)
    pulse = theory.steady_pulse(0.6, 0.65, 0.002, speed, rate_strengthening=0.3)
    assert row["exact_front_speed_right"] == approx(speed)
    assert row["exact_pulse_slip"] == row["exact_left_pulse_slip"] == approx(pulse.slip)
    assert row[["exact_regime", "exact_transition_time", "exact_first_stick_time"]].isna().all()


def test_the_balance_distance_begins_at_the_nucleation():
    x, tau = [-3.0, -1.0, 0.0, 1.0], [-0.5, -0.5, 1.0, 0.0]
    distances = []
    for shift in (0.0, 6.0):
        profile = Prestress.through([position + shift for position in x], tau)
        run = Run("stress", profile, 0.0, 0.02, 0.002, "total", friction("coulomb").mapping())
        distances.append(
            predictions(TOPICS, [run], MEASURE_SETTINGS).loc[0, "exact_balance_distance"]
        )
    assert distances[1] == approx(distances[0])
