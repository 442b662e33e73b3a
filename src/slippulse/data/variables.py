"""Units and meaning of everything that a data file may hold."""

# Units and long names of every variable that a data file may hold.
VARIABLES = {
    "x": ("1", "position, in units of the layer thickness H"),
    "prestress": ("1", "non-dimensional pre-stress"),
    "release_time": ("1", "time of the first release, NaN where never"),
    "stick_time": ("1", "time of the last stick, NaN where never or sliding at the end"),
    "slip": ("1", "slip at the end"),
    "slip_velocity": ("1", "slip velocity at the end"),
    "slip_acceleration": ("1", "slip acceleration at the end"),
    "sample_time": ("1", "time of a sample"),
    "sample_position": ("1", "position of a sample, in units of the layer thickness H"),
    "sample_slip": ("1", "slip at the sampled times and positions"),
    "sample_velocity": ("1", "slip velocity at the sampled times and positions"),
}
