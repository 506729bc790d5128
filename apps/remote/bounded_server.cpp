#include "apps/remote/bounded_server.hpp"

#ifdef WHEELTAP_WITH_HTTP

#include <arpa/inet.h>
#include <netdb.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <memory>
#include <system_error>
#include <thread>

namespace wheeltap::apps {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kPoll = 100;  // ms between two checks for a stop of the server

void name_of(const sockaddr_storage& address, socklen_t length, std::string& ip, int& port) {
  char host[NI_MAXHOST] = {}, service[NI_MAXSERV] = {};
  if (getnameinfo(reinterpret_cast<const sockaddr*>(&address), length, host, sizeof host, service,
                  sizeof service, NI_NUMERICHOST | NI_NUMERICSERV) != 0)
    return;
  ip = host;
  port = std::atoi(service);
}

}  // namespace

thread_local socket_t BoundedServer::here_ = INVALID_SOCKET;
thread_local bool BoundedServer::close_ = false;

/// A socket with deadlines.
class BoundedServer::Connection final : public httplib::Stream {
 public:
  Connection(const BoundedServer& server, socket_t socket) : server_(server), socket_(socket) {}

  /// Waits for a request; returns false if no request arrives.
  [[nodiscard]] bool wait_for_request() {
    writing_ = false;
    deadline_ = Clock::now() + server_.bounds_.idle;
    if (begin_ == end_ && !wait(POLLIN)) return false;
    deadline_ = Clock::now() + server_.bounds_.request;
    return true;
  }

  [[nodiscard]] bool is_readable() const override { return begin_ < end_ || wait(POLLIN); }
  [[nodiscard]] bool is_writable() const override { return wait(POLLOUT); }

  ssize_t read(char* to, std::size_t size) override {
    if (begin_ == end_) {  // lines are read byte by byte
      if (!wait(POLLIN)) return -1;
      const ssize_t n = ::recv(socket_, buffer_.data(), buffer_.size(), 0);
      if (n <= 0) return n;
      begin_ = 0;
      end_ = static_cast<std::size_t>(n);
    }
    const std::size_t n = std::min(size, end_ - begin_);
    std::copy_n(buffer_.begin() + static_cast<std::ptrdiff_t>(begin_), n, to);
    begin_ += n;
    return static_cast<ssize_t>(n);
  }

  ssize_t write(const char* from, std::size_t size) override {
    if (!writing_) deadline_ = Clock::now() + server_.bounds_.response;
    writing_ = true;
    if (!wait(POLLOUT)) return -1;
    return ::send(socket_, from, size, MSG_NOSIGNAL | MSG_DONTWAIT);
  }

  void get_remote_ip_and_port(std::string& ip, int& port) const override {
    sockaddr_storage address{};
    socklen_t length = sizeof address;
    if (getpeername(socket_, reinterpret_cast<sockaddr*>(&address), &length) == 0)
      name_of(address, length, ip, port);
  }
  void get_local_ip_and_port(std::string& ip, int& port) const override {
    sockaddr_storage address{};
    socklen_t length = sizeof address;
    if (getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &length) == 0)
      name_of(address, length, ip, port);
  }
  [[nodiscard]] socket_t socket() const override { return socket_; }

 private:
  /// Waits until the socket is ready. Returns false at the deadline or if the server stops.
  [[nodiscard]] bool wait(short what) const {
    while (!server_.stopped()) {
      const auto left =
          std::chrono::duration_cast<std::chrono::milliseconds>(deadline_ - Clock::now()).count();
      if (left <= 0) return false;
      pollfd watched{.fd = socket_, .events = what, .revents = 0};
      const int ready = ::poll(&watched, 1, static_cast<int>(std::min<long>(left, kPoll)));
      if (ready > 0) return true;  // ready, or closed, which reading detects
      if (ready < 0 && errno != EINTR) return false;
    }
    return false;
  }

  const BoundedServer& server_;
  socket_t socket_;
  Clock::time_point deadline_{};
  bool writing_ = false;
  std::array<char, 4096> buffer_{};
  std::size_t begin_ = 0, end_ = 0;  // unread part of the buffer
};

/// One thread per connection.
class BoundedServer::Threads final : public httplib::TaskQueue {
 public:
  void enqueue(std::function<void()> work) override {
    const std::lock_guard lock(mutex_);
    std::erase_if(threads_, [](Running& one) { return one.done->load(); });
    auto done = std::make_shared<std::atomic<bool>>(false);
    try {
      threads_.push_back({std::jthread([work, done] {
                            work();
                            *done = true;
                          }),
                          done});
    } catch (const std::system_error&) {  // the system has no more threads
      work();
    }
  }
  void shutdown() override {
    const std::lock_guard lock(mutex_);
    threads_.clear();  // joins the threads
  }

 private:
  struct Running {
    std::jthread thread;
    std::shared_ptr<std::atomic<bool>> done;
  };
  std::mutex mutex_;
  std::list<Running> threads_;
};

BoundedServer::BoundedServer(const ConnectionBounds& bounds) : bounds_(bounds) {
  new_task_queue = [] { return new Threads; };
  set_payload_max_length(bounds.body);
}

std::optional<std::string> BoundedServer::body_of(const httplib::ContentReader& reader) {
  std::string body;
  const bool whole = reader([&](const char* data, std::size_t size) {
    if (body.size() + size > bounds_.body) return false;
    body.append(data, size);
    return true;
  });
  if (whole) {
    set_waiting(here_, false);
    return body;
  }
  close_ = true;
  return {};
}

void BoundedServer::enter(socket_t socket) {
  const std::lock_guard lock(mutex_);
  open_.insert(socket);
  if (open_.size() > bounds_.connections) {
    // Close the connection that has waited longest; if all are busy, close the new connection.
    const socket_t leaves = waiting_.empty() ? socket : waiting_.front();
    if (!waiting_.empty()) waiting_.pop_front();
    ::shutdown(leaves, SHUT_RDWR);
  }
  waiting_.push_back(socket);
}

void BoundedServer::leave(socket_t socket) {
  const std::lock_guard lock(mutex_);
  waiting_.remove(socket);
  open_.erase(socket);
  ::shutdown(socket, SHUT_RDWR);
  ::close(socket);
}

void BoundedServer::set_waiting(socket_t socket, bool waiting) {
  const std::lock_guard lock(mutex_);
  waiting_.remove(socket);
  if (waiting) waiting_.push_back(socket);
}

bool BoundedServer::process_and_close_socket(socket_t socket) {
  here_ = socket;
  close_ = false;
  enter(socket);
  Connection connection(*this, socket);
  bool well = true;
  for (bool closed = false; well && !closed && !close_;) {
    if (!connection.wait_for_request()) break;
    well = process_request(connection, false, closed, nullptr);
    set_waiting(socket, true);
  }
  leave(socket);
  return well;
}

}  // namespace wheeltap::apps

#endif
