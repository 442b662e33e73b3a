"""The columns of a measured table, and the group of records that each one needs.

A sweep records release and stick times ("fronts"), fields at the end ("fields") and samples in time
("samples"). `RECORD_FOR` maps the name of a column to one of these groups.
"""

FROM_FRONTS = """
    front_speed_right front_speed_left front_intercept_right front_intercept_left
    front_speed_error_right front_speed_error_left transition_time transition_length
    transition_longest_wait first_stick_time first_stick_position balance_distance
    last_release_time last_release_distance last_release_length
    paper_transition_time paper_transition_length beyond
"""
FROM_FIELDS = """
    largest_velocity pulse_front pulse_width pulse_peak_velocity pulse_slip pulse_stress_drop
    pulse_acceleration slip_variation pulse_half_width pulse_shape_deviation lattice_noise
    sliding_at_once
"""
FROM_SAMPLES = """
    slip_time_background slip_time_nucleation slip_length_background slip_length_nucleation
    centre_velocity_share largest_velocity_change late_front_speed_left late_front_speed_right
    profile_change energy_change strain_left
"""

RECORD_FOR = (
    dict.fromkeys(FROM_FRONTS.split(), "fronts")
    | dict.fromkeys(FROM_FIELDS.split(), "fields")
    | dict.fromkeys(FROM_SAMPLES.split(), "samples")
)
