"""The client takes images of Aravis's own fake camera. Usage: check_fake_camera.py TOOL"""

import subprocess
import sys
import time

from gige import enter_own_network, expect, need, take, total

IMAGES = 20


def main():
    tool = sys.argv[1]
    need("arv-fake-gv-camera-0.8")
    enter_own_network()
    fake = subprocess.Popen(["arv-fake-gv-camera-0.8", "-i", "127.0.0.1", "-s", "GV01"])
    try:
        for pixel_format in ("Mono8", "Mono16"):
            # The fake camera starts in its own time.
            limit = time.monotonic() + 30
            while True:
                code, lines, errors = take(tool, IMAGES, 512, 512, pixel_format)
                if code == 0 or "does not answer" not in errors or time.monotonic() > limit:
                    break
            expect(code == 0, f"{pixel_format}: {errors}")
            expect(lines[0].startswith("Aravis Fake"), lines[0])
            print(f"{pixel_format}: {lines[-1]}, {total(lines, 'retries')} retries")
    finally:
        fake.terminate()
        fake.wait(timeout=30)


main()
