"""The package as its users meet it, against NumPy."""

import re
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest

import alula

SECTION = {
    "title": "section",
    "flow": {"mach": 0.5, "alpha": "2 deg"},
    "body": [{"naca": "0012"}],
    "cloud": {"spacing": 0.0625, "far_field": 10.0},
    "scheme": {"limiter": "none"},
}

SECTION_FILE = """
title = "section"
[flow]
mach = 0.5
alpha = "2 deg"
[[body]]
naca = "0012"
[cloud]
spacing = 0.0625
far_field = 10.0
[scheme]
limiter = "none"
"""

SPHERE = {
    "flow": {"mach": 0.3},
    "body": [{"sphere": {"radius": 0.5}}],
    "cloud": {"spacing": 0.25, "far_field": 2.0},
    "time": {"steady": {"iterations": 3}},
}


@pytest.fixture(scope="module")
def section():
    return alula.run(SECTION)


def test_pressure_over_the_surface_gives_the_loads(section):
    wall, alpha = section.surface, np.radians(2.0)
    force = -(wall["cp"][:, None] * wall["area_vector"]).sum(axis=0) / section.summary["chord"]
    lift = np.array([-np.sin(alpha), np.cos(alpha)])
    drag = np.array([np.cos(alpha), np.sin(alpha)])
    assert section.converged
    assert 0.2 < section.cl < 0.35
    np.testing.assert_allclose([force @ lift, force @ drag], [section.cl, section.cd], rtol=1e-10, atol=1e-12)
    arm = wall["positions"] - [0.25, 0.0]
    pressure = -wall["cp"][:, None] * wall["area_vector"]
    moment = (arm[:, 1] * pressure[:, 0] - arm[:, 0] * pressure[:, 1]).sum()
    np.testing.assert_allclose(moment, section.cm, rtol=1e-10, atol=1e-12)


def test_arrays_have_their_shapes_and_own_what_they_show(section):
    fields, wall = section.fields, section.surface
    n, m = section.summary["particles"], len(wall["cp"])
    assert fields["positions"].shape == fields["velocity"].shape == (n, 2)
    assert fields["vorticity"].shape == fields["mach"].shape == (n,)
    assert wall["normal"].shape == wall["area_vector"].shape == (m, 2)
    assert m == (fields["kind"] == 1).sum()
    assert [section.bodies[k] for k in set(wall["body"])] == ["body-1"]
    for array in [*fields.values(), *wall.values()]:
        assert np.isfinite(array).all()
    # views of three components, not copies of two
    assert fields["velocity"].base is not None and fields["velocity"].strides == (24, 8)
    speed = np.linalg.norm(fields["velocity"], axis=1)
    sound = np.sqrt(1.4 * fields["pressure"] / fields["density"])
    np.testing.assert_allclose(speed / sound, fields["mach"], rtol=1e-12)


def test_an_array_outlives_its_result():
    cp = alula.run(SECTION | {"time": {"steady": {"iterations": 2}}}).surface["cp"]
    assert np.isfinite(cp).all() and cp.flags.writeable


def test_history_has_a_row_for_each_iteration(section):
    history = section.history
    assert history["iteration"].tolist() == list(range(1, section.summary["iterations"] + 1))
    assert history["cl"][-1] == section.cl
    assert history["residual"][-1] < 1e-3


def test_dict_and_file_give_the_same_bits(section, tmp_path):
    file = tmp_path / "case.toml"
    file.write_text(SECTION_FILE)
    again = alula.run(file, threads=1)
    assert (again.cl, again.cd, again.cm) == (section.cl, section.cd, section.cm)
    for name, values in section.fields.items():
        np.testing.assert_array_equal(values, again.fields[name])
    numbers = alula.run(SECTION | {"cloud": {"spacing": np.float32(0.0625), "far_field": np.int64(10), "box": None}})
    assert numbers.cl == section.cl


def test_a_folder_holds_what_the_result_holds(section, tmp_path):
    kept = alula.run(SECTION | {"output": {"report": False}}, out=tmp_path / "run")
    table = np.genfromtxt(tmp_path / "run" / "surface.csv", delimiter=",", names=True, usecols=(0, 1, 12))
    np.testing.assert_array_equal(table["cp"], kept.surface["cp"])
    assert kept.folder == tmp_path / "run" and kept.cl == section.cl
    with pytest.raises(OSError, match="holds a finished run"):
        alula.run(SECTION, out=tmp_path / "run")


def test_space_has_three_components():
    with pytest.warns(UserWarning, match="a rough guess"):
        result = alula.run(SPHERE)
    n = result.summary["particles"]
    assert result.fields["velocity"].shape == result.fields["vorticity"].shape == (n, 3)
    area = np.linalg.norm(result.surface["area_vector"], axis=1).sum()
    assert abs(area / np.pi - 1) < 0.02
    assert np.abs(result.surface["area_vector"].sum(axis=0)).max() < 1e-12


def test_a_polar_is_a_table():
    case = SECTION | {"flow": {"mach": 0.5, "alpha": ["0 deg", "2 deg"]}, "accuracy": {"particles": 100}}
    polar = alula.run(case).polar
    assert polar["alpha_deg"].tolist() == [0.0, 2.0]
    assert abs(polar["cl"][0]) < 1e-3 and 0.2 < polar["cl"][1] < 0.35
    assert polar["converged"].all() and polar["reason"] == ["", ""]
    assert (polar["cl_error"] > 0).all()


def test_every_mistake_is_told(tmp_path):
    wrong = SECTION | {"flow": {"mach": -0.5, "alpa": "2 deg"}, "cloud": {"spacing": "wide"}}
    with pytest.raises(alula.CaseError) as caught:
        alula.run(wrong)
    assert isinstance(caught.value, ValueError)
    mistakes = {m["key"]: m for m in caught.value.mistakes}
    assert {"flow.mach", "flow.alpa", "cloud.spacing"} <= set(mistakes)
    assert "alpha" in mistakes["flow.alpa"]["hint"]
    assert all(m["line"] is None for m in mistakes.values())
    assert all(m["message"] in str(caught.value) for m in mistakes.values())
    file = tmp_path / "case.toml"
    file.write_text(SECTION_FILE.replace("0.0625", '"wide"'))
    with pytest.raises(alula.CaseError, match="case.toml:9:11") as caught:
        alula.check(file)
    assert [(m["key"], m["line"]) for m in caught.value.mistakes] == [("cloud.spacing", 9)]


def test_what_is_no_case_is_told(tmp_path):
    with pytest.raises(FileNotFoundError, match="cannot read"):
        alula.run(tmp_path / "none.toml")
    with pytest.raises(TypeError, match="a case is the path of a case file or a dict"):
        alula.run(7)
    with pytest.raises(TypeError, match=r"`flow.mach` is a `object`; allowed: numbers"):
        alula.run({"flow": {"mach": object()}})
    with pytest.raises(TypeError, match="`progress` is a `int`; allowed: what can be called"):
        alula.run(SECTION, progress=3)
    with pytest.raises(ValueError, match="`threads` is 0; allowed: 1 or more"):
        alula.run(SECTION, threads=0)
    (tmp_path / "file").write_text("")
    with pytest.raises(OSError, match="cannot make the run folder(.|\n)*with `out`"):
        alula.run(SECTION, out=tmp_path / "file" / "run")
    with pytest.raises(alula.CaseError, match="`wing.dat`") as caught:
        alula.run(SECTION | {"body": [{"airfoil": "wing.dat"}]})
    assert len(caught.value.mistakes) == 1


def test_a_computation_that_breaks_off_is_told():
    # beyond divergence, so that the body goes where the cloud cannot follow
    springs = {"elastic_axis": -0.6, "mass_ratio": 75.0, "x_alpha": 0.25, "r_alpha2": 0.75, "frequency_ratio": 0.5}
    case = SECTION | {
        "structure": springs | {"speed_index": 5.0, "initial": {"pitch": "1 deg"}},
        "time": {"dual": {"step": 1.0, "until": 4000.0}},
    }
    with pytest.raises(alula.ComputationError, match="the structure had"):
        alula.run(case)


def test_check_tells_what_a_case_means():
    told = alula.check(SECTION | {"flow": {"pressure": "1 atm", "temperature": "15 degC", "mach": 0.5}})
    meant = told["understood"]
    assert told["title"] == "section" and meant["dimensional"]
    np.testing.assert_allclose(meant["dynamic_pressure"], 0.5 * 1.4 * 101325 * 0.25)
    np.testing.assert_allclose(meant["sound_speed"], np.sqrt(1.4 * 287.05 * 288.15))
    np.testing.assert_allclose(meant["bodies"][0]["max"][0], 1.0)
    assert told["particles"] > 500 and told["cost"]["bytes"] > 0 and told["notes"] == []


def test_progress_is_told_and_other_threads_go_on():
    events, counted, over = [], [0], threading.Event()

    def count():
        while not over.is_set():
            counted[0] += 1
            time.sleep(1e-4)

    thread = threading.Thread(target=count)
    thread.start()
    result = alula.run(SECTION, progress=events.append)
    over.set()
    thread.join()
    iterations = [e for e in events if e["event"] == "iteration"]
    assert [e["iteration"] for e in iterations] == result.history["iteration"].tolist()
    assert iterations[-1]["cl"] == result.cl and iterations[-1]["time"] is None
    assert any(e["event"] == "note" and "particles" in e["message"] for e in events)
    assert counted[0] > 10


def test_an_exception_in_the_callback_ends_the_run():
    def weary(event):
        if event["event"] == "iteration" and event["iteration"] == 3:
            raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        alula.run(SECTION, progress=weary)


def test_what_is_doubtful_is_a_warning():
    with pytest.warns(UserWarning, match="scheme adds drag"):
        alula.run(SECTION | {"flow": {"mach": 0.03}, "time": {"steady": {"iterations": 1}}})


@pytest.mark.skipif(not hasattr(signal, "setitimer"), reason="no timers there")
def test_ctrl_c_is_heard_without_a_callback():
    march = SECTION | {"time": {"explicit": {"until": 1e4}}}
    earlier = signal.signal(signal.SIGALRM, signal.default_int_handler)
    try:
        signal.setitimer(signal.ITIMER_REAL, 0.3)
        with pytest.raises(KeyboardInterrupt):
            alula.run(march)
    finally:
        signal.signal(signal.SIGALRM, earlier)


INTERRUPTED = """
import alula, signal, sys
# whoever started the tests may have had it ignored
signal.signal(signal.SIGINT, signal.default_int_handler)
def told(event):
    if event.get("iteration") == 3:
        print("begun", flush=True)
case = {"flow": {"mach": 0.3}, "body": [{"circle": {"radius": 0.5}}], "cloud": {"spacing": 0.125, "far_field": 4.0},
        "time": {"explicit": {"until": 1e4}}}
try:
    alula.run(case, out=sys.argv[1], progress=told)
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""


@pytest.mark.skipif(sys.platform == "win32", reason="signals are sent otherwise there")
def test_ctrl_c_leaves_a_checkpoint(tmp_path):
    child = subprocess.Popen([sys.executable, "-c", INTERRUPTED, str(tmp_path / "run")], stdout=subprocess.PIPE, text=True)
    assert child.stdout.readline() == "begun\n"
    child.send_signal(signal.SIGINT)
    rest, _ = child.communicate(timeout=30)
    assert rest == "interrupted\n" and child.returncode == 0
    assert (tmp_path / "run" / "checkpoint.alula").is_file()


def test_a_stopped_run_goes_on_to_the_same_bits(section, tmp_path):
    def weary(event):
        if event.get("iteration") == 5:
            raise RuntimeError("enough")

    with pytest.raises(RuntimeError, match="enough"):
        alula.run(SECTION, out=tmp_path / "run", progress=weary)
    resumed = alula.resume(tmp_path / "run", threads=1)
    assert resumed.converged and resumed.cl == section.cl
    assert np.array_equal(resumed.fields["pressure"], section.fields["pressure"])
    assert np.array_equal(resumed.history["residual"], section.history["residual"])
    with pytest.raises(alula.CaseError, match="is finished"):
        alula.resume(tmp_path / "run")
    with pytest.raises((alula.CaseError, OSError)):
        alula.resume(tmp_path / "none")


def test_stubs_name_what_there_is():
    stubs = (Path(__file__).parents[1] / "alula.pyi").read_text()
    public = {name: getattr(alula, name) for name in dir(alula) if not name.startswith("_")}
    public.pop("alula", None)
    assert {"run", "flutter", "gaf", "solid", "cloud", "geometry", "check", "resume"} <= set(public)
    for name, thing in public.items():
        assert thing.__doc__ and re.search(rf"^(class|def) {name}\b", stubs, re.MULTILINE)
        if isinstance(thing, type) and not issubclass(thing, Exception):
            body = stubs.split(f"class {name}:\n")[1].split("\nclass ")[0].split("\ndef ")[0]
            own = {own for own in dir(thing) if not own.startswith("_")}
            assert own == {line.split("(")[0] for line in body.split("    def ")[1:]}
            assert all(getattr(thing, attribute).__doc__ for attribute in own)
