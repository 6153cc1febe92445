"""COBS against npm's cobs, both ways. Usage: check_npm_cobs.py TOOL FOLDER (where install_npm.sh put node_modules)"""

import json
import pathlib
import shutil
import subprocess
import sys

from peer import ask, expect, random_buffers, skip

SCRIPT = """
const cobs = require(process.argv[1]);
const jobs = JSON.parse(require('fs').readFileSync(0, 'utf8'));
console.log(JSON.stringify({
  encoded: jobs.data.map(hex => Buffer.from(cobs.encode(Buffer.from(hex, 'hex'))).toString('hex')),
  decoded: jobs.code.map(hex => Buffer.from(cobs.decode(Buffer.from(hex, 'hex'))).toString('hex')),
}));
"""


def main():
    tool, folder = sys.argv[1:3]
    node = shutil.which("node") or shutil.which("nodejs")
    if not node:
        skip("node is not installed")
    module = pathlib.Path(folder) / "node_modules" / "cobs"
    if not module.is_dir():
        skip(f"npm's cobs is not in {folder}: run tests/peers/wire_formats/install_npm.sh")

    data = list(random_buffers(400, 1400))
    data += [bytes(range(1, 255)), bytes(range(1, 256)), bytes(range(1, 255)) + b"\0", bytes(range(0, 255))]
    ours = ask(tool, "cobs-encode", [d.hex() for d in data])
    # The peer knows no delimiter: the zero at the end is the link's.
    jobs = {"data": [d.hex() for d in data], "code": [code[:-2] for code in ours]}
    answer = subprocess.run([node, "--no-deprecation", "-e", SCRIPT, str(module.resolve())], input=json.dumps(jobs),
                            capture_output=True, text=True, check=True)
    peer = json.loads(answer.stdout)

    decoded_here = ask(tool, "cobs-decode", [code + "00" for code in peer["encoded"]])
    for original, back, here, code, theirs in zip(data, peer["decoded"], decoded_here, ours, peer["encoded"]):
        expect(back == original.hex(), f"the peer reads {code} as {back}")
        expect(here == original.hex(), f"{theirs} of the peer is read as {here}")
        # The peer ends a full last group with an empty one (code 1); both mean the same.
        expect(code[:-2] in (theirs, theirs[:-2] if theirs.endswith("01") else theirs), f"{code} against {theirs}")
    print(f"{len(data)} buffers agree both ways")


main()
