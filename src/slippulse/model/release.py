"""The rules of release."""

# The stress that is compared with 1 has the damping force in it, or not.
RELEASES = ("total", "elastic")
