"""Structures of particles alone as arrays."""

import signal

import numpy as np
import pytest

import alula

BAR = {
    "title": "bar",
    "body": [
        {
            "name": "bar",
            "box": {"size": [0.3, 0.1]},
            "solid": {
                "spacing": 0.025,
                "material": {"density": 1000, "young": 1e6, "poisson": 0.3},
                "support": {"where": {"x_max": -0.1499}},
                "load": {"where": {"x_min": 0.1499}, "traction": [1e3, 0], "history": "min(t/0.01, 1)"},
                "probe": [{"name": "tip", "at": [0.15, 0]}],
            },
        }
    ],
    "time": {"explicit": {"until": 0.02}},
}

HELD = {"body": [{**BAR["body"][0], "solid": {**BAR["body"][0]["solid"], "load": {
    "where": {"x_min": 0.1499}, "traction": [1e3, 0]}}}]}


def test_a_march_has_fields_and_histories():
    found = alula.solid(BAR)
    fields, n = found.fields, found.summary["particles"]
    assert found.study == "march" and found.converged and found.bodies == ["bar"]
    assert fields["positions"].shape == fields["at_rest"].shape == (n, 2) and fields["stress"].shape == (n, 3, 3)
    np.testing.assert_allclose(fields["positions"], fields["at_rest"] + fields["displacement"])
    stress = fields["stress"]
    np.testing.assert_allclose(stress, stress.transpose(0, 2, 1), atol=1e-9)
    deviator = stress - np.trace(stress, axis1=1, axis2=2)[:, None, None] / 3 * np.eye(3)
    np.testing.assert_allclose(np.sqrt(1.5 * (deviator**2).sum(axis=(1, 2))), fields["von_mises_stress"], rtol=1e-9)
    np.testing.assert_allclose(-np.trace(stress, axis1=1, axis2=2) / 3, fields["pressure"], atol=1e-9)
    np.testing.assert_allclose(fields["volume"].sum(), 0.03, rtol=1e-9)
    history, tip = found.history, found.probes["tip"]
    assert tip.shape == (len(history["time"]), 2) and history["time"][-1] == 0.02
    np.testing.assert_array_equal(tip[:, 0], history["tip_ux"])
    assert tip[-1].tolist() == found.summary["probes"][0]["displacement"]
    assert found.energies["strain"] == history["strain"][-1] > 0
    assert found.modes is None and found.shapes is None and found.folder is None
    assert repr(found) == "<alula.Solid of 'bar': march>"


def test_an_equilibrium_is_under_its_load():
    found = alula.solid({**HELD, "time": {"steady": {}}})
    assert found.study == "equilibrium"
    middle = abs(found.fields["at_rest"][:, 0]) < 0.03
    np.testing.assert_allclose(found.fields["stress"][middle, 0, 0].mean(), 1e3, rtol=0.02)


def test_modes_have_shapes():
    found = alula.solid({**HELD, "time": {"modes": {"number": 2}}})
    n = found.summary["particles"]
    assert found.shapes.shape == (2, n, 2) and found.modes["frequency"].shape == (2,)
    np.testing.assert_allclose(abs(found.shapes).max(axis=(1, 2)), 1.0)
    np.testing.assert_allclose(found.modes["omega"], 2 * np.pi * found.modes["frequency"])
    # bending of a short cantilever is the first
    tip = found.fields["at_rest"][:, 0].argmax()
    assert abs(found.shapes[0, tip, 1]) > abs(found.shapes[0, tip, 0])


def test_a_stopped_march_goes_on(tmp_path):
    def weary(event):
        if event.get("iteration", 0) > 10:
            raise LookupError("enough")

    # long enough to be stopped before it ends
    long = BAR | {"time": {"explicit": {"until": 6.0}}}
    with pytest.raises(LookupError):
        alula.solid(long, out=tmp_path / "bar", progress=weary)
    resumed, whole = alula.resume(tmp_path / "bar"), alula.solid(long, threads=1)
    assert isinstance(resumed, alula.Solid) and resumed.folder == tmp_path / "bar"
    for name, values in whole.history.items():
        np.testing.assert_array_equal(values, resumed.history[name])
    np.testing.assert_array_equal(whole.fields["stress"], resumed.fields["stress"])
    table = np.genfromtxt(tmp_path / "bar" / "history.csv", delimiter=",", names=True)
    np.testing.assert_array_equal(table["strain"], resumed.history["strain"])


def test_check_tells_of_structures():
    told = alula.check(BAR)
    assert told["title"] == "bar" and told["particles"] == 65 and told["held"] == [5]


def test_gas_and_structure_are_told_apart():
    with pytest.raises(alula.CaseError, match="has no gas(.|\n)*`alula.solid`"):
        alula.run(BAR)
    with pytest.raises(alula.CaseError, match="has no gas"):
        alula.cloud(BAR)
    with pytest.raises(alula.CaseError, match="has a gas(.|\n)*`alula.run`"):
        alula.solid({"flow": {"mach": 0.5}, "body": [{"naca": "0012"}]})
    with pytest.raises(alula.CaseError, match="is not in `bar`"):
        alula.solid({**BAR, "body": [{**BAR["body"][0], "solid": {
            **BAR["body"][0]["solid"], "probe": [{"name": "tip", "at": [0.9, 0]}]}}]})


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="no timers there")
def test_ctrl_c_is_heard():
    earlier = signal.signal(signal.SIGALRM, signal.default_int_handler)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.3)
        with pytest.raises(KeyboardInterrupt):
            alula.solid({**BAR, "time": {"explicit": {"until": 1e4}}})
    finally:
        signal.signal(signal.SIGALRM, earlier)
