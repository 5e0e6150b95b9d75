//! Models of MuJoCo that are not what they should be, and what is decided where they leave it open.

use tribo_robot::mjcf::{self, MjcfError};
use tribo_robot::{ChainRemark, SerialChain};

/// An arm of six hinges, each on a link of a metre, one axis after the other; `end` is in the last body.
fn arm(before: &str, end: &str, after: &str) -> String {
    let mut text = format!("<mujoco model=\"six\">{before}<worldbody><body name=\"base\" pos=\"0 0 1\">");
    for k in 1..=6 {
        let axis = if k % 2 == 1 { "0 0 1" } else { "0 1 0" };
        text += &format!(
            "\n<body name=\"link_{k}\" pos=\"0 0 0.2\"><joint name=\"joint_{k}\" axis=\"{axis}\" range=\"-90 90\"/>\
             <inertial pos=\"0 0 0.1\" mass=\"2\" diaginertia=\"0.1 0.1 0.1\"/>"
        );
    }
    text + end + &"</body>".repeat(7) + "</worldbody>" + after + "</mujoco>"
}

fn read(text: &str) -> SerialChain {
    mjcf::parse(text, None, None).expect("an arm")
}

#[test]
fn refusals_name_the_element_to_blame() {
    let changed = |from: &str, to: &str| {
        let text = arm("", "", "");
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1)
    };
    let finger = "<body name=\"finger\"><joint name=\"slide\" type=\"slide\"/><geom size=\"0.1\"/></body>";
    let cases: Vec<(String, Option<&str>, &[&str])> = vec![
        (String::new(), None, &["not MJCF"]),
        ("<mujoco>".to_owned(), None, &["not MJCF"]),
        ("<robot/>".to_owned(), None, &["<robot>", "not <mujoco>"]),
        ("<mujoco/>".to_owned(), None, &["no body"]),
        ("<!DOCTYPE x [<!ENTITY a \"b\">]><mujoco/>".to_owned(), None, &["not MJCF"]),
        ("<mujocoinclude><body/></mujocoinclude>".to_owned(), None, &["part that another file includes"]),
        (format!("<mujoco>{}", "<a>".repeat(100_000)), None, &["nested"]),
        (arm("<include file=\"more.xml\"/>", "", ""), None, &["more.xml", "was not read"]),
        (
            changed("<inertial pos=\"0 0 0.1\" mass=\"2\" diaginertia=\"0.1 0.1 0.1\"/>", ""),
            None,
            &["joint_1", "moves no mass", "link_1"],
        ),
        (
            changed(
                "<inertial pos=\"0 0 0.1\" mass=\"2\" diaginertia=\"0.1 0.1 0.1\"/>",
                "<geom name=\"hull\" mesh=\"hull\"/>",
            ),
            None,
            &["link_1", "geom `hull` of body `link_1`", "<inertial>"],
        ),
        (changed("mass=\"2\"", "mass=\"-2\""), None, &["inertial of body `link_1`", "mass is -2", "0 to 1e6"]),
        (changed("mass=\"2\"", "mass=\"NaN\""), None, &["mass", "one number"]),
        (changed("diaginertia=\"0.1 0.1 0.1\"", "diaginertia=\"0.1 0.1\""), None, &["diaginertia", "three numbers"]),
        (
            changed("diaginertia=\"0.1 0.1 0.1\"", "fullinertia=\"0.1 0.1 -0.1 0 0 0\""),
            None,
            &["positive semi-definite"],
        ),
        (
            changed("axis=\"0 0 1\"", "axis=\"0 0 0\""),
            None,
            &["joint `joint_1` of body `link_1`", "axis", "a direction"],
        ),
        (changed("axis=\"0 0 1\"", "class=\"nowhere\""), None, &["class", "nowhere", "<default>"]),
        (changed("axis=\"0 0 1\"", "type=\"ball\""), None, &["`joint_1` is a ball joint"]),
        (changed("axis=\"0 1 0\"", "type=\"slide\""), None, &["`joint_2` is prismatic"]),
        (changed("range=\"-90 90\"", "range=\"90 -90\""), None, &["joint_1", "range", "lower below upper"]),
        (changed("range=\"-90 90\"", "damping=\"-1\""), None, &["damping is -1", "0 or above"]),
        (
            changed("<joint name=\"joint_1\"", "<joint name=\"other\"/><joint name=\"joint_1\""),
            None,
            &["one of several joints of its body"],
        ),
        (changed("name=\"link_2\"", "name=\"link_1\""), None, &["body `link_1` is there twice"]),
        (changed("name=\"joint_2\"", "name=\"joint_1\""), None, &["joint `joint_1` is there twice"]),
        (changed("name=\"link_2\"", "name=\"l\u{9b}2J\""), None, &["control character"]),
        (arm("<compiler angle=\"grad\"/>", "", ""), None, &["compiler", "grad", "radian or degree"]),
        (arm("<compiler settotalmass=\"5\"/>", "", ""), None, &["settotalmass is not supported"]),
        (arm("<compiler eulerseq=\"abc\"/>", "", ""), None, &["eulerseq"]),
        (arm("", "<attach model=\"hand\"/>", ""), None, &["<attach> in body `link_6`"]),
        (arm("", finger, ""), Some("finger"), &["`slide` is prismatic", "did you mean `link_6`?"]),
        (arm("", "", ""), Some("link_5"), &["5 joints", "`link_5`", "6 or 7"]),
        (arm("", "", ""), Some("link"), &["tip_link `link`", "did you mean `link_1`"]),
        (arm("", "", "<actuator><motor joint=\"joint_1\" gear=\"a\"/></actuator>"), None, &["gear", "numbers"]),
    ];
    for (text, tip, parts) in cases {
        let message = mjcf::parse(&text, None, tip).expect_err(&text).to_string();
        for part in parts {
            assert!(message.contains(part), "{message:?} lacks {part:?}");
        }
        assert!(!message.contains(|letter: char| letter.is_control()), "{message:?}");
    }
}

#[test]
fn what_is_meant_to_be_mjcf_is_told_from_urdf() {
    for (text, expected) in [
        ("<mujoco/>", true),
        ("\u{feff}<?xml version=\"1.0\"?>\n<!-- <robot> of a@b <b@c> --><!-- more -->\n<mujoco model=\"a\">", true),
        ("<mujocoinclude/>", true),
        ("<?xml version=\"1.0\"?><!-- <mujoco> --><robot name=\"mujoco\"/>", false),
        ("<!-- <mujoco>", false),
        ("<!-->", false),
        ("", false),
        ("mujoco", false),
    ] {
        assert_eq!(mjcf::is_mjcf(text), expected, "{text}");
    }
}

#[test]
fn torque_limits_are_those_of_the_drives() {
    let drives = "<default><motor ctrlrange=\"-50 50\"/></default>";
    let list = "<actuator><motor joint=\"joint_1\"/><motor joint=\"joint_2\" gear=\"-3\"/>\
                <position joint=\"joint_3\" forcerange=\"-7 7\" gear=\"2\"/><general joint=\"joint_4\" gainprm=\"0.5\"/>\
                <motor joint=\"joint_5\"/><motor joint=\"joint_5\" forcerange=\"-4 5\"/><position joint=\"joint_6\"/></actuator>";
    let text = arm(drives, "", list).replace("name=\"joint_2\"", "name=\"joint_2\" actuatorfrcrange=\"-20 30\"");
    // A motor's own friction and inertia go through the gear twice (qfrc_passive of MuJoCo 4.0 says so for the damping).
    let text = text.replace("gear=\"-3\"", "gear=\"-3\" damping=\"0.2\" armature=\"0.1\"");
    let chain = read(&text);
    let arm = chain.arm::<6>().expect("six joints");
    assert!((arm.viscous_nm_s_per_rad[1] - 1.8).abs() < 1e-15 && (arm.arm.rotor_inertia_kg_m2[1] - 0.9).abs() < 1e-15);
    let limits = chain.arm::<6>().expect("six joints").arm.limits;
    assert_eq!(limits.tau_max_nm.as_slice()[..5], [50.0, 20.0, 14.0, 25.0, 54.0]);
    assert!(limits.tau_max_nm[5].is_finite() && limits.tau_max_nm[5] > 0.0);
    let unknown = chain.remarks().into_iter().find_map(|remark| match remark {
        ChainRemark::NoTorqueLimit { joints } => Some(joints),
        _ => None,
    });
    assert_eq!(unknown, Some(vec!["joint_6".to_owned()]));
}

#[test]
fn the_flange_is_a_site_and_the_base_carries_the_first_joint() {
    let site = "<site name=\"wrist_attachment_site\" pos=\"0 0 0.3\"/><site name=\"other\" pos=\"0 0 0.4\"/>";
    let text =
        arm("<option gravity=\"0 0 -1.62\"/>", site, "").replace("pos=\"0 0 1\"", "pos=\"0 0 1\" euler=\"180 0 0\"");
    let height = |tip| {
        mjcf::parse(&text, None, tip).expect("an arm").arm::<6>().expect("six").arm.link_from_flange_translation.norm()
    };
    assert_eq!([height(None), height(Some("other")), height(Some("link_6"))], [0.3, 0.4, 0.0]);
    let arm = read(&text).arm::<6>().expect("six").arm;
    // In the axes of the base, which hangs upside down.
    assert!((arm.gravity_m_s2 - nalgebra::Vector3::new(0.0, 0.0, 1.62)).amax() < 1e-15);
    assert_eq!(arm.placements[0].translation.z, 0.2);
    let from_world = mjcf::parse(&text, Some("world"), None).expect("an arm").arm::<6>().expect("six").arm;
    assert_eq!(from_world.gravity_m_s2.z, -1.62);
    assert!((from_world.placements[0].translation.z - 0.8).abs() < 1e-15);
}

#[test]
fn includes_are_read_once_and_in_place() {
    let whole = arm("<compiler angle=\"radian\"/>", "<site name=\"flange\" pos=\"0 0 1\"/>", "");
    let main = whole.replace("<compiler angle=\"radian\"/>", "<include file=\"settings.xml\"/>");
    let main = main.replace("<site name=\"flange\" pos=\"0 0 1\"/>", "<include file=\"parts/tool.xml\"></include>");
    let mut read_file = |file: &str| match file {
        "settings.xml" => Ok("<mujoco><compiler angle=\"radian\"/><include file=\"empty.xml\"/></mujoco>".to_owned()),
        "parts/tool.xml" => {
            Ok("<?xml version=\"1.0\"?><mujocoinclude>\n<site name=\"flange\" pos=\"0 0 1\"/></mujocoinclude>"
                .to_owned())
        }
        "empty.xml" => Ok("<mujocoinclude/>".to_owned()),
        "twice.xml" => Ok("<mujocoinclude><include file=\"twice.xml\"/></mujocoinclude>".to_owned()),
        _ => Err("no such file".to_owned()),
    };
    let text = mjcf::with_includes(&main, &mut read_file).expect("one text");
    assert_eq!(read(&text).arm::<6>(), read(&whole).arm::<6>());
    // An include inside of an include goes with it.
    let nested = main.replace(
        "<include file=\"settings.xml\"/>",
        "<include file=\"settings.xml\"> <include file=\"lost.xml\"/> </include>",
    );
    assert_eq!(mjcf::with_includes(&nested, &mut read_file).expect("one text"), text);
    for (file, expected) in [("lost.xml", "no such file"), ("twice.xml", "included twice"), ("", "names no file")] {
        let text = arm(&format!("<include file=\"{file}\"/>"), "", "");
        let error = mjcf::with_includes(&text, &mut read_file).expect_err(file);
        assert!(matches!(&error, MjcfError::Include { message, .. } if message == expected), "{error}");
    }
}

/// Whatever happens to a file, it is read or refused, and what is read has finite numbers.
#[test]
fn no_mutation_brings_it_down() {
    let settings = "<compiler balanceinertia=\"true\" eulerseq=\"XyZ\"/><include file=\"a\"/>\
                    <default><joint armature=\"0.1\" damping=\"1\"/><default class=\"c\"><geom density=\"900\"/></default></default>";
    let end = "<frame euler=\"1 2 3\"><geom class=\"c\" type=\"capsule\" fromto=\"0 0 0 0 0 1\" size=\"0.1\"/></frame>\
               <body quat=\"1 0 0 1\"><joint name=\"finger\" type=\"slide\"/><geom type=\"box\" size=\"0.1 0.1 0.1\"/></body>";
    let text = arm(settings, end, "<actuator><motor joint=\"joint_1\" ctrlrange=\"-9 9\" gear=\"2\"/></actuator>")
        .into_bytes();
    let mut state = 0x2545_F491_4F6C_DD1D_u64;
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
        b"<include file=\"a\"/>",
        b"<!--",
        b" class=\"c\"",
        b"<frame>",
    ];
    let mut read = 0;
    for _ in 0..4000 {
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
                    bytes.splice(at..at, spices[random(spices.len())].iter().copied());
                }
                _ => bytes.truncate(at.max(1)),
            }
        }
        let whole = mjcf::with_includes(&String::from_utf8_lossy(&bytes), &mut |_| Ok("<mujocoinclude/>".to_owned()));
        let chain = whole.and_then(|text| mjcf::parse(&text, None, None));
        if let Some(described) = chain.ok().and_then(|chain| chain.arm::<6>()) {
            read += 1;
            let arm = described.arm;
            let numbers = arm.links.iter().flat_map(|link| link.com_m.iter().chain(link.inertia_kg_m2.iter()));
            assert!(numbers.chain(arm.limits.tau_max_nm.iter()).all(|x| x.is_finite()));
            assert!(arm.placements.iter().all(|placement| placement.rotation.iter().all(|x| x.is_finite())));
        }
    }
    assert!(read > 100, "only {read} of 4000 could still be read: the mutations are too coarse to test anything");
}
