// Implementation of Ranks with MPI (C interface; MPI 3.1). Only this file calls MPI. The file is
// built as a module. The program loads the module only if mpirun has started the program, so that
// the program also runs without MPI.
//
// During shared work, the thread that joined the ranks communicates, and other threads compute. A
// rank requests a unit of work from rank 0 whenever one of its threads is free. At the end, each
// rank sends its outcomes to all ranks.
#include <mpi.h>

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <cstring>
#include <deque>
#include <exception>
#include <limits>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <vector>

#include "base/parallel.hpp"
#include "base/ranks.hpp"

namespace wheeltap::base {
namespace {

using Clock = std::chrono::steady_clock;

enum class Says : std::int64_t { want, give, none, done, stop, pause };

/// Message between ranks during shared work.
struct Message {
  std::int64_t says = 0;
  std::int64_t section = 0;  ///< number of the shared section to which the message belongs
  std::int64_t unit = 0;
};

/// Sleeps increasingly long while a rank has no work and no messages. If ranks share processors, a
/// waiting rank must leave the processor free.
class Backoff {
 public:
  void reset() { wait_ = kFirst; }
  void wait() {
    std::this_thread::sleep_for(wait_);
    wait_ = std::min(2 * wait_, kLongest);
  }

 private:
  static constexpr std::chrono::microseconds kFirst{5}, kLongest{500};
  std::chrono::microseconds wait_ = kFirst;
};

void append(std::string& to, const void* bytes, std::size_t n) {
  to.append(static_cast<const char*>(bytes), n);
}
void append(std::string& to, std::int64_t number) {
  append(to, &number, sizeof number);
}
std::int64_t take(std::string_view& from) {
  std::int64_t number = 0;
  if (from.size() < sizeof number)
    throw std::logic_error("a message from another rank is too short");
  std::memcpy(&number, from.data(), sizeof number);
  from.remove_prefix(sizeof number);
  return number;
}

/// The threads of one rank, which compute the units of the rank, and their outcomes. If the system
/// starts no thread, the list of outcomes is empty.
class Workers {
 public:
  struct Outcome {
    std::int64_t unit;
    std::string bytes;
    std::exception_ptr error;
  };

  Workers(int threads, const std::function<void(int)>& job, const Carriage& carriage)
      : job_(job), carriage_(carriage) {
    const std::scoped_lock lock(mutex_);  // the threads wait until `working_` is known
    enlist(pool_, threads, [this] { work(); });
    working_ = static_cast<int>(pool_.size());
  }
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;
  ~Workers() {
    none_left();
    pool_.clear();
  }

  /// Number of threads that have begun to wait for a unit since the last call.
  [[nodiscard]] int newly_free() {
    const std::scoped_lock lock(mutex_);
    return std::exchange(free_, 0);
  }
  void give(std::int64_t unit) {
    const std::scoped_lock lock(mutex_);
    given_.push_back(unit);
    some_.notify_one();
  }
  void none_left() {
    const std::scoped_lock lock(mutex_);
    closed_ = true;
    some_.notify_all();
  }
  [[nodiscard]] bool ended() {
    const std::scoped_lock lock(mutex_);
    return working_ == 0;
  }
  /// Returns the outcomes; the caller must call this function after all threads have ended.
  [[nodiscard]] std::vector<Outcome>& outcomes() { return outcomes_; }

 private:
  void work() {
    std::unique_lock lock(mutex_);
    while (true) {
      ++free_;
      some_.wait(lock, [&] { return closed_ || !given_.empty(); });
      if (given_.empty()) break;
      Outcome outcome{given_.front(), {}, {}};
      given_.pop_front();
      lock.unlock();
      try {
        job_(static_cast<int>(outcome.unit));
        outcome.bytes = carriage_.pack(static_cast<int>(outcome.unit));
      } catch (...) {
        outcome.error = std::current_exception();
      }
      lock.lock();
      outcomes_.push_back(std::move(outcome));
    }
    --working_;
  }

  const std::function<void(int)>& job_;
  const Carriage& carriage_;
  std::mutex mutex_;
  std::condition_variable some_;
  std::deque<std::int64_t> given_;
  bool closed_ = false;
  int free_ = 0, working_ = 0;
  std::vector<Outcome> outcomes_;
  std::vector<std::jthread> pool_;
};

class MpiRanks final : public Ranks {
 public:
  MpiRanks() {
    int provided = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
    MPI_Comm_dup(MPI_COMM_WORLD, &talk_);
    MPI_Comm_dup(MPI_COMM_WORLD, &together_);
    MPI_Comm_dup(MPI_COMM_WORLD, &farewell_);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &size_);
  }
  ~MpiRanks() override { MPI_Finalize(); }

  [[nodiscard]] int rank() const override { return rank_; }
  [[nodiscard]] int size() const override { return size_; }
  [[nodiscard]] bool stop_agreed() const override { return agreed_; }
  [[nodiscard]] bool stop_requested() const override { return told_to_stop_; }
  [[nodiscard]] bool pause_requested() const override { return told_to_pause_; }

  void share_out(int n, int threads, const std::function<void(int)>& job,
                 const Carriage& carriage) override {
    ++section_;
    told_to_pause_ = false;
    std::vector<Workers::Outcome> mine;
    {
      Workers workers(std::max(1, std::min(thread_count(threads), n)), job, carriage);
      if (rank_ == 0) {
        hand_out(n, workers, carriage);
      } else {
        ask_for(workers);
      }
      mine = std::move(workers.outcomes());
    }
    exchange(n, mine, job, carriage);
  }

  [[nodiscard]] std::string from_first(std::string bytes) override {
    auto size = static_cast<std::int64_t>(bytes.size());
    MPI_Request request = MPI_REQUEST_NULL;
    MPI_Ibcast(&size, sizeof size, MPI_BYTE, 0, together_, &request);
    finish(request);
    bytes.resize(static_cast<std::size_t>(size));
    broadcast(bytes.data(), bytes.size(), 0);
    return bytes;
  }

  [[nodiscard]] bool all_have(const std::string& bytes) override {
    const char same = from_first(bytes) == bytes ? 1 : 0;
    for (const char s : gathered(std::string(1, same))) {
      if (s != 1) return false;
    }
    return true;
  }

  [[nodiscard]] bool meet(double seconds) override {
    MPI_Request request = MPI_REQUEST_NULL;
    MPI_Ibarrier(farewell_, &request);
    const auto end = Clock::now() + std::chrono::duration<double>(seconds);
    for (Backoff backoff; !is_done(request); backoff.wait()) {
      if (Clock::now() >= end) return false;
    }
    return true;
  }

  [[noreturn]] void abort(int exit_code) override {
    MPI_Abort(MPI_COMM_WORLD, exit_code);
    std::abort();
  }

 private:
  // The communication of rank 0: gives the next unit to each rank that requests a unit, including
  // rank 0.
  void hand_out(int n, Workers& workers, const Carriage& carriage) {
    std::int64_t next = 0;
    int at_work = size_ - 1;
    bool stop = false;
    Backoff backoff;
    while (at_work > 0 || !workers.ended()) {
      bool idle = true;
      for (int k = workers.newly_free(); k > 0; --k) {
        next < n ? workers.give(next++) : workers.none_left();
        idle = false;
      }
      int from = 0;
      for (Message message; receive(message, from);) {
        idle = false;
        switch (static_cast<Says>(message.says)) {
          case Says::want:
            next < n ? send(Says::give, next, from) : send(Says::none, 0, from);
            next += next < n ? 1 : 0;
            break;
          case Says::stop:
            stop = true;
            break;
          default:  // done
            --at_work;
        }
      }
      if (!told_to_stop_ && (stop || wishes_to_stop())) {
        told_to_stop_ = true;
        send_all(Says::stop);
      }
      if (!told_to_pause_ && carriage.pause && carriage.pause()) {
        told_to_pause_ = true;
        send_all(Says::pause);
      }
      idle ? backoff.wait() : backoff.reset();
    }
  }

  // The communication of the other ranks.
  void ask_for(Workers& workers) {
    int asked = 0;  // number of requests without an answer
    bool wished = false;
    Backoff backoff;
    while (!workers.ended() || asked > 0) {
      bool idle = true;
      for (int k = workers.newly_free(); k > 0; --k, ++asked) {
        send(Says::want, 0, 0);
        idle = false;
      }
      int from = 0;
      for (Message message; receive(message, from);) {
        idle = false;
        switch (static_cast<Says>(message.says)) {
          case Says::give:
            workers.give(message.unit);
            --asked;
            break;
          case Says::none:
            workers.none_left();
            --asked;
            break;
          case Says::pause:
            told_to_pause_ = true;
            break;
          default:  // stop
            told_to_stop_ = true;
        }
      }
      if (!wished && wishes_to_stop()) {
        wished = true;
        told_to_stop_ = true;
        send(Says::stop, 0, 0);
      }
      idle ? backoff.wait() : backoff.reset();
    }
    send(Says::done, 0, 0);
  }

  void exchange(int n, std::vector<Workers::Outcome>& mine, const std::function<void(int)>& job,
                const Carriage& carriage) {
    constexpr std::int64_t kFailed = 1;
    std::string bytes;
    for (const Workers::Outcome& outcome : mine) {
      append(bytes, outcome.unit);
      append(bytes, outcome.error ? kFailed : 0);
      append(bytes, static_cast<std::int64_t>(outcome.bytes.size()));
      bytes += outcome.bytes;
    }
    std::string head;
    append(head, section_);
    append(head, n);
    append(head, told_to_stop_ || wishes_to_stop() ? 1 : 0);
    append(head, static_cast<std::int64_t>(bytes.size()));
    const std::string heads = gathered(head);
    std::int64_t failed = n;  // lowest number of a failed unit
    std::int64_t done = 0;    // number of completed units; units are given out in order
    std::string_view next = heads;
    for (int r = 0; r < size_; ++r) {
      if (take(next) != section_ || take(next) != n)
        throw std::logic_error("the ranks have taken different branches");
      if (take(next) != 0) agreed_ = true;
      const std::int64_t size = take(next);
      std::string theirs = r == rank_ ? std::move(bytes) : std::string();
      theirs.resize(static_cast<std::size_t>(size));
      broadcast(theirs.data(), theirs.size(), r);
      for (std::string_view rest = theirs; !rest.empty();) {
        const std::int64_t unit = take(rest);
        done = std::max(done, unit + 1);
        const bool fails = take(rest) == kFailed;
        const auto length = static_cast<std::size_t>(take(rest));
        if (fails) failed = std::min(failed, unit);
        if (!fails && r != rank_) carriage.unpack(static_cast<int>(unit), rest.substr(0, length));
        rest.remove_prefix(length);
      }
    }
    if (failed == n) {  // no rank had a thread for these units: every rank computes them itself
      for (; done < n; ++done) job(static_cast<int>(done));
      return;
    }
    for (const Workers::Outcome& outcome : mine) {
      if (outcome.unit == failed) std::rethrow_exception(outcome.error);
    }
    job(static_cast<int>(failed));
    throw std::runtime_error("unit " + std::to_string(failed) + " failed on another rank");
  }

  // Returns the bytes of all ranks; every rank passes the same number of bytes.
  [[nodiscard]] std::string gathered(std::string bytes) {
    std::string all(bytes.size() * static_cast<std::size_t>(size_), '\0');
    MPI_Request request = MPI_REQUEST_NULL;
    const int n = static_cast<int>(bytes.size());
    MPI_Iallgather(bytes.data(), n, MPI_BYTE, all.data(), n, MPI_BYTE, together_, &request);
    finish(request);
    return all;
  }

  // All ranks have already called this function, and the transfer progresses only while a rank
  // polls. The ranks therefore do not sleep.
  void broadcast(void* bytes, std::size_t n, int from) {
    constexpr std::size_t kMost = std::size_t{1} << 30;  // MPI counts bytes as int
    for (std::size_t at = 0; at < n; at += kMost) {
      MPI_Request request = MPI_REQUEST_NULL;
      MPI_Ibcast(static_cast<char*>(bytes) + at, static_cast<int>(std::min(kMost, n - at)),
                 MPI_BYTE, from, together_, &request);
      while (!is_done(request)) std::this_thread::yield();
    }
  }

  static bool is_done(MPI_Request& request) {
    int done = 0;
    MPI_Test(&request, &done, MPI_STATUS_IGNORE);
    return done != 0;
  }
  static void finish(MPI_Request& request) {
    for (Backoff backoff; !is_done(request);) backoff.wait();
  }

  void send(Says says, std::int64_t unit, int to) const {
    const Message message{static_cast<std::int64_t>(says), section_, unit};
    MPI_Send(&message, sizeof message, MPI_BYTE, to, 0, talk_);
  }
  void send_all(Says says) const {
    for (int r = 1; r < size_; ++r) send(says, 0, r);
  }
  // Receives the next message of this section, if one has arrived, and discards messages of earlier
  // sections.
  bool receive(Message& message, int& from) const {
    while (true) {
      int there = 0;
      MPI_Status status;
      MPI_Iprobe(MPI_ANY_SOURCE, 0, talk_, &there, &status);
      if (there == 0) return false;
      from = status.MPI_SOURCE;
      MPI_Recv(&message, sizeof message, MPI_BYTE, from, 0, talk_, MPI_STATUS_IGNORE);
      if (message.section == section_) return true;
    }
  }

  MPI_Comm talk_ = MPI_COMM_NULL, together_ = MPI_COMM_NULL, farewell_ = MPI_COMM_NULL;
  int rank_ = 0, size_ = 1;
  std::int64_t section_ = 0;
  bool agreed_ = false;
  std::atomic<bool> told_to_stop_{false}, told_to_pause_{false};
};

}  // namespace
}  // namespace wheeltap::base

/// Entry point of the module for the program. The caller deletes the result at program end.
extern "C" wheeltap::base::Ranks* wheeltap_join_ranks() {
  return new wheeltap::base::MpiRanks;
}
