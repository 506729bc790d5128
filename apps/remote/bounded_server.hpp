// An HTTP server that bounds what one connection may take: time, threads and memory.
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

/// How much of a server one connection may have.
struct ConnectionBounds {
  /// At a time: for one more, the one is closed whose request has been awaited the longest.
  std::size_t connections = 512;
  std::chrono::seconds idle{60};      ///< between two requests of a connection
  std::chrono::seconds request{20};   ///< for all bytes of a request, from its first to its last
  std::chrono::seconds response{60};  ///< for all bytes of a response
  std::size_t body = std::size_t{16} << 20U;  ///< bytes of a request, unpacked, however it is sent
};

/// httplib lets a connection keep a thread of its pool for as long as a byte comes now and then,
/// and takes bodies without a length however long they are. Here each connection has a thread of
/// its own and a deadline, and they are counted. It is for others to bound the work that requests
/// begin.
class BoundedServer : public httplib::Server {
 public:
  explicit BoundedServer(const ConnectionBounds& bounds);

  /// The whole body of a request whose handler reads it; none where it is too long or does not come
  /// to its end: the connection is closed then.
  [[nodiscard]] std::optional<std::string> body_of(const httplib::ContentReader& reader);

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
  std::set<socket_t> open_;      // those that are not yet closed
  std::list<socket_t> waiting_;  // of these, those whose request has not come; the longest first
  static thread_local socket_t here_;  // of this thread
  static thread_local bool close_;     // it, once its request is answered
};

}  // namespace wheeltap::apps

#endif
