"""Files of a repository that the user has: a clone, bare or not, or a plain folder."""
import pathlib
import posixpath
import subprocess


class Missing(Exception):
    """One line that says what is not there."""


class Repository:
    """FOLDER/owner+name, or a `repo` in it. A clone is read at the commit, without a checkout; a
    plain folder as it is."""
    def __init__(self, folder, name, commit):
        self.root = pathlib.Path(folder) / name.replace("/", "+")
        if not self.root.is_dir():
            raise Missing(f"{self.root}: no such folder; put a clone of github.com/{name} there")
        if (self.root / "repo").is_dir() and not (self.root / ".git").exists():
            self.root = self.root / "repo"
        self.commit = None
        if (self.root / ".git").exists() or (self.root / "HEAD").is_file():
            if self._git("cat-file", "-e", commit + "^{commit}").returncode != 0:
                raise Missing(f"{self.root}: has no commit {commit}; fetch it with git")
            self.commit = commit

    def _git(self, *arguments):
        return subprocess.run(["git", "-C", str(self.root), *arguments], capture_output=True,
                              check=False)

    def read(self, path):
        path = posixpath.normpath(path)
        if self.commit:
            shown = self._git("show", f"{self.commit}:{path}")
            if shown.returncode != 0:
                raise Missing(f"{self.root}: has no {path} at {self.commit}")
            return shown.stdout
        try:
            return (self.root / path).read_bytes()
        except OSError as error:
            raise Missing(f"{self.root / path}: {error.strerror}") from error
