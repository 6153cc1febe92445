"""One packet in 100, dropped by the kernel: no image is lost. Usage: check_packet_loss.py TOOL"""

import subprocess
import sys

from gige import device, enter_own_network, expect, need, skip, take, total

IMAGES = 50
IMAGES_AT_ONE_IN_TEN = 10  # each takes up to ten attempts of a second and more
# Of the stream only (the client's socket receives it): GVCP commands go to port 3956 and come from there.
RULES = """
table inet loss {
  counter dropped { }
  chain input {
    type filter hook input priority 0;
    udp sport != 3956 udp dport != 3956 numgen random mod %d < 1 counter name dropped drop
  }
}
"""


def dropped():
    """Packets, as nftables counted them."""
    words = subprocess.run(["nft", "list", "counters"], check=True, capture_output=True, text=True).stdout.split()
    return int(words[words.index("packets") + 1])


def run(tool, one_in, images=IMAGES):
    """Takes the images with the kernel dropping packets; its lines."""
    subprocess.run(["nft", "flush", "ruleset"], check=True)
    subprocess.run(["nft", "-f", "-"], input=RULES % one_in, text=True, check=True)
    with device(tool):
        return take(tool, images, 500, 848, "Mono16", "compare")


def main():
    tool = sys.argv[1]
    need("nft")
    enter_own_network()
    probe = subprocess.run(["nft", "-f", "-"], input=RULES % 100, capture_output=True, text=True)
    if probe.returncode != 0:
        skip(f"the kernel refuses nftables: {probe.stderr.strip()}")
    code, lines, errors = run(tool, 100)
    expect(code == 0, f"1 in 100: {errors}")
    expect(dropped() > 0, "nothing was dropped")
    expect(total(lines, "resent") > 0, "nothing was sent again")
    print(f"1 in 100: {lines[-1]}, {dropped()} packets dropped, {total(lines, 'resent')} sent again, "
          f"{total(lines, 'retries')} retries")
    with device(tool):
        subprocess.run(["nft", "flush", "ruleset"], check=True)
        code, lines, errors = take(tool, IMAGES, 500, 848, "Mono16", "compare", "buffer=212992")
    expect(code == 0, f"Debian's default socket buffer: {errors}")
    print(f"no loss, Debian's default socket buffer: {lines[0]}; {lines[-1]}, {total(lines, 'resent')} sent again, "
          f"{total(lines, 'retries')} retries")
    code, lines, errors = run(tool, 10, IMAGES_AT_ONE_IN_TEN)
    # Completes, or ends with one sentence.
    expect(code == 0 or (code == 1 and errors.strip().splitlines()[-1].startswith("camera 127.0.0.1: ")),
           f"1 in 10: {code} {errors}")
    print(f"1 in 10: code {code}, {lines[-1]}, {dropped()} dropped, {total(lines, 'resent')} sent again, "
          f"{total(lines, 'retries')} retries")


main()
