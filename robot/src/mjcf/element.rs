//! Elements with the attributes of their default classes.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use roxmltree::Node;

use super::MjcfError;

/// A node of the XML.
pub(super) type Xml<'a> = Node<'a, 'a>;

/// `<default>`: classes of attributes. The first is the one of elements without class.
#[derive(Debug)]
pub(super) struct Defaults<'a> {
    classes: Vec<Class<'a>>,
    names: BTreeMap<&'a str, usize>,
}

#[derive(Debug)]
struct Class<'a> {
    above: Option<usize>,
    /// Values by element and attribute.
    values: BTreeMap<(&'a str, &'a str), &'a str>,
}

/// An element, in a class.
#[derive(Clone, Copy, Debug)]
pub(super) struct Element<'a> {
    pub node: Xml<'a>,
    class: usize,
}

/// The name under which defaults of an element are kept: all actuators share theirs, as in MuJoCo.
fn shared_name(tag: &str) -> &str {
    match tag {
        "motor" | "position" | "velocity" | "intvelocity" | "damper" | "cylinder" | "muscle" | "adhesion" | "pid"
        | "orientation" | "dcmotor" => "general",
        tag => tag,
    }
}

impl<'a> Defaults<'a> {
    /// All classes of a model.
    pub fn of(model: Xml<'a>) -> Self {
        let mut all = Self { classes: vec![Class { above: None, values: BTreeMap::new() }], names: BTreeMap::new() };
        let tops = model.children().filter(|node| node.has_tag_name("default"));
        let mut waiting: Vec<(Xml<'a>, Option<usize>)> = tops.map(|node| (node, None)).collect();
        waiting.reverse();
        while let Some((node, above)) = waiting.pop() {
            let name = node.attribute("class");
            let class = match (above, name) {
                (None, None) => 0,
                // Whatever the outermost class is called, it is that of elements without one.
                (None, Some(name)) => *all.names.entry(name).or_insert(0),
                (Some(above), name) => {
                    all.classes.push(Class { above: Some(above), values: BTreeMap::new() });
                    let class = all.classes.len() - 1;
                    if let Some(name) = name {
                        all.names.insert(name, class);
                    }
                    class
                }
            };
            for child in node.children().filter(Node::is_element) {
                match child.has_tag_name("default") {
                    true => waiting.push((child, Some(class))),
                    false => {
                        let tag = shared_name(child.tag_name().name());
                        let values = child.attributes().map(|it| ((tag, it.name()), it.value()));
                        all.classes[class].values.extend(values);
                    }
                }
            }
        }
        all
    }

    /// A class by name.
    pub fn class(&self, name: &str) -> Result<usize, MjcfError> {
        self.names.get(name).copied().or((name == "main").then_some(0)).ok_or_else(|| MjcfError::Attribute {
            element: "an element".to_owned(),
            attribute: "class",
            value: name.escape_debug().to_string(),
            allowed: "a class of <default>",
        })
    }

    /// An element in the class that it names, else in that of the bodies around it.
    pub fn element(&self, node: Xml<'a>, childclass: usize) -> Result<Element<'a>, MjcfError> {
        let class = node.attribute("class").map_or(Ok(childclass), |name| self.class(name))?;
        Ok(Element { node, class })
    }

    /// The first of several attributes that exclude each other, and its text: the element's own, then that of its classes from
    /// the inside.
    pub fn one_of(&self, element: Element<'a>, names: &[&'static str]) -> Option<(&'static str, &'a str)> {
        let first =
            |value: &dyn Fn(&'static str) -> Option<&'a str>| names.iter().find_map(|&name| Some((name, value(name)?)));
        let tag = shared_name(element.node.tag_name().name());
        let mut classes = std::iter::successors(Some(element.class), |&class| self.classes[class].above);
        first(&|name| element.node.attribute(name))
            .or_else(|| classes.find_map(|class| first(&|name| self.classes[class].values.get(&(tag, name)).copied())))
    }

    /// The text of an attribute.
    pub fn text(&self, element: Element<'a>, name: &'static str) -> Option<&'a str> {
        self.one_of(element, &[name]).map(|(_, text)| text)
    }

    /// The numbers of an attribute.
    pub fn numbers(
        &self,
        element: Element<'a>,
        name: &'static str,
        count: RangeInclusive<usize>,
    ) -> Result<Option<Vec<f64>>, MjcfError> {
        self.text(element, name).map(|text| numbers(&called(element.node), name, text, count)).transpose()
    }

    /// The number of an attribute.
    pub fn number(&self, element: Element<'a>, name: &'static str) -> Result<Option<f64>, MjcfError> {
        Ok(self.numbers(element, name, 1..=1)?.map(|numbers| numbers[0]))
    }
}

/// What a node is called in messages.
pub(super) fn called(node: Xml<'_>) -> String {
    let tag = node.tag_name().name();
    let own = |node: Xml<'_>| match node.attribute("name") {
        Some(name) => format!("{} `{}`", node.tag_name().name(), name.escape_debug()),
        None => node.tag_name().name().to_owned(),
    };
    let body = node.ancestors().skip(1).find(|node| node.has_tag_name("body"));
    match (tag, body) {
        ("body", _) | (_, None) => own(node),
        (_, Some(body)) => format!("{} of {}", own(node), own(body)),
    }
}

/// Numbers in a text, finite all of them.
pub(super) fn numbers(
    element: &str,
    attribute: &'static str,
    text: &str,
    count: RangeInclusive<usize>,
) -> Result<Vec<f64>, MjcfError> {
    let parsed: Option<Vec<f64>> =
        text.split_whitespace().map(|part| part.parse().ok().filter(|x: &f64| x.abs() < 1e12)).collect();
    parsed.filter(|numbers| count.contains(&numbers.len())).ok_or_else(|| MjcfError::Attribute {
        element: element.to_owned(),
        attribute,
        value: format!("\"{}\"", text.escape_debug()),
        allowed: match count.into_inner() {
            (1, 1) => "one number",
            (2, 2) => "two numbers",
            (3, 3) => "three numbers",
            (4, 4) => "four numbers",
            (6, 6) => "six numbers",
            _ => "finite numbers",
        },
    })
}
