// An HTTP server with limits on the time, threads and memory of each connection.
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

/// Limits of a server and its connections.
struct ConnectionBounds {
  /// Largest number of simultaneous connections. If a connection beyond this number arrives, the
  /// server closes the connection that has waited longest for a request.
  std::size_t connections = 512;
  std::chrono::seconds idle{60};      ///< longest time between two requests of a connection
  std::chrono::seconds request{20};   ///< longest time from the first to the last byte of a request
  std::chrono::seconds response{60};  ///< longest time for sending a response
  /// Largest size of a request after decompression [bytes]
  std::size_t body = std::size_t{16} << 20U;
};

/// A server that gives each connection a thread and a deadline, and limits the number of
/// connections. The server of httplib has no limits per connection. A connection occupies a thread
/// of the thread pool as long as single bytes arrive. A request body of unknown length may have any
/// size. The caller must limit the work that a request causes.
class BoundedServer : public httplib::Server {
 public:
  explicit BoundedServer(const ConnectionBounds& bounds);

  /// Reads the whole body of a request. If the body is too long or incomplete, the result is empty
  /// and the connection is closed.
  [[nodiscard]] std::optional<std::string> body_of(const httplib::ContentReader& reader);

  /// Closes the connection of this thread after the response to a request whose body is not read.
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
  std::list<socket_t> waiting_;        // open connections without a request, the longest wait first
  static thread_local socket_t here_;  // connection that this thread serves
  static thread_local bool close_;     // true if the connection should be closed after the response
};

}  // namespace wheeltap::apps

#endif
