#!/usr/bin/env python3
"""The largest depth that the stack of a Zynq image can reach, from the call graph of the linked image.

    stack_bound.py LISTING --stack BYTES [--margin SHARE]

LISTING is the output of `objdump -d --no-show-raw-insn` of the image. The disassembly, not the compiler's own report, because only the
linked image holds every function that runs, those of the run-time library and of assembler files included, and its calls as they are.

The frame of a function is the sum of all its pushes: more than it uses if it has several exits. A branch to another function counts as
a call. Interrupts run on the stack that they interrupt, once, because they are not nested. An indirect call is an error unless
INDIRECT lists what it may reach, a cycle unless RECURSION bounds its depth, and a frame whose size is not a constant unless FRAMES
states it. The exit status is 1 with an error, or if bound and margin exceed the stack.
"""
import argparse
import dataclasses
import re
import subprocess
import sys

ENTRY = "main"  # what precedes it (startup.S, static constructors) has returned
INTERRUPT = "interrupt_entry"

SINK = [r"^vbar::boards::FlightExecutive::sink\("]
BOARD = r"^vbar::boards::zynq7000::\(anonymous namespace\)::FlightBoard::"
# Functions with indirect calls (demangled), and what these may reach.
INDIRECT = [
    (r"^vbar_interrupt$", [r"^vbar::boards::zynq7000::(Uart|Ethernet)::on_interrupt\(", r"^vbar::boards::zynq7000::\(anonymous namespace\)::on_expiry\(", r"^vbar::boards::zynq7000::\(anonymous namespace\)::start_wake_timer\(\)::.*_FUN\("]),
    # packets to the sink
    (r"^void vbar::fsw::messaging::Outbox::send<", SINK),
    (r"^vbar::fsw::gnc::Gnc::(report_|point_|command_|report\(|command\()", SINK),
    (r"^vbar::fsw::(measurements|messaging|navigation)::\w+::report\w*\(", SINK),
    # the rules of telecommands
    (r"^vbar::fsw::messaging::Telecommands::", [r"^vbar::fsw::gnc::\(anonymous namespace\)::(are_consistent\(|set<.*_FUN\()"]),
    # the platform of the executive
    (r"^vbar::boards::FlightExecutive::", [BOARD + r"(open_receiver|read_receiver|send|session_begins|step_begins|step_ends)\(",
                                           BOARD + r"platform\(\)::.*_FUN\("]),
    # comparisons of sorts, windows of the solver, records of a receiver
    (r"^void std::__(insertion_sort|adjust_heap|introsort_loop)<vbar::fsw::imaging::DetectedObject", [r"^vbar::fsw::imaging::\(anonymous namespace\)::is_first\("]),
    (r"^void std::__(insertion_sort|adjust_heap|introsort_loop)<vbar::fsw::imaging::Component", [r"^vbar::fsw::imaging::is_brighter\("]),
    (r"^vbar::fsw::control::solve_koenig_damico\(", [r"LitWindows::thrust_windows\(\) const::.*_FUN\("]),
    (r"^vbar::fsw::Status vbar::fsw::gnss::\(anonymous namespace\)::read_records<", [r"^vbar::fsw::gnss::\(anonymous namespace\)::(range|compressed)_record\("]),
]
# Cycles: a function of each, and the number of its frames that can be alive at once, with the reason.
RECURSION = [
    (r"^void std::__introsort_loop<", 2 * 17, "its limit: twice the logarithm of the number of elements, below 2^17"),
]
# Frames that no constant states, in bytes.
FRAMES = {
    INTERRUPT: (16, "return state, and alignment of the interrupted stack"),
}


class Unbounded(Exception):
    pass


@dataclasses.dataclass
class Function:
    frame: int = 0
    calls: set = dataclasses.field(default_factory=set)
    is_indirect: bool = False
    unknown: str = ""  # an instruction that changes the stack by an unknown amount


def register_count(text):
    """Of "r4, r6-r8, lr" or "d8-d15"."""
    count = 0
    numbers = {"sl": 10, "fp": 11, "ip": 12, "sp": 13, "lr": 14, "pc": 15}
    number = lambda name: numbers[name] if name in numbers else int(name[1:])
    for part in text.split(","):
        first, _, last = part.strip().partition("-")
        count += number(last) - number(first) + 1 if last else 1
    return count


def stack_of(mnemonic, operands):
    """Bytes that an instruction takes from the stack; None if they are not known."""
    registers = re.search(r"\{(.*)\}", operands)
    if mnemonic.startswith("push") or (mnemonic.startswith(("stmdb", "stmfd")) and operands.startswith("sp!")):
        return 4 * register_count(registers[1])
    if mnemonic.startswith("vpush") or (mnemonic.startswith("vstmdb") and operands.startswith("sp!")):
        return (8 if registers[1].startswith("d") else 4) * register_count(registers[1])
    written_back = re.search(r"\[sp, #-(\d+)\]!", operands)
    if written_back:
        return int(written_back[1])
    if mnemonic.startswith("srsdb"):
        return 8
    if re.match(r"(sub|add|mov|bic|and|ldr)", mnemonic) and re.match(r"sp\b(?!!)", operands):
        lowered = re.match(r"sp, (?:sp, )?#(-?\d+)", operands)
        if mnemonic.startswith("sub") and lowered:
            return int(lowered[1])
        if mnemonic.startswith("add"):
            return 0
        return None
    return 0


def is_end(mnemonic, operands):
    """Whether nothing behind an instruction is reached from it: labels of assembler files are not functions of their own."""
    if mnemonic in ("b", "bx", "udf", ".word") or mnemonic.startswith("rfe"):
        return True
    return mnemonic in ("pop", "ldr", "ldm", "ldmia", "mov", "movs", "add", "bl") and ("pc" in operands or mnemonic == "bl")


def read_listing(lines):
    """Functions by their (mangled) names."""
    functions = {}
    name, falls_through = None, False
    for line in lines:
        begin = re.match(r"^[0-9a-f]+ <(.+)>:$", line)
        if begin:
            if name is not None and falls_through and not name.startswith("_Z"):
                functions[name].calls.add(begin[1])
            name, falls_through = begin[1], True
            functions[name] = Function()
            continue
        fields = line.rstrip("\n").split("\t")
        if name is None or len(fields) < 2:
            continue
        function, mnemonic, operands = functions[name], re.sub(r"\.[nw]$", "", fields[1].strip()), (fields[2] if len(fields) > 2 else "").split("@")[0].strip()
        if (mnemonic, operands) == ("andeq", "r0, r0, r0") or mnemonic == "nop":
            continue  # padding
        falls_through = not is_end(mnemonic, operands)
        taken = stack_of(mnemonic, operands)
        if taken is None:
            function.unknown = f"{mnemonic} {operands}"
        else:
            function.frame += taken
        target = re.search(r"<([^+>]+)(\+0x[0-9a-f]+)?>$", operands)
        if re.match(r"(b|bl|blx)(eq|ne|cs|cc|mi|pl|vs|vc|hi|ls|ge|lt|gt|le)?$", mnemonic) and target:
            if target[1] != name:
                function.calls.add(target[1])
        elif re.match(r"blx?", mnemonic) and not target and re.match(r"r\d+|ip|fp|sl", operands):
            function.is_indirect = True
        elif mnemonic == "bx" and operands != "lr":
            function.is_indirect = True
        if re.match(r"bl", mnemonic) and target and target[1] == name and not target[2]:
            function.calls.add(name)
    return functions


def demangled(names):
    result = subprocess.run(["c++filt"], input="\n".join(names), capture_output=True, text=True, check=True)
    return dict(zip(names, result.stdout.splitlines()))


class Graph:
    def __init__(self, functions, plain, indirect=INDIRECT, recursion=RECURSION, frames=FRAMES):
        self.functions, self.plain = functions, plain
        self.indirect, self.recursion, self.frames = indirect, recursion, frames
        self.known = {}

    def callees(self, name):
        function = self.functions[name]
        calls = set(function.calls)
        if function.is_indirect:
            rules = [targets for caller, targets in self.indirect if re.search(caller, self.plain[name])]
            if not rules:
                raise Unbounded(f"an indirect call that is not listed: {self.plain[name]}")
            reached = {other for targets in rules for other in self.functions if any(re.search(t, self.plain[other]) for t in targets)}
            if not reached:
                raise Unbounded(f"the list of what an indirect call reaches names nothing: {self.plain[name]}")
            calls |= reached
        return calls

    def frame(self, name):
        function = self.functions[name]
        if name in self.frames:
            return function.frame + self.frames[name][0]
        if function.unknown:
            raise Unbounded(f"a frame of unknown size: {self.plain[name]}: {function.unknown}")
        return function.frame

    def deepest(self, name, alive=()):
        """(bytes, path) from the entry of a function on."""
        if name in self.known:
            return self.known[name]
        if name not in self.functions:
            raise Unbounded(f"a call of what is not in the listing: {name}")
        if name in alive:
            raise Unbounded("a cycle: " + " -> ".join(self.plain[n] for n in alive[alive.index(name):] + (name,)))
        times = next((depth for who, depth, _ in self.recursion if re.search(who, self.plain[name])), 1)
        below = [self.deepest(callee, alive + (name,)) for callee in sorted(self.callees(name)) if not (callee == name and times > 1)]
        depth, path = max(below, default=(0, ()))
        self.known[name] = (times * self.frame(name) + depth, (name,) + path)
        return self.known[name]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("listing")
    parser.add_argument("--stack", type=int, required=True)
    parser.add_argument("--margin", type=float, default=0.1)
    options = parser.parse_args()
    with open(options.listing) as lines:
        functions = read_listing(lines)
    graph = Graph(functions, demangled(list(functions)))
    sys.setrecursionlimit(10000)
    try:
        depth, path = graph.deepest(ENTRY)
        interrupt, _ = graph.deepest(INTERRUPT)
    except Unbounded as error:
        print(f"stack_bound: {error}", file=sys.stderr)
        return 1
    for name in path:
        print(f"{graph.frame(name):8d}  {graph.plain[name]}")
    print(f"{interrupt:8d}  an interrupt\n{depth + interrupt:8d}  bytes at most, of {options.stack}")
    if (depth + interrupt) * (1.0 + options.margin) > options.stack:
        print("stack_bound: the stack is too small", file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
