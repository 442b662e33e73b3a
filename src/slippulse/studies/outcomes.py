"""What may come of a run at an edge of the solver's domain."""

RIGHT, FLAGGED, REFUSED, STOPPED = "right", "flagged", "refused", "stopped"
NO_NUMBER, NOT_OFFERED, WRONG = "no number", "not offered", "WRONG WITHOUT A FLAG"
VERDICTS = (RIGHT, FLAGGED, REFUSED, STOPPED, NO_NUMBER, NOT_OFFERED, WRONG)
