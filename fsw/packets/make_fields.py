#!/usr/bin/env python3
"""Generates visitors of all fields of all messages from their definitions: make_fields.py vbar.lcm fields.h explained_codes.h

explained_codes.h has the comments of all constants that are values of fields; one without a comment is an error.

The notation of comments that name units, elements of arrays and codes is explained in vbar.lcm. A field whose name
already ends in its unit (`range_m`) keeps its place for the names of elements: `range_m[2]` with elements x and y has the
columns range_x_m and range_y_m.
"""
import re
import sys
from pathlib import Path

STRUCT = re.compile(r"struct (\w+) \{\n(.*?)\n\}", re.S)
CONSTANT = re.compile(r"  const \w+ (k[A-Z]\w*)\s*=\s*-?\w+;\s*(?://(.*))?$")
FIELD = re.compile(r"  (\w+) (\w+)(\[\d+\])?;\s*(?://(.*))?$")
UNIT = re.compile(r"\[([^];]*)(?:;([^]]*))?\]\s*$")
CODES = re.compile(r"\{(\|?)(?:(\w+)\.)?(k\w+)\}\s*$")
UNITS_IN_NAMES = ("m", "m2", "px", "px2", "dn", "s", "ns", "rad", "kgm2", "mps", "radps")


def literal(text):
    """A text as a literal of C++."""
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


def words_of(name, prefix):
    """kModeStationKeeping with the prefix kMode: station_keeping."""
    return re.sub(r"(?<!^)(?=[A-Z])", "_", name[len(prefix):]).lower()


def structs_of(text):
    """{struct: ([(constant, comment)], [(field, comment)])}"""
    found = {}
    for struct, body in STRUCT.findall(text):
        constants, fields = [], []
        last = None  # constant or field, whose comment a line of comment continues
        for line in body.split("\n"):
            if line.strip().startswith("//"):
                if last:
                    last[1] += line.strip()[2:]
            elif match := CONSTANT.match(line):
                constants.append(last := [match[1], match[2] or ""])
            elif match := FIELD.match(line):
                fields.append(last := [match[2], match[4] or ""])
            elif line.strip():
                sys.exit(f"struct {struct}: not understood: {line}")
        found[struct] = constants, fields
    return found


def code_table_of(struct, comment, structs):
    """(bits, struct that owns the constants, their prefix, [(constant, its comment)]) of a field; None without codes."""
    match = CODES.search(comment)
    if not match:
        return None
    bits, owner, prefix = match[1], match[2] or struct, match[3]
    constants = [(name, text) for name, text in structs[owner][0] if name.startswith(prefix)]
    if not constants:
        sys.exit(f"struct {struct}: no constant {owner}.{prefix}...")
    return bits, owner, prefix, constants


def codes_of(struct, comment, structs, tables):
    """The initialiser of Field::codes."""
    found = code_table_of(struct, comment, structs)
    if not found:
        return "{}"
    bits, owner, prefix, constants = found
    table = f"{owner}_{prefix}"
    rows = ", ".join(f'{{{owner}::{name}, "{words_of(name, prefix)}"}}' for name, _ in constants)
    tables[table] = f"inline constexpr Code {table}[] = {{{rows}}};\n"
    return f"{{codes::{table}, {len(constants)}, {'true' if bits else 'false'}}}"


def field_of(struct, name, comment, structs, tables):
    """The initialiser of a Field."""
    match = UNIT.search(comment)
    unit = (match[1] if match else "").strip().replace("/", "p")
    elements = (match[2] or "").split() if match else []
    stem, _, last = name.rpartition("_")
    if last in UNITS_IN_NAMES and unit in ("", last):
        unit = last
    else:
        stem = name
    names = "nullptr"
    if elements:
        table = f"{struct}_{name}"
        tables[table] = f"inline constexpr const char* {table}[] = {{" + ", ".join(f'"{e}"' for e in elements) + "};\n"
        names = f"codes::{table}"
    codes = codes_of(struct, comment, structs, tables)
    meaning = CODES.sub("", UNIT.sub("", CODES.sub("", comment).rstrip()).rstrip()).strip()
    return f'Field{{"{name}", "{stem}", "{unit}", {names}, {codes}, {literal(meaning)}}}'


def header(structs):
    tables, visitors = {}, ""
    for struct, (_, fields) in structs.items():
        lines = "".join(f"  visit({field_of(struct, name, comment, structs, tables)}, message.{name});\n"
                        for name, comment in fields)
        visitors += f"""
template <MessageOf<{struct}> Message, class Visitor>
constexpr void visit_fields(Message& message, Visitor&& visit) {{
{lines}}}
"""
    includes = "".join(f"#include <vbar/{struct}.hpp>\n" for struct in sorted(structs))
    return f"""#pragma once
// Made from vbar.lcm by make_fields.py: visit_fields(message, visit) calls visit(Field, value) for every field in order.
// An array comes as a reference to all of it.
#include <type_traits>

{includes}
namespace vbar {{

struct Code {{
  int value;
  const char* word;
}};

/// What the values of a field are called; none: they are plain numbers.
struct Codes {{
  const Code* codes = nullptr;
  int count = 0;
  bool are_bits = false;
}};

struct Field {{
  const char* name;             ///< of the message's member
  const char* stem;             ///< the name without its unit
  const char* unit;             ///< as names end in it ("m", "mps"), or empty
  const char* const* elements;  ///< names of an array's elements, or null
  Codes codes;
  const char* meaning;  ///< of the comment, without what it says of unit, elements and codes
}};

/// `Message`, as one that is read or one that is written.
template <class Some, class Message>
concept MessageOf = std::is_same_v<std::remove_const_t<Some>, Message>;

namespace codes {{
{"".join(tables.values())}}}  // namespace codes
{visitors}
}}  // namespace vbar
"""


def explanations(structs):
    """The words of all codes with the comments of their constants, once each, in the order of the file."""
    rows, seen = "", set()
    for struct, (_, fields) in structs.items():
        for _, comment in fields:
            found = code_table_of(struct, comment, structs)
            if not found or found[1:3] in seen:
                continue
            _, owner, prefix, constants = found
            seen.add((owner, prefix))
            for name, text in constants:
                meaning, _, turn = (part.strip().rstrip(".") for part in text.partition("Turn:"))
                if not meaning:
                    sys.exit(f"struct {owner}: {name}: its word is printed, but no comment explains it")
                quantity = words_of(prefix, "k") or "answer"
                rows += (f'    {{{owner}::{name}, "{words_of(name, prefix)}", "{quantity}", "{owner}", {literal(meaning)}, '
                         f'{literal(turn)}}},\n')
    return f"""#pragma once
// Made from vbar.lcm by make_fields.py: what the words of codes mean.
#include <vbar/fields.h>

namespace vbar {{

struct ExplainedCode {{
  int value;
  const char* word;
  const char* quantity;  ///< whose value it is: "fault"
  const char* owner;     ///< message that defines it
  const char* meaning;   ///< and what raises it
  const char* turn;      ///< what a user can change, or empty
}};

inline constexpr ExplainedCode kExplainedCodes[] = {{
{rows}}};

}}  // namespace vbar
"""


if __name__ == "__main__":
    STRUCTS = structs_of(Path(sys.argv[1]).read_text())
    Path(sys.argv[2]).write_text(header(STRUCTS))
    Path(sys.argv[3]).write_text(explanations(STRUCTS))
