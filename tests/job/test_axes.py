"""Local axes: right-handed frames, what they are at known points, and what is refused."""

import numpy as np
import pytest

from abut import Axes
from abut.errors import InputError

EVERY = [
    Axes(), Axes(x=(1, 2, 0.5), xy=(0, 0, 3)), Axes("cylindrical"), Axes("cylindrical", (1, 2, 3), (1, -1, 2)),
    Axes("spherical", (0.5, 0, 0)), Axes("spherical", axis=(0, 1, 1)),
]  # fmt: skip


@pytest.mark.parametrize("axes", EVERY, ids=str)
def test_frames_are_orthonormal_and_right_handed(axes):
    frames = axes.frames(np.random.default_rng(1).normal(size=(20, 3)))
    assert frames @ frames.transpose(0, 2, 1) == pytest.approx(np.broadcast_to(np.eye(3), frames.shape), abs=1e-14)
    assert np.linalg.det(frames) == pytest.approx(1.0, abs=1e-14)


@pytest.mark.parametrize("kind", ["rectangular", "cylindrical", "spherical"])
def test_frames_in_the_plane(kind):
    axes = Axes(kind, x=(3, 4)) if kind == "rectangular" else Axes(kind, origin=(1, 1))
    (frame,) = axes.frames([[4.0, 5.0]])
    assert frame == pytest.approx(np.array([[0.6, 0.8], [-0.8, 0.6]]), abs=1e-15)


def test_rectangular_turns_the_second_direction_into_the_plane_given():
    (frame,) = Axes(x=(0, 2, 0), xy=(-1, 7, 0)).frames([[0, 0, 0]])
    assert frame == pytest.approx(np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1]]), abs=1e-15)


def test_cylindrical_is_radial_around_and_along():
    points = np.array([[0.0, 3.0, 9.0], [-2.0, 0.0, 1.0]])
    radial, around, along = Axes("cylindrical").frames(points).transpose(1, 0, 2)
    assert radial == pytest.approx(np.array([[0, 1, 0], [-1, 0, 0]]), abs=1e-15)
    assert around == pytest.approx(np.array([[-1, 0, 0], [0, -1, 0]]), abs=1e-15)
    assert along == pytest.approx(np.array([[0, 0, 1], [0, 0, 1]]), abs=1e-15)


def test_spherical_is_radial_east_and_north():
    (frame,) = Axes("spherical").frames([[1.0, 0.0, 1.0]])
    half = np.sqrt(0.5)
    assert frame == pytest.approx(np.array([[half, 0, half], [0, 1, 0], [-half, 0, half]]), abs=1e-15)


def test_points_on_the_axis_have_a_frame_too():
    for axes in EVERY:
        if axes.kind != "rectangular":
            origin, axis = np.array(axes.origin or (0, 0, 0)), np.array(axes.axis or (0, 0, 1))
            for frame in axes.frames([origin, origin + 2 * axis]):
                assert frame @ frame.T == pytest.approx(np.eye(3), abs=1e-12)


@pytest.mark.parametrize(
    ("given", "words"),
    [
        ({"kind": "polar"}, "axes: kind"),
        ({"kind": "cylindrical", "x": (1, 0, 0)}, "x does not go with"),
        ({"axis": (0, 0, 1)}, "axis does not go with"),
        ({"kind": "cylindrical", "axis": (0, 0, 0)}, "other than zero"),
        ({"x": (1,)}, "expected 2 or 3 numbers"),
        ({"x": 5}, "expected 2 or 3 numbers"),
    ],
)
def test_refused(given, words):
    with pytest.raises(InputError, match=words):
        Axes(**given)


@pytest.mark.parametrize(
    ("axes", "dim", "words"),
    [
        (Axes(x=(0, 1, 0)), 3, "parallel"),
        (Axes("cylindrical", axis=(0, 0, 1)), 2, "the model is 2D"),
        (Axes("cylindrical", origin=(0, 0)), 3, "expected 3 numbers"),
    ],
)
def test_refused_for_a_mesh(axes, dim, words):
    with pytest.raises(InputError, match=words):
        axes.check(dim, "supports[0]")
