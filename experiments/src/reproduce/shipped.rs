//! The settings that ship with the experiments, as text: what `tribo reproduce` takes without `--config`.

/// Of [`super::Roveda2022`].
pub const ROVEDA2022: &str = include_str!("../../01_roveda2022/config.yaml");

/// Of [`super::Linderoth2013`].
pub const LINDEROTH2013: &str = include_str!("../../02_linderoth2013/config.yaml");

/// Of [`super::Simoni2017`].
pub const SIMONI2017: &str = include_str!("../../03_simoni2017/config.yaml");

/// Of [`super::Simoni2019`].
pub const SIMONI2019: &str = include_str!("../../04_simoni2019/config.yaml");

/// Of [`super::uhlmann2023::Uhlmann2023`].
pub const UHLMANN2023: &str = include_str!("../../05_uhlmann2023/config.yaml");

/// Of [`super::PushedTool`].
pub const WRENCH_PULSES: &str = include_str!("../../07_wrench_pulses/config.yaml");

/// Of [`super::OverCompensation`].
pub const OVERCOMPENSATION: &str = include_str!("../../09_overcompensation/config.yaml");
