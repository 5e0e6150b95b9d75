"""Takes the hand off an MJCF of the FR3: without_hand.py IN.xml OUT.xml (both beside the folder meshes)."""
import sys
import xml.etree.ElementTree as xml

tree = xml.parse(sys.argv[1])
root = tree.getroot()
gone = set()
for parent in root.iter("body"):
    for body in [child for child in parent if child.tag == "body" and child.get("name") == "hand"]:
        gone |= {part.get("name") for part in body.iter() if part.get("name")}
        parent.remove(body)
# Whatever still names a part of the hand: actuators, tendons, equalities, contacts.
for section in root:
    if section.tag not in ("actuator", "tendon", "equality", "contact", "sensor", "keyframe"):
        continue
    for entry in list(section):
        named = {value for part in entry.iter() for value in part.attrib.values()}
        if section.tag == "keyframe" or named & gone or any("finger" in value or "split" in value for value in named):
            section.remove(entry)
root.find("compiler").set("meshdir", "meshes")
tree.write(sys.argv[2])
