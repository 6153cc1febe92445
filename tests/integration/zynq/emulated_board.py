"""QEMU's xilinx-zynq-a9 with one flight image. Whatever happens, no process is left behind."""

import ctypes
import os
import signal
import socket
import subprocess
import tempfile
import time


def free_udp_port():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def die_with_parent():
    pr_set_pdeathsig = 1
    ctypes.CDLL(None).prctl(pr_set_pdeathsig, signal.SIGKILL)


class EmulatedBoard:
    """Context manager: the emulator runs inside the `with`."""

    def __init__(self, image, semihosting=True, arguments=(), raw_ethernet=False, address="10.0.2.15:5000", halted=False):
        self.image = image
        self.semihosting = semihosting
        self.arguments = arguments
        self.raw_ethernet = raw_ethernet
        self.address = address  # of the image: IP address and UDP port
        self.halted = halted  # as after a reset by a debugger: nothing is loaded, self.gdb_socket is the debug server

    def __enter__(self):
        self.folder = tempfile.TemporaryDirectory(prefix="vbar-zynq-")
        self.console_path = os.path.join(self.folder.name, "console")
        serial_path = os.path.join(self.folder.name, "uart0")
        listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        listener.bind(serial_path)
        listener.listen(1)
        listener.settimeout(30)
        self.udp_port = free_udp_port()
        # Not restrict=on: it holds back the answers to forwarded datagrams.
        network = f"user,hostfwd=udp:127.0.0.1:{self.udp_port}-{self.address}"
        if self.raw_ethernet:  # each Ethernet frame as a datagram to and from self.frames
            self.frames = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            self.frames.bind(("127.0.0.1", 0))
            self.frames.settimeout(5)
            network = f"socket,udp=127.0.0.1:{self.frames.getsockname()[1]},localaddr=127.0.0.1:{self.udp_port}"
        semihosting = "enable=on,target=native" if self.semihosting else "enable=off"
        for argument in self.arguments:
            semihosting += ",arg=" + argument
        command = [
            "qemu-system-arm", "-M", "xilinx-zynq-a9", "-m", "128M", "-nodefaults", "-display", "none",
            "-accel", "tcg,tb-size=64", "-icount", "shift=5,sleep=off,align=off", "-semihosting-config", semihosting,
            "-chardev", f"socket,id=link,path={serial_path},server=off", "-serial", "chardev:link",
            "-chardev", f"file,id=console,path={self.console_path}", "-serial", "chardev:console",
            "-nic", network + ",model=cadence_gem"]
        self.gdb_socket = os.path.join(self.folder.name, "gdb")
        command += ["-S", "-gdb", f"unix:{self.gdb_socket},server=on,wait=off"] if self.halted else ["-kernel", self.image]
        try:
            self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL,
                                            stderr=subprocess.PIPE, preexec_fn=die_with_parent)
            self.serial = listener.accept()[0]
            deadline = time.monotonic() + 30
            while self.halted and not os.path.exists(self.gdb_socket):
                if time.monotonic() > deadline:
                    raise TimeoutError("the emulator opens no debug server")
                time.sleep(0.05)
        except BaseException:
            self.__exit__()
            raise
        finally:
            listener.close()
        return self

    def __exit__(self, *_):
        if hasattr(self, "process"):
            self.process.kill()
            self.process.communicate()
        for name in ("serial", "frames"):
            if hasattr(self, name):
                getattr(self, name).close()
        self.folder.cleanup()

    def console(self):
        with open(self.console_path, encoding="ascii", errors="replace") as text:
            return text.read().replace("\r\n", "\n")

    def wait(self, timeout=20):
        """The emulator's exit code; None if it still runs."""
        try:
            return self.process.wait(timeout)
        except subprocess.TimeoutExpired:
            return None
