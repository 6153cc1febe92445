#!/usr/bin/env python3
"""boards/zynq7000/stack_bound.py on small listings whose bounds are added by hand."""
import os
import pathlib
import sys
import unittest

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "boards" / "zynq7000"))
import stack_bound  # noqa: E402


def listing(text):
    """Lines as of objdump, from "name: instruction; instruction"."""
    lines = []
    for number, function in enumerate(text.strip().splitlines()):
        name, _, body = function.strip().partition(": ")
        lines.append(f"{number:08x} <{name}>:\n")
        for instruction in body.split("; "):
            mnemonic, _, operands = instruction.strip().partition(" ")
            lines.append(f"  {number:x}:\t{mnemonic}\t{operands}\n")
    return lines


def graph(text, **tables):
    functions = stack_bound.read_listing(listing(text))
    return stack_bound.Graph(functions, {name: name for name in functions}, **({"indirect": [], "recursion": [], "frames": {}} | tables))


class StackBound(unittest.TestCase):
    def test_the_deepest_path_counts(self):
        depth, path = graph("""
            main: push {r4, lr}; sub sp, sp, #24; bl 10 <left>; bl 20 <right>; pop {r4, pc}
            left: push {r4, r5, r6, lr}; vpush {d8-d9}; bl 30 <leaf>; pop {r4, r5, r6, pc}
            right: str lr, [sp, #-4]!; sub sp, sp, #20; ldr pc, [sp], #4
            leaf: strd r4, [sp, #-16]!; bx lr""").deepest("main")
        self.assertEqual(path, ("main", "left", "leaf"))
        self.assertEqual(depth, 8 + 24 + 16 + 16 + 16)

    def test_a_branch_at_the_end_is_a_call(self):
        depth, _ = graph("main: sub sp, sp, #8; add sp, sp, #8; b 10 <other>\nother: push {r4-r11, lr}; pop {r4-r11, pc}").deepest("main")
        self.assertEqual(depth, 8 + 36)
        depth, _ = graph("main: sub sp, sp, #8; beq 4 <main+0x4>; bx lr").deepest("main")
        self.assertEqual(depth, 8)

    def test_a_label_of_an_assembler_file_continues(self):
        depth, _ = graph("main: push {lr}; mov r0, r1\nlabel: sub sp, sp, #12; bx lr").deepest("main")
        self.assertEqual(depth, 16)

    def test_a_cycle_needs_a_bound(self):
        text = "main: push {lr}; bl 10 <sort>; pop {pc}\nsort: sub sp, sp, #16; bl 10 <sort>; bl 20 <leaf>; bx lr\nleaf: push {lr}; pop {pc}"
        with self.assertRaisesRegex(stack_bound.Unbounded, "a cycle: sort -> sort"):
            graph(text).deepest("main")
        self.assertEqual(graph(text, recursion=[("^sort$", 10, "ten")]).deepest("main")[0], 4 + 160 + 4)
        with self.assertRaisesRegex(stack_bound.Unbounded, "a cycle: a -> b -> a"):
            graph("a: bl 10 <b>; bx lr\nb: bl 0 <a>; bx lr").deepest("a")

    def test_an_indirect_call_needs_a_list_that_names_something(self):
        text = "main: push {lr}; blx r3; pop {pc}\nsink: sub sp, sp, #40; bx lr"
        with self.assertRaisesRegex(stack_bound.Unbounded, "not listed: main"):
            graph(text).deepest("main")
        with self.assertRaisesRegex(stack_bound.Unbounded, "names nothing: main"):
            graph(text, indirect=[("^main$", ["^gone$"])]).deepest("main")
        self.assertEqual(graph(text, indirect=[("^main$", ["^sink$"])]).deepest("main")[0], 44)

    def test_a_frame_of_unknown_size_is_an_error(self):
        for instruction in ("sub sp, sp, r1", "ldr sp, [r3]", "bic sp, sp, #7", "mov sp, r7"):
            with self.subTest(instruction), self.assertRaisesRegex(stack_bound.Unbounded, "unknown size: main"):
                graph(f"main: {instruction}; bx lr").deepest("main")
        self.assertEqual(graph("main: sub sp, sp, r1; bx lr", frames={"main": (20, "because")}).deepest("main")[0], 20)

    def test_a_call_of_what_is_not_there_is_an_error(self):
        with self.assertRaisesRegex(stack_bound.Unbounded, "not in the listing: gone"):
            graph("main: bl 10 <gone>; bx lr").deepest("main")


if __name__ == "__main__":
    unittest.main(verbosity=2)
