"""A page on 127.0.0.1 whose address has a token; requests of another Host or from pages of another Origin are refused."""
import hmac
import http.server
import json
import secrets
import threading
import urllib.parse

STALL_S = 5.0            # a viewer that takes nothing for so long is left
MOST_BYTES = 1000        # of a request's body
POLICY = "img-src data: blob:"


class Refusal(Exception):
    """code, sentence"""


class Handler(http.server.BaseHTTPRequestHandler):
    """Answers by the routes of the server's site: {(method, name behind the token): function of this handler and the query}."""
    protocol_version = "HTTP/1.1"
    server_version, sys_version = "vbar", ""

    def log_message(self, *_):
        pass

    def send(self, code, kind, body, **headers):
        self.send_response(code)
        for header, value in ({"Content-Type": f"{kind}; charset=utf-8", "Content-Length": str(len(body))} | headers).items():
            self.send_header(header.replace("_", "-"), value)
        self.end_headers()
        self.wfile.write(body)

    def send_page(self, page, **headers):
        body = page.replace(POLICY, f"{POLICY}; connect-src 'self'", 1).encode()
        self.send(200, "text/html", body, Cache_Control="no-store", X_Content_Type_Options="nosniff", Referrer_Policy="no-referrer", X_Frame_Options="DENY",
                  **headers)

    def is_allowed(self):
        """Whether the request is for this address and, if a page made it, from this address."""
        hosts = {f"{name}:{self.server.server_address[1]}" for name in ("127.0.0.1", "localhost")}
        origin = self.headers.get("Origin")
        is_known = origin is None or origin.removeprefix("http://") in hosts or origin in self.server.origins
        return self.headers.get("Host") in hosts and is_known

    def answer(self, method):
        self.connection.settimeout(STALL_S)
        address = urllib.parse.urlsplit(self.path)
        token, _, name = address.path.lstrip("/").partition("/")
        try:
            if not self.is_allowed():
                raise Refusal(403, "refused: another Host or Origin")
            route = self.server.site.routes.get((method, name))
            if not hmac.compare_digest(token.encode(), self.server.token.encode()) or not route:
                raise Refusal(404, "not found")
            route(self, urllib.parse.parse_qs(address.query))
        except Refusal as refusal:
            code, sentence = refusal.args
            self.close_connection = True  # a body may be left unread
            self.send(code, "text/plain", (sentence + "\n").encode(), Connection="close")
        except (OSError, ValueError):
            self.close_connection = True  # the viewer left, or takes nothing

    def do_GET(self):  # noqa: N802
        self.answer("GET")

    def do_POST(self):  # noqa: N802
        self.answer("POST")

    def json_body(self):
        """The JSON object that was sent."""
        length = self.headers.get("Content-Length", "")
        if not length.isascii() or not length.isdecimal() or int(length) > MOST_BYTES:
            raise Refusal(400, f"Content-Length: found {length[:20]!r}; accepted: 0 to {MOST_BYTES}")
        try:
            value = json.loads(self.rfile.read(int(length)))
        except (ValueError, RecursionError):
            value = None
        if not isinstance(value, dict):
            raise Refusal(400, "body: accepted: a JSON object")
        return value


class Server(http.server.ThreadingHTTPServer):
    daemon_threads = True

    def __init__(self, site, port, origins=()):
        super().__init__(("127.0.0.1", port), Handler)
        self.origins = origins
        self.site, self.token, self.is_over = site, secrets.token_urlsafe(16), threading.Event()

    @property
    def address(self):
        return f"http://127.0.0.1:{self.server_address[1]}/{self.token}/"

    def handle_error(self, request, client_address):
        """A connection that breaks concerns no other."""
