"""Diagnosis."""

import _thread
import json
import signal
import time

import pytest
import tribo


def test_a_payload_is_named_written_and_then_nothing_is_missing(model, loaded_log, tmp_path):
    heard = []
    diagnosis = tribo.diagnose(loaded_log, model, progress=lambda stage, part: heard.append((stage, part)))
    assert (diagnosis.verdict, diagnosis.findings[0].cause) == ("named", "payload")
    assert diagnosis.findings[0].label == diagnosis.findings[0].raw["label"] == "payload"
    assert diagnosis.findings[0].params["mass_kg"] == pytest.approx(0.8, abs=0.02)
    assert all(0 <= part <= 1 for _, part in heard) and heard
    extended = diagnosis.extend(tmp_path / "extended.yaml")
    assert extended.to_yaml() == tribo.Model.read(tmp_path / "extended.yaml").to_yaml()
    assert tribo.diagnose(loaded_log, tmp_path / "extended.yaml").verdict == "nothing_missing"
    diagnosis.report(tmp_path / "report.html")
    assert (tmp_path / "report.html").read_text(encoding="utf-8").startswith("<!doctype html>")
    assert "a body that the model lacks" in str(diagnosis) and "<table>" in diagnosis._repr_html_()
    assert "<th>panda_joint4 (3)</th>" in diagnosis._repr_html_()
    before, after = (sum(diagnosis.rms_nm[key]) for key in ["held_out_before", "held_out_after"])
    assert after < 0.1 * before


def test_the_command_says_the_same(model, loaded_log, tmp_path, command, monkeypatch):
    monkeypatch.chdir(tmp_path)
    loaded_log.write(tmp_path / "log.csv")
    model.save(tmp_path / "model.yaml")
    said = json.loads(command("diagnose", "log.csv", "--model", "model.yaml", "--json").stdout)
    ours = tribo.diagnose("log.csv", "model.yaml").document
    assert ours == said


def test_a_wrong_log_is_refused_and_a_doubtful_one_warned_of(model, loaded_log):
    tau = loaded_log.quantity("tau")
    flipped = tribo.Log.from_arrays(loaded_log.time, loaded_log.quantity("q"), -tau, loaded_log.quantity("dq"))
    with pytest.raises(ValueError, match="opposite sign"):
        tribo.diagnose(flipped, model)
    with pytest.raises(ValueError, match="7 joints; the model has 6"):
        tribo.diagnose(loaded_log, "ur10e")
    with pytest.raises(ValueError, match="band_hz is -1; allowed: greater than 0"):
        tribo.diagnose(loaded_log, model, band_hz=-1)
    with pytest.raises(ValueError, match="no log is given"):
        tribo.diagnose([], model)


def test_control_c_ends_it(model, loaded_log):
    heard = []

    def press(stage, _part):
        heard.append(stage)
        _thread.interrupt_main()
        # Long enough for the main thread to be asked: the work must not go on after this.
        time.sleep(1.0)

    # Python in a job in the background ignores Ctrl-C unless it is told otherwise.
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        with pytest.raises(KeyboardInterrupt):
            tribo.diagnose([loaded_log, loaded_log.slice(0, 9000)], model, progress=press)
    finally:
        signal.signal(signal.SIGINT, before)
    assert len(heard) == 1
