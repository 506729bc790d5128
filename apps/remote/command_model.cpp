#include "apps/remote/command_model.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <optional>
#include <sstream>
#include <system_error>

#include "apps/json_text.hpp"
#include "apps/words.hpp"
#include "base/start_program.hpp"
#include "io/bytes.hpp"
#include "io/text/text.hpp"

namespace wheeltap::apps {

using identification::OutsideModelError;
using Kind = OutsideModelError::Kind;
namespace fs = std::filesystem;

namespace {

constexpr std::size_t kLongestAnswer = 200;  // characters of a program's output in messages

fs::path own_directory() {
  std::error_code error;
  const fs::path temporary = fs::temp_directory_path(error);
  if (error) {
    const char* said = std::getenv("TMPDIR");
    throw OutsideModelError(Kind::unreachable,
                            (said != nullptr ? "TMPDIR=" + std::string(said) : "/tmp") +
                                ": is not a usable folder for the files of the program: set TMPDIR "
                                "to one");
  }
  std::string name = (temporary / "wheeltap-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr)
    throw OutsideModelError(Kind::unreachable,
                            name + ": cannot be created: " + std::strerror(errno));
  return name;
}

void replace(std::string& word, const std::string& what, const std::string& by) {
  for (auto at = word.find(what); at != std::string::npos; at = word.find(what, at + by.size()))
    word.replace(at, what.size(), by);
}

void write(const fs::path& path, const std::string& text) {
  std::ofstream file(path, std::ios::binary);
  file << text;
  file.close();
  if (!file) throw OutsideModelError(Kind::unreachable, path.string() + ": cannot be written");
}

std::string number_text(double x) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), x).ptr};
}

/// Runs a program. Returns its exit status as from waitpid; empty if a timeout killed it.
std::optional<int> run(const std::vector<std::string>& words, const fs::path& directory,
                       double timeout_seconds) {
  const auto opened = [](const fs::path& path, int how) {
    return open(path.c_str(), how | O_CLOEXEC, 0644);
  };
  constexpr int kNew = O_WRONLY | O_CREAT | O_TRUNC;
  const std::array files{opened("/dev/null", O_RDONLY), opened(directory / "stdout.txt", kNew),
                         opened(directory / "stderr.txt", kNew)};
  const pid_t pid = base::start_program({.file = words[0].c_str(),
                                         .words = words,
                                         .directory = directory.string(),
                                         .input = files[0],
                                         .output = files[1],
                                         .error = files[2]});
  const std::string trouble = std::strerror(errno);
  for (const int file : files) close(file);
  if (pid < 0) throw OutsideModelError(Kind::unreachable, "cannot start a process: " + trouble);
  const auto handle = static_cast<int>(syscall(SYS_pidfd_open, pid, 0));
  if (handle < 0) {
    kill(-pid, SIGKILL);
    (void)base::wait_for(pid);
    throw OutsideModelError(Kind::unreachable, "this system does not support pidfd_open");
  }
  const auto end =
      std::chrono::steady_clock::now() + std::chrono::duration<double>(timeout_seconds);
  bool late = false;
  while (true) {
    const double left =
        std::chrono::duration<double>(end - std::chrono::steady_clock::now()).count();
    pollfd watched{.fd = handle, .events = POLLIN, .revents = 0};
    const int ready =
        left > 0.0 ? poll(&watched, 1, static_cast<int>(std::min(1e9, std::ceil(1e3 * left)))) : 0;
    if (ready > 0) break;
    if (ready < 0 && errno == EINTR) continue;
    late = true;
    break;
  }
  // Kill its whole process group.
  kill(-pid, SIGKILL);
  if (late) kill(pid, SIGKILL);
  const int status = base::wait_for(pid);
  close(handle);
  if (late) return {};
  return status;
}

std::string last_words(const fs::path& directory) {
  std::string said;
  try {
    said = io::read_bytes(directory / "stderr.txt");
  } catch (const std::exception&) {
    return {};
  }
  while (!said.empty() && (said.back() == '\n' || said.back() == ' ')) said.pop_back();
  said.erase(0, said.rfind('\n') + 1);  // npos + 1 = 0
  if (said.size() > kLongestAnswer) said = said.substr(0, kLongestAnswer) + "...";
  return said.empty() ? "" : ": " + said;
}

}  // namespace

CommandModel::CommandModel(CommandSpec spec, std::vector<std::string> names, int outputs)
    : spec_(std::move(spec)), names_(std::move(names)), outputs_(outputs) {}

std::vector<std::string> CommandModel::words_in(const fs::path& directory) const {
  std::vector<std::string> words = spec_.words;
  const char* ending = spec_.numbers ? ".txt" : ".json";
  for (std::string& word : words) {
    replace(word, "{in}", (directory / "in").string() + ending);
    replace(word, "{out}", (directory / "out").string() + ending);
    replace(word, "{case}", spec_.folder.string());
  }
  if (words[0].find('/') != std::string::npos && fs::path(words[0]).is_relative())
    words[0] = (spec_.folder / words[0]).lexically_normal().string();
  return words;
}

std::string CommandModel::answer_in(const fs::path& file, std::span<double> y) const {
  std::error_code missing;
  if (!fs::exists(file, missing))
    return "the program ended with exit code 0 but wrote no predictions";
  if (const auto bytes = fs::file_size(file, missing); !missing && bytes > kLargestAnswer)
    return "the program wrote " + std::to_string(bytes) + " bytes, more than the " +
           std::to_string(kLargestAnswer) + " allowed";
  const std::string text = io::read_bytes(file);
  std::vector<double> found;
  if (spec_.numbers) {
    std::istringstream words(text);
    for (std::string word; words >> word;) {
      double value = 0.0;
      const char* begin = word.data() + (word[0] == '+' ? 1 : 0);
      const auto [end, error] = std::from_chars(begin, word.data() + word.size(), value);
      if (error != std::errc() || end != word.data() + word.size())
        return "the program wrote \"" + word.substr(0, kLongestAnswer) +
               "\", which is not a number";
      found.push_back(value);
    }
  } else {
    Json said = parse_answer(text);
    if (said.is_object() && said.contains("predictions")) said = Json(said["predictions"]);
    if (said.is_discarded()) {
      if (text.find("NaN") == std::string::npos && text.find("Infinity") == std::string::npos)
        return "the program wrote invalid JSON";
      return "the program wrote numbers that are not finite: " + text.substr(0, kLongestAnswer);
    }
    if (!said.is_array())
      return "the program wrote neither a list nor an object with \"predictions\"";
    for (const Json& value : said) {
      if (!value.is_number())
        return "the program wrote " + value.dump().substr(0, kLongestAnswer) +
               ", which is not a number";
      found.push_back(value.get<double>());
    }
  }
  if (found.size() != y.size())
    return "the program wrote " + std::to_string(found.size()) + " predictions, must be " +
           std::to_string(y.size());
  for (std::size_t i = 0; i < y.size(); ++i) {
    if (!std::isfinite(found[i]))
      return "prediction " + std::to_string(i + 1) + " is " + number_text(found[i]) +
             ", must be a finite number";
    y[i] = found[i];
  }
  return {};
}

std::string CommandModel::attempt(std::span<const double> x, std::span<double> y, bool last) {
  const fs::path directory = own_directory();
  const std::vector<std::string> words = words_in(directory);
  std::string text;
  if (spec_.numbers) {
    for (const double value : x) text += number_text(value) + "\n";
  } else {
    Json values = Json::object();
    for (std::size_t i = 0; i < x.size(); ++i) values[names_[i]] = x[i];
    text = values.dump() + "\n";
  }
  write(directory / (spec_.numbers ? "in.txt" : "in.json"), text);
  const auto status = run(words, directory, spec_.patience.timeout_seconds);
  std::string trouble;
  if (!status) {
    trouble = "took longer than " + significant(spec_.patience.timeout_seconds, 3) +
              " s (\"timeout\" in the predictor) and was killed";
  } else if (WIFSIGNALED(*status)) {
    trouble = "was ended by signal " + std::to_string(WTERMSIG(*status)) + last_words(directory);
  } else if (const int code = WEXITSTATUS(*status);
             code == base::kProgramNotFound || code == base::kNotRunnable) {
    const std::string words_of_it = last_words(directory);
    trouble = words_of_it.empty()
                  ? (code == base::kProgramNotFound ? "does not exist" : "cannot be run")
                  : "ended with exit code " + std::to_string(code) + words_of_it;
  } else if (code != 0) {
    trouble = "ended with exit code " + std::to_string(code) + last_words(directory);
  } else {
    trouble = answer_in(directory / (spec_.numbers ? "out.txt" : "out.json"), y);
  }
  if (trouble.empty() || !last) {
    std::error_code ignored;
    fs::remove_all(directory, ignored);
    return trouble;
  }
  return words[0] + ": " + trouble + " (its files are in " + directory.string() + ")";
}

void CommandModel::evaluate(std::span<const double> x, std::span<double> y) {
  std::string trouble;
  const int tries = spec_.patience.retries + 1;
  for (int i = 0; i < tries; ++i) {
    trouble = attempt(x, y, i + 1 == tries);
    if (trouble.empty()) return;
  }
  const std::string times = tries > 1 ? ", " + std::to_string(tries) + " times" : "";
  throw OutsideModelError(Kind::bad_answer,
                          io::printable(trouble + times + ", at " +
                                        Json(std::vector<double>(x.begin(), x.end())).dump()));
}

}  // namespace wheeltap::apps
