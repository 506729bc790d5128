// An HTTP server with bounds on the time, threads and memory of each connection.
#pragma once

#ifdef WHEELTAP_WITH_HTTP

#include <httplib.h>

#include <chrono>
#include <list>
#include <mutex>
#include <optional>
#include <set>
#include <string>

namespace wheeltap::apps {

/// Bounds of a server and its connections.
struct ConnectionBounds {
  /// Simultaneous connections. One more closes the connection that has waited longest for a
  /// request.
  std::size_t connections = 512;
  std::chrono::seconds idle{60};      ///< between two requests of a connection
  std::chrono::seconds request{20};   ///< for all bytes of a request, from its first to its last
  std::chrono::seconds response{60};  ///< for all bytes of a response
  std::size_t body = std::size_t{16} << 20U;  ///< bytes of a request after decompression
};

/// Gives each connection a thread and a deadline, and limits their number. The server of httplib
/// does not: a connection keeps a thread of its pool as long as single bytes arrive, and the size
/// of bodies without a length has no limit. The caller must bound the work of requests.
class BoundedServer : public httplib::Server {
 public:
  explicit BoundedServer(const ConnectionBounds& bounds);

  /// Reads the whole body of a request; none, with a closed connection, if it is too long or
  /// incomplete.
  [[nodiscard]] std::optional<std::string> body_of(const httplib::ContentReader& reader);

  /// Closes the connection of this thread after its answer, for a request whose body is not read.
  static void close_after_answer() { close_ = true; }

 private:
  class Connection;
  class Threads;

  bool process_and_close_socket(socket_t socket) override;
  [[nodiscard]] bool stopped() const { return svr_sock_ == INVALID_SOCKET; }
  void enter(socket_t socket);
  void leave(socket_t socket);
  void set_waiting(socket_t socket, bool waiting);

  ConnectionBounds bounds_;
  std::mutex mutex_;
  std::set<socket_t> open_;            // open connections
  std::list<socket_t> waiting_;        // open connections without a request, longest wait first
  static thread_local socket_t here_;  // the connection of this thread
  static thread_local bool close_;     // close it after the answer
};

}  // namespace wheeltap::apps

#endif
