"""Is a report one well-formed page that needs nothing else? Says what is wrong, or nothing."""

import re
import sys
import xml.etree.ElementTree as ElementTree

text = open(sys.argv[1], encoding="utf-8").read()
root = ElementTree.fromstring(text)  # every element closed, every & and < escaped
for element in root.iter():
    for name, value in element.attrib.items():
        if element.tag == "img" and name == "src" and value.startswith("data:image/png;base64,"):
            continue  # a picture that the page holds itself
        if name in ("src", "href", "srcset", "data", "action"):
            print(f"{element.tag} refers to {value}")
        if re.search(r"\b(nan|inf)\b", value, re.IGNORECASE):
            print(f"{element.tag} {name}={value[:80]} holds no number")
    if element.tag in ("script", "link", "iframe"):
        print(f"{element.tag} in the page")
    if re.search(r"\b(nan|inf)\b", element.text or "", re.IGNORECASE):
        print(f"{element.tag} says {element.text[:80]}")
for outside in re.findall(r"https?://\S+|@import|url\(", text):
    print(f"the page mentions {outside}")
