"""Tuning: simulated, and by ask and tell."""

import json

import numpy as np
import pytest
import tribo


def test_a_campaign_in_memory_is_the_command_s(tmp_path, command):
    ours = tribo.tune(trials=3)
    assert ours.best_cost < 0.2 * ours.uncompensated_cost and len(ours.trials) == 3
    assert ours.compensator.parameters[1]["coulomb_nm"] == pytest.approx(0.9, rel=0.05)
    said = json.loads(command("tune", "--trials", 3, "--out", "campaign", "--json", "--quiet").stdout)
    for document in (said, ours.document):
        document.pop("wall_s")
    assert said == ours.document
    on_disk = tribo.tune(trials=3, out=tmp_path / "again")
    assert (tmp_path / "again" / "tuned.yaml").read_text() == (tmp_path / "campaign" / "tuned.yaml").read_text()
    assert on_disk.compensator.to_yaml() == tribo.Compensator.read(tmp_path / "again" / "tuned.yaml").to_yaml()


def test_a_compensator_cancels_friction():
    compensator = tribo.tune(trials=2).compensator
    torque = compensator.torque(np.full(7, 0.5))
    known = [joint["coulomb_nm"] + 0.5 * joint["viscous_nm_s_per_rad"] for joint in compensator.parameters]
    np.testing.assert_allclose(torque, known, rtol=1e-9)
    assert (compensator.torque(np.zeros(7)) == 0).all()
    np.testing.assert_allclose(compensator.torque(np.zeros(7), np.full(7, 0.5)), known, rtol=1e-9)
    assert compensator.velocity == "hybrid"
    with pytest.raises(ValueError, match="dq has 6 numbers"):
        compensator.torque(np.zeros(6))


def test_settings_that_there_are_not_are_told():
    with pytest.raises(ValueError, match="trails"):
        tribo.tune(trails=3)
    with pytest.raises(ValueError, match="allowed"):
        tribo.tune(trials=0)
    with pytest.raises(ValueError, match="robot"):
        tribo.tune(robot="no_such_robot")


def test_ask_and_tell_with_the_simulated_robot_of_the_command(tmp_path, command):
    campaign = tribo.Campaign(tmp_path / "mine", user_trials={"torque": "commanded"})
    costs = []
    for _ in range(3):
        trial = campaign.ask()
        assert campaign.running == [trial.number]
        trial.compensator.save(tmp_path / "next.yaml")
        command("simulate", "--compensation", "next.yaml", "--seed", trial.number + 1, "--log", "trial.csv")
        told = campaign.tell(tmp_path / "trial.csv", trial)
        costs.append(told.cost)
    assert costs[-1] < 0.25 * costs[0] and campaign.finished == [0, 1, 2]
    assert campaign.compensator.parameters[1]["coulomb_nm"] == pytest.approx(0.9, rel=0.1)
    assert told.best["cost"] < 0.25 * costs[0]
    # The command sees the same campaign.
    assert "trial 3" in command("ask", "mine", "--anyway").stderr
    again = tribo.Campaign(tmp_path / "mine")
    assert again.running == [3] and again.asked(3).number == 3
    again.give_up(3)
    again.withdraw(2, "the arm was touched")
    assert again.finished == [0, 1]
    with pytest.raises(ValueError, match="keeps the settings it began with"):
        tribo.Campaign(tmp_path / "mine", trials=9)


def test_a_log_that_cannot_be_the_trial_s_is_refused(tmp_path, command):
    campaign = tribo.Campaign(tmp_path / "mine")
    trial = campaign.ask()
    trial.compensator.save(tmp_path / "next.yaml")
    command("simulate", "--compensation", "next.yaml", "--log", "trial.csv")
    log = tribo.read_log(tmp_path / "trial.csv")
    standing = tribo.Log.from_arrays(log.time, 0 * log.quantity("q") + log.quantity("q")[0], log.quantity("tau"), tau_desired=log.quantity("tau_desired"))
    with pytest.raises(ValueError):
        campaign.tell(standing, trial)
    with pytest.raises(ValueError, match="no log, and no reason"):
        campaign.tell()
    assert campaign.running == [0]
    assert campaign.tell(failed="somebody pressed stop").trial == 0
