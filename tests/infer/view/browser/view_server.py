"""lte_view as a child process."""
import re
import signal
import subprocess


class ViewServer:
    def __init__(self, tool, scene, *flags, port=0):
        self.process = subprocess.Popen(
            [str(tool), str(scene), "--port", str(port), "--quiet", *map(str, flags)],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        line = self.process.stdout.readline()
        found = re.search(r"http://([^:/]+):(\d+)/\S*", line)
        if not found:
            self.process.wait()
            raise RuntimeError(f"lte_view does not serve: {line} {self.process.stderr.read()}")
        self.address, self.port = found[0], int(found[2])

    def stop(self):
        """Ctrl-C; returns the exit code."""
        if self.process.poll() is None:
            self.process.send_signal(signal.SIGINT)
            try:
                self.process.wait(60)
            except subprocess.TimeoutExpired:
                self.process.kill()
                self.process.wait()
        return self.process.returncode
