//! URDFs that are not what they should be.

use tribo_robot::urdf::{self, UrdfError, to_urdf};
use tribo_robot::{ChainError, presets};

/// The UR10e as a URDF, with one part replaced.
fn changed(from: &str, to: &str) -> String {
    let text = to_urdf(&presets::ur10e());
    assert!(text.contains(from), "{from} is not in\n{text}");
    text.replacen(from, to, 1)
}

fn refusal(text: &str) -> String {
    urdf::parse(text, None, None).expect_err("refused").to_string()
}

#[test]
fn refusals_name_the_joint_or_link_to_blame() {
    let joint_3 = "<joint name=\"joint_3\" type=\"revolute\">";
    let kind = |kind: &str| changed(joint_3, &joint_3.replace("revolute", kind));
    let no_mass = {
        let text = to_urdf(&presets::ur10e());
        let from = text.find("<link name=\"link_4\">").expect("link 4");
        let to = from + text[from..].find("</link>").expect("its end") + "</link>".len();
        format!("{}<link name=\"link_4\"/>{}", &text[..from], &text[to..])
    };
    let second_arm = {
        let text = to_urdf(&presets::ur10e());
        let again: String = text.lines().skip(2).collect::<Vec<_>>().join("\n").replace("</robot>", "");
        let again = again.replace("link_0", "link_00");
        let again = (1..=6).fold(again, |text, k| text.replace(&format!("link_{k}\""), &format!("link_{k}b\"")));
        let again =
            again.replace("joint_", "turn_").replace("flange_joint", "turn_f").replace("\"flange\"", "\"flange_b\"");
        let joined =
            "<joint name=\"both\" type=\"fixed\"><parent link=\"link_0\"/><child link=\"link_00\"/></joint></robot>";
        text.replace("</robot>", &format!("{again}{joined}"))
    };
    let cases: Vec<(String, &[&str])> = vec![
        ("<robot".to_owned(), &["not a URDF"]),
        ("no xml at all".to_owned(), &["not a URDF"]),
        (String::new(), &["not a URDF"]),
        (kind("prismatic"), &["`joint_3` is prismatic", "revolute"]),
        (kind("floating"), &["`joint_3` is floating"]),
        (kind("planar"), &["`joint_3` is planar"]),
        (kind("fixed"), &["5 joints", "link_0", "flange", "6 or 7"]),
        (changed("<axis xyz=\"0 0 1\"/>", "<axis xyz=\"0 0 1\"/><mimic joint=\"joint_2\"/>"), &["joint_1", "mimic"]),
        (changed("<axis xyz=\"0 0 1\"/>", "<axis xyz=\"0 0 0\"/>"), &["joint_1", "axis", "a direction"]),
        (changed("<axis xyz=\"0 0 1\"/>", "<axis xyz=\"NaN 0 1\"/>"), &["joint_1", "axis"]),
        (changed("velocity=\"2.0943951023931953\"", "velocity=\"-1\""), &["joint_1", "velocity", "above 0"]),
        (changed("effort=\"330\"", "effort=\"-1\""), &["joint_1", "effort"]),
        (changed("upper=\"3.141592653589793\"", "upper=\"-4\""), &["joint_3", "lower below upper"]),
        (changed("<mass value=\"7.369\"/>", "<mass value=\"-7.369\"/>"), &["link_1", "mass", "-7.369"]),
        (changed("<mass value=\"7.369\"/>", "<mass value=\"inf\"/>"), &["link_1", "mass"]),
        (changed("iyy=\"0.77068", "iyy=\"-0.77068"), &["link_2", "positive semi-definite"]),
        (no_mass, &["joint_4", "no mass", "link_4"]),
        (changed("<child link=\"link_2\"/>", "<child link=\"link_9\"/>"), &["joint_2", "link_9", "not there"]),
        (
            changed("<child link=\"link_3\"/>", "<child link=\"link_1\"/>"),
            &["link_1", "joint_1", "joint_3", "closed loops"],
        ),
        (changed("<parent link=\"link_0\"/>", "<parent link=\"flange\"/>"), &["0 joints", "`link_0`"]),
        (
            changed("<link name=\"flange\"/>", "<link name=\"flange\"/><link name=\"island\"/>"),
            &["2 root links", "link_0, island", "base_link"],
        ),
        (
            "<robot name=\"arm\" xmlns:xacro=\"http://ros.org/wiki/xacro\"><xacro:arm/></robot>".to_owned(),
            &["xacro arm.urdf.xacro > arm.urdf"],
        ),
        (changed("joint_2", "joint_1"), &["joint `joint_1` is there twice"]),
        (
            changed("<link name=\"flange\"/>", "<link name=\"flange\"/><link name=\"flange\"/>"),
            &["link `flange` is there twice"],
        ),
        (second_arm, &["more than one chain", "--tip-link", "`flange` or `flange_b`"]),
        (format!("<robot name=\"deep\">{}", "<a>".repeat(100_000)), &["nested"]),
    ];
    for (text, parts) in cases {
        let message = refusal(&text);
        for part in parts {
            assert!(message.contains(part), "{message:?} lacks {part:?}");
        }
    }
}

/// What many public files have at the wrist: fingers, and several frames.
#[test]
fn grippers_are_held_and_the_tool_frame_is_the_flange() {
    let finger = |name: &str, kind: &str| {
        format!(
            "<link name=\"{name}\"><inertial><mass value=\"0.1\"/><inertia ixx=\"0\" ixy=\"0\" ixz=\"0\" iyy=\"0\" iyz=\"0\" izz=\"0\"/></inertial></link>\
             <joint name=\"{name}_joint\" type=\"{kind}\"><parent link=\"link_6\"/><child link=\"{name}\"/><limit lower=\"0\" upper=\"1\" effort=\"1\" velocity=\"1\"/></joint>"
        )
    };
    let flange = "<link name=\"flange\"/>";
    let read = |more: &str, tip| urdf::parse(&changed(flange, &format!("{flange}{more}")), None, tip);
    let bare = urdf::parse(&to_urdf(&presets::ur10e()), None, None).expect("an arm").arm::<6>().expect("six");
    // Two fingers, one finger, a finger that turns, a mimic.
    for more in [
        finger("left", "prismatic") + &finger("right", "prismatic"),
        finger("left", "prismatic"),
        finger("finger", "revolute"),
        finger("a", "revolute") + &finger("b", "revolute").replace("<limit", "<mimic joint=\"a_joint\"/><limit"),
    ] {
        let chain = read(&more, None).expect("an arm");
        let arm = chain.arm::<6>().expect("six joints").arm;
        let fingers = more.matches("<link").count() as f64;
        assert!((arm.links[5].mass_kg - bare.arm.links[5].mass_kg - 0.1 * fingers).abs() < 1e-12, "{more}");
        let said: Vec<String> = chain.remarks().iter().map(ToString::to_string).collect();
        assert!(said.iter().any(|remark| remark.contains("held where the file draws them")), "{said:?}");
    }
    let frame = |name: &str, x: f64| {
        format!(
            "<link name=\"{name}\"/><joint name=\"{name}_joint\" type=\"fixed\"><origin xyz=\"{x} 0 0\"/><parent link=\"link_6\"/><child link=\"{name}\"/></joint>"
        )
    };
    let flange_x = |chain: tribo_robot::SerialChain| chain.arm::<6>().expect("six").arm.link_from_flange_translation.x;
    let two = frame("tool0", 0.5) + &frame("ee_link", 0.7);
    assert_eq!(flange_x(read(&two, None).expect("an arm")), 0.5);
    assert_eq!(flange_x(read(&two, Some("ee_link")).expect("an arm")), 0.7);
    // Without a tool frame, the last link that moves.
    assert_eq!(flange_x(read(&frame("camera", 0.3), None).expect("an arm")), 0.0);
    let error = read(&two, Some("tool")).expect_err("no such link").to_string();
    assert!(error.contains("did you mean `tool0`?"), "{error}");
    let error = read(&finger("left", "prismatic"), Some("left")).expect_err("no arm").to_string();
    assert!(error.contains("`left_joint` is prismatic") && error.contains("did you mean `link_6`?"), "{error}");
}

/// A torque and a speed of 0 are limits that nobody knows; a prefix that nobody declares is a vendor's.
#[test]
fn unknown_limits_are_assumed_and_said() {
    let text = changed("effort=\"330\"", "effort=\"0\"").replacen(
        "velocity=\"2.0943951023931953\"",
        "velocity=\"0\" drake:acceleration=\"3\"",
        1,
    );
    let chain = urdf::parse(&text, None, None).expect("an arm");
    let said: Vec<String> = chain.remarks().iter().map(ToString::to_string).collect();
    assert!(
        said[0].starts_with("no torque limit of joint_1") && said[1].starts_with("no speed limit of joint_1"),
        "{said:?}"
    );
    let arm = chain.arm::<6>().expect("six joints").arm;
    assert_eq!(arm.limits.qd_max_rad_s[0], std::f64::consts::PI);
    // Stretched out, with a vertical axis: inertia alone, of 30 kg m² at most.
    let torque = arm.limits.tau_max_nm[0];
    assert!(torque > 50.0 && torque < 300.0, "{torque}");
    assert_eq!(arm.limits.tau_max_nm[1], 330.0);
}

/// A base that is turned: gravity stays that of the root.
#[test]
fn gravity_is_the_roots() {
    let turned = "<link name=\"wall\"/><joint name=\"mount\" type=\"fixed\"><origin xyz=\"0 0 1\" rpy=\"0 1.5707963267948966 0\"/><parent link=\"wall\"/><child link=\"link_0\"/></joint><link name=\"link_0\"/>";
    let text = changed("<link name=\"link_0\"/>", turned);
    let gravity = |base| urdf::parse(&text, base, None).expect("an arm").arm::<6>().expect("six").arm.gravity_m_s2;
    assert!((gravity(None) - nalgebra::Vector3::new(0.0, 0.0, -9.81)).amax() < 1e-12);
    assert!((gravity(Some("link_0")) - nalgebra::Vector3::new(9.81, 0.0, 0.0)).amax() < 1e-12);
}

#[test]
fn ends_choose_among_branches_and_rigid_branches_weigh() {
    let heavy = "<link name=\"flange\"/><link name=\"tool\"><inertial><mass value=\"2\"/>\
                 <inertia ixx=\"0\" ixy=\"0\" ixz=\"0\" iyy=\"0\" iyz=\"0\" izz=\"0\"/></inertial></link>\
                 <joint name=\"tool_joint\" type=\"fixed\"><origin xyz=\"0 0 0.1\"/><parent link=\"link_6\"/><child link=\"tool\"/></joint>";
    let text = changed("<link name=\"flange\"/>", heavy);
    let arm = |tip: &str| urdf::parse(&text, Some("link_0"), Some(tip)).expect(tip).arm::<6>().expect("six joints").arm;
    let (at_flange, at_tool) = (arm("flange"), arm("tool"));
    assert_eq!(at_flange.links, at_tool.links);
    assert!((at_flange.links[5].mass_kg - 2.615).abs() < 1e-12);
    assert_eq!(at_tool.link_from_flange_translation.z, 0.1);
    assert_eq!(at_flange.link_from_flange_translation, presets::ur10e().link_from_flange_translation);
    let end = |base, tip| urdf::parse(&text, base, tip).expect_err("refused");
    let chain = |base, tip| match end(base, tip) {
        UrdfError::Chain(error) => error,
        other => panic!("{other}"),
    };
    assert!(matches!(chain(Some("nowhere"), None), ChainError::NoSuchEnd { which: "base_link", .. }));
    assert!(matches!(chain(None, Some("nowhere")), ChainError::NoSuchEnd { which: "tip_link", .. }));
    assert!(matches!(chain(Some("link_3"), Some("link_1")), ChainError::NotConnected { .. }));
    assert!(matches!(chain(Some("link_2"), Some("flange")), ChainError::Joints { found: 4, .. }));
    assert_eq!(urdf::parse(&text, None, Some("tool")).expect("a chain").arm::<7>(), None);
}

/// Whatever happens to a file, it is read or refused, and what is read has finite numbers.
#[test]
fn no_mutation_brings_it_down() {
    let text = to_urdf(&presets::iiwa14()).into_bytes();
    let mut state = 0x9E37_79B9_7F4A_7C15_u64;
    let mut random = move |below: usize| {
        // xorshift64: the same files in every run.
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state % below as u64) as usize
    };
    let spices: [&[u8]; 12] = [
        b"<",
        b"/>",
        b"\"",
        b"-",
        b"e999",
        b"NaN",
        b"inf",
        b"0",
        b"&",
        b"<!--",
        b"type=\"fixed\"",
        b"<joint name=\"x\" type=\"fixed\">",
    ];
    let mut read = 0;
    for _ in 0..3000 {
        let mut bytes = text.clone();
        for _ in 0..1 + random(4) {
            let at = random(bytes.len());
            match random(4) {
                0 => bytes[at] = (32 + random(95)) as u8,
                1 => {
                    let until = (at + random(200)).min(bytes.len() - 1);
                    bytes.drain(at.min(until)..until);
                }
                2 => {
                    let spice = spices[random(spices.len())];
                    bytes.splice(at..at, spice.iter().copied());
                }
                _ => bytes.truncate(at.max(1)),
            }
        }
        if let Ok(chain) = urdf::parse(&String::from_utf8_lossy(&bytes), None, None)
            && let Some(arm) = chain.arm::<7>()
        {
            read += 1;
            assert!(
                arm.arm.links.iter().all(|link| link.mass_kg.is_finite() && link.com_m.iter().all(|x| x.is_finite()))
            );
            assert!(arm.arm.placements.iter().all(|placement| placement.rotation.iter().all(|x| x.is_finite())));
        }
    }
    assert!(read > 100, "only {read} of 3000 could still be read: the mutations are too coarse to test anything");
}

/// A chain of `links` links: the first are welded by fixed joints, the last seven are an arm's.
fn long_chain(links: usize) -> String {
    let mut text = "<robot name=\"r\">\n".to_owned();
    for k in 0..links {
        text += &format!(
            "<link name=\"l{k}\"><inertial><mass value=\"1\"/><inertia ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial></link>\n"
        );
    }
    for k in 1..links {
        let kind = if k + 7 < links { "fixed" } else { "revolute" };
        text += &format!(
            "<joint name=\"j{k}\" type=\"{kind}\"><origin xyz=\"0 0 0.01\"/><parent link=\"l{}\"/><child link=\"l{k}\"/><axis xyz=\"0 0 1\"/>\
             <limit lower=\"-1\" upper=\"1\" effort=\"10\" velocity=\"1\"/></joint>\n",
            k - 1
        );
    }
    text + "</robot>\n"
}

/// The least of three times (s) that it takes to read a text.
fn seconds(text: &str) -> f64 {
    let once = || {
        let begun = std::time::Instant::now();
        urdf::parse(text, None, None).expect("an arm");
        begun.elapsed().as_secs_f64()
    };
    (0..3).map(|_| once()).fold(f64::INFINITY, f64::min)
}

/// Reading takes time in proportion to the file: eight times the links, about eight times as long. Quadratic would be 64.
#[test]
fn a_long_chain_is_read_in_linear_time() {
    let [short, long] = [1_000, 8_000].map(|links| seconds(&long_chain(links)));
    println!("1000 links in {short:.3} s, 8000 links in {long:.3} s");
    assert!(long < 24.0 * short, "{short} s, {long} s");
}

#[test]
fn a_joint_of_a_link_with_itself_is_refused() {
    let text =
        long_chain(8).replace("<parent link=\"l2\"/><child link=\"l3\"/>", "<parent link=\"l3\"/><child link=\"l3\"/>");
    let error = urdf::parse(&text, None, None).expect_err("no arm").to_string();
    assert_eq!(error, "joint `j3` has link `l3` as parent and as child");
}

/// What a terminal would obey is refused, and shown written out.
#[test]
fn names_with_control_characters_are_refused() {
    for (from, to, expected) in [
        ("\"l3\"", "\"l&#27;[2J3\"", "not a URDF"),
        ("\"j3\"", "\"j&#x9b;2J3\"", "the name of joint `j\\u{9b}2J3` has a control character"),
        ("\"l3\"", "\"l&#10;3\"", "the name of link `l\\n3` has a control character"),
        ("\"r\"", "\"r\u{9b}31m\"", "the name of robot `r\\u{9b}31m` has a control character"),
    ] {
        let text = long_chain(8).replace(from, to);
        let error = urdf::parse(&text, None, None).expect_err("no arm").to_string();
        assert!(error.contains(expected) && !error.contains(|letter: char| letter.is_control()), "{error:?}");
    }
}
