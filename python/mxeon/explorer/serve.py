# SPDX-License-Identifier: Apache-2.0
"""A local server of the explorer's page, which also receives files dropped on the page.

Only the page itself can send files. Before a page of another site sends a PUT, browsers request
permission, which this server does not give. The server also checks the host name of requests, so
that no other domain can point to the server's address.
"""

from collections.abc import Callable
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path, PurePosixPath
from threading import Lock
from urllib.parse import unquote

from mxeon.errors import MxeonError, one_line

LARGEST = 2**30  # maximum bytes of a received file

Make = Callable[[list[str], str | None], str]  # arguments: documents, and environment map or None


class Server(ThreadingHTTPServer):
    """A server of one page. Files that users drop on the page are stored in `folder`."""

    daemon_threads = True

    def __init__(self, make: Make, files: list[str], light: str | None, folder: Path) -> None:
        self.make, self.files, self.light, self.folder = make, files, light, folder
        self.page, self.lock = make(files, light), Lock()
        super().__init__(("127.0.0.1", 0), _Handler)
        self.host = f"127.0.0.1:{self.server_port}"

    def receive(self, path: PurePosixPath, content: bytes) -> None:
        """Store and show a file that was sent to /files/... or /light/..., or raise MxeonError."""
        _, kind, *parts = path.parts
        target = self.folder.joinpath(kind, *parts)
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(content)
        files, light = self.files, self.light
        if kind == "light":
            light = str(target)
        elif target.suffix.lower() == ".mtlx":
            files = [str(target), *(each for each in files if each != str(target))]
        else:
            return  # the file is an image that a document may use
        self.page = self.make(files, light)
        self.files, self.light = files, light


class _Handler(BaseHTTPRequestHandler):
    server: Server

    def do_GET(self) -> None:
        known = self.path == "/" and self.headers["Host"] == self.server.host
        self._reply(200 if known else 404, self.server.page if known else "no such page")

    def do_PUT(self) -> None:
        path, size = PurePosixPath(unquote(self.path)), int(self.headers["Content-Length"] or 0)
        plain = not any(each == ".." or set(each) & set("\\:\0") for each in path.parts)
        known = plain and len(path.parts) > 2 and path.parts[1] in ("files", "light")
        if not known or self.headers["Host"] != self.server.host or size > LARGEST:
            return self._reply(403, f"{path.name}: refused")
        try:
            with self.server.lock:
                self.server.receive(path, self.rfile.read(size))
        except (MxeonError, OSError) as error:
            text = one_line(error).replace(f"{self.server.folder}/{path.parts[1]}/", "")
            return self._reply(422, text)
        return self._reply(204, "")

    def _reply(self, status: int, text: str) -> None:
        content = text.encode()
        kind = "html" if status == 200 else "plain"
        self.send_response(status)
        self.send_header("Content-Type", f"text/{kind}; charset=utf-8")
        self.send_header("Content-Length", str(len(content)))
        self.send_header("Cache-Control", "no-store")
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, *_: object) -> None:
        """Print nothing. The function that makes the page prints warnings about documents."""
