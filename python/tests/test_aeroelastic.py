"""Flutter boundaries and generalised forces as arrays."""

import signal

import numpy as np
import pytest

import alula

SECTION = {
    "title": "section",
    "flow": {"mach": 0.5},
    "body": [{"naca": "0012"}],
    "cloud": {"spacing": 0.0625, "far_field": 10.0},
}

TYPICAL = SECTION | {
    "structure": {
        "elastic_axis": -0.5,
        "mass_ratio": 100,
        "x_alpha": 0.25,
        "r_alpha2": 0.25,
        "frequency_ratio": 0.2,
        "reduced_speed": 4.0,
    },
    "flutter": {"cloud_error": False, "reduced_frequencies": [0.05, 0.1, 0.2]},
    "output": {"report": False},
}

FORCES = SECTION | {"gaf": {"reduced_frequencies": [0.0, 0.05, 0.1], "pivot": [0.25, 0.0]}}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("flutter")


@pytest.fixture(scope="module")
def boundary(folder):
    return alula.flutter(TYPICAL, out=folder / "section")


@pytest.fixture(scope="module")
def forces():
    return alula.gaf(FORCES)


def test_a_boundary_tells_where_flutter_begins(boundary):
    assert boundary.mach.tolist() == [0.5]
    crossing = boundary.crossings[0]
    assert (crossing["kind"], crossing["branch"], crossing["mach"]) == ("flutter", "mode 1", 0.5)
    # thin sections begin at 6.26 without and at 6.15 with compressibility at Mach 0.3
    assert 4.5 < crossing["reduced_speed"] < 6.5
    assert (boundary.speeds[0], boundary.frequencies[0]) == (crossing["speed"], crossing["frequency"])
    assert boundary.speed_errors[0] == crossing["speed_error"] < 0.05 * crossing["speed"]
    # k = omega b/U with half a chord
    k = 2 * np.pi * crossing["frequency"] * 0.5 / crossing["speed"]
    np.testing.assert_allclose(k, crossing["reduced_frequency"], rtol=1e-9)
    assert crossing["altitude"] is None and {s["coordinate"] for s in crossing["shape"]} == {"plunge", "pitch"}
    assert repr(boundary) == "<alula.Flutter of 'section': 1 crossings at 1 Mach numbers>"


def test_damping_changes_sign_at_the_crossing(boundary):
    vg = boundary.vg
    m = len(vg["speed"])
    assert all(len(column) == m for column in vg.values())
    own = (vg["branch"] == "mode 1") & (vg["mach"] == 0.5)
    speed, damping = vg["speed"][own], vg["damping"][own]
    order = np.argsort(speed)
    speed, damping = speed[order], damping[order]
    k = np.flatnonzero((damping[:-1] < 0) & (damping[1:] > 0))[0]
    between = np.interp(0.0, damping[k : k + 2], speed[k : k + 2])
    assert abs(between / boundary.speeds[0] - 1) < 0.02
    # g = 2 Re(lambda)/|lambda|
    some = own & (vg["frequency"] > 0)
    value = vg["eigenvalue"][some]
    np.testing.assert_allclose(2 * value.real / abs(value), vg["damping"][some], atol=1e-12)
    assert np.isnan(vg["altitude"]).all() and vg["mode"].dtype == np.float64


def test_units_go_with_the_case(boundary):
    units = boundary.units
    assert (units["speed"], units["frequency"], units["density"]) == ("a", "a/L", "rho")
    assert units["speed_error"] == "a" and units["damping"] == units["reduced_frequency"] == "1"
    assert set(boundary.vg) - set(units) == {"branch", "eigenvalue"}
    assert "k = omega b/U" in boundary.conventions


def test_a_boundary_is_a_dict_as_well(boundary, folder):
    told = boundary.to_dict()
    at = told["flutter"][0]
    assert told["title"] == "section" and len(at["crossings"]) == len(boundary.crossings)
    assert len(at["forces"]) == len(at["reduced_frequencies"])
    assert boundary.folder == folder / "section" and (boundary.folder / "v-g.csv").is_file()
    table = np.genfromtxt(boundary.folder / "v-g.csv", delimiter=",", names=True, usecols=(13, 5))
    np.testing.assert_array_equal(table["speed"], boundary.vg["speed"])
    with pytest.raises(OSError, match="holds earlier results\n(.|\n)*`out`"):
        alula.flutter(TYPICAL, out=folder / "section")


def test_forces_serve_other_structures_without_a_flow(boundary, folder):
    again = alula.flutter(TYPICAL, forces=folder / "section" / "flutter.json")
    np.testing.assert_allclose(again.speeds, boundary.speeds, rtol=0.01)
    heavy = TYPICAL | {"structure": TYPICAL["structure"] | {"mass_ratio": 200}}
    assert alula.flutter(heavy, forces=folder / "section" / "flutter.json").speeds[0] > again.speeds[0]
    assert again.folder is None
    with pytest.raises(OSError, match="nothing.json"):
        alula.flutter(TYPICAL, forces=folder / "nothing.json")


def test_without_a_folder_all_is_the_same(boundary):
    again = alula.flutter(TYPICAL, threads=1)
    assert again.speeds[0] == boundary.speeds[0]
    assert again.crossings == boundary.crossings


def test_matrices_have_rows_and_columns(forces):
    assert forces.modes == ["plunge", "pitch"]
    assert forces.q.shape == forces.q_error.shape == (3, 2, 2) and forces.q.dtype == np.complex128
    assert forces.cl.shape == forces.cm_error.shape == forces.converged.shape == (3, 2)
    assert forces.converged.all() and np.isnan(forces.nonlinearity).all()
    assert forces.reduced_frequencies.tolist() == [0.0, 0.05, 0.1]
    # the row of pitch is the moment, that of plunge the force over the length of half a chord
    np.testing.assert_allclose(forces.q[:, 1, :], forces.cm, atol=1e-9)
    np.testing.assert_allclose(forces.q[:, 0, :], 0.5 * forces.cl, atol=1e-9)
    # a steady plunge makes no force, a thin section 2 pi/beta per radian
    assert abs(forces.q[0, 0, 0]) < 1e-9
    assert abs(forces.cl[0, 1] / (2 * np.pi / np.sqrt(0.75)) - 1) < 0.2
    assert (forces.q_error[:, 1, 1] < abs(forces.cl[:, 1])).all()


def test_matrices_tell_what_they_hold_for(forces):
    told = forces.conditions
    assert (told["mach"], told["speed"], told["pivot"]) == (0.5, 0.5, [0.25, 0.0])
    assert abs(told["chord"] - 1) < 1e-9 and abs(told["reduced_length"] - 0.5) < 1e-9
    np.testing.assert_allclose(told["dynamic_pressure"], 0.125)
    np.testing.assert_allclose(forces.frequencies, forces.reduced_frequencies * 0.5 / np.pi, rtol=1e-9)
    assert forces.units["frequencies"] == "a/L" and forces.units["q"] == "1"
    table = forces.to_dict()
    assert table["mode"].tolist() == ["plunge", "pitch"] * 3 and len(table["k"]) == 6
    np.testing.assert_array_equal(table["q_plunge_re"] + 1j * table["q_plunge_im"], forces.q[:, 0, :].ravel())
    np.testing.assert_array_equal(table["q_pitch_error"], forces.q_error[:, 1, :].ravel())


def test_a_folder_holds_the_same_matrices(forces, tmp_path):
    kept = alula.gaf(FORCES, out=tmp_path / "gaf")
    np.testing.assert_array_equal(kept.q, forces.q)
    assert (tmp_path / "gaf" / "gaf.json").is_file()


def test_what_is_missing_is_told():
    with pytest.raises(alula.CaseError, match=r"the case has no table `\[flutter\]`"):
        alula.flutter(SECTION)
    with pytest.raises(alula.CaseError, match=r"the case has no table `\[gaf\]`"):
        alula.gaf(SECTION)
    wrong = TYPICAL | {"flow": {"mach": -0.5}, "flutter": {"methd": "pk"}}
    with pytest.raises(alula.CaseError) as caught:
        alula.flutter(wrong)
    assert {"flow.mach", "flutter.methd"} <= {m["key"] for m in caught.value.mistakes}


@pytest.mark.parametrize("command", [lambda c, **k: alula.flutter(TYPICAL | c, **k), lambda c, **k: alula.gaf(FORCES | c, **k)])
@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="no timers there")
def test_ctrl_c_is_heard(command):
    earlier = signal.signal(signal.SIGALRM, signal.default_int_handler)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.5)
        with pytest.raises(KeyboardInterrupt):
            command({"cloud": {"spacing": 0.01, "far_field": 20.0}})
    finally:
        signal.signal(signal.SIGALRM, earlier)


def test_an_interrupted_boundary_goes_on(tmp_path):
    case = TYPICAL | {"flutter": TYPICAL["flutter"] | {"mach": [0.5, 0.3]}}
    seen = []

    def weary(event):
        seen.append(event["event"])
        # the second Mach number has begun when its steady flow does
        if event.get("iteration") == 1 and seen.count("iteration") > 1:
            raise LookupError("enough")

    with pytest.raises(LookupError):
        alula.flutter(case, out=tmp_path / "two", progress=weary)
    resumed = alula.resume(tmp_path / "two")
    assert isinstance(resumed, alula.Flutter) and resumed.mach.tolist() == [0.5, 0.3]
    assert np.isfinite(resumed.speeds).all()
