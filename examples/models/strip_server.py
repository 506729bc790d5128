#!/usr/bin/env python3
"""The model of strip.py as a UM-Bridge server. It needs only Python's standard library.

usage: strip_server.py [PORT]

The server prints its address. Without PORT, it uses a free port.
"""
import http.server
import json
import sys

from strip import MODES, frequencies


class Handler(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"  # keeps connections open
    wbufsize = -1  # sends each response in one piece

    def log_message(self, *_):
        pass

    def answer(self, body):
        text = json.dumps(body).encode()
        self.send_response(200)
        self.send_header("Content-Type", "application/json")
        self.send_header("Content-Length", str(len(text)))
        self.end_headers()
        self.wfile.write(text)

    def do_GET(self):
        self.answer({"protocolVersion": 1.0, "models": ["strip"]})

    def do_POST(self):
        question = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
        if self.path == "/ModelInfo":
            self.answer({"support": {"Evaluate": True, "Gradient": False, "ApplyJacobian": False,
                                     "ApplyHessian": False}})
        elif self.path == "/InputSizes":
            self.answer({"inputSizes": [2]})
        elif self.path == "/OutputSizes":
            self.answer({"outputSizes": [MODES]})
        else:
            self.answer({"output": [frequencies(*question["input"][0])]})


if __name__ == "__main__":
    server = http.server.ThreadingHTTPServer(("127.0.0.1", int(sys.argv[1]) if len(sys.argv) > 1 else 0), Handler)
    print(f"http://127.0.0.1:{server.server_address[1]}", flush=True)
    server.serve_forever()
