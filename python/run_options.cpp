#include "python/run_options.hpp"

#include <pybind11/stl.h>

#include <limits>
#include <stdexcept>

#include "apps/cases/syntax/case_text.hpp"
#include "base/number.hpp"

namespace wheeltap::python {
namespace {

constexpr std::int64_t kMany = 1'000'000'000;

std::int64_t whole(const char* name, const py::handle& value, std::int64_t lowest,
                   std::int64_t highest) {
  const auto n = value.cast<std::int64_t>();
  if (n >= lowest && n <= highest) return n;
  throw std::invalid_argument(std::string(name) + " = " + std::to_string(n) +
                              ", must be a whole number from " + std::to_string(lowest) + " to " +
                              std::to_string(highest));
}

double positive(const char* name, const py::handle& value) {
  const auto x = value.cast<double>();
  if (x > 0.0 && x <= std::numeric_limits<double>::max()) return x;
  throw std::invalid_argument(std::string(name) + " = " + base::number(x) + ", must be > 0");
}

}  // namespace

RunOptions run_options(const py::dict& said) {
  RunOptions out;
  out.common.quiet = true;
  out.common.command_line = "wheeltap from Python";
  for (const auto& [key, value] : said) {
    const auto name = key.cast<std::string>();
    if (value.is_none()) continue;
    const auto count = [&, v = value](std::int64_t lowest, std::int64_t highest) {
      return static_cast<int>(whole(name.c_str(), v, lowest, highest));
    };
    if (name == "seed") {
      out.common.seed = static_cast<std::uint64_t>(
          whole("seed", value, 0, std::numeric_limits<std::int64_t>::max()));
    } else if (name == "threads") {
      out.common.threads = count(1, 4096);
    } else if (name == "max_memory_gb") {
      out.common.max_memory_gb = positive("max_memory_gb", value);
    } else if (name == "max_hours") {
      out.common.max_hours = positive("max_hours", value);
    } else if (name == "allow_hosts") {
      out.common.allow_hosts = value.cast<std::vector<std::string>>();
    } else if (name == "allow_commands") {
      out.common.allow_commands = value.cast<bool>();
    } else if (name == "chains") {
      out.sampling.chains = count(1, 1000);
    } else if (name == "warmup") {
      out.sampling.warmup = count(1, kMany);
    } else if (name == "draws") {
      out.sampling.draws = count(100, kMany);
    } else if (name == "search") {
      out.sampling.searches = count(0, kMany);
    } else if (name == "prior_only") {
      out.sampling.prior_only = value.cast<bool>();
    } else if (name == "quick") {
      out.sampling.quick = value.cast<bool>();
    } else if (name == "evidence") {
      out.sampling.evidence = value.cast<std::string>();
    } else {
      throw std::invalid_argument("there is no option \"" + name + "\"");
    }
  }
  return out;
}

apps::CaseFile case_of(const std::string& path, const py::object& text,
                       const std::vector<std::string>& overrides) {
  if (text.is_none()) return apps::read_case(path, overrides);
  return apps::parse_case(path, text.cast<std::string>(), overrides);
}

}  // namespace wheeltap::python
