"""A server and a client of the UM-Bridge protocol, version 1.0, written from its description with the standard library
alone."""
import http.client
import http.server
import json
import threading
import urllib.parse


class Broken(Exception):
    """A fault that a test injects: an HTTP status, a plain text as answer, or an endless answer."""

    def __init__(self, status=None, text=None, endless=False):
        super().__init__(status or text)
        self.status, self.text, self.endless = status, text, endless


class Model:
    """f(list of numbers) -> list of numbers, and its vector-Jacobian product, if it has one."""

    def __init__(self, inputs, outputs, function, gradient=None, input_sizes=None):
        self.input_sizes, self.output_sizes = input_sizes or [inputs], [outputs]
        self.function, self.gradient = function, gradient


class Server:
    """Serves models by name at any free port, or at `port`, until it is closed."""

    def __init__(self, models, port=0):
        self.calls = 0
        self.asked = []
        lock = threading.Lock()
        outer = self

        class Handler(http.server.BaseHTTPRequestHandler):
            protocol_version = "HTTP/1.1"
            wbufsize = -1  # one packet per answer

            def log_message(self, *_):
                pass

            def say(self, status, text):
                body = text.encode()
                self.send_response(status)
                self.send_header("Content-Type", "application/json")
                self.send_header("Content-Length", str(len(body)))
                self.end_headers()
                self.wfile.write(body)

            def do_GET(self):
                self.say(200, json.dumps({"protocolVersion": 1.0, "models": list(models)}))

            def do_POST(self):
                asked = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
                model = models[asked["name"]]
                try:
                    answer = {"/ModelInfo": lambda: {"support": {"Evaluate": True, "Gradient": bool(model.gradient),
                                                                 "ApplyJacobian": False, "ApplyHessian": False}},
                              "/InputSizes": lambda: {"inputSizes": model.input_sizes},
                              "/OutputSizes": lambda: {"outputSizes": model.output_sizes},
                              "/Evaluate": lambda: {"output": [model.function(sum(asked["input"], []))]},
                              "/Gradient": lambda: {"output": model.gradient(asked["input"][0], asked["sens"])},
                              }[self.path]
                    if self.path == "/Evaluate":
                        with lock:
                            outer.calls += 1
                            outer.asked.append(sum(asked["input"], []))
                    self.say(200, json.dumps(answer()))
                except ConnectionAbortedError:  # like a killed server
                    self.close_connection = True
                except Broken as broken:
                    if broken.status:
                        self.say(broken.status, json.dumps({"error": {"type": "InvalidOutput", "message": "broken"}}))
                    elif broken.endless:
                        self.send_response(200)
                        self.send_header("Content-Length", str(10**12))
                        self.end_headers()
                        while True:  # until the client disconnects
                            self.wfile.write(b" ")
                            self.wfile.flush()
                    else:
                        self.say(200, broken.text)

        class Listener(http.server.ThreadingHTTPServer):
            allow_reuse_address = True
            daemon_threads = True
            request_queue_size = 64

            def handle_error(self, *_):  # a client that disconnects
                pass

        self.listener = Listener(("127.0.0.1", port), Handler)
        self.port = self.listener.server_address[1]
        self.url = f"http://127.0.0.1:{self.port}"
        threading.Thread(target=self.listener.serve_forever, kwargs={"poll_interval": 0.01}, daemon=True).start()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.listener.shutdown()
        self.listener.server_close()


class Client:
    """Requests to a server. It returns `error` answers with their status."""

    def __init__(self, url):
        self.connection = http.client.HTTPConnection(urllib.parse.urlparse(url).netloc, timeout=60)

    def get(self, path):
        self.connection.request("GET", path)
        answer = self.connection.getresponse()
        return answer.status, json.loads(answer.read())

    def post(self, path, **body):
        self.connection.request("POST", path, json.dumps(body), {"Content-Type": "application/json"})
        answer = self.connection.getresponse()
        return answer.status, json.loads(answer.read())

    def evaluate(self, name, x):
        status, answer = self.post("/Evaluate", name=name, input=[x], config={})
        assert status == 200, answer
        return answer["output"][0]
