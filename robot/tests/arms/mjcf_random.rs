//! Random models of MuJoCo, written here, against MuJoCo.

use std::fmt::Write;

use serde_json::{Value, json};
use tribo_robot::mjcf;

use crate::python_witness::{answer, python};
use crate::witness::{MUJOCO, hold, question};

/// Models that are tried.
const MODELS: u64 = 60;
/// Two double-precision algorithms, and MuJoCo's iterative search for principal axes (1e-12).
const TOLERANCE: f64 = 1e-9;

/// xorshift64: the same models in every run.
struct Draws(u64);

impl Draws {
    fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 % n as u64) as usize
    }

    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.below(1 << 20) as f64 / f64::from(1 << 20)
    }

    fn numbers(&mut self, count: usize, low: f64, high: f64) -> String {
        (0..count).map(|_| format!("{:.6}", self.within(low, high))).collect::<Vec<_>>().join(" ")
    }
}

/// One model, and the switches that it was written with.
struct Writer {
    draws: Draws,
    degrees: bool,
    text: String,
}

impl Writer {
    fn angle(&mut self, low: f64, high: f64) -> f64 {
        let angle = self.draws.within(low, high);
        if self.degrees { angle.to_degrees() } else { angle }
    }

    fn orientation(&mut self) -> String {
        match self.draws.below(6) {
            0 => format!("quat=\"{}\"", self.draws.numbers(4, 0.1, 1.0)),
            1 => format!("euler=\"{} {} {}\"", self.angle(-3.0, 3.0), self.angle(-3.0, 3.0), self.angle(-3.0, 3.0)),
            2 => format!("axisangle=\"{} {}\"", self.draws.numbers(3, 0.1, 1.0), self.angle(-3.0, 3.0)),
            3 => format!("xyaxes=\"1 {} 1 {}\"", self.draws.numbers(3, -0.5, 0.4), self.draws.within(-0.5, 0.5)),
            4 => format!("zaxis=\"{}\"", self.draws.numbers(3, -1.0, -0.1)),
            _ => String::new(),
        }
    }

    fn pose(&mut self) -> String {
        format!("pos=\"{}\" {}", self.draws.numbers(3, -0.3, 0.3), self.orientation())
    }

    /// A geom of any primitive, of a class or with its own numbers, and some that weigh nothing.
    fn geom(&mut self) {
        let kind = ["sphere", "capsule", "cylinder", "box", "ellipsoid"][self.draws.below(5)];
        let size = self.draws.numbers(3, 0.02, 0.09);
        let place = match self.draws.below(3) {
            0 if kind != "sphere" => format!("fromto=\"{}\"", self.draws.numbers(6, -0.2, 0.2)),
            _ => self.pose(),
        };
        let weight = match self.draws.below(4) {
            0 => format!("mass=\"{}\"", self.draws.within(0.1, 2.0)),
            1 => format!("density=\"{}\"", self.draws.within(100.0, 4000.0)),
            2 => "class=\"heavy\"".to_owned(),
            _ => String::new(),
        };
        let group = ["", "group=\"1\"", "group=\"4\""][self.draws.below(3)];
        let _ = writeln!(self.text, "<geom type=\"{kind}\" size=\"{size}\" {place} {weight} {group}/>");
        let _ = match self.draws.below(4) {
            0 => writeln!(self.text, "<geom class=\"visual\" size=\"0.3\"/>"),
            1 => writeln!(self.text, "<geom type=\"sphere\" mass=\"0\" size=\"0.3\"/>"),
            _ => Ok(()),
        };
    }

    /// What a body weighs: an inertial in one of its forms, or geoms.
    fn weight(&mut self) {
        let (pose, mass) = (self.pose(), self.draws.within(0.3, 4.0));
        let at = pose.split_inclusive('"').take(2).collect::<String>();
        match self.draws.below(3) {
            0 => {
                let moments = self.draws.numbers(3, 0.02, 0.035);
                let _ = writeln!(self.text, "<inertial {pose} mass=\"{mass}\" diaginertia=\"{moments}\"/>");
            }
            1 => {
                let (moments, products) = (self.draws.numbers(3, 0.03, 0.04), self.draws.numbers(3, -0.004, 0.004));
                let _ = writeln!(self.text, "<inertial {at} mass=\"{mass}\" fullinertia=\"{moments} {products}\"/>");
            }
            _ => {
                self.geom();
                self.geom();
                let _ = writeln!(self.text, "<geom size=\"0.05\"/>");
            }
        }
        // Beside an inertial it counts for nothing, unless the compiler says so.
        self.geom();
    }

    fn joint(&mut self, k: usize) {
        let range = (self.angle(-2.5, -0.5), self.angle(0.5, 2.5));
        let class = ["", "class=\"strong\"", "class=\"stronger\""][self.draws.below(3)];
        let anchor =
            [String::new(), format!("pos=\"{}\"", self.draws.numbers(3, -0.1, 0.1))][self.draws.below(2)].clone();
        let reference = [String::new(), format!("ref=\"{}\"", self.angle(-0.4, 0.4))][self.draws.below(2)].clone();
        let own = [String::new(), format!("armature=\"{}\"", self.draws.within(0.0, 0.3))][self.draws.below(2)].clone();
        let axis =
            [String::new(), format!("axis=\"{}\"", self.draws.numbers(3, 0.1, 1.0))][self.draws.below(2)].clone();
        let limit = ["", "limited=\"true\""][self.draws.below(2)];
        let _ = writeln!(
            self.text,
            "<joint name=\"turn_{k}\" {class} {anchor} {axis} {reference} {own} {limit} range=\"{} {}\"/>",
            range.0, range.1
        );
    }
}

/// A model of an arm with six or seven joints on a turned pedestal, a gripper at its end.
fn model(seed: u64) -> String {
    let draws = Draws(0x9E37_79B9_7F4A_7C15 ^ (seed + 1).wrapping_mul(0xD134_2543_DE82_EF95));
    let mut it = Writer { draws, degrees: false, text: String::new() };
    let joints = 6 + it.draws.below(2);
    let angle = [" angle=\"radian\"", " angle=\"degree\"", ""][it.draws.below(3)];
    it.degrees = angle != " angle=\"radian\"";
    let sequence = ["", " eulerseq=\"zyx\"", " eulerseq=\"XYZ\"", " eulerseq=\"xYz\""][it.draws.below(4)];
    let inertia = ["", " inertiagrouprange=\"0 3\"", " boundmass=\"0.8\"", " boundinertia=\"0.03\""][it.draws.below(4)];
    let balance = ["", " balanceinertia=\"true\""][it.draws.below(2)];
    let gravity =
        ["".to_owned(), format!("<option gravity=\"{}\"/>", it.draws.numbers(3, -9.0, 9.0))][it.draws.below(2)].clone();
    let _ = writeln!(
        it.text,
        "<mujoco model=\"random {seed}\">\n<compiler{angle}{sequence}{inertia}{balance} autolimits=\"true\"/>\n{gravity}\n\
         <default><geom density=\"1200\"/><joint damping=\"0.3\"/>\n\
         <default class=\"strong\"><joint armature=\"0.1\" frictionloss=\"0.7\" damping=\"0.9\"/>\n\
         <default class=\"stronger\"><joint axis=\"0 1 0.5\" armature=\"0.2\"/><motor gear=\"3\" forcerange=\"-5 4\"/></default></default>\n\
         <default class=\"heavy\"><geom density=\"3000\"/></default>\n\
         <default class=\"visual\"><geom type=\"sphere\" mass=\"0\" group=\"2\"/></default></default>\n<worldbody>"
    );
    let _ = writeln!(
        it.text,
        "<geom type=\"plane\" size=\"1 1 1\"/><body name=\"ball\" pos=\"3 0 0\"><freejoint/><geom size=\"0.1\"/></body>"
    );
    let pose = it.pose();
    let _ = writeln!(it.text, "<body name=\"pedestal\" {pose}>");
    it.geom();
    let mut ends = Vec::new();
    for k in 0..joints {
        let (pose, class) = (it.pose(), ["", "childclass=\"strong\"", "childclass=\"stronger\""][it.draws.below(3)]);
        let frame = it.pose();
        let framed = it.draws.below(3) == 0;
        if framed {
            let _ = writeln!(it.text, "<frame {frame}>");
        }
        let _ = writeln!(it.text, "<body name=\"link_{k}\" {pose} {class}>");
        it.joint(k);
        it.weight();
        let welded = it.pose();
        let _ = writeln!(it.text, "<frame {frame}><geom size=\"0.03\" pos=\"0.1 0 0\"/></frame>\n<body {welded}>");
        it.weight();
        let _ = writeln!(it.text, "</body>");
        ends.push(if framed { "</body></frame>" } else { "</body>" });
    }
    let (flange, finger) = (it.pose(), it.pose());
    let _ = writeln!(it.text, "<site name=\"flange\" {flange}/>");
    for side in ["left", "right"] {
        let _ =
            writeln!(it.text, "<body name=\"{side}\" {finger}><joint name=\"{side}\" type=\"slide\" ref=\"0.01\"/>");
        it.weight();
        let _ = writeln!(it.text, "</body>");
    }
    it.text.extend(ends.into_iter().rev());
    let _ = writeln!(it.text, "</body></worldbody><actuator>");
    for k in 0..joints {
        let class = ["", "class=\"stronger\""][it.draws.below(2)];
        let own = [
            String::new(),
            format!("armature=\"{:.4}\" gear=\"{:.3}\"", it.draws.within(0.0, 0.01), it.draws.within(-9.0, 9.0)),
        ][it.draws.below(2)]
        .clone();
        let _ = writeln!(it.text, "<motor name=\"drive_{k}\" joint=\"turn_{k}\" ctrlrange=\"-20 20\" {class} {own}/>");
    }
    let _ = writeln!(it.text, "</actuator></mujoco>");
    it.text
}

#[test]
fn random_models_are_what_mujoco_makes_of_them() {
    let Some(python) = python("mujoco,numpy", "nothing compares models of MuJoCo with MuJoCo") else { return };
    let (mut names, mut questions) = (Vec::new(), Vec::new());
    for seed in 0..MODELS {
        let text = model(seed);
        let chain = mjcf::parse(&text, None, None).unwrap_or_else(|error| panic!("{seed}: {error}"));
        names.push(format!("model {seed}"));
        questions.push(question(&chain, json!({"text": text, "base": "pedestal", "site": "flange"})));
    }
    hold(&names, &answer(&python, MUJOCO, &Value::from(questions)), TOLERANCE);
}
