"""How accurately linear systems are solved: Eisenstat and Walker 1996, choice 2, within its bounds."""

from __future__ import annotations

import numpy as np
import pytest

from abut.nonlinear.forcing import forcing
from abut.nonlinear.settings import DEFAULT

BALANCED = DEFAULT.newton.balanced
ASKED = DEFAULT.accuracy
ROUGH, FINE, SHARE, SPARE = ASKED.rough, ASKED.fine, ASKED.share, ASKED.spare


def test_it_follows_the_square_of_the_last_reduction() -> None:
    assert forcing(1e-3, np.inf, DEFAULT) == ROUGH  # the first one
    for error in (1e-3, 2e-4):
        assert forcing(error, 1e-2, DEFAULT) == pytest.approx(SHARE * (error / 1e-2) ** 2)
    assert forcing(2e-2, 1e-2, DEFAULT) == ROUGH  # it has grown


def test_no_finer_than_the_last_iteration_needs() -> None:
    """What is left then is a part of what counts as balanced; never finer than is worth anything, never rougher than at
    first."""
    assert forcing(1e-3, 1.0, DEFAULT) == FINE
    assert forcing(1e-6, 1e-2, DEFAULT) == pytest.approx(SPARE * BALANCED / 1e-6)
    assert forcing(2e-6, 1e-2, DEFAULT) * 2e-6 == pytest.approx(SPARE * BALANCED)
    assert forcing(1e-12, 1e-2, DEFAULT) == ROUGH
    assert forcing(0.0, 1e-2, DEFAULT) == ROUGH
