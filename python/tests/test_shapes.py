"""Clouds and bodies as arrays."""

import signal
import time

import numpy as np
import pytest

import alula

CIRCLE = {
    "flow": {"mach": 0.3},
    "body": [{"name": "rod", "circle": {"radius": 0.5}}],
    "boundary": {"y_min": "symmetry"},
    "cloud": {"spacing": 0.25, "far_field": 4},
}

# a tetrahedron without one of its faces
OPEN = """solid part
facet normal 0 0 -1
outer loop
vertex 0 0 0
vertex 0 1 0
vertex 1 0 0
endloop
endfacet
facet normal 0 -1 0
outer loop
vertex 0 0 0
vertex 1 0 0
vertex 0 0 1
endloop
endfacet
facet normal -1 0 0
outer loop
vertex 0 0 0
vertex 0 0 1
vertex 0 1 0
endloop
endfacet
endsolid part
"""


def test_particles_know_their_boundary():
    cloud = alula.cloud(CIRCLE)
    n = len(cloud.kind)
    assert cloud.positions.shape == cloud.normal.shape == cloud.area_vector.shape == (n, 2)
    assert cloud.spacing.shape == cloud.volume.shape == cloud.body.shape == cloud.boundary.shape == (n,)
    assert cloud.boundaries == ["rod", "x_min", "x_max", "y_min", "y_max"] and cloud.bodies == ["rod"]
    assert cloud.conditions["y_min"] == "symmetry" and cloud.conditions["x_min"] == "far_field"
    fluid, wall, side = (cloud.kind == k for k in range(3))
    assert (cloud.boundary[fluid] == -1).all() and (cloud.normal[fluid] == 0).all()
    assert (cloud.body[wall] == 0).all() and (cloud.body[side] == -1).all()
    np.testing.assert_allclose(cloud.normal[wall], 2 * cloud.positions[wall], atol=1e-9)
    left = cloud.boundary == cloud.boundaries.index("x_min")
    assert left.any() and (cloud.normal[left] == [-1, 0]).all()
    assert repr(cloud) == f"<alula.Cloud of 'case': {n} particles>"


def test_a_cloud_is_that_of_its_run():
    case = CIRCLE | {"time": {"steady": {"iterations": 1}}, "boundary": {}}
    cloud, run = alula.cloud(case), alula.run(case)
    np.testing.assert_array_equal(cloud.positions, run.fields["positions"])
    np.testing.assert_array_equal(cloud.kind, run.fields["kind"])


def test_a_section_has_an_outline():
    # bodies are enough
    section = alula.geometry({"body": [{"name": "wing", "naca": "0012"}]})
    assert section.dimension == 2 and section.closed and section.span is None
    assert abs(section.chord - 1) < 1e-9 and section.chord == section.reference_area
    # Abbott and von Doenhoff: area .0822 of a section 12 % thick
    np.testing.assert_allclose(section.volume, 0.0822, rtol=0.01)
    outline, = section.outlines
    assert (outline[0] == outline[-1]).all()
    steps = np.diff(outline, axis=0)
    np.testing.assert_allclose(np.hypot(*steps.T).sum(), section.area)
    x, y = outline.T
    np.testing.assert_allclose(0.5 * (x[:-1] * y[1:] - x[1:] * y[:-1]).sum(), section.volume)
    np.testing.assert_allclose(section.boxes["wing"], section.extents)
    np.testing.assert_allclose(section.area_vectors.sum(axis=0), 0, atol=1e-12)


def test_a_wing_has_span_and_chord():
    wing = alula.geometry({"body": [{"wing": {"naca": "0012", "span": 4, "chord": 1, "tip": "flat"}}]})
    assert wing.dimension == 3 and wing.elements.shape == wing.area_vectors.shape
    triangles = wing.vertices[wing.elements]
    volume = np.einsum("ij,ij->i", triangles[:, 0], np.cross(triangles[:, 1], triangles[:, 2])).sum() / 6
    np.testing.assert_allclose(volume, wing.volume)
    np.testing.assert_allclose(np.linalg.norm(wing.area_vectors, axis=1).sum(), wing.area)
    assert wing.outlines is None and wing.extents.shape == (2, 3)
    np.testing.assert_allclose([wing.span, wing.chord, wing.reference_area], [4, 1, 4], rtol=1e-6)
    np.testing.assert_allclose(wing.volume, 4 * 0.0822, rtol=0.01)
    assert len(wing.elements) == len(wing.body) and repr(wing).startswith("<alula.Geometry of body-1: ")


def test_files_are_read_as_they_are(tmp_path):
    section = tmp_path / "square.dat"
    section.write_text("square\n1 0\n0.5 0.1\n0 0\n0.5 -0.1\n1 0\n")
    np.testing.assert_allclose(alula.geometry(section).extents, [[0, -0.1], [1, 0.1]], atol=0.02)
    solid = tmp_path / "part.STL"
    solid.write_text(OPEN)
    part = alula.geometry(str(solid))
    assert part.closed and part.notes
    np.testing.assert_allclose(part.volume, 1 / 6)
    case = tmp_path / "case.toml"
    case.write_text('[flow]\nmach = 0.3\n[[body]]\nsurface = "part.STL"\n')
    np.testing.assert_array_equal(alula.geometry(case).vertices, part.vertices)


def test_what_is_wrong_is_told(tmp_path):
    with pytest.raises(FileNotFoundError, match="none.stl"):
        alula.geometry(tmp_path / "none.stl")
    broken = tmp_path / "broken.dat"
    broken.write_text("nothing\n")
    with pytest.raises(alula.CaseError, match="broken.dat"):
        alula.geometry(broken)
    with pytest.raises(TypeError, match="a case is the path of a case file or a dict"):
        alula.geometry(7)
    with pytest.raises(alula.CaseError) as caught:
        alula.cloud(CIRCLE | {"cloud": {"spacin": 1, "far_field": -1}})
    assert {"cloud.spacin", "cloud.far_field"} <= {m["key"] for m in caught.value.mistakes}


def test_check_tells_all_that_is_refused(tmp_path):
    (tmp_path / "bending.csv").write_text("x,y,dx,dy\n0,0,a,1\n0.1,b,1,1\n")
    case = tmp_path / "case.toml"
    case.write_text("""
[flow]
mach = 0.3
[[body]]
naca = "0012"
[structure]
elastic_axis = -0.5
mass_ratio = 100
x_alpha = 0.25
r_alpha2 = 0.25
frequency_ratio = 0.2
reduced_speed = 4.0
[flutter]
match = "altitude"
[gaf]
reduced_frequencies = [0.1]
pivot = [0.25, 0]
mode = [{ name = "bending", file = "bending.csv" }]
""")
    with pytest.raises(alula.CaseError) as caught:
        alula.check(case)
    mistakes = caught.value.mistakes
    assert [m["line"] for m in mistakes] == [2, 3, None] and "standard atmosphere" in mistakes[2]["message"]
    assert all(m["message"] in str(caught.value) and m["hint"] in str(caught.value) for m in mistakes)


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="no timers there")
@pytest.mark.parametrize("look", [alula.cloud, alula.check])
def test_ctrl_c_is_heard_at_once(look):
    fine = {"flow": {"mach": 0.3}, "body": [{"sphere": {"radius": 0.5}}], "cloud": {"spacing": 0.02, "far_field": 6}}
    earlier = signal.signal(signal.SIGALRM, signal.default_int_handler)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.3)
        began = time.monotonic()
        with pytest.raises(KeyboardInterrupt):
            look(fine)
        assert time.monotonic() - began < 2
    finally:
        signal.signal(signal.SIGALRM, earlier)
