"""What the figure of the inference shows is what was inferred."""

from __future__ import annotations

import numpy as np
import pytest

from slippulse.claims.inference import inference, likely


@pytest.fixture(scope="module")
def drawn(draw):
    return draw("study_published_figure")


def test_numbers_are_the_same_from_the_figures_own_table(drawn):
    again, study = inference(drawn.table), inference(drawn.measured["published_figure"])
    assert again == study
    for release in ("total", "elastic"):
        rows = drawn.table[(drawn.table["part"] == "best") & (drawn.table["release"] == release)]
        assert (rows["pull"] ** 2).sum() == pytest.approx(study[release]["chi2"])
        assert rows.set_index("reading")["pull"].to_dict() == pytest.approx(study[release]["pulls"])


def test_regions_are_drawn_around_the_best_fits_and_curves_as_far_as_accepted(drawn):
    axes = drawn.figure.axes
    for panel, name in zip(axes[1:3], ("tau0", "gamma"), strict=True):
        for release in ("total", "elastic"):
            found = inference(drawn.table)[release]
            patches = {patch.get_gid(): patch for patch in panel.collections}
            outer, inner = (patches[f"{release} {level}"].get_paths()[0].vertices for level in (0.95, 0.68))
            low, high = found["regions"][0.95][name]
            # A joint region of two parameters is wider than that of one.
            assert outer[:, 1].min() < low and outer[:, 1].max() > high
            assert np.ptp(inner[:, 0]) < np.ptp(outer[:, 0])
            assert inner[:, 0].min() < found["damping_ratio"] < inner[:, 0].max()
    assert max(line.get_ydata().max() for line in axes[0].lines if line.get_gid()) <= likely(0.95, 7)
