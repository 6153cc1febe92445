"""Aravis's own programs use the emulated camera. Usage: check_aravis_tools.py TOOL"""

import re
import subprocess
import sys

from gige import device, enter_own_network, expect, need

ADDRESS = "127.0.0.1"


def run(*command):
    """What the program prints."""
    result = subprocess.run(command, capture_output=True, text=True, timeout=60)
    return result.stdout + result.stderr


def main():
    tool = sys.argv[1]
    need("arv-tool-0.8", "arv-camera-test-0.8")
    enter_own_network()
    with device(tool):
        control = ["arv-tool-0.8", "-a", ADDRESS, "control"]
        text = run(*control, "DeviceModelName", "SensorWidth", "ExposureAuto=Off", "ExposureTime=12345", "ExposureTime",
                   "PixelFormat=Mono12Packed", "PixelFormat", "Width=500", "OffsetX=710", "OffsetX", "PayloadSize")
        for expected in ("DeviceModelName = Grasshopper3 GS3-PGE-23S6M", "SensorWidth = 1920", "ExposureTime = 12345",
                         "PixelFormat = Mono12Packed", "OffsetX = 710", "PayloadSize = 900000"):
            expect(expected in text, f"arv-tool: \"{expected}\" is not in: {text}")
        features = run("arv-tool-0.8", "-a", ADDRESS, "features")
        for name in ("TriggerSoftware", "BlackLevel", "SharpnessEnabled", "AcquisitionFrameRateEnabled", "GevSCPD"):
            expect(name in features, f"arv-tool features: {name} is missing")
    with device(tool):
        text = run("arv-camera-test-0.8", "-n", ADDRESS, "--no-packet-socket", "-a", "-w", "500", "-h", "848", "-f", "10",
                   "--duration=3")
        completed = re.search(r"n_completed_buffers\s*=\s*(\d+)", text) or re.search(r"Completed buffers\s*=\s*(\d+)", text)
        expect(completed and int(completed.group(1)) > 0, f"arv-camera-test: no image: {text}")
        print(f"arv-camera-test: {completed.group(0)}")


main()
