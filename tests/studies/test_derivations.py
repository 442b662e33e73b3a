"""Numbers that the derivations in the supplement quote."""

import math

from slippulse_paper.studies.derivations import one_way_functions


def test_a_front_that_does_not_stop_in_time_has_no_stop():
    stopping = one_way_functions(0.3, gamma=0.65, damping_ratio=0.1, release="total")
    assert -4.7 < stopping["one_way_stop_position"]() < -4.6
    running = one_way_functions(0.02, gamma=0.65, damping_ratio=0.1, release="total")
    assert math.isnan(running["one_way_stop_position"]())
    assert math.isnan(running["one_way_stop_time"]())
    assert running["one_way_transition_time"]() > 3.0
