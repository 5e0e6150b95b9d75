//! Where the arm is in a robot description.

use clap::Args;

/// Ends of the arm in a robot description.
#[derive(Clone, Debug, Default, Args)]
pub struct Ends {
    /// Where the arm begins: a link of the URDF or a body of the MJCF that --robot names [default: the root of a URDF; the body that
    /// carries the first joint of an MJCF; below a rail or wheels].
    #[arg(long, value_name = "LINK", requires = "robot")]
    pub base_link: Option<String>,
    /// Where the arm ends, whose frame is the flange: a link of the URDF, a body or site of the MJCF that --robot names [default:
    /// where a gripper begins, else the last link, tool0 or attachment_site].
    #[arg(long, value_name = "LINK", requires = "robot")]
    pub tip_link: Option<String>,
}
