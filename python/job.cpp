#include "python/job.hpp"

#include <exception>
#include <thread>

namespace wheeltap::python {

namespace {

constexpr std::chrono::milliseconds kBetweenLooks{50};

}  // namespace

void Job::publish(Progress progress) {
  const std::scoped_lock lock(mutex_);
  news_ = std::move(progress);
}

bool Job::ended_within(std::chrono::milliseconds time) {
  std::unique_lock lock(mutex_);
  return ended_.wait_for(lock, time, [&] { return has_ended_; });
}

std::optional<Progress> Job::news() {
  const std::scoped_lock lock(mutex_);
  return std::exchange(news_, std::nullopt);
}

void watched(const py::object& progress, const std::function<void(Job&)>& work) {
  Job job;
  std::exception_ptr failed;
  std::optional<py::error_already_set> raised;
  std::thread thread([&] {
    // Create this thread's Python state once, for all callbacks into Python.
    const py::gil_scoped_acquire held;
    {
      const py::gil_scoped_release released;
      try {
        work(job);
      } catch (...) {
        failed = std::current_exception();
      }
    }
    const std::scoped_lock lock(job.mutex_);
    job.has_ended_ = true;
    job.ended_.notify_all();
  });
  {
    const py::gil_scoped_release released;
    for (bool ended = false; !ended;) {
      ended = job.ended_within(kBetweenLooks);
      const py::gil_scoped_acquire held;
      try {
        if (raised) continue;
        if (PyErr_CheckSignals() != 0) throw py::error_already_set();
        const auto news = job.news();
        if (news && !progress.is_none() && progress(*news).is(py::bool_(false))) job.stop();
      } catch (py::error_already_set& error) {
        raised.emplace(error);
        job.stop();
      }
    }
    thread.join();
  }
  if (raised) throw py::error_already_set(*raised);
  if (failed) std::rethrow_exception(failed);
}

}  // namespace wheeltap::python
