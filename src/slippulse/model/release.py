"""The two rules by which a block is released."""

# A block is released when its stress reaches 1. The stress includes the damping force under "total"
# and excludes it under "elastic".
RELEASES = ("total", "elastic")
