//! The fault campaign: what breaks on real robots is broken here on purpose, in the middle of a trial.
//!
//! | fault | what must happen | where |
//! |---|---|---|
//! | encoder silent for 20 ms | the arm does not notice, the trial ends; its J is spoiled by the step when the sensor comes back | `sensors` |
//! | encoder silent for good, one or all | fault `SensorFrozen`, safe torque | `sensors` |
//! | encoder jumps | fault `SensorJumped`, safe torque; a jump that the arm could have made is survived | `sensors` |
//! | NaN, infinity | fault `SensorNotFinite`, safe torque | `sensors`, `integration/tick_faults.rs` |
//! | samples late, twice | survived while they are few ms (J 10 in place of 3); beyond, the trial is stopped | `sensors` |
//! | noise ×10 | a compensator that believes it is withdrawn before the arm moves; the acceleration limit of a trial stops it without guard too | `sensors` |
//! | clock jumps | fault `ClockJumped`, safe torque | `sensors` |
//! | one joint with the wrong sign | stopped with a reason, at the first tick where the sign is out of range | `sensors` |
//! | torque saturation | stopped: `TorqueSaturation` | `robot` |
//! | singular pose, pose at a limit | finite torque; past the limit stopped: `JointLimit` | `robot` |
//! | compensator of 0 to 300 % | withdrawn before anybody sees it, with a reason | `robot`, `integration/compensation_guard.rs` |
//! | model of another arm | the trial ends or is stopped, nothing is unsafe | `robot` |
//! | a hand pushes with 50 N | compliant: the trial ends or is stopped, within its limits | `robot` |
//! | power fails in a trial | stopped while the arm has hardly begun to fall | `robot` |
//! | a log in degrees, ms, ns, mNm; signs turned, joints swapped or moved on, torques of noise or never written, encoder frozen, `dq` wrong, gravity left out, another robot or side of the gears | refused, or warned of, in one sentence with the column to mend | `diagnose/tests/recognise`, `cli/tests/command_line/wrong_logs.rs` |
//! | a trial in which most joints stood still | refused: what costs nothing is no trial | `cli/tests/command_line/wrong_logs.rs` |
//! | an arm that never moved | no trial; `estimate`, `diagnose` and `convert` say so and go on | `cli/tests/command_line/wrong_logs.rs` |
//! | a joint that often stands in the first trial; one that stands in all | tuned by the third, its friction given to no neighbour; named | `campaign/tests/campaigns/standing_joints.rs` |
//! | a friction law that is not the robot's | said wherever the campaign is shown, or gone over to | `cli/tests/command_line/ask_and_tell.rs` |
//! | one impossible number in a trial's log | its row is left out, and said: cost and next parameters are those of the good log | `cli/tests/command_line/taking_back.rs` |
//! | the log of another trial, or of another compensator | refused: `tau_friction` or the positions say so | `cli/tests/command_line/taking_back.rs` |
//! | every compensator is stopped; friction beyond the box | the campaign ends after five, the box is named | `campaign/tests/campaigns/standing_joints.rs` |
//! | an exported compensator is given NaN, infinity, a negative period, garbage as memory | a torque within half of the joint's largest, also with `-O3 -ffast-math`; garbage is forgotten | `export/tests/formats/bounds.rs` |
//! | a file that claims more than it holds, or unpacks without end | refused before the memory is gone | `fuzz_inputs/bombs.rs`, `logs/tests/formats/bad_parquet.rs`, `logs/tests/formats/convert.rs` |
//! | a URDF of 10 000 links, or with a link that is its own parent | read in linear time, or refused | `robot/tests/arms/urdf.rs` |
//! | `--threads` out of range; `--out` in a directory, or a report over a file, of somebody else's | refused, nothing changed | `cli/tests/command_line/streams_and_signals.rs`, `campaign_directories.rs` |
//! | names in files with control characters | shown, not obeyed | `cli/tests/command_line/control_characters.rs` |
//! | a processor from before 2013 | a sentence, exit code 2 | `cli/tests/command_line/old_processor.rs` |
//! | a motion that fails with the true friction compensated | said before the first trial, in `--json`, report and window | `cli/tests/command_line/commands.rs`, `campaign/tests/campaigns/standing_joints.rs` |
//! | a log is read from a pipe to which nobody writes | the campaign is not held meanwhile | `cli/tests/command_line/streams_and_signals.rs` |
//! | deadline missed, loop stalled | held, then stopped with the safe torque | `runtime/tests/overruns.rs` |
//! | disk full, directory read-only | exit code 2, file and reason named, nothing lost | `cli/tests/command_line/storage_faults.rs` |
//! | system clock jumps | a campaign's result does not change | `cli/tests/command_line/storage_faults.rs` |
//! | SIGKILL, SIGTERM, SIGINT | no finished trial is lost; the resumed result is the undisturbed one | `cli/tests/command_line/kill_and_resume.rs` |
//! | standard output or error full | exit code 2 and why; messages are lost, the work is not | `cli/tests/command_line/streams_and_signals.rs` |
//! | two processes begin one campaign, or study | one does, the other is refused and changes no byte | `cli/tests/command_line/campaign_directories.rs` |
//! | SIGKILL while a trial is told | told or not told; `tuned.yaml` and the report are made true by the next opening | `cli/tests/command_line/campaign_directories.rs` |
//! | campaign.yaml edited, cut, emptied; a trial's log replaced | refused, the field or the trial named | `cli/tests/command_line/campaign_directories.rs` |
//! | a log that teaches nothing; a trial told by mistake | the campaign goes on; the trial is taken back | `cli/tests/command_line/taking_back.rs` |
//! | two processes on one campaign | the second is told, the first does not notice | `cli/tests/command_line/bad_input.rs`, `ask_and_tell.rs` |
//!
//! At every tick of every story the command is finite, within the torque limits and within the rate limit of the last one; and
//! once it is stopped, the arm comes to rest, wherever sensors or motors still allow that.

mod robot;
mod sensors;
mod story;
