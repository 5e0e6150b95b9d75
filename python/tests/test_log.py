"""Logs."""

import numpy as np
import pytest
import tribo


def arrays(n=400, joints=7):
    time = np.arange(n) * 2e-3
    phase = np.arange(joints)
    q = np.sin(3 * time[:, None] + phase)
    return time, q, 3 * np.cos(3 * time[:, None] + phase), 2 * q


def test_arrays_come_back():
    time, q, dq, tau = arrays()
    log = tribo.Log.from_arrays(time, q, tau, dq, temperature=20 + 0 * q, temperature_ambient=0 * time)
    assert (len(log), log.joints, log.duration) == (400, 7, pytest.approx(0.798))
    for name, values in [("q", q), ("dq", dq), ("tau", tau), ("temperature_ambient", 0 * time)]:
        assert (log.quantity(name) == values).all()
    assert log.quantity("theta") is None
    assert (log.time == time).all()


@pytest.mark.parametrize("ending", [".csv", ".csv.gz", ".parquet", ".mcap"])
def test_files_come_back(tmp_path, ending):
    time, q, dq, tau = arrays()
    log = tribo.Log.from_arrays(time, q, tau, dq)
    path = tmp_path / f"log{ending}"
    log.write(path)
    back = tribo.read_log(path)
    assert (back.quantity("q") == q).all() and (back.quantity("tau") == tau).all()
    assert "400" in back.summary()


def test_velocity_is_worked_out():
    time, q, dq, tau = arrays()
    log = tribo.Log.from_arrays(time, q, tau)
    inner = slice(10, -10)
    np.testing.assert_allclose(log.quantity("dq")[inner], dq[inner], atol=1e-3)


def test_frames_come_back():
    pandas = pytest.importorskip("pandas")
    time, q, dq, tau = arrays()
    frame = tribo.log_to_pandas(tribo.Log.from_arrays(time, q, tau, dq))
    assert list(frame.columns[:2]) == ["q_0", "q_1"] and frame.index.name == "time"
    again = tribo.log_from_pandas(frame)
    assert (again.quantity("q") == q).all() and (again.time == time).all()
    with pytest.raises(ValueError, match="q_3"):
        tribo.log_from_pandas(frame.drop(columns=["q_3"]))
    with pytest.raises(ValueError):
        tribo.log_from_pandas(pandas.DataFrame({"time": time}))


def test_columns_of_others_are_mapped_or_proposed():
    pandas = pytest.importorskip("pandas")
    time, q, dq, tau = arrays()
    names = [f"{kind}_{joint}" for kind in ["pos", "vel", "eff"] for joint in range(7)]
    frame = pandas.DataFrame(np.hstack([np.degrees(q), dq, tau]), columns=names)
    frame.insert(0, "stamp", 1e3 * time)
    map = "q=pos_{joint}[deg],dq=vel_{joint},tau=eff_{joint},time=stamp[ms]"
    log = tribo.log_from_pandas(frame, map=map)
    np.testing.assert_allclose(log.quantity("q"), q, atol=1e-12)
    np.testing.assert_allclose(log.time, time, atol=1e-12)
    usual = frame.rename(columns={"stamp": "time"}).assign(time=time)
    usual[names[:7]] = q
    with pytest.warns(UserWarning, match="read as .*; give map to change it"):
        proposed = tribo.log_from_pandas(usual)
    assert (proposed.quantity("tau") == tau).all()
    with pytest.raises(ValueError, match="no column of the form"):
        tribo.log_from_pandas(frame, map="q=no_such_{joint}")
    long = pandas.DataFrame(
        {
            "time": np.repeat(time, 7),
            "joint": [f"joint_{j}" for j in range(7)] * len(time),
            "position": q.ravel(),
            "velocity": dq.ravel(),
            "effort": tau.ravel(),
        }
    )
    with pytest.warns(UserWarning, match="read as"):
        assert (tribo.log_from_pandas(long).quantity("q") == q).all()


def test_wrong_logs_are_told(tmp_path):
    time, q, dq, tau = arrays()
    broken = q.copy()
    broken[3, 2] = np.nan
    with pytest.raises(ValueError, match="column q_2, row 3: NaN is not finite"):
        tribo.Log.from_arrays(time, broken, tau, dq)
    with pytest.raises(ValueError, match="row 1"):
        tribo.Log.from_arrays(0 * time, q, tau, dq)
    with pytest.raises(ValueError, match="q has shape .*; allowed: .400, columns"):
        tribo.Log.from_arrays(time, q[:-1], tau[:-1])
    with pytest.raises(ValueError, match=r"q has shape \[2800\]; allowed: \(400, columns\), a row for each of time"):
        tribo.Log.from_arrays(time, q.ravel(), tau, dq)
    with pytest.raises(ValueError, match="speed is no quantity of a log; allowed: time, q"):
        tribo.Log.from_arrays(time, q, tau, speed=q)
    with pytest.raises(FileNotFoundError, match="no_such.csv"):
        tribo.read_log(tmp_path / "no_such.csv")
    with pytest.raises(FileNotFoundError, match="nowhere"):
        tribo.Log.from_arrays(time, q, tau, dq).write(tmp_path / "nowhere" / "log.csv")
    with pytest.raises(ValueError, match="the name ends in none of"):
        tribo.Log.from_arrays(time, q, tau, dq).write(tmp_path / "log.txt")
