"""Is a report one well-formed page that needs nothing else? Says what is wrong, or nothing."""

import re
import sys
import xml.etree.ElementTree as ElementTree

text = open(sys.argv[1], encoding="utf-8").read()
root = ElementTree.fromstring(text)  # every element closed, every & and < escaped
anchors = {"#" + element.attrib["id"] for element in root.iter() if "id" in element.attrib}


def outside(plot):
    """The first coordinate of a plot that lies outside its view box, or none."""
    width, height = (float(number) for number in plot.attrib["viewBox"].split()[2:])
    for element in plot.iter():
        points = [(element.attrib.get(x), element.attrib.get(y)) for x, y in
                  (("x", "y"), ("x1", "y1"), ("x2", "y2"), ("cx", "cy"))]
        points += re.findall(r"[ML](-?[\d.]+) (-?[\d.]+)", element.attrib.get("d", ""))
        for x, y in points:
            if not 0 <= float(x or 0) <= width or not 0 <= float(y or 0) <= height:
                return f"{x}, {y}"
    return None


for element in root.iter():
    for name, value in element.attrib.items():
        if element.tag == "img" and name == "src" and value.startswith("data:image/png;base64,"):
            continue  # a picture that the page contains
        if element.tag == "image" and name == "href" and value.startswith("data:image/png;base64,"):
            continue
        if element.tag == "a" and name == "href" and (value in anchors or re.fullmatch(r"\w+\.(csv|json)", value)):
            continue  # a section of the page, or a table of the same run folder
        if element.tag == "a" and name == "href" and re.fullmatch(r"runs/\w+/", value):
            continue  # the folder of a case of the same campaign
        if name in ("src", "href", "srcset", "data", "action"):
            print(f"{element.tag} refers to {value}")
        if re.search(r"\b(nan|inf)\b", value, re.IGNORECASE):
            print(f"{element.tag} {name}={value[:80]} holds no number")
    if element.attrib.get("class") == "plot" and outside(element):
        print(f"a plot has a coordinate outside its frame: {outside(element)}")
    if element.tag in ("script", "link", "iframe"):
        print(f"{element.tag} in the page")
    if re.search(r"\b(nan|inf)\b", element.text or "", re.IGNORECASE):
        print(f"{element.tag} says {element.text[:80]}")
for reference in re.findall(r"https?://\S+|@import|url\(", text):
    print(f"the page mentions {reference}")
