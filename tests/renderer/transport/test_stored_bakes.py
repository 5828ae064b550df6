"""Bakes are kept, known by geometry, and made anew where they are damaged."""

import pytest
import trimesh

from renderer.transport import stored
from renderer.transport.scene import _loaded, scene_geometry
from renderer.transport.visibility import bake


@pytest.fixture
def ball_and_plate(ball_and_plate, tmp_path):
    """The same with a ball of few triangles, quicker to bake."""
    trimesh.creation.icosphere(subdivisions=2).export(tmp_path / "b.ply", vertex_normal=True)
    ball, plate = ball_and_plate.objects
    coarse = ball.model_copy(update={"mesh": str(tmp_path / "b.ply")})
    return ball_and_plate.model_copy(update={"objects": (coarse, plate)})


@pytest.mark.usefixtures("_own_bakes")
def test_a_scene_is_baked_once_and_again_where_its_file_is_damaged(ball_and_plate, monkeypatch):
    made = []
    monkeypatch.setattr("renderer.transport.scene.bake", lambda o: made.append(1) or bake(o))

    def fresh():
        _loaded.cache_clear()
        return scene_geometry(ball_and_plate)

    first, again = fresh(), fresh()
    assert len(made) == 1 and first.first_sight == again.first_sight
    (path,) = stored.folder().iterdir()
    path.write_bytes(path.read_bytes()[:1000])
    assert fresh().first_sight == first.first_sight and len(made) == 2


@pytest.mark.usefixtures("_own_bakes")
def test_old_bakes_make_room(ball_and_plate, monkeypatch):
    scene_geometry(ball_and_plate)
    (old,) = stored.folder().iterdir()
    monkeypatch.setattr(stored, "MOST_BYTES", old.stat().st_size + 1000)
    moved = ball_and_plate.objects[0].model_copy(update={"position": (0.0, 0.0, 1.1)})
    scene_geometry(ball_and_plate.model_copy(update={"objects": (moved,)}))
    (new,) = stored.folder().iterdir()
    assert new != old


def test_a_bake_is_known_by_geometry_alone(ball_and_plate, copper):
    ball, plate = ball_and_plate.objects
    other = ball.model_copy(update={"material": copper(0.1), "name": "x", "judged": False})
    moved = ball.model_copy(update={"position": (0.0, 0.0, 1.1)})

    def key(*objects):
        return stored.placement(ball_and_plate.model_copy(update={"objects": objects}))

    assert key(ball, plate) == key(other, plate) != key(moved, plate)
