"""A server for one page on this machine: the page, and runs at the values that it sends.

It listens on 127.0.0.1 alone.  The address of the page has a random token, which every request
brings back, so that no other page in the browser can ask for anything.
"""

import json
import secrets
import threading
from collections.abc import Callable
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from typing import Any
from urllib.parse import parse_qs, urlsplit

from tribo.files import strict_json
from tribo.validation import InputError
from tribo.viewer.html import SERVED, document

ADDRESS = "127.0.0.1"
# Most bytes of a request.
MOST_BYTES = 64 * 1024
# Statuses of HTTP.
WRONG = 400
FORBIDDEN = 403
LARGE = 413


class Server(ThreadingHTTPServer):
    """The server of a page, whose `source` contains the first run and the sliders.

    `run` returns what the page shows for values of the sliders, and raises InputError.  Each
    request has to know the `token`.
    """

    daemon_threads = True
    allow_reuse_address = False

    def __init__(self, source: dict[str, Any], run: Callable[[object], dict[str, Any]]) -> None:
        super().__init__((ADDRESS, 0), _Handler)
        self.token = secrets.token_urlsafe(24)
        self.page = document(source, SERVED).encode()
        self.run = run
        self.one_run = threading.Lock()

    @property
    def host(self) -> str:
        return f"{ADDRESS}:{self.server_address[1]}"

    @property
    def url(self) -> str:
        return f"http://{self.host}/?token={self.token}"

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Say nothing of a browser that closes a connection."""


class _Handler(BaseHTTPRequestHandler):
    """Answers the page, and runs; 403 to all else."""

    server: Server
    protocol_version = "HTTP/1.1"
    timeout = 60.0  # of a connection that sends nothing [s]
    disable_nagle_algorithm = True  # headers and content are sent one after the other

    def do_GET(self) -> None:
        """The page, to a browser that knows the token."""
        asked = urlsplit(self.path)
        token = parse_qs(asked.query).get("token", [""])[0]
        if asked.path != "/" or not self._is_ours(token, needs_origin=False):
            self._answer(FORBIDDEN, b"forbidden", "text/plain")
            return
        self._answer(200, self.server.page, "text/html; charset=utf-8")

    def do_POST(self) -> None:
        """The run at the values in the body."""
        token = self.headers.get("X-Tribo-Token", "")
        if self.path != "/run" or not self._is_ours(token, needs_origin=True):
            self._refuse(FORBIDDEN, "forbidden")
            return
        length = self.headers.get("Content-Length", "")
        if not (length.isascii() and length.isdigit()) or "Transfer-Encoding" in self.headers:
            self._refuse(WRONG, "the request must have a length")
            return
        if int(length) > MOST_BYTES:
            self._refuse(LARGE, f"the request must have at most {MOST_BYTES} bytes")
            return
        try:
            values = json.loads(self.rfile.read(int(length)))
            with self.server.one_run:
                found = self.server.run(values)
        except InputError as error:
            self._refuse(WRONG, str(error))
            return
        except (ValueError, RecursionError):
            self._refuse(WRONG, "the request must be JSON")
            return
        self._answer(200, strict_json(found, None).encode(), "application/json")

    def _is_ours(self, token: str, needs_origin: bool) -> bool:
        """Whether a request comes from the page of this server, or opens it."""
        host = self.server.host
        origin = self.headers.get("Origin", "" if needs_origin else f"http://{host}")
        known = secrets.compare_digest(token.encode(), self.server.token.encode())
        return known and self.headers.get("Host") == host and origin == f"http://{host}"

    def _refuse(self, status: int, sentence: str) -> None:
        self.close_connection = True  # what is left of the body is not read
        self._answer(status, json.dumps({"error": sentence}).encode(), "application/json")

    def _answer(self, status: int, content: bytes, kind: str) -> None:
        """Send a response that browsers neither keep nor show within another page."""
        self.send_response(status)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(content)))
        self.send_header("Cache-Control", "no-store")
        self.send_header("Referrer-Policy", "no-referrer")
        self.send_header("X-Content-Type-Options", "nosniff")
        self.send_header("X-Frame-Options", "DENY")
        if self.close_connection:
            self.send_header("Connection", "close")
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, format: str, *arguments: object) -> None:
        """Print nothing."""
