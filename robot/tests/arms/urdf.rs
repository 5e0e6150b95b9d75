//! URDFs that are not what they should be.

use tribo_robot::presets;
use tribo_robot::urdf::{UrdfChain, UrdfError, to_urdf};

/// The UR10e as a URDF, with one part replaced.
fn changed(from: &str, to: &str) -> String {
    let text = to_urdf(&presets::ur10e());
    assert!(text.contains(from), "{from} is not in\n{text}");
    text.replacen(from, to, 1)
}

fn refusal(text: &str) -> String {
    UrdfChain::parse(text, None, None).expect_err("refused").to_string()
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
    let gripper = "<link name=\"flange\"/><link name=\"finger\"/><joint name=\"grip\" type=\"prismatic\">\
                   <parent link=\"link_6\"/><child link=\"finger\"/><limit lower=\"0\" upper=\"1\" effort=\"1\" velocity=\"1\"/></joint>";
    let second_end = "<link name=\"flange\"/><link name=\"other\"/><joint name=\"other_joint\" type=\"fixed\">\
                      <parent link=\"link_6\"/><child link=\"other\"/></joint>";
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
        (changed("velocity=\"2.0943951023931953\"", "velocity=\"0\""), &["joint_1", "velocity", "above 0"]),
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
            &["2 root links", "island, link_0", "base_link"],
        ),
        (
            "<robot name=\"arm\" xmlns:xacro=\"http://ros.org/wiki/xacro\"><xacro:arm/></robot>".to_owned(),
            &["no root link", "xacro"],
        ),
        (changed("joint_2", "joint_1"), &["joint `joint_1` is there twice"]),
        (
            changed("<link name=\"flange\"/>", "<link name=\"flange\"/><link name=\"flange\"/>"),
            &["link `flange` is there twice"],
        ),
        (changed("<link name=\"flange\"/>", gripper), &["grip", "prismatic"]),
        (
            changed("<link name=\"flange\"/>", second_end),
            &["branches at link `link_6`", "`flange_joint`", "`other_joint`", "tip_link"],
        ),
        (format!("<robot name=\"deep\">{}", "<a>".repeat(100_000)), &["nested"]),
    ];
    for (text, parts) in cases {
        let message = refusal(&text);
        for part in parts {
            assert!(message.contains(part), "{message:?} lacks {part:?}");
        }
    }
}

#[test]
fn ends_choose_among_branches_and_rigid_branches_weigh() {
    let heavy = "<link name=\"flange\"/><link name=\"tool\"><inertial><mass value=\"2\"/>\
                 <inertia ixx=\"0\" ixy=\"0\" ixz=\"0\" iyy=\"0\" iyz=\"0\" izz=\"0\"/></inertial></link>\
                 <joint name=\"tool_joint\" type=\"fixed\"><origin xyz=\"0 0 0.1\"/><parent link=\"link_6\"/><child link=\"tool\"/></joint>";
    let text = changed("<link name=\"flange\"/>", heavy);
    let arm =
        |tip: &str| UrdfChain::parse(&text, Some("link_0"), Some(tip)).expect(tip).arm::<6>().expect("six joints").arm;
    let (at_flange, at_tool) = (arm("flange"), arm("tool"));
    assert_eq!(at_flange.links, at_tool.links);
    assert!((at_flange.links[5].mass_kg - 2.615).abs() < 1e-12);
    assert_eq!(at_tool.link_from_flange_translation.z, 0.1);
    assert_eq!(at_flange.link_from_flange_translation, presets::ur10e().link_from_flange_translation);
    let end = |base, tip| UrdfChain::parse(&text, base, tip).expect_err("refused");
    assert!(matches!(end(Some("nowhere"), None), UrdfError::NoSuchEnd { which: "base_link", .. }));
    assert!(matches!(end(None, Some("nowhere")), UrdfError::NoSuchEnd { which: "tip_link", .. }));
    assert!(matches!(end(Some("link_3"), Some("link_1")), UrdfError::NotConnected { .. }));
    assert!(matches!(end(Some("link_2"), Some("flange")), UrdfError::Joints { found: 4, .. }));
    assert_eq!(UrdfChain::parse(&text, None, Some("tool")).expect("a chain").arm::<7>(), None);
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
        if let Ok(chain) = UrdfChain::parse(&String::from_utf8_lossy(&bytes), None, None)
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
        UrdfChain::parse(text, None, None).expect("an arm");
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
    let error = UrdfChain::parse(&text, None, None).expect_err("no arm").to_string();
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
        let error = UrdfChain::parse(&text, None, None).expect_err("no arm").to_string();
        assert!(error.contains(expected) && !error.contains(|letter: char| letter.is_control()), "{error:?}");
    }
}
