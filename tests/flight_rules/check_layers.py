"""Includes of the product's C++ code against the table of rooms, layers.toml: what a room may include, and that nothing points upward.

Usage: check_layers.py ROOT              prints each include that the table does not allow, with file and line; exit status 1 if there is one
       check_layers.py ROOT --list       prints the arrows between rooms as the code has them, with the number of includes
       check_layers.py ROOT --draft      prints a table that the code would pass, floors computed; includes that close a cycle are in its comments
       check_layers.py ROOT --picture    prints the section of docs/tour.md
       check_layers.py ROOT --write      writes that section into docs/tour.md
"""

import collections
import fnmatch
import pathlib
import posixpath
import re
import sys
import tomllib

TABLE = "tests/flight_rules/layers.toml"
PAGE = "docs/tour.md"
BEGIN, END = "<!-- rooms: written by tests/flight_rules/check_layers.py --write -->", "<!-- end of rooms -->"
SUFFIXES = {".h", ".hpp", ".cpp", ".c", ".inc"}
INCLUDE = re.compile(r'^\s*#\s*include\s*"([^"]+)"')
BLOCK_COMMENT = re.compile(r"/\*.*?\*/", re.S)

Arrow = collections.namedtuple("Arrow", "path line name source target")  # an include: file, line, name; room of the file and of the header


def matches(pattern, room):
    """Whether a room is one of a pattern's: part by part, `*` within a part, `/**` at the end for the folder and all below it."""
    if pattern == "**":
        return True
    if pattern.endswith("/**"):
        return matches(pattern[:-3], "/".join(room.split("/")[:pattern.count("/")]))
    parts, others = pattern.split("/"), room.split("/")
    return len(parts) == len(others) and all(map(fnmatch.fnmatchcase, others, parts))


class Table:
    """Rooms by floors, the ground first. A key is a folder, its subfolders included unless they are keys themselves; a key with `*` stands for
    each folder that it matches, every one a room of its own."""

    def __init__(self, text):
        content = tomllib.loads(text)
        self.folders = content["folders"]
        self.floors = [floor["rooms"] for floor in content["floor"]]
        self.names = [floor["name"] for floor in content["floor"]]
        self.keys = {key: (level, may) for level, rooms in enumerate(self.floors) for key, may in rooms.items()}
        if len(self.keys) < sum(map(len, self.floors)):
            twice = [key for key, count in collections.Counter(key for rooms in self.floors for key in rooms).items() if count > 1]
            raise SystemExit(f"{TABLE}: on two floors: {', '.join(twice)}")

    def room_of(self, path):
        """(room, key) of a file; the longest matching folder counts, a folder by name before one by `*`. (None, None) if the table lacks it."""
        parts = path.split("/")[:-1]
        for length in range(len(parts), 0, -1):
            folder = "/".join(parts[:length])
            if folder in self.keys:
                return folder, folder
            for key in self.keys:
                if "*" in key and matches(key, folder):
                    return folder, key
        return None, None

    def level(self, room):
        return self.keys[self.room_of(room + "/x")[1]][0]

    def may(self, room):
        return self.keys[self.room_of(room + "/x")[1]][1]


def read_tree(root, folders):
    """Text of every source file of the product by its path."""
    files = {}
    for folder in folders:
        for path in sorted((root / folder).rglob("*")):
            if path.suffix in SUFFIXES and path.is_file():
                files[path.relative_to(root).as_posix()] = path.read_text(encoding="utf-8")
    return files


def includes_of(path, text, files):
    """(line, name, path of the header) of each include in quotes. A header that is generated has the path that the include gives."""
    text = BLOCK_COMMENT.sub(lambda comment: "\n" * comment[0].count("\n"), text)
    for number, line in enumerate(text.split("\n"), 1):
        if found := INCLUDE.match(line):
            beside = posixpath.normpath(posixpath.join(posixpath.dirname(path), found[1]))
            yield number, found[1], beside if beside in files else posixpath.normpath(found[1])


def arrows_of(table, files):
    """The includes from one room into another, and the rooms that the table lacks."""
    arrows = []
    missing = collections.defaultdict(list)
    for path, text in files.items():
        room = table.room_of(path)[0]
        if room is None:
            missing[posixpath.dirname(path)].append(path)
        for line, name, header in includes_of(path, text, files):
            target = table.room_of(header)[0]
            if room and target and target != room:
                arrows.append(Arrow(path, line, name, room, target))
    faults = [f"{TABLE}: lacks the room {folder} ({len(paths)} files, the first is {paths[0]})" for folder, paths in sorted(missing.items())]
    return arrows, faults


def table_faults(table, files, arrows):
    """Entries that point at their own floor or upward, that name nothing, or that no include needs."""
    rooms = {table.room_of(path)[0] for path in files} - {None}
    used_keys = {table.room_of(path)[1] for path in files}
    for key, (level, may) in table.keys.items():
        if key not in used_keys:
            yield f"{TABLE}: room {key} holds no file"
            continue
        sources = {room for room in rooms if table.room_of(room + "/x")[1] == key}
        for entry in may:
            reached = {room for room in rooms if matches(entry, room)} - sources
            upward = sorted(room for room in reached if table.level(room) >= level)
            if not reached:
                yield f"{TABLE}: room {key} may include {entry}, which names no other room"
            elif upward:
                yield f"{TABLE}: room {key} may include {', '.join(upward)}, not below floor {level + 1} ({table.names[level]})"
            elif not any(arrow.source in sources and arrow.target in reached for arrow in arrows):
                yield f"{TABLE}: room {key} may include {entry}, which no file of it does: remove the entry"


def cycles(graph):
    """Sets of rooms that reach each other, by Tarjan's algorithm."""
    index, low, stack, found = {}, {}, [], []

    def visit(node):
        index[node] = low[node] = len(index)
        stack.append(node)
        for other in sorted(graph.get(node, ())):
            if other not in index:
                visit(other)
                low[node] = min(low[node], low[other])
            elif other in stack:
                low[node] = min(low[node], index[other])
        if low[node] == index[node]:
            place = stack.index(node)
            component = stack[place:]
            del stack[place:]
            if len(component) > 1:
                found.append(sorted(component))

    for node in sorted(graph):
        if node not in index:
            visit(node)
    return found


def graph_of(arrows):
    graph = collections.defaultdict(set)
    for arrow in arrows:
        graph[arrow.source].add(arrow.target)
    return graph


def findings(table, files):
    """Sentences, one for each breach."""
    arrows, faults = arrows_of(table, files)
    yield from faults
    for arrow in arrows:
        if not any(matches(entry, arrow.target) for entry in table.may(arrow.source)):
            source, target = table.level(arrow.source), table.level(arrow.target)
            upward = f"; it is not below: floor {source + 1} includes floor {target + 1}" if target >= source else ""
            allowed = ", ".join(table.may(arrow.source)) or "no other room"
            yield f'{arrow.path}:{arrow.line}: "{arrow.name}": room {arrow.source} may not include room {arrow.target}, only {allowed}{upward}'
    for component in cycles(graph_of(arrows)):
        inner = sorted({(a.source, a.target) for a in arrows if a.source in component and a.target in component})
        yield f"rooms that include each other: {', '.join(component)}; by " + ", ".join(f"{a} -> {b}" for a, b in inner)
    yield from table_faults(table, files, arrows)


def listing(arrows):
    """Lines `room -> room  count`, sorted."""
    counts = collections.Counter((arrow.source, arrow.target) for arrow in arrows)
    width = max((len(source) for source, _ in counts), default=0)
    return [f"{source:{width}} -> {target}  {count}" for (source, target), count in sorted(counts.items())]


# ---------------------------------------------------------------------------------------------------------------- draft


def weakest_arrows(arrows):
    """Arrows (room, room) whose removal leaves no cycle: in each cycle the one of fewest includes, in turn."""
    counts = collections.Counter((arrow.source, arrow.target) for arrow in arrows)
    removed = []
    while True:
        graph = collections.defaultdict(set)
        for source, target in counts:
            graph[source].add(target)
        components = cycles(graph)
        if not components:
            return removed
        for component in components:
            inner = {pair: count for pair, count in counts.items() if set(pair) <= set(component)}
            weakest = min(inner, key=lambda pair: (inner[pair], pair))
            removed.append(weakest)
            del counts[weakest]


def levels(graph, rooms):
    """Floor of each room: one above the highest that it includes."""
    height = {}

    def visit(room):
        if room not in height:
            height[room] = 1 + max((visit(other) for other in graph.get(room, ())), default=-1)
        return height[room]

    for room in rooms:
        visit(room)
    return height


def with_every_folder(table, files):
    """A table of one floor with the rooms of a table, and with each folder that it lacks as a room."""
    rooms = sorted({table.room_of(path)[0] or posixpath.dirname(path) for path in files})
    return Table(f"folders = {list(table.folders)}\n[[floor]]\nname = ''\nrooms = {{" + ", ".join(f'"{room}" = []' for room in rooms) + "}")


def draft(table, files):
    """A table that the code passes. Rooms are those of the table, and each folder that it lacks."""
    extended = with_every_folder(table, files)
    arrows, _ = arrows_of(extended, files)
    removed = set(weakest_arrows(arrows))
    graph = graph_of([arrow for arrow in arrows if (arrow.source, arrow.target) not in removed])
    height = levels(graph, extended.keys)
    lines = ["folders = [" + ", ".join(f'"{folder}"' for folder in table.folders) + "]"]
    for level in range(max(height.values()) + 1):
        lines += ["", "[[floor]]", f'name = "{level + 1}"', "[floor.rooms]"]
        for room in sorted(room for room in height if height[room] == level):
            lines.append(f'"{room}" = [' + ", ".join(f'"{other}"' for other in sorted(graph.get(room, ()))) + "]")
    for arrow in arrows:
        if (arrow.source, arrow.target) in removed:
            lines.append(f'# cycle: {arrow.path}:{arrow.line} of {arrow.source} includes "{arrow.name}" of {arrow.target}')
    return lines


# ---------------------------------------------------------------------------------------------------------------- picture


def reduced(graph):
    """The arrows that do not follow from others."""

    def reach(room, seen):
        for other in graph.get(room, ()):
            if other not in seen:
                seen.add(other)
                reach(other, seen)
        return seen

    return {room: {other for other in others if not any(other in reach(third, set()) for third in others if third != other)}
            for room, others in graph.items()}


def diagram(graph, label):
    """A flowchart in Mermaid's notation, the ground at the bottom."""
    graph = graph if cycles(graph) else reduced(graph)
    rooms = sorted({*graph, *(other for others in graph.values() for other in others)})
    identifier = {room: re.sub(r"\W", "_", room) for room in rooms}
    lines = ["```mermaid", "flowchart TD"] + [f'  {identifier[room]}["{label(room)}"]' for room in rooms]
    lines += [f"  {identifier[room]} --> {identifier[other]}" for room in sorted(graph) for other in sorted(graph[room])]
    return lines + ["```"]


def picture(table, files):
    """The section of the page: two diagrams and the table, as the code has them."""
    arrows, _ = arrows_of(table, files)
    flight = graph_of([a for a in arrows if a.source.startswith("fsw/") and a.target.startswith("fsw/")])

    def part(room):
        return "fsw" if room.startswith("fsw/") else "/".join(room.split("/")[:2])

    host = collections.defaultdict(set)
    for arrow in arrows:
        if part(arrow.source) != part(arrow.target):
            host[part(arrow.source)].add(part(arrow.target))
    rooms = sorted({table.room_of(path)[0] for path in files} - {None}, key=lambda room: (table.level(room), room))
    graph = graph_of(arrows)
    lines = [BEGIN, "", f"An arrow is an include. `{TABLE}` lists what each room may include, always of a lower floor; the test `flight_rules.layers`",
             "verifies each include. Arrows that follow from others are omitted.", "", "Rooms of the flight software:", ""]
    lines += diagram(flight, lambda room: room.removeprefix("fsw/"))
    lines += ["", "The product, flight software as one block:", ""] + diagram(host, str)
    lines += ["", "| floor | room | includes |", "|---|---|---|"]
    lines += [f"| {table.level(room) + 1} | `{room}` | {', '.join(f'`{other}`' for other in sorted(graph.get(room, ()))) or 'nothing'} |" for room in rooms]
    return "\n".join(lines + ["", END])


def section_of(page):
    """The written section of the page, None if it has none."""
    found = re.search(re.escape(BEGIN) + r".*?" + re.escape(END), page, re.S)
    return found and found[0]


def main():
    root, options = pathlib.Path(sys.argv[1]), sys.argv[2:]
    if len(options) > 1 or not set(options) <= {"--list", "--draft", "--picture", "--write"}:
        sys.exit(__doc__)
    table = Table((root / TABLE).read_text(encoding="utf-8"))
    files = read_tree(root, table.folders)
    if len(files) < 300:
        sys.exit(f"only {len(files)} files found below {root}: is that the root of the tree?")
    if options == ["--list"]:
        print(*listing(arrows_of(with_every_folder(table, files), files)[0]), sep="\n")
    elif options == ["--draft"]:
        print(*draft(table, files), sep="\n")
    elif options == ["--picture"]:
        print(picture(table, files))
    else:
        page = (root / PAGE).read_text(encoding="utf-8")
        if options == ["--write"]:
            if section_of(page) is None:
                sys.exit(f"{PAGE} lacks the lines {BEGIN} and {END}")
            (root / PAGE).write_text(page.replace(section_of(page), picture(table, files)), encoding="utf-8")
            return
        faults = list(findings(table, files))
        if section_of(page) != picture(table, files):
            faults.append(f"{PAGE}: the section of rooms is not current: tests/flight_rules/check_layers.py . --write")
        if faults:
            print(*faults, sep="\n")
            sys.exit(f"{len(faults)} breaches of the layers")
        print(f"{len(files)} files keep to the layers")


if __name__ == "__main__":
    main()
